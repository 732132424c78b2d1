#!/bin/sh
# interpolate.sh - render, probe and slice --time: a step by its time; with --interpolate what lies between two.
# marks: threads
. tests/support/tap.sh

command -v python3 >/dev/null || { skip "--interpolate" "no python3 here"; finish; }
json() { # json FILE EXPRESSION: python, with the file as j
    python3 -c 'import json, sys
j = json.load(open(sys.argv[1]))
sys.exit(not eval(f"({sys.argv[2]})"))' "$@"
}
same() { cmp -s "$tmp/$1" "$tmp/$2"; }
differs() { ! cmp -s "$tmp/$1" "$tmp/$2"; }
says() { grep -q -- "$1" "$tmp/err"; }

run "$leafcast" generate drop --dims 24 --steps 3 -o "$tmp/d.nrrd" -q
run "$leafcast" convert "$tmp/d_0000.nrrd" "$tmp/d_0001.nrrd" "$tmp/d_0002.nrrd" --times 1,2,6 -o "$tmp/d.leaf" -q
run "$leafcast" generate buckyball --tets --dims 9 --steps 3 --deform 0.2 -o "$tmp/b.mesh" -q
run "$leafcast" convert "$tmp/b_0000.mesh" "$tmp/b_0001.mesh" "$tmp/b_0002.mesh" -o "$tmp/b.leaf" -q
view="--iso 100 --size 40x30 --view standard"

# picture NAME ARGUMENT...: distances and colours, and what is told.
picture() {
    name=$1
    shift
    # shellcheck disable=SC2086 # arguments
    exits "drawn: $*" 0 "$leafcast" render "$tmp/d.leaf" $view "$@" --depth-f64 "$tmp/$name" -o "$tmp/$name.ppm" --stats "$tmp/$name.json" -q
}

picture step1 --step 1
picture time2 --time 2
picture time2i --time 2 --interpolate
picture half --time 4 --interpolate
picture near --time 2.001 --interpolate
echo '[{"time": 2, "fov": 30}, {"time": 6, "fov": 30}]' >"$tmp/path.json"
exits "a movie between steps" 0 "$leafcast" render "$tmp/d.leaf" --iso 100 --size 40x30 --interpolate --camera-path "$tmp/path.json" --frames 3 --depth-f64 "$tmp/m_%d" -o "$tmp/m_%d.ppm" --stats "$tmp/m.json" -q
ok "its times are told" json "$tmp/m.json" '[f["time"] for f in j["frames"]] == [2, 4, 6] and j["frames"][1]["between"] == 0.5'
picture alone --time 4 --interpolate --view fit --fov 30
ok "and are what they are alone" same m_1.ppm alone.ppm
echo '[{"fov": 30}, {"time": 2}, {}]' >"$tmp/path.json"
exits "entries without a time" 0 "$leafcast" render "$tmp/d.leaf" --iso 100 --size 40x30 --interpolate --camera-path "$tmp/path.json" --frames 5 -o "$tmp/m_%d.ppm" --stats "$tmp/m.json" --force -q
ok "have that of the one before, the first one the first step's" json "$tmp/m.json" '[f["time"] for f in j["frames"]] == [1, 1.5, 2, 2, 2]'
exits "of the command line's time" 0 "$leafcast" render "$tmp/d.leaf" --iso 100 --size 40x30 --time 4 --interpolate --camera-path "$tmp/path.json" -o "$tmp/m_%d.ppm" --stats "$tmp/m.json" --force -q
ok "an entry has that before the first one that says a time" json "$tmp/m.json" '[f["time"] for f in j["frames"]] == [4, 2, 2]'
exits "of its step" 0 "$leafcast" render "$tmp/d.leaf" --iso 100 --size 40x30 --step 2 --camera-path "$tmp/path.json" -o "$tmp/m_%d.ppm" --stats "$tmp/m.json" --force -q
ok "or that step" json "$tmp/m.json" '[f["step"] for f in j["frames"]] == [2, 1, 1]'
exits "of a step that is none" 2 "$leafcast" render "$tmp/d.leaf" --iso 100 --size 40x30 --step 3 --camera-path "$tmp/path.json" -o "$tmp/m_%d.ppm" --force -q
run "$leafcast" convert "$tmp"/d_0000.nrrd "$tmp"/d_0001.nrrd --times=-1e308,1e308 -o "$tmp/far.leaf" -q
exits "times further apart than doubles go" 0 "$leafcast" render "$tmp/far.leaf" --iso 100 --size 8x8 --time=0.5e308 --interpolate -o "$tmp/x.ppm" --stats "$tmp/far.json" -q
ok "have a share, too" json "$tmp/far.json" 'j["between"] == 0.75'
ok "a step by its time" same step1 time2
ok "a step by its time, between or not" same step1 time2i
ok "its colours" same step1.ppm time2i.ppm
ok "half way is another picture" differs half step1
ok "just behind a step is, too" differs near step1
ok "the step and the share are told" json "$tmp/half.json" '(j["step"], j["between"], j["time"]) == (1, 0.5, 4)'
ok "of a step there is no share" json "$tmp/time2i.json" '(j["step"], j["time"]) == (1, 2) and "between" not in j'
ok "both steps are read" json "$tmp/half.json" 'j["bytes"]["read"] > 0'

