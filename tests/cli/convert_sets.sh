#!/bin/sh
# convert_sets.sh - leafcast convert --fields all and --steps all of grids: each set is that of a
# conversion of it alone, whichever format it comes from; what is left out is named; files are read once.
# marks: long
. tests/support/tap.sh

out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
same() { cmp -s "$tmp/$1" "$tmp/$2"; }
convert() { run "$leafcast" convert "$@" -o "$out" --force; }
json() { python3 -c "import json, sys; x = json.load(open(sys.argv[1])); assert $1, x" "$tmp/out"; }


# all FORMAT FILE STEPS FIELD.. - $out has these fields at so many steps, each as from a conversion of it alone; "-": no
# name. FORMAT may be two words.
all() {
    all_name=$1 all_file=$2 all_steps=$3
    shift 3
    ok "$all_name: converts" [ "$rc" = 0 ]
    exits "$all_name: is sound" 0 "$leafcast" verify "$out"
    run "$leafcast" info "$out" --json
    ok "$all_name: $# fields, $all_steps steps" json "len(x['fields']) == $# and x['steps'] == $all_steps"
    for all_field in "$@"; do
        all_step=0
        while [ $all_step -lt "$all_steps" ]; do
            set -- --step $all_step
            [ "$all_steps" -gt 1 ] || set --
            [ "$all_field" = - ] || set -- "$@" --field "$all_field"
            run "$leafcast" convert "$all_file" "$@" -o "$tmp/one.leaf" --force -q
            "$leafcast" export "$tmp/one.leaf" -o "$tmp/one.raw" --force -q -q
            "$leafcast" export "$out" "$@" -o "$tmp/set.raw" --force -q
            ok "$all_name: $all_field at step $all_step" same one.raw set.raw
            all_step=$((all_step + 1))
        done
    done
}

# ---- fields of VTK's grids ----

cat >"$tmp/small.vtk" <<'END'
# vtk DataFile Version 3.0
a grid of 2 x 3 x 2 nodes
ASCII
DATASET STRUCTURED_POINTS
DIMENSIONS 2 3 2
ORIGIN 1 2 3
SPACING 1 1 2
POINT_DATA 12
SCALARS vtkGhostType unsigned_char
LOOKUP_TABLE default
0 0 0 0 0 0 0 0 0 0 0 0
SCALARS heat float
LOOKUP_TABLE default
1 2 3 4 5 6 7 8 9 10 11 12
SCALARS count short
LOOKUP_TABLE default
1 2 3 4 5 6 7 8 9 10 11 12
VECTORS speed float
3 4 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 2
SCALARS cold double
LOOKUP_TABLE default
12 11 10 9 8 7 6 5 4 3 2 1
CELL_DATA 2
SCALARS load float
LOOKUP_TABLE default
7 8
END
convert "$tmp/small.vtk" --fields all
ok "what is unlike the first is left out, and named" says 'field count is left out: .*i16, expected f32' err
ok "the others are told" [ "$(sed '/^file/,$d' "$tmp/out" | tr -s ' \n' ' ')" = "fields heat speed cold " ]
all "VTK" "$tmp/small.vtk" 1 heat speed cold
run "$leafcast" convert "$tmp/small.vtk" --field heat --field speed --field cold -o "$tmp/named.leaf"
ok "the bytes of --field repeated" same a.leaf named.leaf
run "$leafcast" convert "$tmp/small.vtk" --fields all --json -o "$out" --force -q
ok "--json tells them" json 'x["fields"] == ["heat", "speed", "cold"] and x["steps"] == 1'
exits "--dry-run" 0 "$leafcast" convert "$tmp/small.vtk" --fields all --dry-run
ok "tells them" says '^fields  *heat$' out
sed 's/^1 2 3 4/4 3 2 1/' "$tmp/small.vtk" >"$tmp/later.vtk"
convert "$tmp/small.vtk" "$tmp/later.vtk" --fields all
ok "of several files" [ "$rc" = 0 ]
run "$leafcast" info "$out" --json
ok "each is a step" json 'len(x["fields"]) == 3 and x["steps"] == 2'
sed 's/^SCALARS cold/SCALARS cool/' "$tmp/small.vtk" >"$tmp/other.vtk"
exits "a file without one of them" 2 "$leafcast" convert "$tmp/small.vtk" "$tmp/other.vtk" --fields all -o "$out" --force -q

