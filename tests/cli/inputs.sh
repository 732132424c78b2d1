#!/bin/sh
# inputs.sh - what convert, resample, tetrahedralize and info make of inputs: headers without end, options that an input
# cannot use.
# marks: long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }

# Headers of megabytes are read in their own length of time; each of these takes a minute where time grows with the
# square.
python3 - "$tmp" <<'PY'
import sys
folder = sys.argv[1] + "/"
nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
key, blank = "k" * 3000, " " * 3000
def write(name, text, samples=64):
    with open(folder + name, "wb") as f:
        f.write(text.encode() + bytes(samples))
write("pairs.nrrd", nrrd + "".join(f"{key}{i}:=x\n" for i in range(4000)) + "\n")
write("blanks.nrrd", nrrd + "".join(f"k{blank}{i}:=x\n" for i in range(4000)) + "\n")
write("comments.nrrd", nrrd + "# c\n" * 4000000 + "\n")
write("line.nrrd", nrrd + "# " + "c" * 16000000 + "\n\n")
write("twice.nrrd", nrrd + "".join(f"{key}{i}:=x\n" for i in range(4000)) + f" {key.upper()} 7:=x\n\n")
mha = "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\n"
write("keys.mha", mha + "".join(f"{key}{i} = x\n" for i in range(4000)) + "ElementDataFile = LOCAL\n")
grid = """DATASET UNSTRUCTURED_GRID
POINTS 4 float
0 0 0 1 0 0 0 1 0 0 0 1
CELLS 1 5
4 0 1 2 3
CELL_TYPES 1
10
POINT_DATA 4
"""
scalars = "SCALARS s%d float 1\nLOOKUP_TABLE default\n0 1 2 3\n"
write("arrays.vtk", "# vtk DataFile Version 3.0\nt\nASCII\n" + grid + "".join(scalars % i for i in range(100000)), 0)
write("title.vtk", "# vtk DataFile Version 3.0\n" + "t" * 16000000 + "\nASCII\n" + grid + scalars % 0, 0)
write("comments.csv", "# c\n" * 4000000 + "x,y,z\n0,0,0\n1,0,0\n0,1,0\n0,0,1\n", 0)
PY
for input in pairs.nrrd blanks.nrrd comments.nrrd line.nrrd keys.mha arrays.vtk title.vtk; do
    exits "a long header, $input" 0 timeout 30 "$leafcast" convert "$tmp/$input" -o "$tmp/$input.leaf"
done
exits "a key that comes twice in a long header" 3 timeout 30 "$leafcast" convert "$tmp/twice.nrrd" -o "$tmp/x.leaf"
ok "is told with its line" says 'line 4006: .*comes twice'
rm "$tmp"/*.nrrd "$tmp"/*.vtk

# ---- options: each is used or refused ----

"$leafcast" generate sphere --dims 8 -o "$tmp/a.nrrd"
"$leafcast" generate sphere --tets --dims 5 -o "$tmp/a.mesh"
{
    printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float sphere\n'
    printf 'element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n'
} >"$tmp/a.ply"
tail -c 512 "$tmp/a.nrrd" >"$tmp/a_8x8x8_uint8.raw"
printf '%s\n' 0 1 2 3 4 5 6 9 >"$tmp/axis"
# The options of convert that depend on the input, with a value, and the inputs that can use them: r(aw) h(eader) m(esh)
# s(urface).
cat >"$tmp/options" <<TABLE
compress=zstd:1 rhms
treelet=16 rh
in-place rh
levels=1 rh
halo=0 rh
follow-links rh
allow-missing rh
dims=8,8,8 r
type=u8 r
big-endian r
skip=0 r
spacing=1,2,3 rh
origin=1,2,3 rh
exaggerate=2 rh
heights -
axes=LPS rh
unit=mm rh
axis-x=$tmp/axis rh
axis-y=$tmp/axis rh
axis-z=$tmp/axis rh
field=sphere ms
fields=all rhms
steps=all rh
times=7 rhms
to=sphere -
component=1 ms
step=0 -
cells-to-points -
by-corners m
coarse=4 m
treelet-tets=64 ms
leaf-tets=4 m
build=sah m
gradients m
normals=smooth s
whole-cells m
dry-run rhms
TABLE
while read -r option inputs; do
    for kind in r h m s; do
        case $kind in
            r) input=$tmp/a_8x8x8_uint8.raw ;;
            h) input=$tmp/a.nrrd ;;
            s) input=$tmp/a.ply ;;
            *) input=$tmp/a.mesh ;;
        esac
        case $inputs in
            *$kind*) want=0 ;;
            *) want=2 ;;
        esac
        exits "convert $kind --$option" $want "$leafcast" convert "$input" "--$option" -o "$tmp/x.leaf" --force
        [ $want = 0 ] || ok "says so" says "${option%%=*}\|no array\|no field of numbers"
    done
done <"$tmp/options"
# Every option of convert but those that any input can use is in that table.
"$leafcast" convert --help-all | sed -n 's/^ *\(-[a-zA-Z?], \)*--\([a-z0-9-]*\).*/\2/p' | sort -u >"$tmp/all"
{
    sed 's/[= ].*//' "$tmp/options"
    printf '%s\n' missing name allow-empty append watch until settle resume checkpoint plot3d solution functions force help help-all json memory output quiet threads usage verbose version
} | sort -u >"$tmp/known"
ok "no option is left out" [ -z "$(comm -23 "$tmp/all" "$tmp/known")" ]
"$leafcast" convert "$tmp/a.nrrd" -o "$tmp/plain.leaf" --force >/dev/null
"$leafcast" convert "$tmp/a.mesh" -o "$tmp/mesh.leaf" --force >/dev/null
for wrong in "mesh.leaf --component 1" "mesh.leaf --cells-to-points" "a.mesh --step 0" "mesh.leaf --step 1" \
    "mesh.leaf --field nothing" "a.mesh --dims 4 --spacing 1"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "resample $wrong" 2 "$leafcast" resample "$tmp"/$wrong -o "$tmp/x.nrrd"
