#!/bin/sh
# view.sh - named colours, lists of isovalues, turntables; flags of a view that would change nothing.
# marks: leaks
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/${2:-err}"; }
g=$tmp/g.leaf
m=$tmp/m.leaf
"$leafcast" generate gyroid --dims 20,24,28 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$g" -q
"$leafcast" generate buckyball --tets --dims 9 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m.mesh" -o "$m" -q
# draw NAME ARGUMENT...: $tmp/NAME.ppm of the grid
draw() {
    name=$1
    shift
    "$leafcast" render "$g" --size 40x30 -o "$tmp/$name.ppm" --force -q "$@" 2>"$tmp/err"
}
same() { cmp -s "$tmp/$1.ppm" "$tmp/$2.ppm"; }
other() { ! same "$1" "$2"; }

draw named --iso 120 --color rebeccapurple
draw hex --iso 120 --color '#663399'
draw upper --iso 120 --color RebeccaPurple
draw plain --iso 120
ok "a colour by its name" same named hex
ok "whatever the case" same upper hex
ok "is that colour" other named plain
draw back --iso 120 --background aliceblue
draw numbers --iso 120 --background '#f0f8ff'
ok "of the background, too" same back numbers
exits "no such colour" 2 "$leafcast" render "$g" --iso 120 --color redd -o "$tmp/x.png"
ok "is told what there is" says "a name such as 'red'"

draw list --iso 100,150 --opacity 0.5
draw twice --iso 100 --iso 150 --opacity 0.5
draw one --iso 100 --opacity 0.5
ok "--iso V,V is --iso V --iso V" same list twice
ok "and not the first alone" other list one
exits "an empty place in the list" 2 "$leafcast" render "$g" --iso 100,,150 -o "$tmp/x.png"
exits "negative ones" 0 "$leafcast" render "$g" --iso -1,-2,120 --size 8x8 --json

exits "a turntable" 0 "$leafcast" render "$g" --iso 120 --size 40x30 --turntable 4 -o "$tmp/t.ppm" -q
ok "of four" [ "$(find "$tmp" -name 't_*.ppm' | wc -l)" = 4 ]
ok "begins where the picture is" same t_0000 plain
# Half a turn about +z through the middle of the box: the standard direction with x and y negated.
centre="9.5 11.5 13.5"
# shellcheck disable=SC2086,SC2046 # numbers
eye=$(awk -v c="$centre" 'BEGIN { split(c, m); d = 2.2 * 27 / sqrt(1 + 0.36 + 0.64)
    printf "%.17g,%.17g,%.17g", m[1] - d, m[2] - 0.6 * d, m[3] + 0.8 * d }')