point() { # point NAME ARGUMENT...
    name=$1
    shift
    exits "a point, $*" 0 "$leafcast" probe "$tmp/d.leaf" --point 8,8,8 --json "$@"
    cp "$tmp/out" "$tmp/point-$name.json"
}
point 1 --step 1
point 2 --step 2
point 4 --time 4 --interpolate
ok "its value is half way" python3 -c 'import json, sys
a, b, m = (json.load(open(f"{sys.argv[1]}/point-{n}.json")) for n in (1, 2, 4))
sys.exit(not (m["value"] == (a["value"] + b["value"]) / 2 and a["value"] != b["value"] and m["between"] == 0.5))' "$tmp"

exits "a slice" 0 "$leafcast" slice "$tmp/d.leaf" --time 4 --interpolate -o "$tmp/s.ppm" --json
ok "tells its time" json "$tmp/out" '(j["step"], j["between"], j["time"]) == (1, 0.5, 4)'
exits "a slice of a step" 0 "$leafcast" slice "$tmp/d.leaf" --time 2 -o "$tmp/s2.ppm" -q
ok "is another" differs s.ppm s2.ppm

printf '%s\n' '{"time": 1.5, "interpolate": true, "depth-f64": "'"$tmp"'/l1"}' '{"step": 1, "depth-f64": "'"$tmp"'/l2"}' >"$tmp/lines"
# shellcheck disable=SC2086
exits "a script" 0 sh -c "\"$leafcast\" render \"$tmp/d.leaf\" $view --script - <\"$tmp/lines\""
ok "a line with a step follows one with a time" same l2 step1
ok "and differs from it" differs l1 l2

# A mesh whose points move: what one opens at a step is drawn at its time; half way it is another, and read once.
mesh() { # mesh NAME ARGUMENT...
    name=$1
    shift
    exits "a mesh, $*" 0 "$leafcast" render "$tmp/b.leaf" --iso 0.3 --size 40x30 --view standard "$@" --depth-f64 "$tmp/$name" -o "$tmp/$name.ppm" --stats "$tmp/$name.json" -q
}
mesh b0 --step 0
mesh b1 --time 1 --interpolate
mesh bhalf --time 0.5 --interpolate
ok "half way it is another picture" differs b0 bhalf
ok "than at either step" differs b1 bhalf
ok "its share is told" json "$tmp/bhalf.json" '(j["step"], j["between"], j["time"]) == (0, 0.5, 0.5) and j["bytes"]["read"] > 0'
exits "a point of a mesh" 0 "$leafcast" probe "$tmp/b.leaf" --point 4,4,4 --time 0.25 --interpolate --json
ok "has a share" json "$tmp/out" 'j["between"] == 0.25 and j["inside"]'
exits "a slice of a mesh" 0 "$leafcast" slice "$tmp/b.leaf" --time 0.25 --interpolate -o "$tmp/sb.ppm" --json
ok "tells its time, too" json "$tmp/out" '(j["step"], j["between"], j["time"]) == (0, 0.25, 0.25)'

