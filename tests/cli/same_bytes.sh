#!/bin/sh
# same_bytes.sh - identical samples and parameters give identical bytes, whatever the input is called or comes through; --name.
. tests/support/tap.sh

mkdir "$tmp/one" "$tmp/other"
python3 - "$tmp" <<'PY'
import struct, sys
folder = sys.argv[1] + "/"
samples = bytes((7 * i + i // 9) % 256 for i in range(20 * 12 * 10))
def write(name, *parts):
    with open(folder + name, "wb") as f:
        f.write(b"".join(parts))
nrrd = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 20 12 10\nencoding: raw\n"
for name in "one/x.nrrd", "other/y.nrrd":
    write(name, nrrd, b"\n", samples)
write("named.nrrd", nrrd, b"content: a thing\n\n", samples)
write("v.raw", samples)
write("w_20x12x10_uint8.raw", samples)
write("m.mhd", b"ObjectType = Image\nNDims = 3\nDimSize = 20 12 10\nElementType = MET_UCHAR\nElementDataFile = v.raw\n")
write("m.mha", b"ObjectType = Image\nNDims = 3\nDimSize = 20 12 10\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n", samples)
mesh = (b"# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n"
        b"0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nCELLS 2 10\n4 0 1 2 3\n4 4 1 2 3\nCELL_TYPES 2\n10\n10\n"
        b"POINT_DATA 5\nSCALARS heat float 1\nLOOKUP_TABLE default\n0 1 2 3 4\n")
write("one/a.vtk", mesh)
write("other/b.vtk", mesh)
write("c.mesh", b"LEAFCAST MESH 1\nname: a mesh\nfield: heat\npoints: 4\ntets: 1\n\n",
      struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1), struct.pack("<4f", 0, 1, 2, 3), struct.pack("<4I", 0, 1, 2, 3))
PY
id_of() { "$leafcast" info "$1" --json | sed -n 's/.*"id": "\([0-9a-f]*\)".*/\1/p'; }
name_of() { "$leafcast" info "$1" --json | python3 -c 'import json, sys; print(json.load(sys.stdin)["name"])'; }
# same NAME COMMAND... - converts to $tmp/b.leaf the bytes of $tmp/a.leaf.
same() {
    tap_name=$1
    shift
    exits "$tap_name" 0 "$@" -o "$tmp/b.leaf" --force
    ok "the same bytes" cmp "$tmp/a.leaf" "$tmp/b.leaf"
}
piped() {
    input=$1
    shift
    "$leafcast" convert - "$@" <"$input"
}
zipped() {
    input=$1
    shift
    gzip -c "$input" >"$tmp/v.raw.gz" && "$leafcast" convert "$tmp/v.raw.gz" "$@"
}

exits "samples in NRRD" 0 "$leafcast" convert "$tmp/one/x.nrrd" -o "$tmp/a.leaf"
same "under another name" "$leafcast" convert "$tmp/other/y.nrrd"
same "in raw" "$leafcast" convert "$tmp/v.raw" --dims 20,12,10 --type u8
same "in raw whose name tells" "$leafcast" convert "$tmp/w_20x12x10_uint8.raw"
same "in gzip" zipped "$tmp/v.raw" --dims 20,12,10 --type u8
same "in MHD" "$leafcast" convert "$tmp/m.mhd" --axes none --unit=
same "in MHA" "$leafcast" convert "$tmp/m.mha" --axes none --unit=
same "NRRD through a pipe" piped "$tmp/one/x.nrrd"
same "MHA through a pipe" piped "$tmp/m.mha" --axes none --unit=
same "raw through a pipe" piped "$tmp/v.raw" --dims 20,12,10 --type u8
same "a name taken away" "$leafcast" convert "$tmp/named.nrrd" --name=
ok "the id, too" [ -n "$(id_of "$tmp/a.leaf")" -a "$(id_of "$tmp/a.leaf")" = "$(id_of "$tmp/b.leaf")" ]
ok "no path is in it" [ "$(LC_ALL=C grep -c -a -e nrrd -e "$tmp" "$tmp/a.leaf")" = 0 ]

# Where a file has no name, its own is shown.
ok "the file's own name" [ "$(name_of "$tmp/b.leaf")" = b ]
cp "$tmp/b.leaf" "$tmp/one/c.d.leaf"
ok "of another one" [ "$(name_of "$tmp/one/c.d.leaf")" = c.d ]
exits "in words" 0 "$leafcast" info "$tmp/b.leaf"
ok "the same" grep -q '^name  *b$' "$tmp/out"
ok "of an input" [ "$(name_of "$tmp/other/y.nrrd")" = y ]
exits "a name in the data" 0 "$leafcast" convert "$tmp/named.nrrd" -o "$tmp/c.leaf"
ok "goes into the file" [ "$(name_of "$tmp/c.leaf")" = "a thing" ]
same_name() {
    exits "--name" 0 "$leafcast" convert "$1" --name "$2" -o "$tmp/n.leaf" --force
    ok "is the name" [ "$(name_of "$tmp/n.leaf")" = "$3" ]
    ok "of a sound file" "$leafcast" verify "$tmp/n.leaf" -q
}
same_name "$tmp/named.nrrd" "another thing" "another thing"
wide=$(printf '\303\244%.0s' 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32)
same_name "$tmp/one/x.nrrd" "$wide" "${wide%??}"
same_name "$tmp/one/x.nrrd" "$(printf 'a\377b')" "$(printf 'a\357\277\275b')"
same_name "$tmp/one/a.vtk" "a thing" "a thing"
same_name "$tmp/c.mesh" "a thing" "a thing"

rm -f "$tmp/a.leaf"
exits "a mesh" 0 "$leafcast" convert "$tmp/one/a.vtk" --coarse=4 -o "$tmp/a.leaf"
same "under another name" "$leafcast" convert "$tmp/other/b.vtk" --coarse=4
ok "the file's own name" [ "$(name_of "$tmp/b.leaf")" = b ]
exits "a mesh with a name" 0 "$leafcast" convert "$tmp/c.mesh" -o "$tmp/c.leaf" --force
ok "keeps it" [ "$(name_of "$tmp/c.leaf")" = "a mesh" ]
mv "$tmp/c.leaf" "$tmp/a.leaf"
same "through a pipe" piped "$tmp/c.mesh"
finish
