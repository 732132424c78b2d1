#!/bin/sh
# npy.sh - arrays that NumPy saved: the same array is the same volume, whatever its type, byte order
# and order in memory; within any memory.
. tests/support/tap.sh

export PYTHONDONTWRITEBYTECODE=1
python=$(python_with numpy)
if [ -z "$python" ]; then
    skip "files of NumPy" "no python3-numpy here"
    finish
fi
cat >"$tmp/lib.py" <<'PY'
import sys
sys.path.insert(0, "tests/support")
import numpy as np
from grid_truth import same, refused, end
tmp = sys.argv[1]
rng = np.random.default_rng(11)
names = {"u1": "u8", "i1": "i8", "u2": "u16", "i2": "i16", "u4": "u32", "i4": "i32", "u8": "u64", "i8": "i64",
         "f2": "f16", "f4": "f32", "f8": "f64"}
def some(name, shape):
    a = rng.standard_normal(shape) * 100
    return np.abs(a).astype(name) if name[0] == "u" else a.astype(name)
def read_as(a):
    name = a.dtype.newbyteorder("=").str[1:]
    return a.astype({"f2": "f4", "u8": "f8", "i8": "f8", "b1": "u1"}.get(name, name))
PY
begin() { cat "$tmp/lib.py" - >"$tmp/test.py"; }

begin <<'PY'
for name, source in names.items():
    for order in "<>":
        for memory in "CF":
            a = np.array(some(name, (3, 4, 5)), np.dtype(name).newbyteorder(order), order=memory)
            np.save(f"{tmp}/a.npy", a)
            same(f"{tmp}/a.npy", read_as(a), np.eye(4), source=source)
a = rng.random((3, 4, 5)) > 0.5
np.save(f"{tmp}/b.npy", a)
same(f"{tmp}/b.npy", a.astype("u1"), source="u8")
for version in (1, 0), (2, 0), (3, 0):
    with open(f"{tmp}/v.npy", "wb") as f:
        np.lib.format.write_array(f, some("f4", (3, 4, 5)), version=version)
    same(f"{tmp}/v.npy", np.load(f"{tmp}/v.npy"))
end()
PY
exits "every type, byte order, order in memory and version" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
for memory in "CF":
    a = np.array(some("i2", (6, 3, 4, 5)), order=memory)
    np.save(f"{tmp}/steps.npy", a)
    for step in range(6):
        same(f"{tmp}/steps.npy", a[step], None, ("--step", step))
    refused(f"{tmp}/steps.npy", "no step 6: there are 6", "--step", 6)
    a = np.array(some("f4", (3, 4, 5, 3)), order=memory)
    np.save(f"{tmp}/vectors.npy", a)
    for c in range(3):
        same(f"{tmp}/vectors.npy", a[..., c], None, ("--component", c + 1))
    w = a.astype("f8")
    same(f"{tmp}/vectors.npy", np.sqrt(w[..., 0] ** 2 + w[..., 1] ** 2 + w[..., 2] ** 2).astype("f4"))
    for name in "c8", "c16":
        a = np.array(some("f8", (2, 3, 4, 5)), order=memory)
        a = np.array((a[0] + 1j * a[1]).astype(name), order=memory)
        np.save(f"{tmp}/complex.npy", a)
        same(f"{tmp}/complex.npy", a.real, None, ("--component", 1))
        same(f"{tmp}/complex.npy", a.imag, None, ("--component", 2))
    a = np.array((some("f4", (7, 3, 4, 5)) * 1j).astype("c8"), order=memory)
    np.save(f"{tmp}/complex.npy", a)
    same(f"{tmp}/complex.npy", a.imag[4], None, ("--component", 2, "--step", 4))
    a = np.array(some("f4", (1, 1, 3, 4, 5)), order=memory)
    np.save(f"{tmp}/ones.npy", a)
    same(f"{tmp}/ones.npy", a[0, 0])
end()
PY
exits "steps, vectors, complex numbers" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
# Passes as the memory wants them, blocks as the reader asks for them.
for shape in (61, 150, 40), (200, 31, 33), (40, 40, 90):
    for name in "u1", "f4", "i8":
        a = np.asfortranarray(some(name, shape))
        np.save(f"{tmp}/f.npy", a)
        for memory in 0, 400_000, 1_000_000:
            for slices in 1, 7, shape[0]:
                if not memory or slices * a[0].nbytes < memory / 2:
                    same(f"{tmp}/f.npy", read_as(a), None, ("--memory", memory, "--slices", slices))
# A budget that does not hold one pass: none for a pipe.
import subprocess, grid_truth
with open(f"{tmp}/f.npy", "rb") as f:
    done = subprocess.run([grid_truth.tool, "-", "--memory", "400000"], stdin=f, capture_output=True)
assert done.returncode == 4 and b"fewer where it is a file" in done.stderr, done.stderr
with open(f"{tmp}/f.npy", "rb") as f:
    done = subprocess.run([grid_truth.tool, "-"], stdin=f, capture_output=True)
assert done.stdout.endswith(np.ascontiguousarray(read_as(a)).tobytes())
end()
PY
exits "Fortran order within any memory, and from a pipe" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
np.save(f"{tmp}/r.npy", np.zeros((3, 4, 5), [("a", "f4"), ("b", "f4")]))
refused(f"{tmp}/r.npy", "'descr': supported are")
np.save(f"{tmp}/r.npy", np.zeros((3, 4, 5), "S4"))
refused(f"{tmp}/r.npy", "'descr': supported are")
np.save(f"{tmp}/r.npy", np.zeros((3, 4, 5), object))
refused(f"{tmp}/r.npy", "'descr': supported are")
np.save(f"{tmp}/r.npy", np.zeros((3, 4, 5), np.longdouble))
refused(f"{tmp}/r.npy", "'descr': supported are")
np.save(f"{tmp}/r.npy", np.zeros((3, 4)))
refused(f"{tmp}/r.npy", "1 sample along z")
np.save(f"{tmp}/r.npy", np.zeros((3, 1, 4)))
refused(f"{tmp}/r.npy", "1 sample along y")
np.save(f"{tmp}/r.npy", np.zeros((2, 3, 4, 5, 6)))
refused(f"{tmp}/r.npy", "expected (z, y, x)")
big = np.full((2, 3, 4), 2**53 + 1)
np.save(f"{tmp}/r.npy", big)
refused(f"{tmp}/r.npy", "slice 0 (counted from 0): the sample with index 0")
end()
PY
exits "refused" 0 "$python" "$tmp/test.py" "$tmp"
exits "convert" 0 "$leafcast" convert "$tmp/f.npy" --memory 64M -o "$tmp/f.leaf"
exits "what it makes is sound" 0 "$leafcast" verify "$tmp/f.leaf"
finish
