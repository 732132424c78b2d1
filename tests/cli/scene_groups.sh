#!/bin/sh
# scene_groups.sh - leafcast render scene.json: scenes in scenes and tiles are what lists of all objects are, to the bit.
# marks: threads leaks
. tests/support/tap.sh

says() { grep -qF -- "$1" "$tmp/$2"; }
scene() { printf '%s\n' "$2" >"$tmp/$1.json"; }
draw() {
    name=$1
    shift
    exits "$name" 0 "$leafcast" render "$tmp/$name.json" -q -o "$tmp/$name.ppm" --depth-f64 "$tmp/$name.f64" --force "$@"
}
same() { ok "$1 is $2" cmp "$tmp/$1.ppm" "$tmp/$2.ppm" && ok "to the bit" cmp "$tmp/$1.f64" "$tmp/$2.f64"; }
seen() { ok "$1 shows something" sh -c "[ \$(od -An -v -tf8 -w8 '$tmp/$1.f64' | grep -vc inf) -gt ${2:-200} ]"; }

run "$leafcast" generate sphere --tets --dims 9 -o "$tmp/ball.mesh" -q
exits "a mesh" 0 "$leafcast" convert "$tmp/ball.mesh" -o "$tmp/ball.leaf" -q
exits "a plant" 0 "$leafcast" generate plant --shape grass -o "$tmp/grass.ply" -q
exits "as treelets" 0 "$leafcast" convert "$tmp/grass.ply" -o "$tmp/grass.leaf" -q
view='"eye": [60, -70, 60], "look-at": [18, 14, 2], "size": [96, 72], "light": [[1, -0.4, 2]], "shadows": true, "ambient": 0.2'
ball='"file": "ball.leaf", "iso": 0.35, "colour": "red"'
grass='"file": "grass.leaf", "transform": {"scale": 20}'

# ---- one place ----
scene pair '{"objects": [{'"$ball"'}, {'"$grass"'}], "size": [5, 5], "background": "red"}'
scene once '{"objects": [{"scene": "pair.json", "transform": {"translate": [9, 5, 1]}}], '"$view}"
scene written '{"objects": [{'"$ball"', "transform": {"translate": [9, 5, 1]}},
    {"file": "grass.leaf", "transform": [{"scale": 20}, {"translate": [9, 5, 1]}]}], '"$view}"
draw once
draw written
same once written
seen once 50

# ---- many places, in a scene at many places ----
row='{"translate": [0, 0, 0]}, [{"rotate": [0, 0, 1], "degrees": 30}, {"translate": [14, 2, 0]}], [{"scale": [1, 0.5, 2]}, {"translate": [26, 0, 1]}]'
turns='{"translate": [0, 0, 0]}, [{"rotate": [0, 0, 1], "degrees": 20}, {"translate": [4, 18, 0]}]'
scene row '{"objects": [{"scene": "pair.json", "instances": ['"$row]}]}"
scene field '{"objects": [{"scene": "row.json", "instances": ['"$turns"']}, {'"$ball"', "transform": {"translate": [0, -20, 0]}}], '"$view}"
python3 - "$tmp" <<'P'
import json, sys
tmp = sys.argv[1]
load = lambda n: json.load(open("%s/%s.json" % (tmp, n)))
steps = lambda t: t if isinstance(t, list) else [t] if t else []
field, row, pair = load("field"), load("row"), load("pair")
objects = [field["objects"][1]]
for turn in field["objects"][0]["instances"]:
    for at in row["objects"][0]["instances"]:
        for o in pair["objects"]:
            objects.append(dict(o, transform=steps(o.get("transform")) + steps(at) + steps(turn)))
