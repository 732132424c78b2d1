#!/bin/sh
# slice.sh - leafcast slice: planes, layers and curved slices as pictures, values and JSON; what is read.
# marks: leaks
. tests/support/tap.sh

leaf=$tmp/v.leaf
json() { # json EXPRESSION: python, with what was printed as j
    python3 -c 'import json, sys
j = json.load(open(sys.argv[1]))
sys.exit(not eval(f"({sys.argv[2]})"))' "$tmp/out" "$1"
}
values() { # values FILE EXPRESSION: python, with its doubles as z, rows of w as at(x, y)
    python3 -c 'import array, json, math, sys
z = array.array("d", open(sys.argv[1], "rb").read())
w = json.load(open(sys.argv[2]))["size"][0]
h = len(z) // w
at = lambda x, y: z[y * w + x]
nan = math.isnan
sys.exit(not eval(f"({sys.argv[3]})"))' "$1" "$tmp/out" "$2"
}
bytes() { # bytes FILE.ppm EXPRESSION: python, with its pixels as p[y][x]
    python3 -c 'import sys
d = open(sys.argv[1], "rb").read().split(b"\n", 3)
w, h = map(int, d[1].split())
p = [[tuple(d[3][3 * (y * w + x) + c] for c in range(3)) for x in range(w)] for y in range(h)]
sys.exit(not eval(f"({sys.argv[2]})"))' "$1" "$2"
}

# f = x + 2y + 4z on 50 x 40 x 30 samples, spacing 2, 1, -1
python3 -c 'import struct, sys
sys.stdout.buffer.write(struct.pack("<60000H", *(x + 2 * y + 4 * z for z in range(30) for y in range(40) for x in range(50))))' >"$tmp/v.raw"
exits "a volume to slice" 0 "$leafcast" convert "$tmp/v.raw" --dims 50,40,30 --type u16 --spacing 2,1,-1 -o "$leaf" -q
f64="--value-f64 $tmp/z.f64 --json --force"

exits "in the middle" 0 "$leafcast" slice "$leaf" $f64
ok "of z" json 'j["origin"] == [0, 39, -14.5] and j["u"] == [98, 0, 0] and j["v"] == [0, -39, 0]'
ok "a square pixel a cell along the shortest edge" json 'j["size"] == [98, 39]'
ok "the field" values "$tmp/z.f64" 'all(abs(at(x, y) - ((x + 0.5) / 2 + 2 * (38.5 - y) + 58)) < 1e-9 for x in range(w) for y in range(h))'
ok "all of it" json 'j["pixels"] == 98 * 39 and abs(j["least"] - 59.25) < 1e-9 and abs(j["most"] - 183.75) < 1e-9'
exits "across x at a coordinate" 0 "$leafcast" slice "$leaf" --axis x --at 30 $f64
ok "y goes right and z up" json 'j["u"] == [0, 39, 0] and j["v"] == [0, 0, -29] and j["origin"] == [30, 0, 0]'
ok "its values" values "$tmp/z.f64" 'all(abs(at(x, y) - (15 + 2 * (x + 0.5) + 4 * (y + 0.5))) < 1e-9 for x in range(w) for y in range(h))'
exits "across y" 0 "$leafcast" slice "$leaf" --axis y --at 10 $f64
ok "x goes right and z up" json 'j["u"] == [98, 0, 0] and j["v"] == [0, 0, -29]'
exits "the nodes of a number, as they are" 0 "$leafcast" slice "$leaf" --axis z --index 29 --nearest --size 50x40 $f64
ok "are the samples" values "$tmp/z.f64" 'all(at(x, y) == x + 2 * (39 - y) + 116 for x in range(50) for y in range(40))'
exits "the layer below, between samples" 0 "$leafcast" slice "$leaf" --axis z --index 28 $f64
ok "is interpolated" values "$tmp/z.f64" 'abs(at(0, 38) - (0.25 + 1 + 112)) < 1e-9'
exits "an oblique plane" 0 "$leafcast" slice "$leaf" --plane 1,1,0,-60 $f64
ok "ends where the volume does" values "$tmp/z.f64" 'not any(map(nan, z))'
ok "and is seen from its side" json 'j["u"][0] < 0 < j["u"][1] and j["v"][2] < 0'
exits "a rectangle, partly outside" 0 "$leafcast" slice "$leaf" --origin -10,5,-3 --u 40,0,0 --v 0,10,0 --size 40x10 $f64
ok "has no data there" values "$tmp/z.f64" 'all(nan(at(x, y)) == (x < 10) for x in range(40) for y in range(10))'
ok "downwards along --v" values "$tmp/z.f64" 'abs(at(20, 7) - (5.25 + 2 * 12.5 + 12)) < 1e-9'
ok "and is told" json 'j["pixels"] == 300'
exits "of a size that fits" 0 "$leafcast" slice "$leaf" --origin -10,5,-3 --u 40,0,0 --v 0,10,0 --json
ok "by the cells" json 'j["size"] == [40, 10]'
exits "along a line" 0 "$leafcast" slice "$leaf" --line "10,5,-1;50,5,-1;50,35,-1" --sweep 0,0,-14 --size 70x14 $f64
ok "around its corner" values "$tmp/z.f64" 'abs(at(39, 3) - (24.75 + 10 + 18)) < 1e-9 and abs(at(40, 3) - (25 + 11 + 18)) < 1e-9'
ok "which is told" json 'len(j["line"]) == 3 and "origin" not in j'
exits "coarser" 0 "$leafcast" slice "$leaf" --level 1 $f64
ok "has fewer pixels" json 'j["size"] == [49, 20]'

