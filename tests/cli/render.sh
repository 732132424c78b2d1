#!/bin/sh
# render.sh - leafcast render: exit codes, what goes where, files, sequences, scripts.
# marks: long, leaks
. tests/support/tap.sh

leaf=$tmp/v.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
quiet() { [ ! -s "$tmp/$1" ]; }
gone() { for f; do [ ! -e "$f" ] || return 1; done; }
there() { for f; do [ -s "$f" ] || return 1; done; }
bytes() { wc -c <"$1" | tr -d ' '; }
json() { # json FILE EXPRESSION: python, with the last line of the file as j
    python3 -c 'import json, sys
text = open(sys.argv[1]).read()
j = json.loads(text if text.startswith("{\n") else text.strip().splitlines()[-1])
sys.exit(not eval(f"({sys.argv[2]})"))' "$@"
}
lines() { [ "$(wc -l <"$tmp/out")" -eq "$1" ]; }
helper=$(dirname "$leafcast")/../libexec/leafcast-write-image
pictures=
[ ! -x "$helper" ] || pictures=yes

run "$leafcast" generate gyroid --dims 75,70,66 -o "$tmp/v.nrrd"
exits "a volume to draw" 0 "$leafcast" convert "$tmp/v.nrrd" -o "$leaf" --treelet 16 -q
small="$leaf --iso 128 --size 40x30"

# ---- usage errors: exit 2, one line that says what, nothing on standard output ----
wrong() { # wrong TEXT ARGUMENT...
    tap_says=$1
    shift
    exits "render $*" 2 "$leafcast" render "$@"
    ok "says: $tap_says" says "$tap_says" err
    ok "prints nothing" quiet out
}
d=$tmp/x.f64
wrong "which treelet file" --iso 1 --depth-f64 "$d"
wrong "nothing to write" "$leaf" --iso 1
wrong "nan is not a finite number" "$leaf" --iso nan --depth-f64 "$d"
wrong "-inf is not a finite number" "$leaf" --iso -inf --depth-f64 "$d"
wrong "is not a number" "$leaf" --iso 1x --depth-f64 "$d"
wrong "unrecognized option" "$leaf" --iso 1 --frobnicate --depth-f64 "$d"
wrong "one treelet file is enough" "$leaf" "$leaf" --iso 1 --depth-f64 "$d"
wrong "not WxH" "$leaf" --iso 1 --size 0x4 --depth-f64 "$d"
wrong "is no colour" "$leaf" --iso 1 --color '#12345' --depth-f64 "$d"
wrong "the k-th belongs to the k-th" "$leaf" --iso 1 --opacity 1 --opacity 0.5 --depth-f64 "$d"
wrong "not above 0" "$leaf" --iso 1 --opacity 0 --depth-f64 "$d"
wrong "none of diffuse, phong, flat" "$leaf" --iso 1 --shading toon --depth-f64 "$d"
wrong "none of midpoint" "$leaf" --iso 1 --intersector newton --depth-f64 "$d"
wrong "no direction" "$leaf" --iso 1 --light 0,0,0 --depth-f64 "$d"
wrong "not 0 to 90" "$leaf" --iso 1 --shadows --light 1,0,0,91 --depth-f64 "$d"
wrong "below 0" "$leaf" --iso 1 --shadows --point-light 1,0,0,1,1,1,-2 --depth-f64 "$d"
wrong "in shadows alone" "$leaf" --iso 1 --light 1,0,0,5 --depth-f64 "$d"
wrong "has a RADIUS" "$leaf" --iso 1 --shadows --light 1,0,0 --light-samples 4 --depth-f64 "$d"
wrong "not above 0" "$leaf" --iso 1 --occlusion 0 --depth-f64 "$d"
wrong "1 .* 64" "$leaf" --iso 1 --occlusion 5,65 --depth-f64 "$d"
wrong "ambient 0" "$leaf" --iso 1 --occlusion 5 --ambient 0 --depth-f64 "$d"
wrong "1 .* 8" "$leaf" --iso 1 --reflect 0.5,9 --depth-f64 "$d"
wrong "--refract.*0.25 .* 4" "$leaf" --iso 1 --opacity 0.5 --refract 4.1 --depth-f64 "$d"
wrong "1 .* 8" "$leaf" --iso 1 --opacity 0.5 --refract 1.5,9 --depth-f64 "$d"
wrong "--refract: nothing is seen through" "$leaf" --iso 1 --refract 1.5 --depth-f64 "$d"
wrong "--refract: nothing is seen through" "$leaf" --iso 1 --refract 1.5 --and "$leaf" --iso 2 --opacity 0.5 --depth-f64 "$d"
wrong "--refract: nothing is seen through" "$leaf" --iso 1 --opacity 0.5 --and "$leaf" --iso 2 --refract 1.5 --depth-f64 "$d"
wrong "--refract: bent rays see no media" "$leaf" --iso 1 --opacity 0.5 --refract 1.5 --tf auto --depth-f64 "$d"
wrong "2 of --refract for 1 of --iso" "$leaf" --iso 1 --opacity 0.5 --refract 1.5 --refract 1.2 --depth-f64 "$d"
wrong "2 of --reflect for 1 of --iso" "$leaf" --iso 1 --reflect 0.5 --reflect 0.2 --depth-f64 "$d"
wrong "ends before it begins" "$leaf" --iso 1 --clip-box 0,0,5,9,9,4 --depth-f64 "$d"
wrong "same point" "$leaf" --iso 1 --eye 1,2,3 --look-at 1,2,3 --depth-f64 "$d"
wrong "kernels" "$leaf" --iso 1 --isa abacus --depth-f64 "$d"
wrong "either --iso or --iso-list" "$leaf" --iso 1 --iso-list 2 --depth-f64 "$d"
wrong "ends in .png .ppm .pfm .exr" "$leaf" --iso 1 -o "$tmp/x.jpg"
ok "nothing was written" gone "$d" "$tmp/x.jpg"
exits "help" 0 "$leafcast" render --help
ok "is on standard output" says 'Usage: leafcast render' out
ok "alone" quiet err

