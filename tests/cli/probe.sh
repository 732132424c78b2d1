#!/bin/sh
# probe.sh - leafcast probe: a pixel's ray, a ray, a point; text and JSON; that it sees what render draws.
# marks: leaks
. tests/support/tap.sh

leaf=$tmp/v.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
json() { # json EXPRESSION: python, with what was printed as j
    python3 -c 'import array, json, sys
j = json.load(open(sys.argv[1]))
sys.exit(not eval(f"({sys.argv[2]})"))' "$tmp/out" "$1"
}

# f = x + 2y + 4z - 1 on 5 x 4 x 3 samples, spacing 2, 1, -1
python3 -c 'import sys
sys.stdout.buffer.write(bytes(x + 2 * y + 4 * z for z in range(3) for y in range(4) for x in range(5)))' >"$tmp/v.raw"
exits "a volume to probe" 0 "$leafcast" convert "$tmp/v.raw" --dims 5,4,3 --type u8 --spacing 2,1,-1 -o "$leaf" -q

exits "a point" 0 "$leafcast" probe "$leaf" --point 3,1.5,-0.25 --json
ok "has its value" json 'j["inside"] and abs(j["value"] - (1.5 + 3 + 1)) < 1e-12'
ok "lies in its cell" json 'j["cell"] == [1, 1, 0] and j["position_in_cell"] == [0.5, 0.5, 0.25]'
ok "between its samples" json 'j["samples"] == [3, 4, 5, 6, 7, 8, 9, 10]'
ok "has its gradient, in world space" json 'j["gradient"] == [0.5, 2, -4]'
exits "a point outside" 0 "$leafcast" probe "$leaf" --point 3,1.5,0.25 --json
ok "is told" json 'not j["inside"] and "value" not in j'
exits "a point and isovalues, as text" 0 "$leafcast" probe "$leaf" --point 3,1.5,-0.25 --iso 5.5 --iso 6
ok "says on which side it is" says '^inside 5.5: yes$' out
ok "of each" says '^inside 6: no$' out

exits "a ray" 0 "$leafcast" probe "$leaf" --iso 2.5 --iso 6.5 --ray -1,1.5,-0.25,1,0,0 --json
ok "has one hit" json 'j["count"] == 1 and len(j["hits"]) == 1'
ok "where it should" json 'abs(j["hits"][0]["t"] - 6) < 1e-12 and j["hits"][0]["cell"][1:] == [1, 0]'
ok "with the isovalue's index" json 'j["hits"][0]["id"] == 1 and j["hits"][0]["isovalue"] == 6.5'
ok "from its side" json 'j["hits"][0]["side"] == "entering"'
ok "with a bound of its error" json '0 < j["hits"][0]["error_bound"] < 1e-9'
ok "with a unit normal towards lower values" json 'abs(sum(n * n for n in j["hits"][0]["normal"]) - 1) < 1e-6 and j["hits"][0]["normal"][0] < 0'
exits "the other way" 0 "$leafcast" probe "$leaf" --iso 2.5 --iso 6.5 --ray 11,1.5,-0.25,-1,0,0 --json
ok "leaves what it entered" json 'j["hits"][0]["side"] == "leaving" and abs(j["hits"][0]["t"] - 6) < 1e-12'
exits "a ray beside the volume" 0 "$leafcast" probe "$leaf" --iso 3 --ray 0,9,0,1,0,0
ok "hits nothing" says '^count: 0$' out
exits "at most one hit" 0 "$leafcast" probe "$leaf" --iso 4 --iso 5 --ray -1,1.5,-0.25,1,0,0 --hits 1 --json
ok "is the first" json 'j["count"] == 1 and j["hits"][0]["isovalue"] == 5'