exits "a grey picture" 0 "$leafcast" slice "$leaf" --axis z --index 0 --nearest --size 50x40 --window 0,255 -o "$tmp/p.ppm"
ok "shows the values" bytes "$tmp/p.ppm" 'all(p[y][x] == 3 * (x + 2 * (39 - y),) for x in range(50) for y in range(40))'
exits "in the window of the field" 0 "$leafcast" slice "$leaf" --size 50x40 -o "$tmp/q.ppm" --json
ok "which is told" json 'j["window"] == [0, 243]'
exits "a colour map" 0 "$leafcast" slice "$leaf" --axis z --index 0 --nearest --size 50x40 --window 0,127 --colour-map viridis -o "$tmp/m.ppm"
ok "from its first colour to its last" bytes "$tmp/m.ppm" 'p[39][0] == (0x44, 1, 0x54) and p[0][49] == (0xfd, 0xe7, 0x25)'
exits "a transfer function" 0 sh -c 'printf "0 1 0 0 0\n60 1 0 0 9\n60 0 0 1 9\n99 0 0 1 9\n" >"$1/two.tf"' sh "$tmp"
exits "gives its colours" 0 "$leafcast" slice "$leaf" --axis z --index 0 --nearest --size 50x40 --tf "$tmp/two.tf" -o "$tmp/t.ppm"
ok "with its step" bytes "$tmp/t.ppm" 'all(p[y][x] == ((255, 0, 0) if x + 2 * (39 - y) < 60 else (0, 0, 255)) for x in range(50) for y in range(40))'
exits "an isoline" 0 "$leafcast" slice "$leaf" --axis z --index 0 --nearest --size 50x40 --window 0,255 --iso 60 --color 0,0,1 -o "$tmp/i.ppm"
ok "where it should be" bytes "$tmp/i.ppm" 'p[9][0] == (0, 0, 255) and p[0][0][0] == 78 and p[39][49][2] == 49'
exits "a picture of a part" 0 "$leafcast" slice "$leaf" --origin -10,5,-3 --u 40,0,0 --v 0,10,0 --size 40x10 -o "$tmp/a.png"
ok "has an alpha channel" python3 -c 'import sys; sys.exit(open(sys.argv[1], "rb").read()[25] != 6)' "$tmp/a.png"
exits "to standard output" 0 "$leafcast" slice "$leaf" --size 8x8 --value-f64 -
ok "64 numbers" [ "$(wc -c <"$tmp/out")" = 512 ]

# What is read: of 4 x 3 x 2 treelets of 16 cells a layer of 12, whatever the budget.
exits "small treelets" 0 "$leafcast" convert "$tmp/v.raw" --dims 50,40,30 --type u16 --treelet 16 -o "$tmp/s.leaf" -q
exits "a layer" 0 "$leafcast" slice "$tmp/s.leaf" --axis z --at 20 $f64 --stats "$tmp/stats.json"
ok "of its treelets alone" json 'j["treelets"]["active"] == j["treelets"]["loaded"] == 12 and j["bytes"]["read"] == j["bytes"]["active"] < j["bytes"]["file"] / 2'
cp "$tmp/z.f64" "$tmp/all.f64"
exits "with little memory" 0 "$leafcast" slice "$tmp/s.leaf" --axis z --at 20 $f64 --memory 1M --threads 1
ok "the same bytes" cmp "$tmp/all.f64" "$tmp/z.f64"
ok "within it" json 'j["peak_budget_bytes"] <= 1 << 20 and j["treelets"]["loaded"] == 12'
ok "statistics in a file" python3 -c 'import json, sys; sys.exit(json.load(open(sys.argv[1]))["treelets"]["loaded"] != 12)' "$tmp/stats.json"
exits "too little" 4 "$leafcast" slice "$tmp/s.leaf" --axis z --at 20 --json --memory 20K

