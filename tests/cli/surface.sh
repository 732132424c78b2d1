#!/bin/sh
# surface.sh - surfaces of triangles, through every verb: what works gives the surface back, what does not says so in a
# line that names the file.
# marks: long
. tests/support/tap.sh
command -v python3 >/dev/null || { skip "surfaces" "no python3 here"; finish; }

says() { grep -q -- "$1" "$tmp/err"; }
prints() { grep -q -- "$1" "$tmp/out"; }
json() { python3 -c 'import json, sys; x = json.load(open(sys.argv[1])); sys.exit(not ('"$1"'))' "$tmp/out"; }
one_line() { [ "$(grep -c . "$tmp/err")" = 1 ]; }

# make SHIFT OTHER FILE: a sheet of 800 triangles, its values and colours; OTHER is added to values.
cat >"$tmp/make.py" <<'PY'
import math, sys
shift, other, path = float(sys.argv[1]), float(sys.argv[2]), sys.argv[3]
n = 20
points = [(i / n, j / n, 0.2 * math.sin(6 * i / n + shift) * math.cos(5 * j / n), i * j / n / n + other, i % 256, j, i * j % 256)
          for j in range(n + 1) for i in range(n + 1)]
rows = [r for j in range(n) for i in range(n) for a in [j * (n + 1) + i] for r in ((a, a + 1, a + n + 2), (a, a + n + 2, a + n + 1))]
with open(path, "w") as f:
    print("ply\nformat ascii 1.0\nelement vertex", len(points), file=f)
    print("property float x\nproperty float y\nproperty float z\nproperty float heat", file=f)
    print("property uchar red\nproperty uchar green\nproperty uchar blue\nelement face", len(rows), file=f)
    print("property list uchar int vertex_indices\nend_header", file=f)
    for p in points: print("%.9g %.9g %.9g %.9g %d %d %d" % p, file=f)
    for r in rows: print(3, *r, file=f)
PY
make() { python3 "$tmp/make.py" "$@"; }
for i in 0 1 2; do make $i 0 "$tmp/moves_$i.ply"; make 0 $i "$tmp/stays_$i.ply"; done

# ---- convert, info, verify ----

exits "converted" 0 "$leafcast" convert "$tmp/stays_0.ply" -o "$tmp/s.leaf" --json
ok "is counted" json 'x["triangles"] == 800 and x["vertices"] == 441 and x["field"] == "heat" and x["flat"] == 0'
exits "is sound" 0 "$leafcast" verify "$tmp/s.leaf"
exits "info" 0 "$leafcast" info "$tmp/s.leaf"
ok "tells of triangles" prints '^surface  *800 triangles, 441 vertices$'
ok "has no histogram" [ "$(grep -c 'histogram\|isovalue' "$tmp/out")" = 0 ]
ok "and says how to draw it" prints '^next  *leafcast render .*s.leaf -o .*s.png$'
exits "info for programs" 0 "$leafcast" info "$tmp/s.leaf" --json
ok "says what it is" json 'x["kind"] == "triangles" and x["triangles"] == 800 and x["moving"] is False'
ok "has no histogram either" json '"histogram" not in x and "isovalues" not in x'
for option in '--iso 0.5' '--steps 0'; do
    # shellcheck disable=SC2086 # split on purpose
    exits "info $option" 2 "$leafcast" info "$tmp/s.leaf" $option
    ok "is told" says 's.leaf: a surface of triangles, which has no isosurfaces'
done
exits "all fields, compressed" 0 "$leafcast" convert "$tmp/stays_0.ply" --fields all --compress zstd -o "$tmp/z.leaf" --json
ok "are two" json 'x["fields"] == ["heat", "rgb"]'
exits "are sound" 0 "$leafcast" verify "$tmp/z.leaf"
exits "a plan" 0 "$leafcast" convert "$tmp/stays_0.ply" --dry-run --json
ok "counts" json 'x["input_triangles"] == 800 and x["spill_bytes"] == 0'

