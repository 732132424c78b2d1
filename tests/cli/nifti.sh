#!/bin/sh
# nifti.sh - NIfTI files written by nibabel: the samples and the transform that it reads back, of every
# type, byte order, version and form.
# marks: long
. tests/support/tap.sh

export PYTHONDONTWRITEBYTECODE=1
python=$(python_with nibabel)
if [ -z "$python" ]; then
    skip "files of nibabel" "no python3-nibabel here"
    finish
fi
cat >"$tmp/lib.py" <<'PY'
import os, sys
sys.path.insert(0, "tests/support")
import numpy as np, nibabel as nib
from grid_truth import same, refused, end
tmp = sys.argv[1]
rng = np.random.default_rng(7)
def some(dtype, shape):
    dtype = np.dtype(dtype)
    if dtype.kind == "f":
        return rng.standard_normal(shape).astype(dtype)
    info = np.iinfo(dtype)
    lo, hi = (info.min, info.max) if dtype.itemsize < 8 else (-2**50 if info.min else 0, 2**50)
    return rng.integers(lo, hi, shape, dtype=dtype, endpoint=True)
# Turned, sheared, scaled differently, mirrored.
turn = np.array([[0.3, -1.2, 0.5, -10], [2, 0.25, 0.1, 20], [-0.4, 0.3, 3, 30.5], [0, 0, 0, 1]])
def turned(angles, zooms, offset):
    from nibabel.eulerangles import euler2mat
    m = np.eye(4)
    m[:3, :3] = euler2mat(*angles) @ np.diag(zooms)
    m[:3, 3] = offset
    return m
PY
begin() { cat "$tmp/lib.py" - >"$tmp/test.py"; }

begin <<'PY'
names = {"u1": "u8", "i1": "i8", "u2": "u16", "i2": "i16", "u4": "u32", "i4": "i32", "u8": "u64", "i8": "i64", "f4": "f32", "f8": "f64"}
for cls, version in (nib.Nifti1Image, 1), (nib.Nifti2Image, 2), (nib.Nifti1Pair, 3), (nib.Nifti2Pair, 4):
    for name, source in names.items():
        for order in "<>":
            a = some(name, (5, 4, 3))
            header = cls.header_class(endianness=order)
            header.set_data_dtype(np.dtype(name).newbyteorder(order))
            image = cls(a, turn, header)
            path = f"{tmp}/{version}{source}{'be' if order == '>' else 'le'}" + (".nii" if version < 3 else ".hdr")
            nib.save(image, path)
            back = nib.load(path)
            assert back.header.endianness == order
            stored = np.asarray(back.dataobj)
            assert stored.dtype.newbyteorder("=") == np.dtype(name)
            want = stored.T.astype("f8") if np.dtype(name).itemsize == 8 else stored.T
            same(path, want, back.affine, source=source)
end()
PY
exits "every type, either order, NIfTI-1 and 2, single files and pairs" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
# The sform goes before the qform; each alone; none.
a = some("i2", (5, 4, 3))
for cls in nib.Nifti1Image, nib.Nifti2Image:
    for i, angles in enumerate(((0.3, -0.7, 1.9), (0, 0, np.pi), (np.pi, 0, 0), (0, np.pi, 0), (2.5, 1, -3))):
        for flip in 1, -1:
            q = turned(angles, (1.5, 2.5, 3.5 * flip), (7, -8, 9.25))
            image = cls(a, None)
            image.set_sform(None, 0)
            image.set_qform(q, 2)
            nib.save(image, f"{tmp}/q.nii")
            back = nib.load(f"{tmp}/q.nii")
            assert np.allclose(back.affine, q, atol=1e-5)
            same(f"{tmp}/q.nii", a.T, back.affine, tolerance=3e-6)
            image.set_sform(turn, 1)
            nib.save(image, f"{tmp}/q.nii")
            back = nib.load(f"{tmp}/q.nii")
            same(f"{tmp}/q.nii", a.T, back.affine)
    image = cls(a, None)
    image.header.set_zooms((0.5, 2, 4))
    nib.save(image, f"{tmp}/n.nii")
    assert nib.load(f"{tmp}/n.nii").header["qform_code"] == 0 == nib.load(f"{tmp}/n.nii").header["sform_code"]
    same(f"{tmp}/n.nii", a.T, np.diag((0.5, 2, 4, 1)))
end()
PY
exits "sform, qform, neither" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
for slope, inter in (0.0123, -7.75), (2, 0), (1, 3), (1, 0), (-0.5, 1e6):
    for name in "u1", "i2", "i4", "f4", "i8":
        a = some(name, (5, 4, 3))
        image = nib.Nifti1Image(a, turn, dtype=name)
        image.header.set_slope_inter(slope, inter)
        nib.save(image, f"{tmp}/s.nii")
        raw = bytearray(open(f"{tmp}/s.nii", "rb").read()) # nibabel scales what it writes: the same numbers again
        raw[352:] = np.ascontiguousarray(a.T).tobytes()
        open(f"{tmp}/s.nii", "wb").write(raw)
        back = nib.load(f"{tmp}/s.nii")
        assert np.allclose(back.dataobj.slope, slope) and np.allclose(back.dataobj.inter, inter)
        plain = slope == 1 and inter == 0
        wide = name in ("i4", "i8")
        want = a.T if plain and name != "i8" else a.T.astype("f8") if plain else back.get_fdata().T.astype("f8" if wide else "f4")
        same(f"{tmp}/s.nii", want, back.affine)
