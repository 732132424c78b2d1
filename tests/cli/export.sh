#!/bin/sh
# export.sh - leafcast export: samples, surfaces and meshes out again, to files and pipes; exit codes.
# marks: leaks
. tests/support/tap.sh

grid=$tmp/g.leaf
mesh=$tmp/m.leaf
left() { [ "$(find "$tmp" -name 'x*' | wc -l)" = "$1" ]; }
says() { grep -q -- "$1" "$tmp/err"; }
count() { sed -n "s/^$1  *//p" "$tmp/out"; }

# Round trips: every type that is stored as it comes.
for type in u8 u16 f32; do
    "$leafcast" generate noise --dims 50,33,70 --type $type --spacing 0.5,2,0.1 -o "$tmp/$type.nrrd" -q
    "$leafcast" convert "$tmp/$type.nrrd" -o "$tmp/$type.leaf" -q
    exits "$type to NRRD" 0 "$leafcast" export "$tmp/$type.leaf" -o "$tmp/x.nrrd"
    ok "the input's bytes" cmp "$tmp/$type.nrrd" "$tmp/x.nrrd"
    exits "$type to a pipe, little memory" 0 "$leafcast" export "$tmp/$type.leaf" -o - --format nrrd --memory 2M
    ok "the same bytes" cmp "$tmp/out" "$tmp/x.nrrd"
    rm "$tmp/x.nrrd"
done
printf 'NRRD0004\ntype: int16\ndimension: 3\nsizes: 3 4 2\nencoding: raw\nendian: little\nspace dimension: 3\nspace directions: (0,-1.5,0) (0.25,0,0.5) (0,0.125,3)\nspace origin: (1,2,3)\n\n%s' \
    abcdefghijklmnopqrstuvwxyz0123456789ABCDEFGHIJKL >"$tmp/i16.nrrd"
"$leafcast" convert "$tmp/i16.nrrd" -o "$tmp/i16.leaf" -q
exits "a sheared grid with a negative spacing" 0 "$leafcast" export "$tmp/i16.leaf" -o "$tmp/x.nrrd"
ok "the input's bytes" cmp "$tmp/i16.nrrd" "$tmp/x.nrrd"
exits "as raw samples" 0 "$leafcast" export "$tmp/i16.leaf" -o "$tmp/x.raw"
ok "says what they are" grep -q "3 x 4 x 2 i16, little endian" "$tmp/out"
ok "they are the input's" [ "$(cat "$tmp/x.raw")" = abcdefghijklmnopqrstuvwxyz0123456789ABCDEFGHIJKL ]
exits "a box of them" 0 "$leafcast" export "$tmp/i16.leaf" --box 1,0,1,2,1,1 -o - --format raw
ok "are those in it" [ "$(cat "$tmp/out")" = 01236789 ]
exits "a sheared grid as .vtr" 3 "$leafcast" export "$tmp/i16.leaf" -o "$tmp/y.vtr"
ok "says what can hold it" says 'turned against'
rm "$tmp/x.nrrd" "$tmp/x.raw"

# Rectilinear axes.
seq 1 3 16 >"$tmp/axis"
"$leafcast" generate gyroid --dims 6 -o "$tmp/even.nrrd" -q
tail -c 216 "$tmp/even.nrrd" >"$tmp/even.raw"
"$leafcast" convert "$tmp/even.raw" --dims 6,6,6 --type u8 --axis-x "$tmp/axis" -o "$tmp/r.leaf" -q
exits "uneven axes as .vtr" 0 "$leafcast" export "$tmp/r.leaf" -o "$tmp/x.vtr"
exits "as .nrrd" 0 "$leafcast" export "$tmp/r.leaf" -o "$tmp/x.nrrd"
"$leafcast" convert "$tmp/x.nrrd" -o "$tmp/x.leaf" -q
exits "and back" 0 "$leafcast" export "$tmp/x.leaf" -o - --format vtr
ok "the same axes and samples" cmp "$tmp/out" "$tmp/x.vtr"
for format in vti nii nii.gz; do
    exits "as .$format" 3 "$leafcast" export "$tmp/r.leaf" -o "$tmp/y.$format"
    ok "says what is uneven" says 'uneven'
done
rm "$tmp"/x.*