# ---- steps of files of our own readers ----

python3 - "$tmp" <<'PY'
import gzip, random, struct, sys
tmp = sys.argv[1] + "/"
random.seed(5)
x, y, z, t = 5, 4, 3, 4
values = [random.randrange(-999, 999) for _ in range(x * y * z * t)]
data = struct.pack("<%dh" % len(values), *values)
h = bytearray(352)
struct.pack_into("<i", h, 0, 348)
struct.pack_into("<8h", h, 40, 4, x, y, z, t, 1, 1, 1)
struct.pack_into("<2h", h, 70, 4, 16)
struct.pack_into("<8f", h, 76, 1, 1, 2, 3, 1, 1, 1, 1)
struct.pack_into("<f", h, 108, 352)
h[344:348] = b"n+1\0"
open(tmp + "four.nii", "wb").write(bytes(h) + data)
open(tmp + "four.nii.gz", "wb").write(gzip.compress(bytes(h) + data))
open(tmp + "cut.nii", "wb").write(bytes(h) + data[:-1])
open(tmp + "cut.nii.gz", "wb").write(gzip.compress(bytes(h) + data[:-1]))
def npy(name, order, numbers):
    head = "{'descr': '<i2', 'fortran_order': %s, 'shape': (%d, %d, %d, %d), }" % (order, t, z, y, x)
    head = head.ljust(117) + "\n"
    open(tmp + name, "wb").write(b"\x93NUMPY\1\0" + struct.pack("<H", len(head)) + head.encode() + numbers)
npy("c.npy", "False", data)
f = [values[((i * z + k) * y + j) * x + l] for l in range(x) for j in range(y) for k in range(z) for i in range(t)]
npy("f.npy", "True", struct.pack("<%dh" % len(f), *f))
head = "NRRD0005\ntype: short\ndimension: 4\nsizes: %d %d %d %d\nencoding: %s\nkinds: space space space time\nendian: little\n\n"
open(tmp + "gzip.nrrd", "wb").write((head % (x, y, z, t, "gzip")).encode() + gzip.compress(data))
open(tmp + "text.nrrd", "w").write(head % (x, y, z, t, "text") + " ".join(map(str, values)))
import os
os.mkdir(tmp + "steps.zarr")
open(tmp + "steps.zarr/.zarray", "w").write('{"zarr_format": 2, "shape": [%d, %d, %d, %d], "chunks": [2, 2, 4, 5], "dtype": "<i2", '
    '"compressor": null, "fill_value": 0, "order": "C", "filters": null}' % (t, z, y, x))
for i in range(2):
    for k in range(2):
        part = []
        for a in range(2):
            for b in range(2):
                for j in range(y):
                    for l in range(x):
                        zz = 2 * k + b
                        part.append(values[((min(2 * i + a, t - 1) * z + min(zz, z - 1)) * y + j) * x + l])
        open(tmp + "steps.zarr/%d.%d.0.0" % (i, k), "wb").write(struct.pack("<%dh" % len(part), *part))
# Enough for reading it again and again to be seen.
big = bytes(h)
big = bytearray(big)
struct.pack_into("<8h", big, 40, 4, 40, 40, 40, 24, 1, 1, 1)
noise = random.randbytes(40 * 40 * 40 * 24 * 2)
open(tmp + "big.nii.gz", "wb").write(gzip.compress(bytes(big) + noise, 1))
PY
for file in four.nii four.nii.gz c.npy f.npy gzip.nrrd text.nrrd steps.zarr; do
    convert "$tmp/$file" --steps all
    all "$file" "$tmp/$file" 4 -