while read -r option; do
    # shellcheck disable=SC2086 # split on purpose
    exits "convert $option" 2 "$leafcast" convert "$tmp/stays_0.ply" -q $option -o "$tmp/x.leaf"
    ok "says so" says "a surface is converted without ${option%%[ =]*}"
    ok "in a line" [ "$(grep -c surface "$tmp/err")" = 1 ]
done <<'X'
--gradients
--build sah
--leaf-tets 4
--coarse=8
--whole-cells
--by-corners
X
exits "large treelets" 2 "$leafcast" convert "$tmp/stays_0.ply" --treelet-tets 16385 -o "$tmp/x.leaf"
printf 'OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 0\n3 0 1 9\n' >"$tmp/none.off"
exits "no sound triangle" 3 "$leafcast" convert "$tmp/none.off" -o "$tmp/x.leaf"
ok "is counted" says '1 triangles with an id that is no point, 1 with a vertex twice, and no triangle besides'

# ---- steps ----

exits "points that move" 0 "$leafcast" convert "$tmp/moves_%d.ply" --fields all -o "$tmp/m.leaf" --json
ok "do" json 'x["moving"] and x["steps"] == 3'
exits "are sound" 0 "$leafcast" verify "$tmp/m.leaf"
exits "are told" 0 "$leafcast" info "$tmp/m.leaf"
ok "are three steps" prints '^steps  *3, times 0 .. 2, vertices move$'
ok "of a surface" prints 'from a surface at 3 steps'
exits "all at once" 0 "$leafcast" convert "$tmp"/stays_?.ply -o "$tmp/all.leaf" -q
exits "the first" 0 "$leafcast" convert "$tmp/stays_0.ply" --append -o "$tmp/grown.leaf" -q
exits "the next" 0 "$leafcast" convert "$tmp/stays_1.ply" --append -o "$tmp/grown.leaf" -q
exits "the last" 0 "$leafcast" convert "$tmp/stays_2.ply" --append -o "$tmp/grown.leaf" -q
exits "are sound" 0 "$leafcast" verify "$tmp/grown.leaf"
for step in 0 1 2; do
    for file in all grown; do
        "$leafcast" export "$tmp/$file.leaf" --step $step -o "$tmp/$file.ply" --force -q || true
    done
    ok "step $step is that of the series" cmp "$tmp/all.ply" "$tmp/grown.ply"
done
exits "points elsewhere" 2 "$leafcast" convert "$tmp/moves_1.ply" --append -o "$tmp/grown.leaf"
exits "steps that move" 2 "$leafcast" convert "$tmp/moves_0.ply" "$tmp/moves_1.ply" --append -o "$tmp/x.leaf"
ok "do not grow" says 'points that move from step to step'
head -n 860 "$tmp/stays_1.ply" | sed 's/element face 800/element face 406/' >"$tmp/none.ply"
exits "another surface" 3 "$leafcast" convert "$tmp/stays_0.ply" "$tmp/none.ply" -o "$tmp/x.leaf"
ok "is named" says 'none.ply: expected 800 triangles, as .*stays_0.ply has, found 406'
"$leafcast" generate buckyball --tets --dims 9 -o "$tmp/b.mesh" -q
"$leafcast" convert "$tmp/b.mesh" -o "$tmp/b.leaf" -q
exits "a mesh behind a surface" 2 "$leafcast" convert "$tmp/b.mesh" --append -o "$tmp/grown.leaf"
ok "is no further step" says 'it is a mesh, and the file is of none'

# ---- normals ----