# Packed: the same bytes within.
exits "a packed NIfTI" 0 "$leafcast" export "$tmp/u8.leaf" -o "$tmp/x.nii.gz"
"$leafcast" export "$tmp/u8.leaf" -o "$tmp/x.nii" -q
ok "is whole" gzip -t "$tmp/x.nii.gz"
# shellcheck disable=SC2016
ok "and what the other is" sh -c 'gzip -dc "$1" | cmp - "$2"' sh "$tmp/x.nii.gz" "$tmp/x.nii"
rm "$tmp"/x.*

# Levels.
"$leafcast" generate gyroid --dims 70,41,33 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$grid" -q
exits "a coarse level" 0 "$leafcast" export "$grid" --level 1 -o "$tmp/x.nrrd"
ok "has half the samples" grep -aq '^sizes: 36 21 17$' "$tmp/x.nrrd"
ok "at twice the distance" grep -aq '^space directions: (2,0,0) (0,2,0) (0,0,2)$' "$tmp/x.nrrd"
exits "a level that is not there" 2 "$leafcast" export "$grid" --level 9 -o "$tmp/y.nrrd"
rm "$tmp"/x.*

# Surfaces: the same bytes for any threads, memory, way.
"$leafcast" generate buckyball --tets --dims 17 --steps 2 --deform 0.4 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m_0000.mesh" "$tmp/m_0001.mesh" -o "$mesh" -q --treelet-tets 500
for kind in grid:120.5 mesh:0.3; do
    [ ${kind%:*} = grid ] && of=$grid || of=$mesh
    for format in ply stl vtp; do
        exits "the surface of a ${kind%:*} as .$format" 0 "$leafcast" export "$of" --iso ${kind#*:} --threads 1 -o "$tmp/x.$format"
        run "$leafcast" export "$of" --iso ${kind#*:} --threads 3 --memory 8M -o - --format $format
        ok "the same by a pipe, with more threads and less memory" cmp "$tmp/out" "$tmp/x.$format"
        rm "$tmp/x.$format"
    done
done
exits "two isovalues" 0 "$leafcast" export "$grid" --iso 100 --iso 130.5 -o "$tmp/x.ply"
ok "say which vertex is of which" grep -aq '^property double isovalue$' "$tmp/x.ply"
both=$(count triangles)
run "$leafcast" export "$grid" --iso 100 -o "$tmp/x.ply" --force
one=$(count triangles)
run "$leafcast" export "$grid" --iso 130.5 -o "$tmp/x.ply" --force
ok "are both ($one and $(count triangles) of $both)" [ $((one + $(count triangles))) = "$both" ]
exits "as floats" 0 "$leafcast" export "$grid" --iso 130.5 --floats -o "$tmp/x.ply" --force
ok "they are" grep -aq '^property float x$' "$tmp/x.ply"
exits "no surface" 0 "$leafcast" export "$grid" --iso 999 -o "$tmp/x.ply" --force
ok "is said, and empty" grep -aq '^element face 0$' "$tmp/x.ply"
ok "on stderr" says 'no such surface'
exits "a closed surface" 0 "$leafcast" export "$mesh" --iso 0.3 -o "$tmp/x.vtp" --json
ok "has half as many vertices as triangles, nearly" sh -c '
    v=$(sed -n "s/.*\"vertices\": \([0-9]*\).*/\1/p" "$1"); t=$(sed -n "s/.*\"triangles\": \([0-9]*\).*/\1/p" "$1")
    [ $((t - 2 * v)) -gt -8 ] && [ $((t - 2 * v)) -lt 200 ]' sh "$tmp/out"
rm "$tmp"/x.*

# Meshes.
for step in 0 1; do
    exits "step $step of a mesh" 0 "$leafcast" export "$mesh" --step $step -o "$tmp/x.vtu"
    ok "all vertices and tets" grep -q '^vertices    4913$' "$tmp/out"
    "$leafcast" resample "$tmp/x.vtu" --dims 20 -o - | tail -c 32000 >"$tmp/one"
    "$leafcast" resample "$tmp/m_000$step.mesh" --dims 20 -o - | tail -c 32000 >"$tmp/other"
    ok "has the input's values everywhere" cmp "$tmp/one" "$tmp/other"
    run "$leafcast" export "$mesh" --step $step --field buckyball --threads 1 --memory 4M -o - --format vtu
    ok "the same by a pipe" cmp "$tmp/out" "$tmp/x.vtu"
    rm "$tmp/x.vtu"
done

# Trouble.
exits "an output that is there" 1 "$leafcast" export "$grid" -o "$tmp/g.nrrd"
exits "the input as output" 2 "$leafcast" export "$grid" -o "$grid" --force --format raw
exits "a folder that is not there" 1 "$leafcast" export "$grid" -o "$tmp/none/x.nrrd"
exits "no treelet file" 3 "$leafcast" export "$tmp/g.nrrd" -o "$tmp/x.nrrd"
exits "a file that is not there" 1 "$leafcast" export "$tmp/none.leaf" -o "$tmp/x.nrrd"
exits "a mesh's samples" 3 "$leafcast" export "$mesh" -o "$tmp/x.nrrd"
ok "says what to do" says 'leafcast resample'
exits "a grid's tets" 3 "$leafcast" export "$grid" -o "$tmp/x.vtu"
for form in nrrd "ply --iso 120" "stl --iso 120"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "too little memory: $form" 4 "$leafcast" export "$grid" -o - --format $form --memory 100K
    # shellcheck disable=SC2016,SC2086
    exits "a file that may not grow: $form" 4 sh -c 'ulimit -f 10; form=$3; exec "$1" export "$2" -o "$4" --format $form' \
        sh "$leafcast" "$grid" "$form" "$tmp/x"
    # shellcheck disable=SC2016,SC2086
    [ ! -c /dev/full ] || exits "a full disk: $form" 4 sh -c '"$1" export "$2" -o - --format $3 >/dev/full' sh "$leafcast" "$grid" "$form"
done
size=$(wc -c <"$grid")
for at in $((size / 2)) $((size / 4)); do
    cp "$grid" "$tmp/damaged.leaf"
    printf 'damage' | dd of="$tmp/damaged.leaf" bs=1 seek=$at conv=notrunc 2>"$tmp/dd"
    exits "damage at $at: samples" 3 "$leafcast" export "$tmp/damaged.leaf" -o "$tmp/x.nrrd"
    exits "damage at $at: a surface" 3 "$leafcast" export "$tmp/damaged.leaf" --iso 120 -o "$tmp/x.ply"
done
size=$(wc -c <"$mesh")
for at in 5000 $((size / 2)) $((size * 7 / 8)); do
    cp "$mesh" "$tmp/damaged.leaf"
    printf 'damage' | dd of="$tmp/damaged.leaf" bs=1 seek=$at conv=notrunc 2>"$tmp/dd"
    exits "damage at $at: a mesh's step" 3 sh -c '"$1" export "$2" -o "$3" && "$1" export "$2" --step 1 -o "$3"' \
        sh "$leafcast" "$tmp/damaged.leaf" "$tmp/x.vtu"
    rm -f "$tmp/x.vtu"
done
for wrong in "-o x" "-o x.nrrd --iso 3" "-o x.ply" "-o x.ply --iso nan" "-o x.ply --iso 3 --iso 3" "-o x.stl --iso 3 --iso 4" \
    "-o x.stl --iso 3 --floats" "-o x.ply.gz --iso 3" "-o x.nrrd --box 1,2,3" "-o x.nrrd --box 0,0,0,70,1,1" \
    "-o x.nrrd --box 2,0,0,1,1,1" "-o x.nrrd --box -1,0,0,1,1,1" "-o x.nrrd --step 1" "-o x.nrrd --floats" \
    "-o x.nrrd --format png" "-o x.ply --iso 3 --field a --field b" "-o x.ply --iso 3 --step 1" "-o - --format raw --json"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "usage: $wrong" 2 "$leafcast" export "$grid" $wrong
done
for wrong in "-o x.vtu --box 0,0,0,1,1,1" "-o x.vtu --iso 1" "-o x.vtu --level 1" "-o x.vtu --field none" "-o x.vtu --step 2" \
    "-o x.ply --iso 1 --level 1"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "usage: $wrong, of a mesh" 2 "$leafcast" export "$mesh" $wrong
done
ok "none of them leaves a file" left 0
finish