done
convert "$tmp/four.nii" --steps all
ok "steps are told" says '^steps  *4$' out
convert "$tmp/four.nii" --steps all --times 0,0.5,2,8 --json
ok "times, too; --json has the steps" json 'x["steps"] == 4'
run "$leafcast" info "$out" --json
ok "and the file" json 'x["times"] == [0, 0.5, 2, 8]'
exits "too few times" 2 "$leafcast" convert "$tmp/four.nii" --steps all --times 0,1 -o "$out" --force -q
exits "fewer samples" 3 "$leafcast" convert "$tmp/cut.nii" --steps all -o "$out" --force -q
exits "fewer, packed" 3 "$leafcast" convert "$tmp/cut.nii.gz" --steps all -o "$out" --force -q
ok "no output is left" [ ! -e "$out.part" ]
exits "--steps some" 2 "$leafcast" convert "$tmp/four.nii" --steps some -o "$out" --force -q
# chosen FILE LIST STEP.. - these are the steps of the output, each as from a conversion of it alone.
chosen() {
    chosen_file=$1 chosen_list=$2 chosen_k=0
    shift 2
    convert "$tmp/$chosen_file" --steps "$chosen_list" --json
    ok "$chosen_file, --steps $chosen_list: $# steps" json "x['steps'] == $#"
    [ $# -gt 1 ] || set -- "$@" ""
    for chosen_step in "$@"; do
        [ "$chosen_step" ] || break
        run "$leafcast" convert "$tmp/$chosen_file" --step "$chosen_step" -o "$tmp/one.leaf" --force -q
        "$leafcast" export "$tmp/one.leaf" -o "$tmp/one.raw" --force -q -q
        [ "${2-}" ] && "$leafcast" export "$out" --step $chosen_k -o "$tmp/set.raw" --force -q
        [ "${2-}" ] || "$leafcast" export "$out" -o "$tmp/set.raw" --force -q
        ok "step $chosen_k is $chosen_step" same one.raw set.raw
        chosen_k=$((chosen_k + 1))
    done
}
for file in four.nii four.nii.gz c.npy f.npy gzip.nrrd steps.zarr; do
    chosen $file 1:2 1 2
    chosen $file 0:3:2 0 2
    chosen $file 1,3 1 3
    chosen $file 2 2
done
chosen four.nii.gz 0,2:3 0 2 3
convert "$tmp/four.nii" --steps 1,3 --times 5,7
run "$leafcast" info "$out" --json
ok "times of those that are taken" json 'x["times"] == [5, 7]'
for list in 4 0:4 1,9; do
    exits "no such step: $list" 2 "$leafcast" convert "$tmp/four.nii" --steps $list -o "$out" --force -q
done
for list in 3,1 1,1 0:2,2; do
    exits "not ascending: $list" 2 "$leafcast" convert "$tmp/four.nii" --steps $list -o "$out" --force -q
done
exits "with --step" 2 "$leafcast" convert "$tmp/four.nii" --steps all --step 0 -o "$out" --force -q
exits "with several inputs" 2 "$leafcast" convert "$tmp/four.nii" "$tmp/four.nii" --steps all -o "$out" --force -q
# shellcheck disable=SC2016
exits "on standard input" 2 sh -c '"$1" convert - --steps all -o "$3" --force <"$2"' sh "$leafcast" "$tmp/four.nii" "$out"

# One set: as ever.
"$leafcast" generate sphere --dims 9 -o "$tmp/one.nrrd"
run "$leafcast" convert "$tmp/one.nrrd" -o "$tmp/plain.leaf"
convert "$tmp/one.nrrd" --steps all --fields all
ok "of a file of one set: the same bytes" same a.leaf plain.leaf

# A packed file of many steps is read once, and so is each header.
bytes=$(tests/support/bytes_read.py "$leafcast" convert "$tmp/big.nii.gz" --steps all -o "$out" --force)
size=$(wc -c <"$tmp/big.nii.gz")
case $bytes in
unknown) skip "a packed file is read once" "no /proc/PID/io here" ;;
*) ok "a packed file is read once ($bytes bytes of $size)" [ "$bytes" -lt $((size * 3 / 2)) ] ;;
esac