end()
PY
exits "scl_slope and scl_inter" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
# Four axes: steps. Five: vectors. RGB and complex.
a = some("i2", (5, 4, 3, 6))
nib.save(nib.Nifti1Image(a, turn), f"{tmp}/t.nii")
for step in range(6):
    same(f"{tmp}/t.nii", a[..., step].T, nib.load(f"{tmp}/t.nii").affine, ("--step", step))
same(f"{tmp}/t.nii", a[..., 0].T)
nib.save(nib.Nifti1Image(a, turn), f"{tmp}/t.nii.gz")
nib.save(nib.Nifti2Pair(a, turn), f"{tmp}/p.img.gz")
for name in "t.nii.gz", "p.hdr.gz":
    same(f"{tmp}/{name}", a[..., 2].T, nib.load(f"{tmp}/{name}").affine, ("--step", 2))
refused(f"{tmp}/t.nii", "no step 6: there are 6", "--step", 6)
v = some("f4", (5, 4, 3, 1, 3))
nib.save(nib.Nifti1Image(v, turn), f"{tmp}/v.nii")
for c in range(3):
    same(f"{tmp}/v.nii", v[..., 0, c].T, None, ("--component", c + 1))
w = v[..., 0, :].astype("f8")
same(f"{tmp}/v.nii", np.sqrt(w[..., 0] ** 2 + w[..., 1] ** 2 + w[..., 2] ** 2).T.astype("f4"))
refused(f"{tmp}/v.nii", "no component 4: a sample has 3", "--component", 4)
v = some("i2", (5, 4, 3, 4, 3))
nib.save(nib.Nifti1Image(v, turn), f"{tmp}/u.nii")
same(f"{tmp}/u.nii", v[..., 2, 1].T, None, ("--component", 2, "--step", 2))
for n, letters in (3, "RGB"), (4, "RGBA"):
    c = some("u1", (5, 4, 3, n))
    packed = c.copy().view([(x, "u1") for x in letters]).reshape(5, 4, 3)
    nib.save(nib.Nifti1Image(packed, turn), f"{tmp}/c.nii")
    for i in range(n):
        same(f"{tmp}/c.nii", c[..., i].T, None, ("--component", i + 1))
    d = c.astype("f8")
    same(f"{tmp}/c.nii", (0.2126 * d[..., 0] + 0.7152 * d[..., 1] + 0.0722 * d[..., 2]).T.astype("f4"), source="u8")
z = some("f4", (5, 4, 3)) + 1j * some("f4", (5, 4, 3))
z = z.astype("c8")
nib.save(nib.Nifti1Image(z, turn), f"{tmp}/z.nii")
same(f"{tmp}/z.nii", z.real.T, None, ("--component", 1))
same(f"{tmp}/z.nii", z.imag.T, None, ("--component", 2))
end()
PY
exits "steps, vectors, colours, complex numbers" 0 "$python" "$tmp/test.py" "$tmp"

# The whole way: what convert makes of it has the transform, and info the type.
exits "convert" 0 "$leafcast" convert "$tmp/1i16be.nii" -o "$tmp/a.leaf"
exits "info" 0 "$leafcast" info "$tmp/a.leaf" --json
ok "has the turned transform" python3 - "$tmp/out" <<'PY'
import json, sys
x = json.load(open(sys.argv[1]))
want = [0.3, -1.2, 0.5, -10, 2, 0.25, 0.1, 20, -0.4, 0.3, 3, 30.5]
sys.exit(not all(abs(a - b) < 1e-6 for a, b in zip(x["to_world"], want)) or x["source_type"] != "i16")
PY
exits "a view of it" 0 "$leafcast" render "$tmp/a.leaf" --iso 0 --size 64x64 -o "$tmp/a.png"
exits "a step by convert" 0 "$leafcast" convert "$tmp/t.nii.gz" --step 3 -o "$tmp/t.leaf"
exits "a component of what has none" 2 "$leafcast" convert "$tmp/1i16be.nii" --component 1 -o "$tmp/t.leaf" --force
exits "info of scaled samples" 0 "$leafcast" info "$tmp/c.nii" --json
ok "tells both types" grep -q '"source_type": "u8"' "$tmp/out"
begin <<'PY'
# Of a pair the image, too; another header beside an image says nothing of it.
a = some("i2", (5, 4, 3))
for cls in nib.Nifti1Pair, nib.Nifti2Pair:
    for packed in "", ".gz":
        nib.save(cls(a, turn), f"{tmp}/i.hdr{packed}")
        same(f"{tmp}/i.img{packed}", a.T, nib.load(f"{tmp}/i.hdr{packed}").affine)
        for file in "i.hdr", "i.img":
            os.remove(f"{tmp}/{file}{packed}")
open(f"{tmp}/head_5x4x3_int16.hdr", "w").write("ENVI\n")
open(f"{tmp}/head_5x4x3_int16.img", "wb").write(a.T.astype("<i2").tobytes())
same(f"{tmp}/head_5x4x3_int16.img", a.T, np.eye(4))
nib.save(nib.Nifti2Pair(a, turn), f"{tmp}/cut.hdr")
os.truncate(f"{tmp}/cut.hdr", 500)
refused(f"{tmp}/cut.img", "cut.hdr: ends at byte 500")
end()
PY
exits "a pair's image" 0 "$python" "$tmp/test.py" "$tmp"
finish