draw() { "$leafcast" render "$1" --size 64x48 -o "$2" --force -q; }
draw "$tmp/s.leaf" "$tmp/flat.ppm"
exits "smooth" 0 "$leafcast" convert "$tmp/stays_0.ply" --normals smooth -o "$tmp/n.leaf" --json
ok "has none of its own" json 'x["normals"] == 0'
exits "is sound" 0 "$leafcast" verify "$tmp/n.leaf"
exits "info" 0 "$leafcast" info "$tmp/n.leaf"
ok "tells of normals" prints '^normals  *at the vertices, 4 bytes each$'
ok "says whose" prints 'triangles, smooth normals'
draw "$tmp/n.leaf" "$tmp/smooth.ppm"
ok "looks another way" [ -n "$(cmp "$tmp/flat.ppm" "$tmp/smooth.ppm")" ]
for form in ply vtp; do
    exits "exported as .$form" 0 "$leafcast" export "$tmp/n.leaf" -o "$tmp/n.$form" --force -q
    exits "converted again" 0 "$leafcast" convert "$tmp/n.$form" -o "$tmp/again.leaf" --force --json
    ok "has normals of its own" json 'x["normals"] == 441'
    exits "info for programs" 0 "$leafcast" info "$tmp/again.leaf" --json
    ok "does so, too" json 'x["normals"] is True and "normals of its own" in x["provenance"]'
    draw "$tmp/again.leaf" "$tmp/again.ppm"
    ok "looks the same" cmp "$tmp/again.ppm" "$tmp/smooth.ppm"
    exits "without them" 0 "$leafcast" convert "$tmp/n.$form" --normals flat -o "$tmp/again.leaf" --force --json
    ok "none is taken" json 'x["normals"] == 0'
    draw "$tmp/again.leaf" "$tmp/again.ppm"
    ok "is flat" cmp "$tmp/again.ppm" "$tmp/flat.ppm"
done
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n' >"$tmp/only.ply"
printf 'property float nx\nproperty float ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_indices\n' >>"$tmp/only.ply"
printf 'end_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n' >>"$tmp/only.ply"
exits "normals alone" 0 "$leafcast" convert "$tmp/only.ply" -o "$tmp/only.leaf"
ok "are told" prints '^normals  *of the file.s own, at its points$'
ok "and are no field" [ ! -s "$tmp/err" ]
exits "a series that moves" 0 "$leafcast" convert "$tmp/moves_%d.ply" --normals smooth --compress zstd -o "$tmp/nm.leaf" -q
exits "is sound" 0 "$leafcast" verify "$tmp/nm.leaf"
exits "its last step" 0 "$leafcast" convert "$tmp/moves_2.ply" --normals smooth -o "$tmp/n2.leaf" -q
"$leafcast" export "$tmp/nm.leaf" --step 2 -o "$tmp/n2.ply" -q
"$leafcast" convert "$tmp/n2.ply" -o "$tmp/n3.leaf" -q
draw "$tmp/n2.leaf" "$tmp/n2.ppm"
draw "$tmp/n3.leaf" "$tmp/n3.ppm"
ok "has the normals of its places" cmp "$tmp/n2.ppm" "$tmp/n3.ppm"
exits "steps of a smooth one" 0 "$leafcast" convert "$tmp/stays_0.ply" --normals smooth --append -o "$tmp/ng.leaf" -q
exits "come with the same option" 0 "$leafcast" convert "$tmp/stays_1.ply" --normals smooth --append -o "$tmp/ng.leaf" -q
exits "are sound" 0 "$leafcast" verify "$tmp/ng.leaf"
exits "and not without it" 2 "$leafcast" convert "$tmp/stays_2.ply" --append -o "$tmp/ng.leaf" -q
ok "are told apart" says '--normals'
exits "another word" 2 "$leafcast" convert "$tmp/stays_0.ply" --normals round -o "$tmp/x.leaf"
ok "is told" says '"round" is neither file, smooth nor flat'
exits "a mesh" 2 "$leafcast" convert "$tmp/b.mesh" --normals smooth -o "$tmp/x.leaf"
ok "has no such normals" says 'b.mesh is no surface of triangles'

# ---- export ----

for form in ply vtp; do
    exits "exported as .$form" 0 "$leafcast" export "$tmp/z.leaf" -o "$tmp/e.$form" --json
    ok "all of it" json 'x["triangles"] == 800 and x["vertices"] == 441'
    exits "converted again" 0 "$leafcast" convert "$tmp/e.$form" --fields all --compress zstd -o "$tmp/again.leaf" --force --json
    ok "has both fields" json 'x["fields"] == ["heat", "rgb"] and x["triangles"] == 800'
    ok "and as many bytes" [ "$(wc -c <"$tmp/again.leaf")" = "$(wc -c <"$tmp/z.leaf")" ]