json.dump(dict(field, objects=objects), open(tmp + "/listed.json", "w"))
json.dump(dict(field, objects=[{"file": "ball.leaf", "iso": 0.35, "instances":
    [{"translate": [12 * (i % 90), 12 * (i // 90), 0]} for i in range(5000)]}]), open(tmp + "/many.json", "w"))
P
draw field
draw listed
same field listed
seen field 400
draw field --treelet-limit 1 --threads 3
same field listed
exits "their counts" 0 "$leafcast" render "$tmp/field.json" --json -q -o "$tmp/field.ppm" --force
draw many
seen many
scene fit '{"objects": [{"scene": "row.json", "instances": [{"translate": [1000, 0, 0]}, {"translate": [1000, 40, 0]}]}], "size": [40, 30]}'
exits "the view that fits is where groups are" 0 "$leafcast" render "$tmp/fit.json" --fail-empty -q -o "$tmp/fit.ppm"

# ---- tiles ----
scene tuft '{"objects": [{"file": "grass.leaf", "transform": [{"scale": 12}, {"translate": [3, 4, 0]}]}]}'
scene dome '{"objects": [{'"$ball"', "transform": [{"scale": 0.7}, {"translate": [1, 1, -2]}]}]}'
tile() { printf '{"scene": "%s.json", "edges": ["%s", "%s", "%s", "%s"]}' "$@"; }
chess="$(tile tuft a c b d), $(tile dome b d a c)"
# Only one order fits: tuft and dome in turn, as on a chessboard; which is first, the seed says.
scene chess '{"objects": [{"tiles": ['"$chess"'], "counts": [4, 3], "size": [10, 9], "origin": [-2, 1, 3]}], '"$view}"
draw chess
seen chess 100
chessboard() {
    python3 - "$tmp" "$1" "$2" <<'P'
import json, sys
tmp, name, ground = sys.argv[1:]
load = lambda n: json.load(open("%s/%s.json" % (tmp, n)))
chess = load("chess")
def height(x, y):
    return 3 if ground == "flat" else 2 + 0.25 * x - 0.125 * y
for first in range(2):
    objects = [] if ground == "flat" else [{"file": "ground.leaf"}]
    for y in range(3):
        for x in range(4):
            at = [-2 + 10 * x, 1 + 9 * y]
            mean = height(at[0] + 5, at[1] + 4.5)
            slope = [0, 0] if ground == "flat" else [0.25, -0.125]
            if ground == "low" and mean > 8:
                continue
            for o in load("dome" if (x + y + first) % 2 else "tuft")["objects"]:
                objects.append(dict(o, transform=o["transform"] + [{"matrix":
                    [1, 0, 0, at[0], 0, 1, 0, at[1], slope[0], slope[1], 1, height(*at)]}]))
    json.dump(dict(chess, objects=objects), open("%s/%s%d.json" % (tmp, name, first), "w"))
P
}
chessboard board flat
draw board0
draw board1
ok "tiles are one of two boards" sh -c "cmp -s '$tmp/chess.f64' '$tmp/board0.f64' || cmp -s '$tmp/chess.f64' '$tmp/board1.f64'"
ok "which differ" sh -c "! cmp -s '$tmp/board0.f64' '$tmp/board1.f64'"

# On ground that is a plane (every number here is one that floats have), and low parts of it alone.
python3 - "$tmp" <<'P'
import struct, sys
with open(sys.argv[1] + "/ground.nrrd", "wb") as f:
    f.write(b"NRRD0004\ntype: float\ndimension: 2\nsizes: 9 9\nencoding: raw\nendian: little\n"
            b"spacings: 8 8\naxis mins: -4 -4\n\n")
    for y in range(9):
        for x in range(9):
            f.write(struct.pack("<f", 2 + 0.25 * (-4 + 8 * x) - 0.125 * (-4 + 8 * y)))
P
exits "ground" 0 "$leafcast" convert "$tmp/ground.nrrd" --heights -o "$tmp/ground.leaf" -q
scene hill '{"objects": [{"file": "ground.leaf"}, {"tiles": ['"$chess"'], "counts": [4, 3], "size": [10, 9], "origin": [-2, 1], "ground": "ground.leaf"}], '"$view}"
draw hill
chessboard slope all
draw slope0
draw slope1
near() {
    python3 - "$tmp" "$@" <<'P'
import array, sys
tmp, name, *others = sys.argv[1:]
def depths(n):
    a = array.array("d")
    a.frombytes(open("%s/%s.f64" % (tmp, n), "rb").read())
    return a
of = depths(name)
apart = [sum(not (a == b or abs(a - b) < 1e-9 * b) for a, b in zip(of, depths(o))) for o in others]
assert min(apart) <= 2 and max(apart) > 20, apart
P
}
ok "tiles lie on the slope" near hill slope0 slope1
scene low '{"objects": [{"file": "ground.leaf"}, {"tiles": ['"$chess"'], "counts": [4, 3], "size": [10, 9], "origin": [-2, 1], "ground": "ground.leaf", "between": [-100, 8]}], '"$view}"
draw low
chessboard lower low
draw lower0
draw lower1
ok "low tiles lie on low ground" near low lower0 lower1
ok "and no others" sh -c "! cmp -s '$tmp/low.f64' '$tmp/hill.f64'"
# Beyond the ground there are no tiles.
scene beyond '{"objects": [{"file": "ground.leaf"}, {"tiles": ['"$chess"'], "counts": [2, 2], "size": [10, 9], "origin": [500, 1], "ground": "ground.leaf"}], '"$view}"
scene bare '{"objects": [{"file": "ground.leaf"}], '"$view}"
draw beyond
draw bare
same beyond bare
# Many tiles, each as often as it takes: a choice by seed.
all=
for w in a b; do for s in a b; do for e in a b; do for n in a b; do
    all="$all${all:+, }$(tile "$([ $w$n = aa ] && echo dome || echo tuft)" $w $s $e $n)"
done; done; done; done
for seed in 0 1; do
    scene wang$seed '{"objects": [{"tiles": ['"$all"'], "counts": [60, 60], "size": [10, 10], "seed": '$seed'}], '"$view}"
    draw wang$seed
done
ok "another seed, other tiles" sh -c "! cmp -s '$tmp/wang0.f64' '$tmp/wang1.f64'"

# ---- what is wrong, and where ----
wrong() {
    scene wrong "$1"
    exits "wrong: $2" "${3:-2}" "$leafcast" render "$tmp/wrong.json" -q -o "$tmp/x.ppm"
    ok "and so it is said" says "$2" err
}
two='"instances": [{"scale": 1}, {"scale": 2}]'
wrong '{"objects": [{"scene": "wrong.json"}]}' 'scenes in scenes, 16 deep: does one lie in itself?'
wrong '{"objects": [{"scene": "wrong.json", '"$two}]}" 'scenes in scenes, 16 deep: does one lie in itself?'
one='{"scene": "wrong.json", '"$two}"
wrong '{"objects": ['"$one, $one, $one, $one]}" 'more than 4096 groups: does a scene lie in itself?'
wrong '{"objects": [{"scene": "none.json"}]}' 'none.json' 1
wrong '{"objects": [{"scene": "ball.leaf"}]}' 'ball.leaf' 3
wrong '{"objects": [{"scene": "grass.ply"}]}' 'grass.ply' 3
wrong '{"objects": [{"scene": 3}]}' 'objects[0]: "scene" takes a name'
wrong '{"objects": [{"scene": "pair.json", "iso": 0.3}]}' 'objects[0]: there is no "iso"'
printf '%s\n' '{"size": [8, 8]}' >"$tmp/none_in.json"
wrong '{"objects": [{"scene": "none_in.json"}]}' 'none_in.json: no scene: a scene has "objects"' 3
printf '%s\n' '{"objects": [{"file": "ball.leaf", "iso": 0.35, "colr": "red"}]}' >"$tmp/bad.json"
wrong '{"objects": [{"scene": "bad.json", '"$two}]}" 'bad.json: objects[0]: there is no "colr"'
printf '%s\n' '{"objects": [{"file": "ball.leaf", "tf": "auto"}]}' >"$tmp/cloud.json"
wrong '{"objects": [{"scene": "cloud.json", '"$two}]}" 'which lies in a scene that is placed many times'
printf '%s\n' '{"objects": [{"file": "ball.leaf", "iso": 0.35, "colour-by": "ball.leaf"}]}' >"$tmp/by.json"
wrong '{"objects": [{"scene": "by.json", '"$two}]}" 'a volume of a group is coloured by another'
wrong '{"objects": [{"scene": "pair.json", '"$two"'}], "caps": true, "clip-plane": [1, 0, 0, -5]}' 'not with caps'
wrong '{"objects": [{"scene": "pair.json", '"$two"', "transform": {"scale": 0}}]}' 'objects[0].transform: leafcast_shown.place'
wrong '{"objects": [{"tiles": []}]}' '"tiles" takes an array of 1 to 256'
wrong '{"objects": [{"tiles": [3], "counts": [1, 1], "size": [1, 1]}]}' 'objects[0]: a tile has a "scene"'
wrong '{"objects": [{"tiles": ['"$chess"'], "size": [1, 1]}]}' '"counts" takes how many'
wrong '{"objects": [{"tiles": ['"$chess"'], "counts": [5000, 5000], "size": [1, 1]}]}' '"counts" takes how many'
wrong '{"objects": [{"tiles": ['"$chess"'], "counts": [2.5, 2], "size": [1, 1]}]}' '"counts" takes how many'
wrong '{"objects": [{"tiles": ['"$chess"'], "counts": [5, 5], "size": [1, 0]}]}' '"size" takes how long'
wrong '{"objects": [{"tiles": ['"$chess"'], "counts": [5, 5], "size": [1, 1], "origin": 3}]}' '"origin" takes two or three'
wrong '{"objects": [{"tiles": ['"$chess"'], "counts": [5, 5], "size": [1, 1], "seed": -3}]}' '"seed" takes a whole number'
wrong '{"objects": [{"tiles": ['"$chess"'], "counts": [5, 5], "size": [1, 1], "between": [3, 2]}]}' '"between" takes the least'
wrong '{"objects": [{"tiles": ['"$chess"'], "counts": [5, 5], "size": [1, 1], "grund": "x"}]}' 'there is no "grund"'
wrong '{"objects": [{"tiles": [{"scene": "tuft.json", "edges": ["a", "b", "c"]}], "counts": [5, 5], "size": [1, 1]}]}' '"edges" takes the names of four'
wrong '{"objects": [{"tiles": ['"$(tile tuft a c b d)"'], "counts": [5, 5], "size": [1, 1]}]}' 'objects[0]: at cell 1, 0 no tile fits'
wrong '{"objects": [{"tiles": ['"$chess"'], "counts": [5, 5], "size": [1, 1], "ground": "ground.leaf"}]}' 'is no "file" of another object'
wrong '{"objects": [{'"$ball"'}, {"tiles": ['"$chess"'], "counts": [5, 5], "size": [1, 1], "ground": "ball.leaf"}]}' 'is no surface'
wrong '{"objects": [{"scene": "chess.json", '"$two}]}" '"tiles" are of a scene that lies in no other'
wrong '{"objects": [{"tiles": ['"$chess"'], "counts": [5, 5], "size": [1, 1], "between": [900, 901]}]}' 'no tile lies anywhere'
exits "--and beside groups alone" 2 "$leafcast" render "$tmp/fit.json" --and "$tmp/ball.leaf" --iso 0.35 -q -o "$tmp/x.ppm"
ok "is refused" says "--and: beside no scene" err
draw field --and "$tmp/ball.leaf" --iso 0.3
ok "nothing was written" [ ! -e "$tmp/x.ppm" ]
finish