# ---- other failures ----
exits "no such file" 1 "$leafcast" render "$tmp/none.leaf" --iso 1 --depth-f64 "$d"
ok "is named" says 'none.leaf' err
head -c 3000 "$leaf" >"$tmp/cut.leaf"
exits "a cut file" 3 "$leafcast" render "$tmp/cut.leaf" --iso 128 --depth-f64 "$d"
exits "no treelet file" 3 "$leafcast" render "$tmp/v.nrrd" --iso 128 --depth-f64 "$d"
exits "a budget too small" 4 "$leafcast" render $small --memory 100K --depth-f64 "$d"
ok "names one that would do" says 'would do' err
exits "no folder" 1 "$leafcast" render $small --depth-f64 "$tmp/no/x.f64"
ok "nothing was written" gone "$d" "$tmp/no"

# ---- depth and statistics ----
exits "depth" 0 "$leafcast" render $small --depth-f64 "$d" --stats "$tmp/s.json"
ok "prints nothing" quiet out
ok "says one line" says 'x.f64: 40 x 30' err
ok "has a double a pixel" [ "$(bytes "$d")" = 9600 ]
ok "statistics have their keys" json "$tmp/s.json" 'j["rays"] == 1200 and
    all(j["time_s"][k] >= 0 for k in ("open", "first_image", "load", "render", "write", "total")) and
    0 < j["treelets"]["loaded"] <= j["treelets"]["active"] <= j["treelets"]["total"] and
    0 < j["bytes"]["visible"] <= j["bytes"]["read"] <= j["bytes"]["file"] and
    j["mrays_per_s"] > 0 and j["peak_rss_bytes"] > 0 and j["threads"] >= 1 and j["isa"]'
cp "$d" "$tmp/first.f64"
exits "an existing depth file" 1 "$leafcast" render $small --depth-f64 "$d"
exits "existing statistics" 1 "$leafcast" render $small --depth-f64 "$tmp/y.f64" --stats "$tmp/s.json"
ok "nothing was written" gone "$tmp/y.f64"
exits "--force, quietly" 0 "$leafcast" render $small --depth-f64 "$d" --force -q
ok "says nothing" quiet err
ok "gives the same bits" cmp -s "$d" "$tmp/first.f64"
exits "--json without outputs" 0 "$leafcast" render $small --json --repeat 3
ok "prints an object" says '^{$' out
ok "of the median of three" json "$tmp/out" 'j["repeats"] == 3 and j["size"] == [40, 30]'

# ---- isovalues that draw nothing ----
for iso in 1e9 -5 256; do
    exits "isovalue $iso" 0 "$leafcast" render "$leaf" --iso $iso --size 8x8 --depth-f64 "$d" --force --stats "$tmp/s.json"
    ok "says there is no surface" says 'no surface at isovalue' err
    ok "loads nothing" json "$tmp/s.json" 'j["treelets"]["loaded"] == 0 and j["bytes"]["read"] == 0'
    ok "misses everywhere" [ "$(od -An -v -tx8 "$d" | tr -s ' ' '\n' | grep -c 7ff0000000000000)" = 64 ]
done