# The same pixels as a picture's.
view="--iso 9.5 --size 16x12 --view close"
run "$leafcast" render "$leaf" $view --depth-f64 "$tmp/z.f64"
agree() {
    python3 - "$tmp/z.f64" "$leafcast" "$leaf" <<'PY'
import array, json, math, subprocess, sys
z = array.array("d", open(sys.argv[1], "rb").read())
hits = 0
for pixel in range(0, 192, 7):
    at = f"{pixel % 16},{pixel // 16}"
    out = subprocess.check_output([sys.argv[2], "probe", sys.argv[3], *"--iso 9.5 --size 16x12 --view close --json --at".split(), at])
    j = json.loads(out)
    t = j["hits"][0]["t"] if j["count"] else math.inf
    hits += j["count"] > 0
    if t != z[pixel]:
        sys.exit(f"# pixel {at}: {t} is not {z[pixel]}")
sys.exit(hits < 3)
PY
}
ok "a pixel's first hit is the picture's depth, bit by bit" agree
exits "a picture without isovalues" 0 "$leafcast" render "$leaf" --size 16x12 --view close --depth-f64 "$tmp/own.f64" -q
exits "a pixel without one" 0 "$leafcast" probe "$leaf" --size 16x12 --view close --at 8,6 --json
ok "is of the surface that render draws" json "j['hits'][0]['t'] == array.array('d', open('$tmp/own.f64', 'rb').read())[6 * 16 + 8]"
exits "a pixel" 0 "$leafcast" probe "$leaf" $view --at 8,6
ok "shows its hit" says '^  t: ' out
ok "and the line that reruns it" says "^rerun: leafcast probe --iso 9.5 --size 16x12 --view close --at 8,6 $leaf\$" out
rerun() { sed -n 's/^rerun: leafcast //p' "$tmp/out" | sed "s|^|'$leafcast' |" >"$tmp/again.sh" && sh "$tmp/again.sh" | cmp - "$tmp/out"; }
ok "which does" rerun
many=$(seq 500 | sed 's/.*/--up 0,0,1/')
exits "a command of 500 options" 0 "$leafcast" probe "$leaf" $many $view --at 8,6
ok "is rerun whole" [ "$(sed -n 's/^rerun: //p' "$tmp/out")" = "$(echo leafcast probe $many $view --at 8,6 "$leaf")" ]
ok "likewise" rerun
odd=$tmp/$(printf 'o\377 d.leaf')
cp "$leaf" "$odd"
exits "a file whose name is no text" 0 "$leafcast" probe "$odd" --point 3,1.5,-0.25 --json
ok "is in the line, as far as it is" json "j['rerun'].endswith(r\"/o\xff d.leaf'\")"

python3 -c 'import struct, sys
sys.stdout.buffer.write(struct.pack("<27f", *[float("nan"), float("-inf")] + 25 * [1.0]))' >"$tmp/hole.raw"
exits "a volume with a hole" 0 "$leafcast" convert "$tmp/hole.raw" --dims 3,3,3 --type f32 -o "$tmp/hole.leaf" -q
exits "a point in it" 0 "$leafcast" probe "$tmp/hole.leaf" --point 0.5,0.5,0.5 --json
ok "has numbers that are null" json 'j["value"] is None and j["samples"] == [None, None] + 6 * [1]'
exits "in words" 0 "$leafcast" probe "$tmp/hole.leaf" --point 0.5,0.5,0.5
ok "a line each" says '^samples: - - 1 1 1 1 1 1$' out

