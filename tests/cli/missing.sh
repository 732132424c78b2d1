#!/bin/sh
# missing.sh - no data: --missing of every sample type, inputs without any number, --allow-empty.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
nothing() { [ ! -e "$tmp/no.leaf" ] && [ -z "$(find "$tmp" -name '*partial*')" ]; }
python3 - "$tmp" <<'PY'
import struct, sys
folder = sys.argv[1] + "/"
dims = (40, 36, 34)
count = dims[0] * dims[1] * dims[2]
nan = float("nan")
def raw(name, code, values):
    with open(folder + name, "wb") as f:
        f.write(struct.pack("<%d%s" % (len(values), code), *values))
def nrrd(name, kind, code, values, endian="little"):
    with open(folder + name, "wb") as f:
        f.write(b"NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\nendian: %s\nencoding: raw\n\n"
                % ((kind.encode(),) + dims + (endian.encode(),)))
        f.write(struct.pack("%s%d%s" % ("<" if endian == "little" else ">", len(values), code), *values))
small = [(i * 7 + i // 40 * 3) % 251 for i in range(count)]
holes = [255 if (i // 5 + i // 97) % 4 == 0 else v for i, v in enumerate(small)]
def with_nan(values, hole):
    return [nan if v == hole else v for v in values]
raw("u8.raw", "B", holes)
nrrd("u8.nrrd", "uint8", "B", holes)
nrrd("u8_f32.nrrd", "float", "f", with_nan(holes, 255))
for kind, code, hole, low in ("int8", "b", -128, -120), ("uint16", "H", 65535, 0), ("int16", "h", -32768, -120), \
        ("int32", "i", -2147483648, -120), ("uint32", "I", 4294967295, 0):
    values = [hole if v == 255 else v % 240 + low for v in holes]
    nrrd(kind + ".nrrd", kind, code, values)
    nrrd(kind + "_big.nrrd", kind, code, values, "big")
    nrrd(kind + "_f32.nrrd", "float", "f", with_nan(values, hole))
nrrd("exact.nrrd", "int32", "i", [16777217 if i == 3 * 40 * 36 + 5 else 0 for i in range(count)])
cube = (b"LEAFCAST MESH 1\n%spoints: 4\ntets: 1\n\n" + struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1))
tet = struct.pack("<4I", 0, 1, 2, 3)
for name, field, values in ("nan", b"field: f\n", [nan] * 4), ("inf", b"field: f\n", [float("inf")] * 4), \
        ("none", b"", [0] * 4), ("untold", b"", [0, 1, 2, 3]), ("zero", b"field: f\n", [0] * 4), \
        ("one", b"field: f\n", [nan, nan, 5, nan]):
    open(folder + name + ".mesh", "wb").write(cube % field + struct.pack("<4f", *values) + tet)
open(folder + "none.vtk", "wb").write(
    b"# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
    b"CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n")
for code, kind in ("f", "f32"), ("d", "f64"):
    raw("nan_6x5x4_%s.raw" % kind, code, [nan if i % 2 else float("inf") for i in range(120)])
    raw("one_6x5x4_%s.raw" % kind, code, [nan if i != 77 else 3 for i in range(120)])
raw("sevens_6x5x4_uint8.raw", "B", [7] * 120)
# What the directory and the payloads hold: all behind the header, whose source type, name and hashes may differ.
open(folder + "same.py", "w").write("""import sys
a, b = (open(p, "rb").read() for p in sys.argv[1:3])
assert a[16:20] == b[16:20] == b"\\5\\0\\0\\0" and a[20:24] != b[20:24] and a[24:232] == b[24:232] and a[4096:] == b[4096:]
""")
PY

# ---- --missing ----

# like NAME COMMAND... - converts to $tmp/b.leaf the treelets of $tmp/a.leaf.
like() {
    tap_name=$1
    shift
    exits "$tap_name" 0 "$@" -o "$tmp/b.leaf" --force
    ok "the treelets of f32 with NaN" python3 "$tmp/same.py" "$tmp/a.leaf" "$tmp/b.leaf"
}
piped() {
    input=$1
    shift
    "$leafcast" convert - "$@" <"$input"
}
exits "f32 with NaN" 0 "$leafcast" convert "$tmp/u8_f32.nrrd" -o "$tmp/a.leaf"
like "u8 with holes" "$leafcast" convert "$tmp/u8.nrrd" --missing 255
ok "are counted" grep -q '^no data  *[1-9][0-9]* samples' "$tmp/out"
ok "a sound file" "$leafcast" verify "$tmp/b.leaf" -q
exits "info" 0 "$leafcast" info "$tmp/b.leaf" --json
ok "tells the input's type" grep -q '"source_type": "u8"' "$tmp/out"
ok "and the file's" grep -q '"sample_type": "f32"' "$tmp/out"
python3 -c '
import struct, sys
v = [-9999.0 if i % 5 == 0 else i % 7 for i in range(4096)]
open(sys.argv[1], "wb").write(struct.pack("<4096f", *v))' "$tmp/marked_16x16x16_f32.raw"
exits "a value that stands apart" 0 "$leafcast" convert "$tmp/marked_16x16x16_f32.raw" -o "$tmp/m.leaf"
ok "is told" grep -q 'marked_16x16x16_f32.raw: 20 % of the samples are -9999, others 0 .. 6; .*--missing=-9999 says so' "$tmp/err"
exits "what is suggested" 0 "$leafcast" info "$tmp/m.leaf" --json
ok "leaves it aside" python3 -c 'import json, sys; h = json.load(open(sys.argv[1]))["histogram"]
assert h["aside"] == -9999 and h["suggested"] and all(0 < v < 6 for v in h["suggested"]), h' "$tmp/out"
exits "info" 0 "$leafcast" info "$tmp/m.leaf"
ok "says so" grep -q '^aside  *-9999, in 20 %: may stand for no data' "$tmp/out"
exits "a medium" 0 "$leafcast" render "$tmp/m.leaf" --tf auto --write-tf "$tmp/m.tf" --size 16x16 -o "$tmp/m.pfm" -v
ok "says so, too" grep -q -- '-9999 may stand for no data and is left aside' "$tmp/err"
ok "and is of the others" awk '!/^#/ && NF == 5 && $1 < 0 { bad = 1 } END { exit bad }' "$tmp/m.tf"
exits "and taken as no data" 0 "$leafcast" convert "$tmp/marked_16x16x16_f32.raw" --missing=-9999 -o "$tmp/m.leaf" --force
python3 -c '
import struct, sys
v = [-1e34 if i % 5 == 0 else i % 7 for i in range(4096)]
open(sys.argv[1], "wb").write(struct.pack("<4096f", *v))
open(sys.argv[2], "wb").write(struct.pack("<4096d", *v))' "$tmp/far_16x16x16_f32.raw" "$tmp/far_16x16x16_f64.raw"
for type in f32 f64; do
    "$leafcast" convert "$tmp/far_16x16x16_$type.raw" -o "$tmp/m.leaf" --force >"$tmp/out" 2>"$tmp/err"
    said=$(sed -n 's/.*\(--missing=[^ ]*\) says so/\1/p' "$tmp/err")
    ok "$type: $said" [ "$said" = "--missing=-1e+34" ]
    exits "$type: as it was told" 0 "$leafcast" convert "$tmp/far_16x16x16_$type.raw" "$said" -o "$tmp/m.leaf" --force
    ok "$type: they are no data" grep -q '^no data  *820 samples' "$tmp/out"
done
ok "is told no more" sh -c '! grep -q "of the samples" "$1"' - "$tmp/err"
like "raw" "$leafcast" convert "$tmp/u8.raw" --dims 40,36,34 --type u8 --missing 255
like "a pipe" piped "$tmp/u8.nrrd" --missing 255
like "raw in a pipe" piped "$tmp/u8.raw" --dims 40,36,34 --type u8 --missing 255
gzip -c "$tmp/u8.raw" >"$tmp/u8.raw.gz"
like "gzip" "$leafcast" convert "$tmp/u8.raw.gz" --dims 40,36,34 --type u8 --missing 255
like "little memory" "$leafcast" convert "$tmp/u8.nrrd" --missing 255 --memory 4M --threads 1
for row in int8:-128 uint16:65535 int16:-32768 int32:-2147483648 uint32:4294967295; do
    type=${row%:*}
    exits "$type as f32 with NaN" 0 "$leafcast" convert "$tmp/${type}_f32.nrrd" -o "$tmp/a.leaf" --force
    like "$type with holes" "$leafcast" convert "$tmp/$type.nrrd" "--missing=${row#*:}"
    like "in the other byte order" "$leafcast" convert "$tmp/${type}_big.nrrd" "--missing=${row#*:}"
done
exits "i32 that f32 cannot hold" 3 "$leafcast" convert "$tmp/exact.nrrd" --missing=-1 -o "$tmp/no.leaf"
ok "is told, and where" says 'slice 3 .*i32 .*f32.* index 5'
ok "leaves nothing" nothing
exits "as missing, it is none" 0 "$leafcast" convert "$tmp/exact.nrrd" --missing 16777217 -o "$tmp/b.leaf" --force
for row in u8:256 u8:-1 u8:1.5 u8:nan int8:128 int8:-129 uint16:65536 int16:32768 int32:2147483648 uint32:-1 \
    u8_f32:1e39; do
    exits "--missing $row" 2 "$leafcast" convert "$tmp/${row%:*}.nrrd" "--missing=${row#*:}" -o "$tmp/no.leaf"
    ok "is told" says "samples are of type .*none can be "
    ok "leaves nothing" nothing
done

# ---- no number at all ----

# empty NAME WHAT COMMAND... - refused with these words; with --allow-empty converted.
empty() {
    tap_name=$1
    what=$2
    shift 2
    exits "$tap_name" 3 "$@" -o "$tmp/no.leaf"
    ok "says so" says "$what.*--allow-empty"
    ok "leaves nothing" nothing
    exits "$tap_name --allow-empty" 0 "$@" --allow-empty -o "$tmp/b.leaf" --force
    ok "a sound file" "$leafcast" verify "$tmp/b.leaf" -q
}
for type in f32 f64; do
    empty "$type of NaN" 'none of the volume.s 120 samples' "$leafcast" convert "$tmp/nan_6x5x4_$type.raw"
    empty "$type of NaN in a pipe" 'none of the volume' piped "$tmp/nan_6x5x4_$type.raw" --dims 6,5,4 --type $type
    exits "$type of NaN and one number" 0 "$leafcast" convert "$tmp/one_6x5x4_$type.raw" -o "$tmp/b.leaf" --force
done
empty "all missing" 'none of the volume' "$leafcast" convert "$tmp/sevens_6x5x4_uint8.raw" --missing 7
empty "a mesh of NaN" 'none of the mesh.s values' "$leafcast" convert "$tmp/nan.mesh"
empty "a mesh of NaN in a pipe" 'none of the mesh.s values' piped "$tmp/nan.mesh"
empty "infinite values" 'none of the mesh.s values' "$leafcast" convert "$tmp/inf.mesh" --compress zstd
empty "steps of NaN" 'none of the mesh.s values' "$leafcast" convert "$tmp/nan.mesh" "$tmp/nan.mesh"
empty "a mesh without values" 'no array of values' "$leafcast" convert "$tmp/none.mesh"
empty "a mesh without values in VTK" 'no array of values' "$leafcast" convert "$tmp/none.vtk"
for mesh in untold zero one; do
    exits "a mesh with values: $mesh" 0 "$leafcast" convert "$tmp/$mesh.mesh" -o "$tmp/b.leaf" --force
done
exits "steps of which one has numbers" 0 "$leafcast" convert "$tmp/nan.mesh" "$tmp/one.mesh" -o "$tmp/b.leaf" --force
finish
