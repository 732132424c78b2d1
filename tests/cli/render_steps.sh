#!/bin/sh
# render_steps.sh - pictures of time series of meshes: a moving one, from the points to the pictures;
# each is that of the step's own file, by either schema.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/$2"; }
json() { # json FILE EXPRESSION: python, with the file as j
    python3 -c 'import json, sys
j = json.load(open(sys.argv[1]))
sys.exit(not eval(f"({sys.argv[2]})"))' "$@"
}
same() { cmp -s "$tmp/$1" "$tmp/$2"; }
view="--iso 0.3 --size 80x60 --eye 60,30,45 --look-at 11,11,11"

run "$leafcast" generate buckyball --tets --dims 24 --deform 0.5 --steps 5 -o "$tmp/b.mesh" -q
exits "a series" 0 "$leafcast" convert "$tmp"/b_0000.mesh "$tmp"/b_0001.mesh "$tmp"/b_0002.mesh "$tmp"/b_0003.mesh --times 0,0.5,1,2 -o "$tmp/b.leaf" -q
for step in 0 1 2 3; do
    run "$leafcast" convert "$tmp/b_000$step.mesh" -o "$tmp/$step.leaf" -q
    run "$leafcast" render "$tmp/$step.leaf" $view --depth-f64 "$tmp/want_$step" -q
done
for schema in 1 2; do
    exits "drawn: schema $schema" 0 "$leafcast" render "$tmp/b.leaf" $view --steps 0:3 --schema $schema --depth-f64 "$tmp/s$schema" --stats "$tmp/s$schema.json" -q
    for step in 0 1 2 3; do
        ok "step $step is that of its own file" same "s${schema}_000$step" "want_$step"
    done
done
ok "steps move" python3 -c 'import sys
sys.exit(len({open(f, "rb").read() for f in sys.argv[1:]}) < 4)' "$tmp"/want_?
ok "statistics tell step and time" json "$tmp/s1.json" '[(f["step"], f["time"], f["field"]) for f in j["frames"]] == [(0, 0, "buckyball"), (1, 0.5, "buckyball"), (2, 1, "buckyball"), (3, 2, "buckyball")]'
ok "another step reads less than the first" json "$tmp/s1.json" 'all(0 < f["bytes"]["read"] < 0.7 * j["frames"][0]["bytes"]["read"] for f in j["frames"][1:])'
ok "refitting, less still" python3 -c 'import json, sys
a, b = (sum(f["bytes"]["read"] for f in json.load(open(p))["frames"]) for p in sys.argv[1:])
sys.exit(b >= a)' "$tmp/s1.json" "$tmp/s2.json"
exits "little memory" 0 "$leafcast" render "$tmp/b.leaf" $view --step 2 --memory 3M --threads 1 --depth-f64 "$tmp/tight" -q
ok "is the same picture" same tight want_2
exits "steps times isovalues" 0 "$leafcast" render "$tmp/b.leaf" --iso-list 0.3,0.5 --steps 1:2 --size 8x8 --depth-f64 "$tmp/x" -q
ok "four pictures" [ -s "$tmp/x_0003" -a ! -e "$tmp/x_0004" ]

# Scripts, and single questions.
cat >"$tmp/script" <<END
{"step": 3, "field": "buckyball", "depth_f64": "$tmp/line3"}
{"step": 1, "depth_f64": "$tmp/line1"}
{"step": 4, "depth_f64": "$tmp/line4"}
{"depth_f64": "$tmp/line0"}
END
exits "a script, of which one line is wrong" 1 "$leafcast" render "$tmp/b.leaf" $view --script "$tmp/script"
ok "steps come in any order" same line3 want_3
ok "to and fro" same line1 want_1
ok "step 0 where none is said" same line0 want_0
ok "a step that is not there is told" says 'there are 1 fields and 4 steps' out
exits "a probe" 0 "$leafcast" probe "$tmp/b.leaf" $view --at 40,30 --step 2 --json
cp "$tmp/out" "$tmp/p.json"
exits "of the step's own file" 0 "$leafcast" probe "$tmp/2.leaf" $view --at 40,30 --json
ok "finds the same" python3 -c 'import json, sys
a, b = (json.load(open(p)) for p in sys.argv[1:])
sys.exit(a["step"] != 2 or a["time"] != 1 or "step" in b or [h["t"] for h in a["hits"]] != [h["t"] for h in b["hits"]])' "$tmp/p.json" "$tmp/out"