done

# ---- raw samples through a pipe ----

# shellcheck disable=SC2016
piped='tail -c 512 "$2" | "$1" convert - --dims 8,8,8 --type u8 -o "$3" --force'
exits "raw samples from a pipe" 0 sh -c "$piped" sh "$leafcast" "$tmp/a.nrrd" "$tmp/piped.leaf"
"$leafcast" info --json "$tmp/piped.leaf" | grep value >"$tmp/piped"
"$leafcast" info --json "$tmp/plain.leaf" | grep value >"$tmp/plain"
ok "are those of the file" cmp "$tmp/piped" "$tmp/plain"
# shellcheck disable=SC2016
exits "too few of them" 3 sh -c 'head -c 500 "$2" | "$1" convert - --dims 8,8,8 --type u8 -o "$3" --force' sh \
    "$leafcast" "$tmp/a_8x8x8_uint8.raw" "$tmp/x.leaf"
ok "are told" says "standard input: ends at byte 500"
# shellcheck disable=SC2016
exits "--skip, --spacing" 0 sh -c '"$1" convert - --dims 8,8,7 --type u8 --skip 64 --spacing 1,1,2 -o "$3" --force <"$2"' \
    sh "$leafcast" "$tmp/a_8x8x8_uint8.raw" "$tmp/x.leaf"
exits "an empty pipe" 3 "$leafcast" convert - -o "$tmp/x.leaf"
ok "is told" says "standard input: is empty"

prints() { grep -q -- "$1" "$tmp/out"; }

