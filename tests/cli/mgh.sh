#!/bin/sh
# mgh.sh - FreeSurfer volumes written by nibabel: the samples and the place that it reads back, of every type, packed or
# not, with frames; and what is refused.
# marks: leaks
. tests/support/tap.sh

export PYTHONDONTWRITEBYTECODE=1
python=$(python_with nibabel)
if [ -z "$python" ]; then
    skip "files of nibabel" "no python3-nibabel here"
    finish
fi
cat >"$tmp/test.py" <<'PY'
import sys
sys.path.insert(0, "tests/support")
import numpy as np, nibabel as nib
from grid_truth import same, refused, end
tmp = sys.argv[1]
rng = np.random.default_rng(11)
from nibabel.eulerangles import euler2mat
turn = np.eye(4)
turn[:3, :3] = euler2mat(0.3, -0.2, 1.1) @ np.diag([0.75, 1.5, -2])
turn[:3, 3] = -10, 20, 30.5
for suffix in "mgh", "mgz":
    path = f"{tmp}/a.{suffix}"
    for name, source in ("u1", "u8"), ("i2", "i16"), ("i4", "i32"), ("f4", "f32"):
        a = (rng.standard_normal((5, 4, 3)) * 50).astype("f4")
        a = np.abs(a).astype(name) if name == "u1" else a.astype(name)
        nib.save(nib.MGHImage(a, turn), path)
        back = nib.load(path)
        same(path, np.asarray(back.dataobj).T, back.affine, source=source, tolerance=1e-5)
    frames = rng.standard_normal((5, 4, 3, 4)).astype("f4")
    nib.save(nib.MGHImage(frames, turn), path)
    same(path, frames[..., 0].T, turn, tolerance=1e-5)
    same(path, frames[..., 2].T, turn, ("--step", 2), tolerance=1e-5)
# The same file without a place: FreeSurfer's own, from right to left, down, to the front. (nibabel turns its y and z.)
a = np.arange(60, dtype=">f4").reshape(3, 4, 5)
nib.save(nib.MGHImage(a.T.astype("f4"), turn), f"{tmp}/a.mgh")
data = bytearray(open(f"{tmp}/a.mgh", "rb").read())
def hurt(at, value):
    copy = bytearray(data)
    copy[at:at + len(value)] = value
    open(f"{tmp}/b.mgh", "wb").write(copy)
    return f"{tmp}/b.mgh"
path = hurt(28, b"\0\0")
same(path, a.astype("f4"), [[-1, 0, 0, 2.5], [0, 0, 1, -1.5], [0, -1, 0, 2]])
refused(hurt(0, b"\0\0\0\2"), "byte 0: version 2, expected 1")
refused(hurt(20, b"\0\0\0\2"), "byte 20: type 2")
refused(hurt(8, b"\0\0\0\0"), "byte 8: 0 samples along an axis")
refused(hurt(16, b"\xff\xff\xff\xff"), "byte 16: -1 frames")
refused(hurt(4, b"\0\0\1\0"), "ends at byte")
open(f"{tmp}/b.mgh", "wb").write(data[:100])
refused(f"{tmp}/b.mgh", "ends at byte 100, expected a header of 284")
# Its content tells, whatever its name is.
open(f"{tmp}/head", "wb").write(data)
same(f"{tmp}/head", a.astype("f4"))
end()
PY
ok "what nibabel writes and reads" "$python" "$tmp/test.py" "$tmp"
cat >"$tmp/world.py" <<'PY'
import sys, numpy as np, nibabel as nib
a = np.arange(60, dtype="f4").reshape(5, 4, 3)
nib.save(nib.MGHImage(a, np.diag([-2, 3, 4, 1])), sys.argv[1])
PY
"$python" "$tmp/world.py" "$tmp/w.mgz"
exits "its world" 0 "$leafcast" info "$tmp/w.mgz"
ok "is RAS, in mm" grep -q '^axes .*RAS.*mm' "$tmp/out"
ok "and its format is told" grep -q '^format  *FreeSurfer$' "$tmp/out"
finish
