#!/bin/sh
# export_told.sh - what a conversion rounds and an export drops or names is said: slopes, turned grids in TIFF, arrays of VTK.
. tests/support/tap.sh
cd "$tmp" || exit 1

# A slope that does not fit f32 exactly, in each format that has one; the largest error, by Python.
python=$(python_with nibabel)
if [ -z "$python" ]; then
    skip "slopes" "no nibabel here"
else
    "$python" - >want <<'PY'
import nibabel, numpy as np
v = np.arange(-40, 85, dtype="i2").reshape(5, 5, 5, order="F") * 77
slope, inter = np.float32(0.1), np.float32(3.7)
i = nibabel.Nifti1Image(v, np.diag([1, 1, 1, 1.]))
i.header.set_data_dtype("i2")
i.header["scl_slope"], i.header["scl_inter"] = slope, inter
nibabel.save(i, "plain.nii")
raw = bytearray(open("plain.nii", "rb").read())
raw[112:116], raw[116:120] = slope.tobytes(), inter.tobytes()  # nibabel scales what it saves
raw[352:352 + 2 * v.size] = v.tobytes(order="F")
open("slope.nii", "wb").write(raw)
exact = v.astype("f8") * float(slope) + float(inter)
print(repr(float(np.abs(exact - exact.astype("f4").astype("f8")).max())))
PY
    exits "a slope" 0 "$leafcast" convert slope.nii -o slope.leaf --force --json
    ok "its rounding is told" "$python" -c '
import json
got, want = json.load(open("out"))["rounding_error"], float(open("want").read())
assert want > 0 and got == want, (got, want)'
    exits "and kept" 0 "$leafcast" info slope.leaf
    ok "in the file" grep -q '^rounding    at most [1-9]' out
fi
"$leafcast" generate sphere --dims 6 --type u8 -o g.nrrd
"$leafcast" convert g.nrrd -o g.leaf -q
exits "whole numbers as they are" 0 "$leafcast" info g.leaf --json
ok "are not rounded" grep -q '"rounding_error": 0.0' out

# A turned grid in a TIFF.
sed 's/^space directions.*/space directions: (0.8,0.6,0) (-0.6,0.8,0) (0,0,1)/' g.nrrd >turned.nrrd
"$leafcast" convert turned.nrrd -o turned.leaf -q
exits "a turned grid as TIFF" 0 "$leafcast" export turned.leaf -o turned.tif
ok "is told" grep -q 'turned.tif: other programs find in a TIFF how far samples are apart, not where' err
ok "in one line" [ "$(grep -c TIFF err)" = 1 ]
exits "with -q" 0 "$leafcast" export turned.leaf -o turned.tif --force -q
ok "nothing is" [ ! -s err ]
exits "a grid along the axes" 0 "$leafcast" export g.leaf -o g.tif
ok "is not told" [ ! -s err ]
for other in nrrd nii vti; do
    exits "as .$other" 0 "$leafcast" export turned.leaf -o "turned.$other" --force
    ok "nothing is lost" [ ! -s err ]
done

# The array of a VTK file: the field, else the data set.
sed 's/^content:.*/content: lungs/' g.nrrd >lungs.nrrd
"$leafcast" convert lungs.nrrd -o lungs.leaf -q
for end in vti vtr; do
    exits "a data set as .$end" 0 "$leafcast" export lungs.leaf -o "lungs.$end"
    ok "names the array" grep -aq 'PointData Scalars="lungs"' "lungs.$end"
done
python=$(python_with netCDF4)
if [ -z "$python" ]; then
    skip "fields of uneven axes" "no netCDF4 here"
else
    "$python" - <<'PY'
import netCDF4, numpy as np
d = netCDF4.Dataset("uneven.nc", "w")
for name, n in (("z", 4), ("y", 5), ("x", 6)):
    d.createDimension(name, n)
    d.createVariable(name, "f4", (name,))[:] = np.arange(n) ** 1.5
for name in "temp", "salt":
    d.createVariable(name, "f4", ("z", "y", "x"))[:] = np.random.default_rng(1).random((4, 5, 6))
PY
    for field in temp salt; do
        "$leafcast" convert uneven.nc --field $field -o uneven.leaf -q --force
        exits "a field as .vtr" 0 "$leafcast" export uneven.leaf -o uneven.vtr --force
        ok "names the array" grep -aq "PointData Scalars=\"$field\"" uneven.vtr
    done
    "$leafcast" convert uneven.nc --field temp --field salt -o both.leaf -q
    exits "one of two fields" 0 "$leafcast" export both.leaf --field salt -o both.vtr
    ok "has its own name" grep -aq 'PointData Scalars="salt"' both.vtr
fi
finish
