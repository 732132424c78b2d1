#!/bin/sh
# mrc.sh - maps that mrcfile wrote: samples, spacing and origin as it reads them, modes, byte orders,
# axes in any order, stacks of volumes.
. tests/support/tap.sh

export PYTHONDONTWRITEBYTECODE=1
python=$(python_with mrcfile)
if [ -z "$python" ]; then
    skip "files of mrcfile" "no python3-mrcfile here"
    finish
fi
cat >"$tmp/test.py" <<'PY'
import sys, itertools, warnings
sys.path.insert(0, "tests/support")
import numpy as np, mrcfile
from grid_truth import same, refused, end
tmp = sys.argv[1]
rng = np.random.default_rng(5)
path = f"{tmp}/a.mrc"
def some(name, shape):
    a = rng.standard_normal(shape) * 50
    return np.abs(a).astype(name) if name[0] == "u" else a.astype(name)
def save(a, **more):
    with mrcfile.new(path, overwrite=True) as m:
        m.set_data(a)
        m.voxel_size = (1.5, 2.5, 4)
        m.header.origin = (10, -20, 30.5)
        if "extended" in more:
            m.set_extended_header(np.array(b"x" * 777))
        for key, value in more.items():
            if key != "extended":
                m.header[key] = value
    with mrcfile.open(path, permissive=True) as m:
        return m.data.copy(), m.voxel_size, m.header.origin
half = getattr(np, "float16")
for name, source in ("i1", "i8"), ("i2", "i16"), ("f4", "f32"), ("u2", "u16"), ("f2", "f16"):
    a = some(name, (3, 4, 5))
    try:
        data, v, o = save(a)
    except ValueError:
        print("# mrcfile does not write", name)
        continue
    if data.dtype != np.dtype(name): # an older mrcfile widens half to float
        source = "f32"
    want = data.astype("f4") if data.dtype == half else data
    same(path, want, [[v.x, 0, 0, o.x], [0, v.y, 0, o.y], [0, 0, v.z, o.z]], source=source)
data, *_ = save(some("i2", (3, 4, 5)), extended=1)
same(path, data)
# The other byte order: every word of the header, and the samples, turned around.
a = some("f4", (3, 4, 5))
save(a)
raw = bytearray(open(path, "rb").read())
words = np.frombuffer(bytes(raw[:208]), "<u4").astype(">u4").tobytes()
raw[:208] = words[:208]
raw[212:216] = b"\x11\x11\0\0"
raw[216:220] = np.frombuffer(bytes(raw[216:220]), "<u4").astype(">u4").tobytes()
raw[1024:] = a.astype(">f4").tobytes()
open(path, "wb").write(raw)
with mrcfile.open(path) as m:
    assert np.array_equal(m.data, a)
same(path, a, [[1.5, 0, 0, 10], [0, 2.5, 0, -20], [0, 0, 4, 30.5]], source="f32")
# Axes in any order: node (i, j, k) of the file lies where the columns say.
a = some("i2", (3, 4, 5))
for axes in itertools.permutations((1, 2, 3)):
    with mrcfile.new(path, overwrite=True) as m:
        m.set_data(a)
        m.header.mapc, m.header.mapr, m.header.maps = axes
        m.header.cella = (30, 44, 60)
        m.header.mx, m.header.my, m.header.mz = 10, 11, 12
        m.header.nxstart, m.header.nystart, m.header.nzstart = 2, -3, 4
        m.header.origin = (0, 0, 0)
    step = (3, 4, 5)
    world = np.zeros((3, 4))
    for i, (axis, start) in enumerate(zip(axes, (2, -3, 4))):
        world[axis - 1, i] = step[axis - 1]
        world[axis - 1, 3] = start * step[axis - 1]
    same(path, a, world)
# A cell with angles.
with mrcfile.new(path, overwrite=True) as m:
    m.set_data(a)
    m.header.cella = (30, 44, 60)
    m.header.mx, m.header.my, m.header.mz = 10, 11, 12
    m.header.cellb = (80, 95, 120)
ca, cb, cg = np.cos(np.radians((80, 95, 120)))
sg = np.sin(np.radians(120))
v = np.sqrt(1 - ca * ca - cb * cb - cg * cg + 2 * ca * cb * cg)
world = np.array([[3, 4 * cg, 5 * cb, 0], [0, 4 * sg, 5 * (ca - cb * cg) / sg, 0], [0, 0, 5 * v / sg, 0]])
same(path, a, world, tolerance=1e-12)
# A stack of volumes.
a = some("i2", (6, 3, 4, 5))
with mrcfile.new(path, overwrite=True) as m:
    m.set_data(a)
    assert m.is_volume_stack()
for step in range(6):
    same(path, a[step], None, ("--step", step))
with mrcfile.new(path, overwrite=True) as m:
    m.set_data((some("f4", (3, 4, 5)) * 1j).astype("c8"))
refused(path, "mode 4: supported are")
end()
PY
exits "maps of mrcfile" 0 "$python" -W ignore "$tmp/test.py" "$tmp"
finish