# Movies that play while the camera turns: the step is the last one whose time has come.
cat >"$tmp/keys.json" <<END
[{"time": 0, "eye": [60, 30, 45]}, {"time": 1, "eye": [30, 60, 45]}, {"step": 3, "eye": [60, 30, 45]}]
END
exits "a movie by time" 0 "$leafcast" render "$tmp/b.leaf" $view --camera-path "$tmp/keys.json" --frames 9 --depth-f64 "$tmp/k" --stats "$tmp/k.json" -q
ok "steps as their times come" json "$tmp/k.json" '[f["step"] for f in j["frames"]] == [0, 0, 1, 1, 2, 2, 2, 2, 3]'
ok "begins with the first step" same k_0000 want_0
ok "ends with the last" same k_0008 want_3
run "$leafcast" render "$tmp/b.leaf" $view --eye 30,60,45 --step 2 --depth-f64 "$tmp/turned" -q
ok "and turns meanwhile" same k_0004 turned
exits "each entry alone" 0 "$leafcast" render "$tmp/b.leaf" $view --camera-path "$tmp/keys.json" --size 8x8 --stats "$tmp/k3.json" --depth-f64 "$tmp/k3" -q
ok "is at its time" json "$tmp/k3.json" '[f["step"] for f in j["frames"]] == [0, 2, 3]'
# Times that are met but for rounding are met: 31 steps a tenth apart.
exits "a tenth apart" 0 "$leafcast" convert "$tmp"/b_0000.mesh "$tmp"/b_0001.mesh "$tmp"/b_0002.mesh "$tmp"/b_0003.mesh "$tmp"/b_0000.mesh "$tmp"/b_0001.mesh "$tmp"/b_0002.mesh --times 0,0.1,0.2,0.3,0.4,0.5,0.6 -o "$tmp/t.leaf" -q
echo '[{"time": 0}, {"time": 0.6}]' >"$tmp/keys.json"
run "$leafcast" render "$tmp/t.leaf" $view --camera-path "$tmp/keys.json" --frames 7 --size 8x8 --stats "$tmp/k7.json" --depth-f64 "$tmp/k7" -q
ok "none is late by rounding" json "$tmp/k7.json" '[f["step"] for f in j["frames"]] == [0, 1, 2, 3, 4, 5, 6]'
while IFS='|' read -r what keys words; do
    echo "$keys" >"$tmp/keys.json"
    exits "a path with $what" 2 "$leafcast" render "$tmp/b.leaf" $view --camera-path "$tmp/keys.json" --frames 3 --depth-f64 "$tmp/y"
    ok "$what: says so" says "keys.json: entry 2: $words" err
done <<END
a time too late|[{"time": 0}, {"time": 2.5}]|time 2.5: the steps go from 0 to 2
one too early|[{"time": 0}, {"time": -1}]|time -1: the steps go from 0 to 2
one that is none|[{"time": 0}, {"time": "soon"}]|"time" is no number
time and step|[{"time": 0}, {"time": 1, "step": 1}]|either "time" or "step"
no view|[{"time": 0}, 7]|not a JSON object
no such step|[{"time": 0}, {"step": 9}]|no such "step"
END

# Each picture would be drawn once for each step, all the same.
for keys in '[{"fov": 30}, {"time": 1}]' '[{"fov": 30}, {"step": 1}]'; do
    echo "$keys" >"$tmp/keys.json"
    exits "a path with $keys, and --steps" 2 "$leafcast" render "$tmp/b.leaf" $view --camera-path "$tmp/keys.json" --steps 0:1 --depth-f64 "$tmp/y"
    ok "says so of $keys" says 'keys.json: entry 2: .*--steps says the steps' err