done
ok "colours are bytes in .ply" grep -aq '^property uchar red$' "$tmp/e.ply"
exits "a step of a series" 0 "$leafcast" export "$tmp/m.leaf" --step 2 -o "$tmp/step.ply" -q
exits "is the file it was" 0 "$leafcast" convert "$tmp/step.ply" --fields all -o "$tmp/step.leaf" -q
exits "converted" 0 "$leafcast" convert "$tmp/moves_2.ply" --fields all -o "$tmp/alone.leaf" -q
ok "to the bit" cmp "$tmp/step.leaf" "$tmp/alone.leaf"
exits "as .stl" 0 "$leafcast" export "$tmp/s.leaf" -o "$tmp/e.stl" --json
ok "its triangles" json 'x["triangles"] == 800'
exits "to standard output" 0 "$leafcast" export "$tmp/z.leaf" --format ply -o -
ok "the same" cmp "$tmp/out" "$tmp/e.ply"
for threads in 1 3; do
    exits "by $threads threads" 0 "$leafcast" export "$tmp/z.leaf" --threads $threads --memory 3M -o "$tmp/t.ply" --force -q
    ok "the same" cmp "$tmp/t.ply" "$tmp/e.ply"
done
exits "one field" 0 "$leafcast" export "$tmp/z.leaf" --field rgb -o "$tmp/one.ply" -q
ok "alone" [ "$(grep -ac '^property float heat$' "$tmp/one.ply")" = 0 ]
exits "a field that is not there" 2 "$leafcast" export "$tmp/z.leaf" --field cold -o "$tmp/x.ply"
for option in '--iso 0.5' --floats '--level 1'; do
    # shellcheck disable=SC2086 # split on purpose
    exits "export $option" 2 "$leafcast" export "$tmp/s.leaf" $option -o "$tmp/x.ply"
    ok "is told" says 's.leaf is a surface of triangles, to become .ply'
done
exits "as cells" 3 "$leafcast" export "$tmp/s.leaf" -o "$tmp/x.vtu"
ok "is told" says 's.leaf: a surface, which .vtu is not for: export it as .ply, .stl or .vtp'
exits "as samples" 3 "$leafcast" export "$tmp/s.leaf" -o "$tmp/x.nrrd"
ok "is told" says 's.leaf: a surface, which has no samples of a grid'
exits "an isosurface of a volume without --iso" 2 "$leafcast" export "$tmp/b.leaf" -o "$tmp/x.ply"
ok "is asked for" says 'which isosurface'

# ---- other verbs ----

exits "drawn" 0 "$leafcast" render "$tmp/s.leaf" --size 64x48 -o "$tmp/s.pfm" -q
exits "drawn, compressed" 0 "$leafcast" render "$tmp/z.leaf" --size 64x48 -o "$tmp/z.pfm" -q
ok "the same picture" cmp "$tmp/s.pfm" "$tmp/z.pfm"
exits "a pixel" 0 "$leafcast" probe "$tmp/s.leaf" --size 64x48 --at 32,24 --json
ok "shows a triangle" json 'x["count"] == 3 and x["hits"][0]["triangle"] < 800 and len(x["hits"][0]["vertices"]) == 9'
ok "and no isovalue" json '"isovalue" not in x["hits"][0]'
for what in "probe --point 0.5,0.5,0.1" "probe --at 32,24 --segments" "slice --plane 0,0,1,-0.1 -o $tmp/x.pfm"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "${what%% -o*}" 2 "$leafcast" $what "$tmp/s.leaf"
    ok "is told" says 'is a surface, of triangles: it has no values beside it'
    ok "in a line" one_line