# Along a ray: f = t / 2 + 3.5 from t = 1 to 9, in cells of length 2.
along="--ray -1,1.5,-0.25,1,0,0"
exits "a ray's profile" 0 "$leafcast" probe "$leaf" $along --segments --json
ok "has every cell" json '[s["cell"] for s in j["segments"]] == [[i, 1, 0] for i in range(4)] and j["cells"] == 4'
ok "each from where the one before ends" json '[(s["t0"], s["t1"]) for s in j["segments"]] == [(1, 3), (3, 5), (5, 7), (7, 9)]'
ok "with its values" json 'all(abs(b - (4 + i + k / 3)) < 1e-14 for i, s in enumerate(j["segments"]) for k, b in enumerate(s["control"]))'
ok "that go on in the next" json 'all(a["control"][3] == b["control"][0] for a, b in zip(j["segments"], j["segments"][1:]))'
ok "and what they are in all" json '(j["length"], j["mean"], j["least"], j["least_t"], j["most"], j["most_t"]) == (8, 6, 4, 1, 8, 9)'
ok "needs no isosurface" json '"hits" not in j'
exits "in words, with an isosurface" 0 "$leafcast" probe "$leaf" $along --segments --iso 6.5
ok "a line a cell" [ "$(grep -c '^ *[1357] *[3579] *[4567] *[5678] .* [0-3] 1 0$' "$tmp/out")" = 4 ]
ok "and the hits" says '^count: 1$' out
exits "as CSV" 0 "$leafcast" probe "$leaf" $along --csv -
ok "nothing but that" [ "$(sed -n '1p;4p' "$tmp/out")" = "t0,t1,i,j,k,value_t0,value_t1,least,least_t,most,most_t
5,7,2,1,0,6,7,6,5,7,7" -a "$(wc -l <"$tmp/out")" = 5 ]
cp "$tmp/out" "$tmp/same.csv"
exits "to files" 0 "$leafcast" probe "$leaf" $along --iso 6.5 --csv "$tmp/p.csv" --svg "$tmp/p.svg"
ok "the same bytes" cmp "$tmp/same.csv" "$tmp/p.csv"
ok "a plot with the curve, the isovalue and where it is met" python3 -c '
import re, sys, xml.etree.ElementTree as x
t = x.parse(sys.argv[1]).getroot()
n = {k: [e for e in t.iter() if e.tag.endswith("}" + k)] for k in ("path", "circle", "text")}
curve = [e for e in n["path"] if e.get("d").count("C") == 4]
sys.exit(not (len(curve) == 1 and len(n["circle"]) == 1 and "6.5" in [e.text for e in n["text"]]))' "$tmp/p.svg"
exits "files that are there stay" 1 "$leafcast" probe "$leaf" $along --svg "$tmp/p.svg"
exits "but with --force" 0 "$leafcast" probe "$leaf" $along --svg "$tmp/p.svg" --force
exits "the input is no output" 2 "$leafcast" probe "$leaf" $along --csv "$leaf" --force
exits "a profile across a hole" 0 "$leafcast" probe "$tmp/hole.leaf" --ray 1.5,-1,0.5,0,1,0 --segments --json
ok "leaves it out" json '[s["cell"] for s in j["segments"]] == [[1, 1, 0]] and j["length"] == 1'
exits "beside the volume" 0 "$leafcast" probe "$leaf" --ray 0,9,0,1,0,0 --json --svg "$tmp/none.svg"
ok "is none" json 'j["cells"] == 0 and j["segments"] == [] and j["mean"] is None'
ok "and is told" says 'passes no cell' none.svg
exits "a mesh" 0 "$leafcast" generate sphere --tets --dims 9 -o "$tmp/m.mesh" -q
exits "converted" 0 "$leafcast" convert "$tmp/m.mesh" -o "$tmp/m.leaf" -q
exits "a pixel's profile through it" 0 "$leafcast" probe "$tmp/m.leaf" --at 500,500 --segments --json
ok "tet by tet" json 'j["cells"] > 8 and all("tet" in s and len(s["control"]) == 2 for s in j["segments"])'
ok "without a gap" json 'abs(sum(s["t1"] - s["t0"] for s in j["segments"]) - (j["segments"][-1]["t1"] - j["segments"][0]["t0"])) < 1e-9'

for wrong in "" "$leaf" "$leaf --iso 1" "$leaf --iso 1 --at 1,1 --point 1,1,1" "$leaf --iso 1 --at 1024,0" \
    "$leaf --iso 1 --at 1.5,0" "$leaf --iso 1 --ray 0,0,0,0,0,0" "$leaf --point 1,2" "$leaf --iso nan --at 1,1" \
    "$leaf --point 1,2,3 -o x" "$leaf --point 1,2,3 --segments" "$leaf $along --csv - --json"; do
    exits "usage: $wrong" 2 "$leafcast" probe $wrong
done
exits "no such file" 1 "$leafcast" probe "$tmp/none" --point 1,2,3
exits "no treelet file" 3 "$leafcast" probe "$tmp/v.raw" --point 1,2,3
finish
