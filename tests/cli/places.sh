#!/bin/sh
# places.sh - grids and meshes of any scale: pictures are those of scale 1, or the conversion refuses; what convert wrote,
# verify and render take.
. tests/support/tap.sh

"$leafcast" generate gyroid --dims 12,10,14 --type f32 -o "$tmp/g.nrrd" -q
"$leafcast" generate buckyball --tets --dims 5 -o "$tmp/b.mesh" -q
power() { awk -v k="$1" 'BEGIN { printf "%.17g", 2 ^ k }'; }

# draw ISOVALUE FOLDER - surface, medium, shaded medium and maximum.
draw() {
    mkdir -p "$2"
    "$leafcast" render "$tmp/s.leaf" --iso "$1" --size 40x30 -o "$2/surface.ppm" --force -q &&
        "$leafcast" render "$tmp/s.leaf" --tf auto --size 40x30 -o "$2/medium.ppm" --force -q &&
        "$leafcast" render "$tmp/s.leaf" --tf auto --shade-medium --size 40x30 -o "$2/shaded.ppm" --force -q &&
        "$leafcast" render "$tmp/s.leaf" --project max --size 40x30 -o "$2/most.ppm" --force -q
}

# like_one SCALE ISOVALUE STATUS KIND INPUT ARGUMENT... - convert: exit STATUS and words, or pictures as those of $tmp/KIND.
like_one() {
    scale=$1 iso=$2 wanted=$3 kind=$4
    shift 4
    rm -f "$tmp/s.leaf"
    run "$leafcast" convert "$@" -o "$tmp/s.leaf" -q
    if [ "$wanted" != 0 ]; then
        ok "$kind, $scale: refused by name" [ "$rc" = "$wanted" -a ! -e "$tmp/s.leaf" ] && grep -q 'scale it' "$tmp/err"
        return
    fi
    ok "$kind, $scale: converts" [ "$rc" = 0 ]
    exits "$kind, $scale: verify" 0 "$leafcast" verify "$tmp/s.leaf"
    run draw "$iso" "$tmp/seen"
    ok "$kind, $scale: draws" [ "$rc" = 0 ]
    ok "$kind, $scale: the pictures of scale 1" diff -rq "$tmp/$kind" "$tmp/seen"
}

"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/s.leaf" -q
draw 0.2 "$tmp/grid"
for k in -1000 -360 -340 -201 -200 -100 100 200 201 340 360 1000; do
    x=$(power $k)
    wanted=0
    { [ $k -ge -200 ] && [ $k -le 200 ]; } || wanted=2
    like_one "2^$k" 0.2 $wanted grid "$tmp/g.nrrd" --spacing "$x,$x,$x"
done

# The header itself, and axes of a rectilinear grid.
header() { # header SPACING: a NRRD of it
    sed "s/space directions: .*/space directions: ($1,0,0) (0,$1,0) (0,0,$1)/" "$tmp/g.nrrd" >"$tmp/h.nrrd"
}
header "$(power -340)"
like_one "2^-340 in the header" 0.2 3 grid "$tmp/h.nrrd"
header "$(power 180)"
like_one "2^180 in the header" 0.2 0 grid "$tmp/h.nrrd"
for k in 3 -250 250; do
    wanted=0
    [ $k = 3 ] || wanted=3
    awk -v k=$k 'BEGIN { for (i = 0; i < 12; i++) printf "%.17g\n", i * 2 ^ k }' >"$tmp/x"
    awk -v k=$k 'BEGIN { for (i = 0; i < 10; i++) printf "%.17g\n", i * 2 ^ k }' >"$tmp/y"
    awk -v k=$k 'BEGIN { for (i = 0; i < 14; i++) printf "%.17g\n", i * 2 ^ k }' >"$tmp/z"
    run "$leafcast" convert "$tmp/g.nrrd" --axis-x "$tmp/x" --axis-y "$tmp/y" --axis-z "$tmp/z" -o "$tmp/a$k.leaf" -q
    ok "axes of steps of 2^$k: exit $wanted (got $rc)" [ "$rc" = $wanted ]
done
exits "so far off that samples coincide" 2 "$leafcast" convert "$tmp/g.nrrd" --origin 1e20,0,0 -o "$tmp/o.leaf"

# Meshes: TetGen's text holds any scale.
scaled() { # scaled FACTOR: four tets around a point
    awk -v f="$1" 'BEGIN {
        split("0 0 0 1 0 0 0 1 0 0 0 1 0.2 0.2 0.2", x)
        print "5 3 1 0"
        for (i = 0; i < 5; i++) printf "%d %.17g %.17g %.17g %g\n", i, x[3*i+1] * f, x[3*i+2] * f, x[3*i+3] * f, i
    }' >"$tmp/t.node"
    printf '4 4 0\n0 0 1 2 4\n1 0 1 4 3\n2 0 4 2 3\n3 4 1 2 3\n' >"$tmp/t.ele"
}
scaled 1
"$leafcast" convert "$tmp/t.node" -o "$tmp/s.leaf" --force -q
draw 2.5 "$tmp/mesh"
for k in -660 -140 -121 -110 -60 60 120 660; do
    scaled "$(power $k)"
    wanted=0
    { [ $k -ge -120 ] && [ $k -le 120 ]; } || wanted=3
    like_one "2^$k" 2.5 $wanted mesh "$tmp/t.node"
done
finish