# ---- fields and steps of importers ----

has() { "$leafcast" --list-verbs | grep -qx "import-$1"; }

python=$(python_with h5py)
if ! has hdf5 || [ -z "$python" ]; then
    skip "HDF5" "no libhdf5, or no python3-h5py here"
else
    "$python" - "$tmp/a.h5" <<'PY'
import h5py, numpy as np, sys
r = np.random.default_rng(3)
with h5py.File(sys.argv[1], "w") as f:
    f["x"] = np.arange(7)
    for name, shape in ("a", (5, 6, 7)), ("b/c", (5, 6, 7)), ("d", (5, 6, 6)), ("t", (3, 5, 6, 7)), ("u", (3, 5, 6, 7)):
        f[name] = r.random(shape).astype("f4")
    f["whole"] = r.integers(0, 9, (5, 6, 7)).astype("i2")
    f["v" + "e" * 80] = r.random((5, 6, 7)).astype("f4")
PY
    convert "$tmp/a.h5" --fields all
    ok "HDF5: others are left out" says 'field /d is left out' err
    ok "HDF5: of another type, too" says 'field /whole is left out' err
    run "$leafcast" info "$out" --json
    ok "HDF5: a long name is cut" json 'x["fields"].pop()["name"] == "/v" + "e" * 61'
    run "$leafcast" convert "$tmp/a.h5" --field /a --field b/c --field t -o "$out" --force
    all "HDF5" "$tmp/a.h5" 1 /a b/c t
    run "$leafcast" convert "$tmp/a.h5" --field t --field u --steps all -o "$out" --force -q
    all "HDF5 with steps" "$tmp/a.h5" 3 t u
fi
python=$(python_with netCDF4)
if ! has netcdf || [ -z "$python" ]; then
    skip "NetCDF" "no libnetcdf, or no python3-netcdf4 here"
else
    "$python" - "$tmp/a.nc" <<'PY'
import netCDF4, numpy as np, sys
r = np.random.default_rng(4)
with netCDF4.Dataset(sys.argv[1], "w") as f:
    for name, size in ("time", None), ("z", 5), ("y", 6), ("x", 7):
        f.createDimension(name, size)
        f.createVariable(name, "f8", (name,))[:] = np.arange(size or 3)
    f.createVariable("still", "f4", ("z", "y", "x"))[:] = r.random((5, 6, 7))
    for name in "salt", "heat":
        f.createVariable(name, "f4", ("time", "z", "y", "x"))[0:3] = r.random((3, 5, 6, 7))
    f.createVariable("floor", "f4", ("y", "x"))[:] = 0
PY
    run "$leafcast" convert "$tmp/a.nc" --fields all -o "$out" --force -q
    all "NetCDF" "$tmp/a.nc" 1 still salt heat
    run "$leafcast" convert "$tmp/a.nc" --field salt --field heat --steps all -o "$out" --force -q
    all "NetCDF, unlimited time" "$tmp/a.nc" 3 salt heat
    # The first is one with steps: those without are none of its series.
    run "$leafcast" convert "$tmp/a.nc" --fields all --steps all --json -o "$out" --force -q
    ok "NetCDF: a series of what has steps" json 'x["fields"] == ["salt", "heat"] and x["steps"] == 3'
fi
tool=${LEAFCAST_BUILD:-build/release}/tests/tool_vdb
if ! has vdb || [ ! -x "$tool" ]; then
    skip "OpenVDB" "no OpenVDB here"
else
    mkdir "$tmp/v"
    "$tool" make "$tmp/v" >"$tmp/out"
    convert "$tmp/v/blosc.vdb" --fields all
    ok "OpenVDB: converts" [ "$rc" = 0 ]
    run "$leafcast" info "$out" --json
    ok "OpenVDB: several fields" json 'len(x["fields"]) > 1'
fi
finish