done
exits "caps" 2 "$leafcast" render "$tmp/s.leaf" --clip-box 0,0,-1,0.5,1,1 --caps -o "$tmp/x.png" -q
ok "is told" says 'a surface itself has no inside'
exits "a pixel's isovalue" 2 "$leafcast" probe "$tmp/s.leaf" --at 32,24 --iso 0.5
ok "is told" says "is a surface itself: it has no isosurfaces"
exits "resampled" 3 "$leafcast" resample "$tmp/s.leaf" --dims 8 -o "$tmp/x.nrrd"
ok "is told" says 's.leaf: a surface, of which none is resampled; meshes and curvilinear grids are'
ok "in a line" one_line
exits "its input resampled" 3 "$leafcast" resample "$tmp/stays_0.ply" --dims 8 -o "$tmp/x.nrrd"
ok "is told" says 'stays_0.ply: a surface, which fills no volume'
exits "filled with tets" 3 "$leafcast" tetrahedralize "$tmp/s.leaf" -o "$tmp/x.mesh"
ok "is told" says 's.leaf: this is a treelet file'
exits "converted again" 3 "$leafcast" convert "$tmp/s.leaf" -o "$tmp/x.leaf"
ok "is told" says 's.leaf: this is a treelet file'

# ---- triangles at one place ----

# face FILE ROW..: a triangle, once per row: its corners, then its colour.
face() {
    to=$1
    shift
    {
        printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n'
        printf 'element face %d\nproperty list uchar int vertex_indices\n' $#
        printf 'property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n-0.3 0.1 0.7\n5.2 0.4 0.1\n1.7 4.9 1.3\n'
        printf '3 %s\n' "$@"
    } >"$tmp/$to.ply"
    "$leafcast" convert "$tmp/$to.ply" --fields all -o "$tmp/$to.leaf" --force -q
}
face red '0 1 2 255 0 0'
face blue '2 1 0 0 0 255'
face turned '0 1 2 255 0 0' '1 2 0 0 255 0' '2 0 1 0 0 255'
face sides '2 1 0 0 0 255' '0 1 2 255 0 0'
for isa in auto scalar; do
    for seen in "front 3,1,9 red" "behind 3,1,-9 blue"; do
        # shellcheck disable=SC2086 # split on purpose
        set -- $seen
        for what in $3 turned sides; do
            "$leafcast" render "$tmp/$what.leaf" --field rgb --size 64x48 --eye $2 --look-at 2,2,0.7 --isa $isa --shading flat \
                -o "$tmp/$1_$what.pfm" --force -q || true
            "$leafcast" render "$tmp/$what.leaf" --field rgb --size 64x48 --eye $2 --look-at 2,2,0.7 --isa $isa --shading flat \
                --opacity 0.5 -o "$tmp/$1_$what.glass.pfm" --force -q || true
        done
        ok "$isa: from $1, two sides show the one that faces the eye" cmp "$tmp/$1_$3.pfm" "$tmp/$1_sides.pfm"
    done
    ok "$isa: of one triangle in three orders the first is seen" cmp "$tmp/front_red.pfm" "$tmp/front_turned.pfm"
    ok "$isa: as one layer" cmp "$tmp/front_red.glass.pfm" "$tmp/front_turned.glass.pfm"
    ok "$isa: two sides are two" [ "$(cmp "$tmp/front_red.glass.pfm" "$tmp/front_sides.glass.pfm" | wc -l)" = 1 ]
done

# ---- sequences ----

exits "steps of a surface" 0 "$leafcast" render "$tmp/m.leaf" --steps all --size 32x24 -o "$tmp/step_%d.pfm" -q
ok "are three pictures" [ "$(ls "$tmp"/step_?.pfm | wc -l)" = 3 ]
exits "turns of a surface" 0 "$leafcast" render "$tmp/s.leaf" --turntable 3 --size 32x24 -o "$tmp/turn_%d.pfm" -q
ok "are three pictures" [ "$(ls "$tmp"/turn_?.pfm | wc -l)" = 3 ]

# ---- interrupted, in little memory ----

exits "kept" 0 "$leafcast" convert "$tmp/moves_%d.ply" --fields all --resume -o "$tmp/r.leaf" -q
ok "the same bytes" cmp "$tmp/r.leaf" "$tmp/m.leaf"
exits "too little memory" 4 "$leafcast" convert "$tmp/stays_0.ply" --memory 1M -o "$tmp/x.leaf"
ok "is told" says 'needs [0-9]* MiB'
finish