done
echo '[{"fov": 30}, 7]' >"$tmp/keys.json"
exits "an entry that is none" 2 "$leafcast" render "$tmp/b.leaf" $view --camera-path "$tmp/keys.json" --frames 3 --depth-f64 "$tmp/y"
ok "an entry that is none: its file, too" says 'keys.json: entry 2: not a JSON object' err
echo '[{"fov": 30}, {"eyes": 1}]' >"$tmp/keys.json"
exits "an entry that is wrong" 2 "$leafcast" render "$tmp/b.leaf" $view --camera-path "$tmp/keys.json" --depth-f64 "$tmp/y"
ok "is told, with its file" says 'keys.json: entry 2: there is no "eyes"' err

exits "steps beyond the end" 2 "$leafcast" render "$tmp/b.leaf" $view --steps 2:4 --depth-f64 "$tmp/y"
ok "are told before anything is drawn" [ ! -e "$tmp/y_0000" ]
for steps in 2:1 -1:2 a:b 1:2:0 0.5:1 '1,' all:1 4 1,4; do
    exits "--steps $steps" 2 "$leafcast" render "$tmp/b.leaf" $view --steps=$steps --depth-f64 "$tmp/y"
done
# drawn LIST STEP.. - the pictures of a list are those of these steps, in this order, numbered from 0 on.
drawn() {
    list=$1 k=0
    shift
    rm -f "$tmp"/z_*
    exits "--steps $list" 0 "$leafcast" render "$tmp/b.leaf" $view --steps "$list" --depth-f64 "$tmp/z" -q
    for step in "$@"; do
        ok "picture $k is step $step" same z_000$k want_"$step"
        k=$((k + 1))
    done
    ok "no more than $#" [ ! -e "$tmp/z_000$k" ]
}
drawn all 0 1 2 3
drawn 1:2 1 2
drawn 0:3:2 0 2
drawn 3,0:1 3 0 1
drawn 2 2
exits "all steps, isovalue by isovalue, to a pipe" 0 "$leafcast" render "$tmp/b.leaf" --iso-list 0.3,0.5 --steps all --size 8x8 --json
ok "a line each" [ "$(grep -c '"step":' "$tmp/out")" = 8 ]
exits "all of one that is none" 3 "$leafcast" render "$tmp/s1.json" $view --steps all --depth-f64 "$tmp/y"
exits "an unknown field" 2 "$leafcast" render "$tmp/b.leaf" $view --field nix --depth-f64 "$tmp/y"
ok "with those there are" says 'there are 1: buckyball' err
exits "an unknown schema" 2 "$leafcast" render "$tmp/b.leaf" $view --schema 3 --depth-f64 "$tmp/y"

# The benchmark of both schemas, at half the size and all of it.
exits "bench time" 0 "$leafcast" bench time "$tmp/b.leaf" --iso 0.3 --size 64x64 --runs 2 --out "$tmp/bench" -q
ok "the same pictures; refitting reads less at first, and keeps less" python3 -c 'import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert [r["size"] for r in rows] == ["32x32", "32x32", "64x64", "64x64"]
one, two = rows[2:]
sys.exit(not (one["differ"] == two["differ"] == "0" and float(one["fps"]) > 0 and float(two["fps"]) > 0
              and float(two["first MB"]) < float(one["first MB"]) and float(two["resident MB"]) < float(one["resident MB"])
              and 0 <= float(one["MB/step"]) < float(two["MB/step"])))' "$tmp/bench/time.csv"
ok "and as bars" python3 -c 'import sys, xml.dom.minidom as x; x.parse(sys.argv[1])' "$tmp/bench/time.svg"
exits "without a series" 3 "$leafcast" bench time "$tmp/0.leaf" --iso 0.3
exits "another suite with a step" 2 "$leafcast" bench frames "$tmp/b.leaf" --iso 0.3 --step 1
finish