exits "a hole" 0 python3 -c 'import struct, sys
open(sys.argv[1], "wb").write(struct.pack("<27f", *[float("nan"), float("-inf")] + 25 * [1.0]))' "$tmp/hole.raw"
exits "converted" 0 "$leafcast" convert "$tmp/hole.raw" --dims 3,3,3 --type f32 -o "$tmp/hole.leaf" -q
exits "is no data" 0 "$leafcast" slice "$tmp/hole.leaf" --at 0.5 --size 2x2 $f64
ok "in its cells" values "$tmp/z.f64" 'nan(at(0, 1)) and nan(at(1, 1)) and at(0, 0) == at(1, 0) == 1'

exits "a mesh" 0 "$leafcast" generate buckyball --tets --dims 11 --steps 4 --deform 0.4 -o "$tmp/m.mesh" -q
exits "converted" 0 "$leafcast" convert "$tmp/m_0000.mesh" "$tmp/m_0001.mesh" -o "$tmp/m.leaf" -q
exits "sliced" 0 "$leafcast" slice "$tmp/m.leaf" --step 1 $f64 -o "$tmp/m.png"
ok "its step is told" json 'j["step"] == 1 and min(j["size"]) > 400'
exits "a moved mesh by itself" 0 "$leafcast" convert "$tmp/m_0001.mesh" -o "$tmp/m1.leaf" -q
part="--origin 1,1,3 --u 6,0,1 --v 0,6,1 --size 40x30 --json --force"
exits "sliced" 0 "$leafcast" slice "$tmp/m1.leaf" $part --value-f64 "$tmp/one.f64"
exits "as a step of both" 0 "$leafcast" slice "$tmp/m.leaf" $part --step 1 --value-f64 "$tmp/two.f64"
exits "as the other step" 0 "$leafcast" slice "$tmp/m.leaf" $part --step 0 --value-f64 "$tmp/zero.f64"
near() { python3 -c 'import array, math, sys
a, b = (array.array("d", open(f, "rb").read()) for f in sys.argv[1:])
same = [x == y or abs(x - y) < 1e-6 or math.isnan(x) and math.isnan(y) for x, y in zip(a, b)]
sys.exit(len(a) != 1200 or sum(same) < 1190)' "$tmp/$1" "$tmp/$2"; }
ok "has the same values" near one.f64 two.f64
not_near() { ! near "$@"; }
ok "not those of the other step" not_near one.f64 zero.f64
exits "has no layers" 2 "$leafcast" slice "$tmp/m.leaf" --index 1 --json

for wrong in "" "$leaf" "$leaf --at 1" "$leaf --json --at 1 --index 2" "$leaf --json --at 999" "$leaf --json --index 50" \
    "$leaf --json --plane 0,0,0,1" "$leaf --json --plane 1,0,0,50 --axis x" "$leaf --json --origin 1,1,1 --u 1,0,0" \
    "$leaf --json --line 1,1,1;2,2,2" "$leaf --json --line 1,1,1 --sweep 1,0,0" "$leaf --json --sweep 1,0,0" \
    "$leaf --json --line 1,1;2,2,2 --sweep 1,0,0" "$leaf --json --level 9" "$leaf --json --window 2,1 -o x.png" \
    "$leaf --json --iso 3" "$leaf --json --color red -o x.png" "$leaf --json --size 0x3" "$leaf --json -o x.gif" \
    "$leaf --json --value-f64 -" "$leaf --value-f64 - -o -" "$leaf --json --field none" "$leaf --json --step 3" \
    "$leaf --value-f64 $leaf --force"; do
    exits "usage: $wrong" 2 "$leafcast" slice $wrong
done
exits "values are not overwritten" 1 "$leafcast" slice "$leaf" --value-f64 "$tmp/z.f64"
exits "no such file" 1 "$leafcast" slice "$tmp/none" --json
exits "no treelet file" 3 "$leafcast" slice "$tmp/v.raw" --json
finish