# ---- sequences ----
exits "a list of isovalues" 0 "$leafcast" render "$leaf" --iso-list 100,120:140,160 --size 8x8 --depth-f64 "$tmp/l.f64" --stats "$tmp/l.json" -q
ok "gives a file each" there "$tmp/l_0000.f64" "$tmp/l_0001.f64" "$tmp/l_0002.f64"
ok "and their statistics" json "$tmp/l.json" '[f["isovalues"] for f in j["frames"]] == [[100], [120, 140], [160]]'
cat >"$tmp/path.json" <<'JSON'
[{"eye": [200, 10, 90]},
 {"eye": [10, 200, 90], "look_at": [30, 30, 30], "fov": 30},
 {"camera": {"view": "close"}, "iso": 100}]
JSON
exits "a camera path" 0 "$leafcast" render "$leaf" --iso 128 --camera-path "$tmp/path.json" --size 8x8 --depth-f64 "$tmp/p%02d.f64" --json -q
ok "gives a file each" there "$tmp/p00.f64" "$tmp/p01.f64" "$tmp/p02.f64"
ok "and a line each" lines 3
ok "whose isovalues may change" json "$tmp/out" 'j["isovalues"] == [100]'
exits "views times isovalues" 0 "$leafcast" render "$leaf" --iso-list 100,150 --camera-path "$tmp/path.json" --size 8x8 --depth-f64 "$tmp/x.f64" -q
ok "gives their product" there "$tmp/x_0005.f64"
exits "one picture of a sequence exists" 1 "$leafcast" render "$leaf" --iso-list 1,100 --size 8x8 --depth-f64 "$tmp/x.f64"
echo '[{"eyes": 3}]' >"$tmp/bad.json"
exits "a path with an unknown key" 2 "$leafcast" render "$leaf" --iso 1 --camera-path "$tmp/bad.json" --depth-f64 "$tmp/q.f64"
ok "is told which" says 'there is no "eyes"' err
echo '[{' >"$tmp/bad.json"
exits "a path that is no JSON" 3 "$leafcast" render "$leaf" --iso 1 --camera-path "$tmp/bad.json" --depth-f64 "$tmp/q.f64"

# ---- scripts ----
cat >"$tmp/script" <<JSON
{"size": [8, 8], "depth_f64": "$tmp/s1.f64"}

{"size": "8x8", "isovalues": [100, 150], "opacity": [0.5, 1], "shadows": true, "lights": 3}
{"size": "8x8", "isovalues": [100, 150], "opacity": [0.5, 1], "color": ["#ff0000", [0, 0, 1]], "shadows": true, "light": [1, 1, 1]}
not JSON
{"size": [8, 8], "depth_f64": "$tmp/s2.f64"}
JSON
exits "a script with two bad lines" 1 "$leafcast" render "$leaf" --iso 128 --script "$tmp/script"
ok "answers every line" lines 5
ok "says what was wrong" says 'line 3: there is no "lights"' err
ok "in the answer too" says '"message":"line 5: ' out
ok "numbers its lines" json "$tmp/out" 'j["line"] == 6 and j["rays"] == 64'
ok "goes on after them" cmp -s "$tmp/s1.f64" "$tmp/s2.f64"
rm -f "$tmp/s1.f64" "$tmp/s2.f64"
"$leafcast" render "$leaf" --iso 128 --script - -q <"$tmp/script" >"$tmp/out" 2>"$tmp/err"
ok "a script on standard input draws alike" cmp -s "$tmp/s1.f64" "$tmp/s2.f64"
ok "quietly but for the errors" [ "$(wc -l <"$tmp/err")" = 3 ]
wrong "takes its outputs from its lines" "$leaf" --iso 1 --script - -o x.png

# ---- pictures ----
exits "PNG" 0 "$leafcast" render $small -o "$tmp/a.png"
ok "is one" [ "$(od -An -c -N4 "$tmp/a.png" | tr -d ' ')" = '211PNG' ]
exits "an existing picture" 1 "$leafcast" render $small -o "$tmp/a.png"
ok "is refused before it is drawn" says 'exists (--force overwrites)' err
exits "no folder" 1 "$leafcast" render $small -o "$tmp/no/a.png"
exits "a sequence of pictures" 0 "$leafcast" render "$leaf" --iso-list 100,150 --size 8x8 -o "$tmp/q.png" -q
ok "is numbered" there "$tmp/q_0000.png" "$tmp/q_0001.png"
if [ "$pictures" ]; then
    exits "EXR" 0 "$leafcast" render $small -o "$tmp/a.exr" -q
    if command -v oiiotool >/dev/null; then
        oiiotool --info -v "$tmp/a.exr" >"$tmp/out" 2>&1
        ok "EXR has its channels" says 'channel list: R, G, B, A, Z, id, N.x, N.y, N.z' out
        ok "and how it was made" says 'leafcast:isovalues: "128"' out
    else
        skip "EXR has its channels" "no oiiotool"
        skip "and how it was made" "no oiiotool"
    fi
else
    skip "EXR" "no OpenImageIO here"
fi
finish
