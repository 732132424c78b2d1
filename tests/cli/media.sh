#!/bin/sh
# media.sh - what a volume is filled with, from flags to pixels: transfer functions and colour maps against VTK's and
# matplotlib's own, presets on any volume, planes and their error, what is refused.
# marks: leaks, long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/${2:-err}"; }
draw() { "$leafcast" render "$tmp/v.leaf" --size 40x30 -q --force "$@"; }
python=$(python_with struct)
# numbers FILE EXPRESSION: of the raw doubles x of a file
numbers() {
    "$python" - "$1" "$2" <<'PY'
import math, struct, sys
bytes = open(sys.argv[1], "rb").read()
x = struct.unpack("<%dd" % (len(bytes) // 8), bytes)
sys.exit(not eval(sys.argv[2]))
PY
}
# f = 10 x on 9 x 7 x 5 samples, spacing 1: a box of 8 x 6 x 4
"$python" -c 'import sys
sys.stdout.buffer.write(bytes(10 * x for z in range(5) for y in range(7) for x in range(9)))' >"$tmp/v.raw"
exits "a volume" 0 "$leafcast" convert "$tmp/v.raw" --dims 9,7,5 --type u8 -o "$tmp/v.leaf" -q

# ---- what is drawn ----
view="--eye 4,3,50 --look-at 4,3,0 --up 0,1,0 --ortho 2 --background 0,0,0,0"
echo '0 1 0.5 0.25 0.3' >"$tmp/one.tf"
# shellcheck disable=SC2086 # arguments
exits "a constant medium" 0 draw --tf "$tmp/one.tf" $view --rgba-f64 "$tmp/rgba" --error-f64 "$tmp/error"
ok "is as by formula" numbers "$tmp/rgba" 'len(x) == 4800 and all(abs(x[4 * i + 3] - 1 + math.exp(-1.2)) < 1 / 510 and
    abs(x[4 * i] - x[4 * i + 3]) < 1e-6 and abs(x[4 * i + 1] - 0.5 * x[4 * i + 3]) < 1e-6 for i in range(1200))'
ok "within its error" numbers "$tmp/error" 'len(x) == 1200 and all(0 <= e <= 1 / 510 for e in x)'
# shellcheck disable=SC2086
exits "opacities" 0 draw --opacity 0:0.2 --opacity-length 2 $view --rgba-f64 "$tmp/rgba" --error 1e-6
ok "are of their length" numbers "$tmp/rgba" 'all(abs(x[4 * i + 3] - 0.36) < 1e-6 for i in range(1200))'
# shellcheck disable=SC2086
exits "a ramp" 0 draw --opacity 0:0,80:0.9 --colour-map viridis $view --error 1/16 --error-f64 "$tmp/error" -o "$tmp/a.ppm"
ok "may err as asked" numbers "$tmp/error" 'max(x) <= 1 / 16'
# shellcheck disable=SC2086
exits "more exactly" 0 draw --opacity 0:0,80:0.9 --colour-map viridis $view --error 1e-6 --error-f64 "$tmp/error"
ok "errs less" numbers "$tmp/error" 'max(x) <= 1e-6'
exits "with a surface" 0 draw --tf auto --iso 35 -o "$tmp/both.ppm"
exits "without" 0 draw --tf auto -o "$tmp/medium.ppm"
exits "alone" 0 draw --iso 35 -o "$tmp/surface.ppm"
ok "both are seen" [ "$(cksum <"$tmp/both.ppm")" != "$(cksum <"$tmp/medium.ppm")" -a \
    "$(cksum <"$tmp/both.ppm")" != "$(cksum <"$tmp/surface.ppm")" ]
exits "what was used" 0 draw --tf auto --write-tf "$tmp/auto.tf" --rgba-f64 "$tmp/first" -o "$tmp/first.ppm"
exits "is used again" 0 draw --tf "$tmp/auto.tf" --rgba-f64 "$tmp/again" -o "$tmp/again.ppm"
ok "to the bit" cmp "$tmp/first" "$tmp/again"
exits "a legend" 0 draw --tf auto --legend --size 300x200 -o "$tmp/legend.ppm" --rgba-f64 "$tmp/with"
exits "none" 0 draw --tf auto --size 300x200 -o "$tmp/none.ppm" --rgba-f64 "$tmp/without"
ok "is in the picture" [ "$(cmp -l "$tmp/legend.ppm" "$tmp/none.ppm" | wc -l)" -gt 3000 ]
ok "not in raw colours" cmp "$tmp/with" "$tmp/without"
exits "shaded" 0 draw --tf auto --shade-medium --light 2,1,0 -o "$tmp/shaded.ppm" --error-f64 "$tmp/error"
ok "is another picture" [ "$(cksum <"$tmp/shaded.ppm")" != "$(cksum <"$tmp/medium.ppm")" ]
ok "whose error nobody knows" numbers "$tmp/error" 'len(x) == 1200 and min(x) == math.inf'
exits "and it says so" 0 "$leafcast" render "$tmp/v.leaf" --size 40x30 --tf auto --shade-medium=1/8 -o "$tmp/shaded.ppm" --force
ok "in its summary" says 'the medium is shaded: not certified'
exits "in its counts" 0 draw --tf auto --shade-medium --json -o "$tmp/shaded.ppm"
ok "too" says '"uncertified_pixels": 1200' out
exits "of several pictures" 0 draw --tf auto --turntable 2 --write-tf "$tmp/turn.tf" --error-f64 "$tmp/turn"
ok "each has its own" [ -s "$tmp/turn_0001.tf" -a -s "$tmp/turn_0001" ]
"$leafcast" generate noise --seed 1 --tets --dims 7 -o "$tmp/m_0000.mesh" -q
"$leafcast" generate noise --seed 2 --tets --dims 7 -o "$tmp/m_0001.mesh" -q
"$leafcast" convert "$tmp/m_0000.mesh" "$tmp/m_0001.mesh" -o "$tmp/m.leaf" -q
exits "time steps" 0 "$leafcast" render "$tmp/m.leaf" --colour-map plasma --steps 0:1 --size 8x8 -q --write-tf "$tmp/s.tf"
ok "share the first one's colours" cmp "$tmp/s_0000.tf" "$tmp/s_0001.tf"
exits "the second alone" 0 "$leafcast" render "$tmp/m.leaf" --colour-map plasma --step 1 --size 8x8 -q --write-tf "$tmp/s1.tf"
ok "has its own" [ "$(cksum <"$tmp/s1.tf")" != "$(cksum <"$tmp/s_0001.tf")" ]
exits "a PNG" 0 draw --tf auto --window 3,30 --colour-map magma --error 1/100 -o "$tmp/a.png"
ok "says what it was made with" [ "$(grep -aoc 'leafcast:\(tf\|colour_map\|window\|error\)' "$tmp/a.png")" -ge 1 -a \
    "$(grep -ao 'leafcast:\(tf\|colour_map\|window\|error\)' "$tmp/a.png" | sort -u | wc -l)" = 4 ]
# Each volume has the constant medium of above: together they are one of so many times the extinction.
set --
for count in 2 3 16; do
    while [ $# -lt $((4 * (count - 1))) ]; do set -- "$@" --and "$tmp/v.leaf" --tf "$tmp/one.tf"; done
    # shellcheck disable=SC2086
    exits "media in $count volumes" 0 draw --tf "$tmp/one.tf" "$@" $view --rgba-f64 "$tmp/rgba" --error-f64 "$tmp/error"
    ok "mix" numbers "$tmp/rgba" "all(abs(x[4 * i + 3] - 1 + math.exp(-1.2 * $count)) < 1 / 510 and
        abs(x[4 * i + 1] - 0.5 * x[4 * i + 3]) < 2 / 510 for i in range(1200))"
    ok "within the error" numbers "$tmp/error" 'all(0 <= e <= 1 / 510 for e in x)'
done
exits "in one more volume than there may be media" 2 draw --tf "$tmp/one.tf" "$@" --and "$tmp/v.leaf" --tf "$tmp/one.tf" -o "$tmp/x.ppm"
exits "a second volume's medium" 0 draw --iso 40 --and "$tmp/v.leaf" --tf auto -o "$tmp/and.ppm"
if draw --tf auto -o "$tmp/a.exr" 2>/dev/null; then
    ok "EXR says the error" grep -aq error "$tmp/a.exr"
else
    skip "EXR says the error" "no leafcast-write-image"
fi
gzip -c "$tmp/auto.tf" >"$tmp/packed.tf.gz"
exits "a packed file" 0 draw --tf "$tmp/packed.tf.gz" --rgba-f64 "$tmp/again"
ok "is read" cmp "$tmp/first" "$tmp/again"

# ---- to compare with ----
# shellcheck disable=SC2086
exits "in steps" 0 draw --tf "$tmp/one.tf" $view --medium steps=1/3 --rgba-f64 "$tmp/rgba" --error-f64 "$tmp/error"
ok "a constant medium is as by formula, too" numbers "$tmp/rgba" 'all(abs(x[4 * i + 3] - 1 + math.exp(-1.2)) < 1e-12 for i in range(1200))'
ok "but nobody knows" numbers "$tmp/error" 'all(e == math.inf for e in x)'
# shellcheck disable=SC2086
exits "up to an opacity, by cells" 0 draw --tf "$tmp/one.tf" $view --medium steps=1/3,0.5 --rgba-f64 "$tmp/rgba"
ok "and no further" numbers "$tmp/rgba" 'all(abs(x[4 * i + 3] - 1 + math.exp(-0.9)) < 1e-12 for i in range(1200))'
# shellcheck disable=SC2086
exits "pre-integrated" 0 draw --tf "$tmp/one.tf" $view --medium preintegrated=2,64 --rgba-f64 "$tmp/rgba"
ok "that too" numbers "$tmp/rgba" 'all(abs(x[4 * i + 3] - 1 + math.exp(-1.2)) < 1e-6 for i in range(1200))'
exits "too small a table" 2 draw --tf auto --medium preintegrated=1,8 -o "$tmp/no.ppm"
exits "steps with a surface" 2 draw --tf auto --iso 35 --medium steps=1 -o "$tmp/no.ppm"
ok "are refused" says 'without isosurfaces'
exits "steps of nothing" 2 draw --tf auto --medium steps=0 -o "$tmp/no.ppm"
exits "steps with an error" 2 draw --tf auto --medium steps=1 --error 1/100 -o "$tmp/no.ppm"
exits "no medium" 2 draw --iso 35 --medium steps=1 -o "$tmp/no.ppm"
exits "steps with a certificate" 2 draw --tf auto --medium steps=1 --certify -o "$tmp/no.ppm"
ok "have none" says 'no error that is known'
exits "no such way" 2 draw --tf auto --medium guessed -o "$tmp/no.ppm"

# ---- scripts ----
cat >"$tmp/lines" <<LINES
{"tf": "$tmp/auto.tf", "rgba_f64": "$tmp/line1"}
{"colour_map": "plasma", "opacity": "0:0,80:0.5", "window": [0, 80], "opacity_length": 3, "error": "1/100", "rgba_f64": "$tmp/line2", "write_tf": "$tmp/line2.tf"}
{"tf": "nothing"}
LINES
exits "a script" 1 draw --script "$tmp/lines"
ok "a bad line is answered" says '"nothing\\" is neither a file nor one of auto|ct|mr' out
ok "draws the same" cmp "$tmp/line1" "$tmp/first"
exits "as flags do" 0 draw --colour-map plasma --opacity 0:0,80:0.5 --window 0,80 --opacity-length 3 --error 1/100 \
    --rgba-f64 "$tmp/flags" --write-tf "$tmp/flags.tf"
ok "in raw colours" cmp "$tmp/line2" "$tmp/flags"
ok "and points" cmp "$tmp/line2.tf" "$tmp/flags.tf"

# ---- presets on any volume ----
"$python" - "$tmp" <<'PY'
import random, struct, sys
random.seed(3)
nan = float("nan")
n = 6 * 5 * 4
kinds = {"constant": [7.0] * n, "zero": [0.0] * n, "none": [nan] * n, "holes": [nan if i % 7 else 3.0 * i for i in range(n)],
         "huge": [random.choice((-1, 1)) * 3e38 for _ in range(n)], "tiny": [1e-38 * random.random() for _ in range(n)],
         "two": [float(i % 97 == 0) for i in range(n)], "tail": [random.random() ** 40 * 1e30 for _ in range(n)]}
for name, values in kinds.items():
    open("%s/%s.raw" % (sys.argv[1], name), "wb").write(struct.pack("<%df" % n, *values))
PY
for name in constant zero none holes huge tiny two tail; do
    exits "$name" 0 "$leafcast" convert "$tmp/$name.raw" --dims 6,5,4 --type f32 -o "$tmp/$name.leaf" -q --allow-empty
    for preset in auto ct mr; do
        exits "$name, $preset" 0 "$leafcast" render "$tmp/$name.leaf" --tf $preset --size 16x12 -q --force --rgba-f64 \
            "$tmp/rgba" --write-tf "$tmp/w.tf" --legend -o "$tmp/w.ppm"
        ok "$name, $preset: colours are finite" numbers "$tmp/rgba" 'all(math.isfinite(v) for v in x)'
    done
done

# ---- against those who made the maps ----
python=$(python_with vtkmodules.vtkRenderingCore)
if [ -n "$python" ]; then
    "$python" - "$leafcast" "$tmp" <<'PY' >"$tmp/out" 2>"$tmp/err"
import json, math, random, subprocess, sys
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
leafcast, tmp = sys.argv[1:]
random.seed(11)
def encoded(v):
    return 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055
def at(points, x):
    before = [p for p in points if p[0] <= x]
    after = [p for p in points if p[0] > x]
    if not before or not after:
        return (before[-1] if before else after[0])[1:]
    a, b = before[-1], after[0]
    s = (x - a[0]) / (b[0] - a[0])
    return [(1 - s) * p + s * q for p, q in zip(a[1:], b[1:])]
worst = [0, 0]
for k in range(40):
    space = ("RGB", "HSV", "Lab", "Diverging", "HSV")[k % 5]
    count = 1 + k % 6
    colours = vtkColorTransferFunction()
    getattr(colours, "SetColorSpaceTo" + space)()
    colours.SetHSVWrap(k % 5 == 4)
    alphas = vtkPiecewiseFunction()
    rgb, opacity = [], []
    xs = sorted(random.uniform(-40, 90) for _ in range(count))
    for x in xs:
        c = [random.random() for _ in range(3)]
        rgb += [x] + c
        colours.AddRGBPoint(x, *c)
        o = [random.random() * 0.99, random.uniform(0.05, 0.95), random.choice((0, 0, 0.3, 1))]
        opacity += [x] + o
        alphas.AddPoint(x, *o)
    xml = k % 2 == 1 and space != "HSV"
    map = {"Name": "a map", "ColorSpace": space, "RGBPoints": rgb, "Points": opacity, "HSVWrap": int(k % 5 == 4)}
    with open(tmp + "/map", "w") as f:
        if xml:
            f.write("<?xml version='1.0'?>\n<ColorMaps><ColorMap name='a map' space='%s'>\n" % space)
            alphas = vtkPiecewiseFunction()
            for i in range(count):
                alphas.AddPoint(rgb[4 * i], opacity[4 * i + 1])
                f.write("<Point x='%.17g' o='%.17g' r='%.17g' g='%.17g' b='%.17g'/>\n" %
                        (rgb[4 * i], opacity[4 * i + 1], *rgb[4 * i + 1:4 * i + 4]))
            f.write("</ColorMap></ColorMaps>")
        else:
            json.dump([map] if k % 3 else map, f)
    subprocess.run([leafcast, "render", tmp + "/v.leaf", "--tf", tmp + "/map", "--opacity-length", "2", "--size", "2x2",
                    "--write-tf", tmp + "/map.tf", "--force", "-q"], check=True)
    points = [[float(v) for v in line.split()] for line in open(tmp + "/map.tf") if line[0] != "#"]
    for i in range(1501):
        x = -50 + i * 0.1 + 0.0123
        got, want = at(points, x), colours.GetColor(x)
        worst[0] = max(worst[0], *(abs(encoded(g) - w) for g, w in zip(got, want)))
        # Where it steps, VTK's and ours may be on different sides.
        step = any(min(abs(x - a - m * (b - a)) for m in opacity[2::4]) < 0.02 * (b - a) for a, b in zip(xs, xs[1:]))
        if not step:
            worst[1] = max(worst[1], abs(1 - math.exp(-2 * got[3]) - alphas.GetValue(x)))
print("worst: colours %.5f, opacities %.5f of %.5f" % (*worst, 1 / 510))
sys.exit(worst[0] > 1 / 510 or worst[1] > 1 / 510)
PY
    rc=$?
    ok "ParaView's maps are VTK's ($(tail -n 1 "$tmp/out"))" [ "$rc" = 0 ]
else
    skip "ParaView's maps are VTK's" "no Python with VTK"
fi
python=$(python_with matplotlib)
if [ -n "$python" ]; then
    for map in viridis plasma inferno magma; do
        exits "$map" 0 draw --colour-map $map --window 0,255 --write-tf "$tmp/$map.tf" --size 2x2
        "$python" - "$tmp/$map.tf" $map <<'PY' >"$tmp/out" 2>"$tmp/err"
import sys
import matplotlib.cm
points = [[float(v) for v in line.split()] for line in open(sys.argv[1]) if line[0] != "#"]
def encoded(v):
    return 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055
worst = 0
for i, want in enumerate(getattr(matplotlib.cm, sys.argv[2]).colors):
    a = max((p for p in points if p[0] <= i + 1e-9), key=lambda p: p[0])
    b = min((p for p in points if p[0] >= i - 1e-9), key=lambda p: p[0])
    s = 0 if b[0] - a[0] < 1e-6 else (i - a[0]) / (b[0] - a[0])
    worst = max(worst, *(abs(encoded((1 - s) * a[c + 1] + s * b[c + 1]) - want[c]) for c in range(3)))
print("%.3f / 255" % (255 * worst))
sys.exit(worst > 1.001 / 255)
PY
        rc=$?
        ok "$map is within 1 of 255 ($(cat "$tmp/out"))" [ "$rc" = 0 ]
    done
else
    skip "maps are the originals" "no Python with matplotlib"
fi

# ---- what is refused ----
echo '{"RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1]}' >"$tmp/colours.json"
while IFS='|' read -r words arguments; do
    # shellcheck disable=SC2046 # arguments
    exits "$arguments" 2 draw -o "$tmp/x.ppm" $(echo "$arguments" | sed "s|@|$tmp/|g")
    ok "$arguments: says why" says "$words"
done <<'TABLE'
neither a file nor one of auto|--tf atuo
neither a file nor one of grey|--colour-map virids
has colours alone|--tf @colours.json
text holds one transfer function|--tf @one.tf#a
has extinctions, which need none|--tf @one.tf --opacity-length 2
--opacity-length is for|--tf ct --opacity-length 2
--window is for|--window 1,2
--window is for|--tf ct --window 1,2
LO below HI|--colour-map grey --window 2,1
LO below HI|--colour-map grey --window 1,1
list of 2 numbers|--opacity 1:
do not rise|--opacity 2:0.5,1:0.5
0 to below 1|--opacity 2:1
0 to below 1|--opacity 2:-0.1
no name of a file|--colour-map=
--tf would change nothing|--tf ct --colour-map grey --opacity 1:0.5
--tf would change nothing|--tf ct --colour-map grey --project max
is not in 1e-9|--tf ct --error 0
is not in 1e-9|--tf ct --error 1/0
is not in 1e-9|--tf ct --error 2
--error is of media|--error 0.1
--error is of media|--project max --error 0.1
none of max, min, mean|--project most
not a finite number|--project first=nan
without --iso|--project max --iso 30
without opacities|--project max --opacity 3:0.5
--legend is of|--legend
--caps: nothing is cut|--iso 50 --caps
--caps: there is no surface|--tf ct --caps --clip-plane 1,0,0,-3
is neither a file nor one of|--iso 50 --caps=pink --clip-plane 1,0,0,-3
--certify is of media|--iso 50 --certify
--certify is of one sample|--tf ct --certify --samples 4
--certify: what --shade-medium shades|--tf ct --shade-medium --certify
--shade-medium is of media|--iso 50 --shade-medium
--shade-medium is of media|--project max --shade-medium
--shade-medium: steps of --medium|--tf ct --shade-medium --medium steps=1
--shade-medium: 0 is not in|--tf ct --shade-medium=0
--shade-medium: 2 is not in|--tf ct --shade-medium=2
--homogeneous: what --shade-medium|--tf ct --shade-medium --homogeneous 3
there is no surface without --iso|--tf ct --light 1,0,0
--error-f64 is of media|--error-f64 @e
--value-f64 is of --project|--tf ct --value-f64 @e
--write-tf is of|--write-tf @e
no surface without --iso|--tf ct --shading phong
1 of --colour for 0 of --iso|--tf ct --color red
is an input|--tf @one.tf --write-tf @one.tf
TABLE
exits "a broken file" 3 draw -o "$tmp/x.ppm" --tf "$tmp/v.raw"
echo '1 0 0 0' >"$tmp/short.tf"
exits "a short line" 3 draw -o "$tmp/x.ppm" --tf "$tmp/short.tf"
ok "is told by its place" says 'short.tf: line 1'
exits "an error that is there" 1 draw -o "$tmp/x.ppm" --tf "$tmp/none.tf"
: >"$tmp/there"
exits "nothing is overwritten" 1 "$leafcast" render "$tmp/v.leaf" --tf auto -q --write-tf "$tmp/there"
ok "and said" says 'exists'
finish