run "$leafcast" render "$g" --iso 120 --size 40x30 --eye "$eye" --depth-f64 "$tmp/half.z"
run "$leafcast" render "$g" --iso 120 --view standard --size 40x30 --turntable 2 --depth-f64 "$tmp/turn.z"
near() {
    od -An -v -t f8 -w8 "$1" >"$tmp/a"
    od -An -v -t f8 -w8 "$2" >"$tmp/b"
    paste "$tmp/a" "$tmp/b" | awk '$1 != $2 && !(($1 - $2) ^ 2 < 1e-12) { bad++ }
        $1 != "inf" { seen++ } END { exit !(seen > 100 && bad <= 2) }'
}
ok "half a turn" near "$tmp/half.z" "$tmp/turn_0001.z"
exits "with isovalues" 0 "$leafcast" render "$g" --iso-list 100,150 --turntable 3 --size 8x8 --json
ok "each is turned" [ "$(grep -c isovalues "$tmp/out")" = 6 ]
ok "isovalue by isovalue" [ "$(grep -n '\[150.0\]' "$tmp/out" | cut -d: -f1 | tr '\n' ' ')" = "4 5 6 " ]
echo '[{"fov": 30}, {"fov": 50}]' >"$tmp/path.json"
exits "with a path" 0 "$leafcast" render "$g" --iso 120 --camera-path "$tmp/path.json" --turntable 3 --size 8x8 --json
ok "each entry is turned" [ "$(grep -c isovalues "$tmp/out")" = 6 ]
exits "--frames without a path" 2 "$leafcast" render "$g" --iso 120 --frames 3 --size 8x8 -o "$tmp/k.ppm"
run "$leafcast" render "$g" --iso 120 --camera-path "$tmp/path.json" --size 40x30 -o "$tmp/key.ppm" -q
exits "a movie" 0 "$leafcast" render "$g" --iso 120 --camera-path "$tmp/path.json" --frames 5 --size 40x30 -o "$tmp/k.ppm" -q
ok "of five" [ "$(find "$tmp" -name 'k_*.ppm' | wc -l)" = 5 ]
ok "begins with the first entry" same k_0000 key_0000
ok "ends with the last" same k_0004 key_0001
echo '[{"fov": 30}, {"fov": 40}]' >"$tmp/half.json"
run "$leafcast" render "$g" --iso 120 --camera-path "$tmp/half.json" --size 40x30 -o "$tmp/half.ppm" -q
ok "and is half between them in its middle" same k_0002 half_0001
ok "which is another picture" other k_0002 k_0004
"$leafcast" render "$g" --iso 120 --camera-path "$tmp/path.json" --frames 5 --size 40x30 -o - --format ppm -q >"$tmp/stream"
cat "$tmp"/k_000?.ppm >"$tmp/joined"
ok "into a pipe: the same, one behind the other" cmp -s "$tmp/stream" "$tmp/joined"
exits "too many frames" 2 "$leafcast" render "$g" --iso 120 --camera-path "$tmp/path.json" --frames 1000001 --size 8x8 -o "$tmp/x.png"
exits "too many pictures" 2 "$leafcast" render "$g" --iso-list 1,2,3 --steps 0:60000 --turntable 1000000 -o "$tmp/x.png"
ok "are counted, not drawn" says 'more than 1000000, the most'

refused() { # refused WHAT SAYS F.leaf ARGUMENT...: render and probe refuse it, with words
    what=$1
    words=$2
    shift 2
    exits "$what" 2 "$leafcast" render "$@" --size 8x8 --json
    ok "says why" says "$words"
    exits "$what, probed" 2 "$leafcast" probe "$@" --size 8x8 --at 4,4
}
refused "shadows without a light" "--light says" "$g" --iso 120 --shadows
refused "highlights that are none" "phong" "$g" --iso 120 --specular 0.5
refused "their exponent" "phong" "$g" --iso 120 --shininess 5
refused "layers of opaque surfaces" "without --opacity" "$g" --iso 120 --layers 2
refused "a light on flat colours" "flat" "$g" --iso 120 --shading flat --light 1,1,1
refused "and the ambient one" "flat" "$g" --iso 120 --shading flat --ambient 0.5
refused "a grid's step" "1 steps" "$g" --iso 120 --step 1
refused "a grid's field" "no field is called" "$g" --iso 120 --field 1
refused "a grid's smooth normals" "central or analytic" "$g" --iso 120 --normals smooth
refused "a mesh's central normals" "faceted or smooth" "$m" --iso 0.3 --normals central
refused "a mesh's level of detail" "no coarse levels" "$m" --iso 0.3 --lod 1
refused "a mesh's intersector" "for grids" "$m" --iso 0.3 --intersector linear
for flag in "--packets 4" "--isopolygons cache" "--schema 2"; do
    # shellcheck disable=SC2086 # a flag with its value
    exits "$flag of a grid" 2 "$leafcast" render "$g" --iso 120 --size 8x8 --json $flag
    ok "is told why" says "for meshes"
done
exits "a scheme for one step" 2 "$leafcast" render "$m" --iso 0.3 --size 8x8 --json --schema 2
exits "what may be said of either" 0 "$leafcast" render "$m" --iso 0.3 --size 8x8 --json --lod exact --intersector marmitt
finish