# What has a surface between steps may have none in the step before: values of 0 to 15, then of 100 to 115.
python3 -c 'import sys
for step in range(2):
    open(f"{sys.argv[1]}/u{step}_16x16x16_u8.raw", "wb").write(bytes(100 * step + i % 16 for i in range(4096)))' "$tmp"
run "$leafcast" convert "$tmp/u0_16x16x16_u8.raw" "$tmp/u1_16x16x16_u8.raw" -o "$tmp/u.leaf" -q
exits "a surface that only is between" 0 "$leafcast" render "$tmp/u.leaf" --iso 58 --time 0.5 --interpolate --size 8x8 -o "$tmp/u.ppm"
ok "is not said to be missing" sh -c "! grep -q 'no surface' '$tmp/err'"
exits "one that is nowhere" 0 "$leafcast" render "$tmp/u.leaf" --iso 300 --time 0.5 --interpolate --size 8x8 -o "$tmp/u.ppm" --force
ok "is said to be missing, by the values of both steps" says "no surface at isovalue 300: the values are 0 to 115"

# Between steps, a picture needs more room than one of a step: the budget that is named suffices.
exits "a budget too small" 4 "$leafcast" render "$tmp/d.leaf" --iso 100 --size 300x200 --time 4 --interpolate --memory 200K --threads 1 -o "$tmp/x.png" -q
named=$(sed -n 's/.*: \([0-9]*\) bytes would do.*/\1/p' "$tmp/err")
ok "names one" [ -n "$named" ]
exits "with that one" 0 "$leafcast" render "$tmp/d.leaf" --iso 100 --size 300x200 --time 4 --interpolate --memory "$named" --threads 1 -o "$tmp/x.png" -q
rm -f "$tmp/x.png"
exits "with less" 4 "$leafcast" render "$tmp/d.leaf" --iso 100 --size 300x200 --time 4 --interpolate --memory $((named - 1)) --threads 1 -o "$tmp/x.png" -q

refused() { # refused NAME TEXT CODE ARGUMENT...
    name=$1
    text=$2
    code=$3
    shift 3
    exits "$name" "$code" "$leafcast" "$@"
    ok "$name: it says why" says "$text"
}
refused "between steps, not asked for" "interpolate draws what is between" 2 render "$tmp/d.leaf" --iso 100 --time 3 -o "$tmp/x.png"
refused "before all steps" "the steps have times from 1 to 6" 2 render "$tmp/d.leaf" --iso 100 --time 0.5 --interpolate -o "$tmp/x.png"
refused "behind all steps" "the steps have times from 1 to 6" 2 probe "$tmp/d.leaf" --point 1,1,1 --time 7
refused "at which time" "at which --time" 2 render "$tmp/d.leaf" --iso 100 --interpolate -o "$tmp/x.png"
refused "at which time, a slice" "at which --time" 2 slice "$tmp/d.leaf" --interpolate -o "$tmp/x.png"
refused "a time of many steps" "either --time or --steps" 2 render "$tmp/d.leaf" --iso 100 --time 2 --steps 0:1 -o "$tmp/x.png"
refused "step and time" "either --step or --time" 2 render "$tmp/d.leaf" --iso 100 --step 1 --time 2 -o "$tmp/x.png"
refused "time and step" "either --step or --time" 2 render "$tmp/d.leaf" --iso 100 --time 3 --interpolate --step 1 -o "$tmp/x.png"
refused "of a slice" "either --step or --time" 2 slice "$tmp/d.leaf" --time 3 --interpolate --step 0 -o "$tmp/x.png"
refused "of a probe" "either --step or --time" 2 probe "$tmp/d.leaf" --iso 100 --at 9,9 --size 20x20 --step 0 --time 2
refused "of a point" "either --step or --time" 2 probe "$tmp/d.leaf" --point 1,1,1 --step 0 --time 2
echo '{"time": 2, "step": 1, "depth-f64": "'"$tmp"'/x.png"}' >"$tmp/lines"
exits "of a line" 1 "$leafcast" render "$tmp/d.leaf" --iso 100 --script "$tmp/lines"
ok "of a line: it says why" grep -q "either --step or --time" "$tmp/out" "$tmp/err"
ok "nothing was written" [ ! -e "$tmp/x.png" ]
finish