# Any of them may be packed, in a file or a pipe: the same treelet file.
"$leafcast" convert "$tmp/a_8x8x8_uint8.raw" -o "$tmp/raw.leaf" >/dev/null
"$leafcast" convert "$tmp/a.nrrd" -o "$tmp/nrrd.leaf" >/dev/null
for packer in gzip:gz bzip2:bz2 xz:xz zstd:zst; do
    suffix=${packer#*:} packer=${packer%:*}
    command -v "$packer" >/dev/null || { skip "$packer" "no $packer here"; continue; }
    "$packer" -qc "$tmp/a_8x8x8_uint8.raw" >"$tmp/a_8x8x8_uint8.raw.$suffix"
    "$packer" -qc "$tmp/a.nrrd" >"$tmp/a.nrrd.$suffix"
    exits "raw samples in $packer" 0 "$leafcast" convert "$tmp/a_8x8x8_uint8.raw.$suffix" -o "$tmp/x.leaf" --force
    ok "are those of the file" cmp "$tmp/x.leaf" "$tmp/raw.leaf"
    # shellcheck disable=SC2016
    exits "NRRD in $packer in a pipe" 0 sh -c '"$1" convert - -o "$3" --force <"$2"' sh "$leafcast" "$tmp/a.nrrd.$suffix" "$tmp/x.leaf"
    ok "is that of the file" cmp "$tmp/x.leaf" "$tmp/nrrd.leaf"
    exits "info of it" 0 "$leafcast" info "$tmp/a.nrrd.$suffix"
    ok "tells what comes next, by its name unpacked" prints "^next .*/a.nrrd.$suffix -o a.leaf$"
    ok "tells the format" prints '^format  *NRRD$'
    head -c 100 "$tmp/a_8x8x8_uint8.raw.$suffix" >"$tmp/cut_8x8x8_uint8.raw.$suffix"
    exits "cut $packer" 3 "$leafcast" convert "$tmp/cut_8x8x8_uint8.raw.$suffix" -o "$tmp/x.leaf" --force
    ok "is told" says "damaged $packer data"
done

# generate: a seed is for fields that have one.
exits "generate noise --seed" 0 "$leafcast" generate noise --dims 8 --seed 3 -o "$tmp/x.nrrd"
exits "generate attractor --seed" 0 "$leafcast" generate attractor --dims 8 --seed 3 -o "$tmp/x.nrrd" --force
for field in sphere gyroid buckyball orbital marschner-lobb; do
    exits "generate $field --seed" 2 "$leafcast" generate $field --dims 8 --seed 3 -o "$tmp/x.nrrd" --force
done
rm "$tmp/x.nrrd"

# ---- what is not read is named ----

python3 - "$tmp" <<'PY'
import sys
folder = sys.argv[1] + "/"
def write(name, *parts):
    data = bytearray(600)
    for at, text in parts:
        data[at:at + len(text)] = text
    open(folder + name, "wb").write(data)
write("NIfTI-1", (0, b"\x5c\x01\0\0"), (344, b"n+1\0"))
write("NIfTI-2", (0, b"\x1c\x02\0\0n+2\0\r\n\x1a\n"))
write("Analyze", (0, b"\x5c\x01\0\0"))
write("DICOM", (128, b"DICM"))
write("MRC", (208, b"MAP "))
write("TIFF", (0, b"II*\0"))
write("BigTIFF", (0, b"MM\0+"))
write("HDF5", (0, b"\x89HDF\r\n\x1a\n"))
write("NetCDF", (0, b"CDF\x02"))
write("NumPy", (0, b"\x93NUMPY\x01\0"))
write("OpenVDB", (0, b" BDV\0\0\0\0"))
write("PNG", (0, b"\x89PNG\r\n\x1a\n"))
write("JPEG", (0, b"\xff\xd8\xff\xe0"))
write("OpenEXR", (0, b"\x76\x2f\x31\x01"))
write("gzip", (0, b"\x1f\x8b\x08"))
write("zstd", (0, b"\x28\xb5\x2f\xfd"))
open(folder + "PLOT3D", "wb").write(b"\0\0\0\2\0\0\0\3\0\0\0\4" + bytes(16 + 24 * 20))
open(folder + "Exodus", "wb").write(b"CDF\1" + bytes(30) + b"num_el_blk")
open(folder + "CGNS", "wb").write(b"\xc0\xa8\xa3\xa9ADF Database Version")
open(folder + "x.dcm", "wb").write(b"not at all")
PY
for format in Analyze gzip zstd PLOT3D; do
    exits "$format" 3 "$leafcast" convert "$tmp/$format" -o "$tmp/x.leaf" --force
    ok "is named" says "/$format: this is .*$format"
done

printf 'HEIGHTS OF HILLS' >"$tmp/hills.dem"
exits "a USGS DEM" 3 "$leafcast" convert "$tmp/hills.dem" -o "$tmp/x.leaf" --force
ok "is told what was expected" says "hills.dem: the record that ends at byte 16: expected the number of a reference system"

# ---- what a library of its own reads: the verb import-X, run by the others ----

# A door of our own: what import-vdb and import-dicom do is played.
mkdir "$tmp/door"
for verb in convert info; do cp "${LEAFCAST_BUILD:?}/libexec/leafcast-$verb" "$tmp/door/$verb"; done
play() { # play VERB: its lines on standard input; asked for a list, it has one field
    {
        echo "#!/bin/sh"
        echo 'case " $* " in *" --list "*) echo "{\"fields\": [{\"name\": \"v\", \"readable\": true}]}"; exit ;; esac'
        cat
    } >"$tmp/door/leafcast-$1"
    chmod +x "$tmp/door/leafcast-$1"
}
bare() { # bare VERB ARGUMENT...: with no other verb in reach
    verb=$1
    shift
    PATH=/usr/bin:/bin "$tmp/door/$verb" "$@"
}
exits "OpenVDB without import-vdb" 3 bare convert "$tmp/OpenVDB" -o "$tmp/x.leaf" --force
ok "is named, with what to do" says "this is OpenVDB, and leafcast-import-vdb, which reads it, is not there"
exits "a suffix alone" 3 bare convert "$tmp/x.dcm" -o "$tmp/x.leaf" --force
ok "is a hint" says "this is DICOM, and leafcast-import-dicom"
for format in DICOM:dicom TIFF:images BigTIFF:images PNG:images JPEG:images OpenEXR:images HDF5:hdf5 NetCDF:netcdf Exodus:exodus CGNS:cgns; do
    play "import-${format#*:}" <<'X'
echo "leafcast $(basename "$0"): F: refused on purpose" >&2
exit 3
X
    exits "${format%:*}" 3 bare convert "$tmp/${format%:*}" -o "$tmp/x.leaf" --force
    ok "what the verb says is said" says "^leafcast convert: F: refused on purpose"
done
play import-vdb <<X
for word; do echo "\$word"; done >"$tmp/asked"
cat "$tmp/a.nrrd"
X
exits "OpenVDB with it" 0 bare convert "$tmp/OpenVDB" -o "$tmp/x.leaf" --force
ok "is what it writes" cmp "$tmp/x.leaf" "$tmp/nrrd.leaf"
ok "is said" says "OpenVDB, read by leafcast import-vdb"
exits "with hints" 0 bare convert "$tmp/OpenVDB" --field=-a --component 2 --step 3 --memory 64M -o "$tmp/x.leaf" --force
ok "hands them on" [ "$(tr '\n' ' ' <"$tmp/asked")" = "-q --tiles -o - --field -a --component 2 --step 3 --memory 33554432 --guard $tmp/x.leaf -- $tmp/OpenVDB " ]
exits "info of it" 0 bare info "$tmp/OpenVDB"
ok "tells the format" prints '^format  *OpenVDB$'
ok "and the values" prints '^values  *[0-9]* \.\. [0-9]*$'
told() { # told TEXT: import-vdb tells its fields with the samples; how often is it asked for a list?
    sed "1a leafcast fields:=$1" "$tmp/a.nrrd" >"$tmp/told.nrrd"
    play import-vdb <<X
cat "$tmp/told.nrrd"
X
    sed -i '2i case " $* " in *" --list "*) echo x >>"'"$tmp"'/lists" ;; esac' "$tmp/door/leafcast-import-vdb"
    : >"$tmp/lists"
    exits "info of what tells '$1'" 0 bare info "$tmp/OpenVDB" --json
}
told '{"fields":[{"name":"told","readable":true}]}'
ok "lists them" prints '"name": "told"'
ok "and asks for none" [ ! -s "$tmp/lists" ]
for text in '{"fields":[{"name"' '[]' '{"fields":3}' "$(printf '{"fields":[{"name":"%03000d"}]}' 7)"; do
    told "$text"
    ok "asks for a list" prints '"name": "v"'
    ok "once" [ "$(wc -l <"$tmp/lists")" = 1 ]
done
gzip -c "$tmp/OpenVDB" >"$tmp/p.vdb.gz"
exits "packed" 3 bare convert "$tmp/p.vdb.gz" -o "$tmp/x.leaf" --force
ok "is refused" says "a file that is not packed"
exits "in a pipe" 3 sh -c '"$1" convert - -o "$3" --force <"$2"' sh "$leafcast" "$tmp/OpenVDB" "$tmp/x.leaf"
ok "too" says "standard input: this is OpenVDB"
play import-vdb <<X
head -c 300 "$tmp/a.nrrd"
kill -SEGV \$\$
X
exits "a verb that crashes" 3 bare convert "$tmp/OpenVDB" -o "$tmp/y.leaf"
ok "is told" says "OpenVDB: leafcast-import-vdb was ended by signal 11"
ok "leaves nothing" [ ! -e "$tmp/y.leaf" ]
play import-vdb <<X
cat "$tmp/a.nrrd"
exit 4
X
exits "one that fails at its end" 4 bare convert "$tmp/OpenVDB" -o "$tmp/y.leaf"
ok "leaves nothing, too" [ ! -e "$tmp/y.leaf" ]
play import-vdb <<X
exit 0
X
exits "one that writes nothing" 3 bare convert "$tmp/OpenVDB" -o "$tmp/y.leaf"

# A folder goes to the verb of its first file that tells a format.
mkdir "$tmp/series" "$tmp/empty"
echo notes >"$tmp/series/a.txt"
cp "$tmp/DICOM" "$tmp/series/b"
play import-dicom <<X
for word; do echo "\$word"; done >"$tmp/asked"
cat "$tmp/a.nrrd"
X
exits "a folder of DICOM" 0 bare convert "$tmp/series" -o "$tmp/x.leaf" --force
ok "goes to import-dicom" [ "$(tail -n 1 "$tmp/asked")" = "$tmp/series" ]
ok "and is what it writes" cmp "$tmp/x.leaf" "$tmp/nrrd.leaf"
exits "info of a folder" 0 bare info "$tmp/series"
exits "a folder of nothing" 3 bare convert "$tmp/empty" -o "$tmp/x.leaf" --force
ok "is told what was expected" says "expected the slices of"

exits "tetrahedralize of NIfTI-1" 3 "$leafcast" tetrahedralize "$tmp/NIfTI-1" -o "$tmp/x.out"
ok "is named" says "this is NIfTI-1"
exits "a grid resampled" 3 "$leafcast" resample "$tmp/a.nrrd" -o "$tmp/x.nrrd"
ok "is sent to convert" says "a grid, which is regular already: convert takes it"
exits "a treelet file converted" 3 "$leafcast" convert "$tmp/plain.leaf" -o "$tmp/x.leaf" --force
ok "is named" says "this is a treelet file"
{ cat "$tmp/PLOT3D" && head -c 484 /dev/zero; } >"$tmp/padded"
exits "PLOT3D with padding" 3 "$leafcast" convert "$tmp/padded" -o "$tmp/x.leaf" --force
ok "is named" says "this is PLOT3D"
printf 'hello, world' >"$tmp/hello"
exits "no known format" 3 "$leafcast" convert "$tmp/hello" -o "$tmp/x.leaf" --force
ok "is shown" says "begins with 68 65 6c 6c 6f"
ok "and what is expected" says "raw samples need --dims and --type"

# ---- info of inputs ----

json() { python3 -c 'import json, sys; x = json.load(open(sys.argv[1])); sys.exit(not ('"$1"'))' "$tmp/out"; }
exits "info of a grid" 0 "$leafcast" info "$tmp/a.nrrd"
ok "tells the format" prints '^format  *NRRD$'
ok "tells dims and type" prints '^grid  *8 x 8 x 8 u8'
ok "tells values" prints '^values  *[0-9]* \.\. [0-9]*$'
ok "has a histogram" prints '%.*##'
ok "suggests isovalues" prints '^isovalues '
ok "tells what comes next" prints "^next  *leafcast convert $tmp/a.nrrd -o a.leaf$"
for raw in "$tmp/a_8x8x8_uint8.raw" "- --dims 8,8,8 --type u8"; do
    # shellcheck disable=SC2086,SC2016 # split on purpose
    exits "info of raw samples" 0 sh -c 'input=$1; shift; "$@" <"$input"' sh "$tmp/a_8x8x8_uint8.raw" "$leafcast" info $raw --json
    ok "tells the format" json 'x["format"] == "raw samples" and x["kind"] == "grid" and x["dims"] == [8, 8, 8]'
    ok "counts all" json 'sum(x["histogram"]["samples"]) == 512 and x["histogram"]["cells"] == 343'
done
ok "what comes next has the options" json '"convert - --dims 8,8,8 --type u8 -o" in x["next"]'
"$leafcast" convert "$tmp/a.nrrd" -o "$tmp/.x" >/dev/null
exits "info of a name that is all suffix" 0 "$leafcast" info "$tmp/.x"
ok "the picture has a name, too" prints "^next  *leafcast render $tmp/.x -o .x.png$"
printf '4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n' >"$tmp/bare.node"
printf '1 4 0\n1 1 2 3 4\n' >"$tmp/bare.ele"
exits "a mesh without an array" 0 "$leafcast" info "$tmp/bare.ele"
sed -n 's/^next  *leafcast //p' "$tmp/out" >"$tmp/next"
exits "what comes next works" 0 sh -c "cd '$tmp' && '$leafcast' $(cat "$tmp/next")"
# The same as of the treelet file that convert makes, whatever the type and the size of the blocks that are read.
for type in u8 u16 f32; do
    "$leafcast" generate gyroid --dims 150,140,90 --type $type --spacing 1,2,-3 -o "$tmp/g.nrrd" --force
    "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" --force >/dev/null
    for memory in 24M 2G; do
        "$leafcast" info "$tmp/g.nrrd" --json --memory $memory >"$tmp/input.json"
        "$leafcast" info "$tmp/g.leaf" --json >"$tmp/out"
        cp "$tmp/input.json" "$tmp/out.input"
        ok "$type within $memory: values, places, histogram as of the treelet file" python3 - "$tmp" <<'PY'
import json, sys
a, b = json.load(open(sys.argv[1] + "/input.json")), json.load(open(sys.argv[1] + "/out"))
for key in "kind", "dims", "sample_type", "source_type", "to_world", "value_min", "value_max", "non_finite", "histogram":
    if key in b and a[key] != b[key]:
        sys.exit(key)
sys.exit(a["histogram"]["total"] != 150 * 140 * 90)
PY
    done
done
python3 -c '
import struct, sys
v = [float("nan"), 1e30, -2.5, float("inf")] + [0.5] * 23
open(sys.argv[1], "wb").write(struct.pack("<27d", *v) + b"more")' "$tmp/nan_3x3x3_f64.raw"
exits "info of doubles with holes" 0 "$leafcast" info "$tmp/nan_3x3x3_f64.raw" --json
ok "counts what is not finite, and what is behind" \
    json 'x["non_finite"] == 2 and x["trailing_bytes"] == 4 and x["value_min"] == -2.5 and x["sample_type"] == "f32"'
exits "info of a mesh" 0 "$leafcast" info "$tmp/a.mesh" --json
ok "tells tets, points, fields, bounds" json \
    'x["tets"] == 384 and x["vertices"] == 125 and x["fields"] == [{"name": "sphere", "steps": 1, "components": 1}] and x["bounds"] == [0, 0, 0, 4, 4, 4]'
ok "draws all tets" json 'x["histogram"]["drawn"] == 384'
"$leafcast" info "$tmp/mesh.leaf" --json >"$tmp/out"
ok "as a treelet file" json \
    'x["tets"] == 384 and x["field_count"] == 1 and x["fields"][0]["name"] == "sphere" and x["kind"] == "mesh"'
exits "info --quick" 0 "$leafcast" info "$tmp/a.mesh" --quick --json
ok "reads no values" json '"value_min" not in x and "histogram" not in x and x["field_count"] == 1'
head -c 300 "$tmp/a.nrrd" >"$tmp/cut.nrrd"
exits "info of a cut file" 3 "$leafcast" info "$tmp/cut.nrrd" --json
exits "info of a cut mesh" 3 sh -c 'head -c 3000 "$2" | "$1" info -' sh "$leafcast" "$tmp/a.mesh"
exits "info of Analyze" 3 "$leafcast" info "$tmp/Analyze"
ok "is named" says "this is Analyze"
exits "info within too little memory" 4 "$leafcast" info "$tmp/g.nrrd" --memory 1M
# Options of info, and the inputs that can use them: l(eaf), r(aw), h(eader), m(esh).
cat >"$tmp/options" <<TABLE
iso=50 l
quick rhm
field=sphere m
dims=8,8,8 r
type=u8 r
big-endian r
skip=0 r
TABLE
while read -r option inputs; do
    for kind in l r h m; do
        case $kind in
            l) input=$tmp/plain.leaf ;;
            r) input=$tmp/a_8x8x8_uint8.raw ;;
            h) input=$tmp/a.nrrd ;;
            *) input=$tmp/a.mesh ;;
        esac
        case $inputs in
            *$kind*) want=0 ;;
            *) want=2 ;;
        esac
        exits "info $kind --$option" $want "$leafcast" info "$input" "--$option"
    done
done <"$tmp/options"
finish
