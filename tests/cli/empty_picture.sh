#!/bin/sh
# empty_picture.sh - a picture without any surface says so, and why; --fail-empty; covered pixels.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/${2:-err}"; }
finite() { od -An -v -t f8 -w8 "$1" | grep -vc inf; }
covered() { sed -n 's/^ *"covered_pixels": \([0-9]*\),$/\1/p' "$tmp/out"; }
# depth F.leaf ARGUMENT...: its picture of distances, and its statistics in $tmp/out.
depth() {
    leaf=$1
    shift
    run "$leafcast" render "$leaf" --size 40x30 --depth-f64 "$tmp/z" --force --json "$@"
}

g=$tmp/g.leaf
"$leafcast" generate sphere --dims 40 --type u8 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$g" -q
for how in "" "--isa scalar" "--opacity 0.5" "--light 1,1,1 --shadows" "--view close --threads 3"; do
    # shellcheck disable=SC2086 # options
    depth "$g" --iso 150 $how
    ok "covered pixels${how:+ with }$how" [ "$(covered)" -gt 50 -a "$(covered)" = "$(finite "$tmp/z")" ]
    ok "nothing is amiss" [ "$(grep -c 'no surface' "$tmp/err")" = 0 ]
done

exits "an isovalue out of range" 0 "$leafcast" render "$g" --iso 999 --size 8x8 --json
ok "says so" says 'no surface at isovalue 999: the values are 34 to 249$'
ok "counts no pixel" [ "$(covered)" = 0 ]
exits "--fail-empty" 1 "$leafcast" render "$g" --iso 999 --size 8x8 -o "$tmp/e.png" --fail-empty
ok "the picture is there" [ -s "$tmp/e.png" ]
ok "says that it is empty" says ': the picture shows no surface$'
exits "a view past it" 1 "$leafcast" render "$g" --iso 150 --size 8x8 --eye 200,200,200 \
    --look-at 300,300,300 --json --fail-empty
ok "says that it is the view" says 'outside of the camera'
exits "clipped away" 1 "$leafcast" render "$g" --iso 150 --size 8x8 --clip-box 0,0,0,1,1,1 --json --fail-empty
ok "says that, too" says 'clipped away'
exits "something seen" 0 "$leafcast" render "$g" --iso 150 --iso 999 --size 8x8 --json --fail-empty
ok "though one isovalue has nothing" says 'no surface at isovalue 999'
exits "a sequence with an empty one" 1 "$leafcast" render "$g" --iso-list 150,999,160 --size 8x8 --json --fail-empty
ok "says how many" says ': 1 of 3 pictures show no surface$'
ok "draws all" [ "$(grep -c '"isovalues"' "$tmp/out")" = 3 ]

# Two fields of different ranges: it is the chosen one's that counts.
cat >"$tmp/two.vtk" <<'VTK'
# vtk DataFile Version 3.0
two fields
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 4 float
0 0 0 4 0 0 0 4 0 0 0 4
CELLS 1 5
4 0 1 2 3
CELL_TYPES 1
10
POINT_DATA 4
SCALARS low float 1
LOOKUP_TABLE default
0 1 2 3
SCALARS high float 1
LOOKUP_TABLE default
1000 1100 1200 1400
VTK
m=$tmp/m.leaf
exits "two fields" 0 "$leafcast" convert "$tmp/two.vtk" --fields all -o "$m"
exits "an isovalue of the other field" 1 "$leafcast" render "$m" --field low --iso 1300 --size 30x30 --json --fail-empty
ok "says the range of the chosen one" says 'no surface at isovalue 1300: the values are 0 to 3$'
exits "of its own" 0 "$leafcast" render "$m" --field high --iso 1300 --size 30x30 --json --fail-empty
ok "covers pixels" [ "$(covered)" -gt 0 ]
for how in "" "--packets 8" "--isa scalar"; do
    # shellcheck disable=SC2086 # options
    depth "$m" --field high --iso 1250 $how
    ok "covered pixels of a mesh${how:+ with }$how" [ "$(covered)" -gt 5 -a "$(covered)" = "$(finite "$tmp/z")" ]
done
finish
