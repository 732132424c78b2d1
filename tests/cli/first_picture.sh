#!/bin/sh
# first_picture.sh - `render F.leaf -o x.png` with nothing else shows something worth seeing: an isovalue that is said, a
# view that fits what is active, an opaque background. The standard view stays; pictures of one run keep one view.
# marks: long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
cat >"$tmp/look.py" <<'PY'
# Depths of a square picture without another library: how much is covered, and the box of what is.
import array, math, sys
z = array.array("d", open(sys.argv[1], "rb").read())
side = math.isqrt(len(z))
seen = [i for i, d in enumerate(z) if math.isfinite(d)]
share = len(seen) / len(z)
x, y = [i % side for i in seen], [i // side for i in seen]
box = (min(x, default=0), min(y, default=0), max(x, default=0), max(y, default=0))
wide, high = (box[2] - box[0] + 1) / side, (box[3] - box[1] + 1) / side
free = min(box[0], box[1], side - 1 - box[2], side - 1 - box[3])
print(f"# covered {share:.3f}, {wide:.3f} wide, {high:.3f} high, {free} pixels of margin")
sys.exit(not eval(sys.argv[2]))
PY
# looks NAME EXPRESSION [ARGUMENT...]: of the first picture of $tmp/NAME.leaf
looks() {
    name=$1
    expression=$2
    shift 2
    run "$leafcast" render "$tmp/$name.leaf" --size 200x200 --depth-f64 "$tmp/z" --force "$@"
    python3 "$tmp/look.py" "$tmp/z" "$expression" >"$tmp/out"
}
# The PNG's pixels: all opaque, and of more than one colour.
opaque() {
    python3 - "$1" <<'PY'
import struct, sys, zlib
data = open(sys.argv[1], "rb").read()
at, idat, head = 8, b"", None
while at < len(data):
    size, kind = struct.unpack(">I4s", data[at:at + 8])
    body = data[at + 8:at + 8 + size]
    head = struct.unpack(">IIBBBBB", body) if kind == b"IHDR" else head
    idat += body if kind == b"IDAT" else b""
    at += 12 + size
width, height, bits, colours = head[:4]
channels, raw = {2: 3, 6: 4}[colours], zlib.decompress(idat)
row, step, pixels = width * channels * bits // 8, channels * bits // 8, set()
before = bytes(row)
for y in range(height):
    kind, line = raw[y * (row + 1)], bytearray(raw[y * (row + 1) + 1:(y + 1) * (row + 1)])
    for i in range(row):
        a, b, c = line[i - step] if i >= step else 0, before[i], before[i - step] if i >= step else 0
        p = a + b - c
        near = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
        line[i] = line[i] + (0, a, b, (a + b) // 2, near)[kind] & 255
    before = bytes(line)
    pixels |= {before[i:i + step] for i in range(0, row, step)}
alpha = {p[3 * bits // 8:] for p in pixels} if channels == 4 else {b"\xff" * (bits // 8)}
print(f"# {width} x {height}, {len(pixels)} colours, alpha {alpha}")
sys.exit(not (alpha == {b"\xff" * (bits // 8)} and len(pixels) > 20))
PY
}

for field in gyroid orbital attractor marschner-lobb sphere; do
    "$leafcast" generate $field --dims 48,40,44 -o "$tmp/$field.nrrd" -q
    "$leafcast" convert "$tmp/$field.nrrd" -o "$tmp/$field.leaf" -q
done
"$leafcast" generate buckyball --tets --dims 12 -o "$tmp/mesh.mesh" -q
"$leafcast" convert "$tmp/mesh.mesh" -o "$tmp/mesh.leaf" -q
for name in gyroid orbital attractor marschner-lobb sphere mesh; do
    exits "$name, with nothing else" 0 "$leafcast" render "$tmp/$name.leaf" -o "$tmp/$name.png"
    ok "$name: says the isovalue" says 'isovalue [-0-9.e]*, as its values suggest'
    ok "$name: nothing is amiss" [ "$(grep -c 'no surface' "$tmp/err")" = 0 ]
    ok "$name: not empty, not full" looks $name '0.02 < share < 0.90'
    ok "$name: inside the picture" looks $name 'free >= 1'
    ok "$name: a good part of it" looks $name 'max(wide, high) > 0.5'
done
# One of the default size is enough to be unpacked; the rest are as good at 96 x 96.
for name in gyroid mesh; do
    run "$leafcast" render "$tmp/$name.leaf" -o "$tmp/small.png" --size 96x96 --force
    ok "$name: opaque, in colours" opaque "$tmp/small.png"
done

# ---- the view fits what is active, not the volume ----

python3 - "$tmp" <<'PY'
import struct, sys
# A block of 255 in zeros, of these sizes, in the middle of 96^3 samples but for `shift`.
def block(name, size, shift=(0, 0, 0)):
    n, data = 96, bytearray(96 ** 3)
    lo = [(n - s) // 2 + d for s, d in zip(size, shift)]
    for z in range(lo[2], lo[2] + size[2]):
        for y in range(lo[1], lo[1] + size[1]):
            at = (z * n + y) * n + lo[0]
            data[at:at + size[0]] = b"\xff" * size[0]
    open(f"{sys.argv[1]}/{name}_96x96x96_uint8.raw", "wb").write(data)
block("small", (12, 10, 8), (20, -25, 30))
block("along_x", (60, 12, 12))
block("along_y", (12, 60, 12))
block("along_z", (12, 12, 60))
PY
for name in small along_x along_y along_z; do
    "$leafcast" convert "$tmp/${name}_96x96x96_uint8.raw" -o "$tmp/$name.leaf" -q
done
ok "a small thing in a large volume fills the picture" looks small 'free >= 1 and wide > 0.7'
ok "in the standard view it does not" looks small 'wide < 0.3' --view standard
for name in along_x along_y; do
    ok "$name: the longer axis lies across" looks $name 'free >= 1 and wide > 0.7 and wide > 1.5 * high'
done
ok "what stands twice as high as it is wide is laid down" looks along_z 'free >= 1 and wide > 0.7 and wide > 1.5 * high'
ok "whatever the field of view" looks along_x 'free >= 1 and wide > 0.7' --fov 60

# ---- the standard view: fov 45, up +z, 2.2 longest edges from the middle towards (1, 0.6, 0.8) ----

standard() { # of 48 x 40 x 44 samples, through the middle of an odd picture
    python3 - "$tmp/out" "$1" <<'PY'
import json, math, sys
j, distance = json.load(open(sys.argv[1])), float(sys.argv[2])
direction = [1, 0.6, 0.8]
length = math.hypot(*direction)
centre = [47 / 2, 39 / 2, 43 / 2]
eye = [c + distance * 47 * d / length for c, d in zip(centre, direction)]
near = lambda a, b: all(abs(x - y) < 1e-9 for x, y in zip(a, b))
sys.exit(not (near(j["origin"], eye) and near(j["direction"], [-d / length for d in direction])))
PY
}
exits "the standard view" 0 "$leafcast" probe "$tmp/gyroid.leaf" --iso 128 --view standard --size 9x9 --at 4,4 --json
ok "is 2.2 longest edges away" standard 2.2
exits "the close view" 0 "$leafcast" probe "$tmp/gyroid.leaf" --iso 128 --view close --size 9x9 --at 4,4 --json
ok "is 1.1 longest edges away" standard 1.1
run "$leafcast" probe "$tmp/gyroid.leaf" --iso 128 --view standard --size 9x9 --at 4,0 --json
ok "of a field of 45 degrees, up +z" python3 -c '
import json, math, sys
d, towards = json.load(open(sys.argv[1]))["direction"], [1, 0.6, 0.8]
length = math.hypot(*towards)
cosine = -sum(a * b / length for a, b in zip(d, towards))
sys.exit(not (abs(math.tan(math.acos(cosine)) - 8 / 9 * math.tan(math.pi / 8)) < 1e-9 and d[2] > -towards[2] / length))' "$tmp/out"

# ---- pictures of one run keep the view of the first ----

covered() { grep -o '"covered_pixels":[0-9]*' "$tmp/out" | cut -d: -f2 | tr '\n' ' '; }
cat >"$tmp/two.raw.py" <<'PY'
import sys
# A block of 100 around one of 200: the isovalues 50 and 150 are active in boxes of their own.
n, data = 64, bytearray(64 ** 3)
for size, value in (48, 100), (12, 200):
    lo = (n - size) // 2
    for z in range(lo, lo + size):
        for y in range(lo, lo + size):
            at = (z * n + y) * n + lo
            data[at:at + size] = bytes([value]) * size
open(sys.argv[1], "wb").write(data)
PY
python3 "$tmp/two.raw.py" "$tmp/two_64x64x64_uint8.raw"
two=$tmp/two.leaf
"$leafcast" convert "$tmp/two_64x64x64_uint8.raw" -o "$two" -q
one() { "$leafcast" render "$two" --size 80x60 --json -q "$@" | grep -o '"covered_pixels": [0-9]*' | cut -d' ' -f2; }
outer=$(one --iso 50)
inner=$(one --iso 150)
run "$leafcast" render "$two" --size 80x60 --json -q --iso-list 50,150
# shellcheck disable=SC2046 # two numbers
set -- $(covered)
ok "isovalues: the first is fitted" [ "$1" = "$outer" ]
ok "and the second is as much smaller as it is" [ $((8 * $2)) -lt "$inner" ]
printf '%s\n' '{"iso": 50}' '{"iso": 150}' '{"iso": 150, "size": [40, 30]}' '{"iso": 150, "view": "standard"}' >"$tmp/lines"
run "$leafcast" render "$two" --size 80x60 --script "$tmp/lines" -q
held="$1 $2"
# shellcheck disable=SC2046 # numbers
set -- $(covered)
ok "a script: likewise" [ "$1 $2" = "$held" ]
ok "a picture of another size is fitted anew" [ $((4 * $3)) -gt $((inner / 2)) ]

# ---- a turntable begins where the picture is ----

# The suggested surface is what it turns, from where the single picture is seen, with the same field of view.
run "$leafcast" render "$two" --size 80x60 --json -q
first=$(grep -o '"covered_pixels": [0-9]*' "$tmp/out" | cut -d' ' -f2)
iso=$(grep -A1 isovalues "$tmp/out" | tail -1 | tr -d ' ')
run "$leafcast" render "$two" --size 80x60 --json -q --turntable 4
# shellcheck disable=SC2046 # numbers
set -- $(covered)
ok "a turntable without an isovalue: the suggested one" [ "$(grep -c "\"isovalues\":\[$iso\]" "$tmp/out")" = 4 ]
# A block seen from the same height after quarter turns is the same size; a pixel or two may round.
ok "begins with the first picture ($1, $first)" [ $(($1 - first)) -ge -2 -a $(($1 - first)) -le 2 ]
ok "and stays as near ($*)" [ $((100 * $2)) -gt $((95 * first)) -a $((100 * $3)) -gt $((95 * first)) ]
run "$leafcast" render "$two" --size 80x60 --json -q --turntable 2 --iso-list 50,150
# shellcheck disable=SC2046 # numbers
set -- $(covered)
ok "isovalues on a turntable keep the first one's view ($*)" \
    [ $(($1 - outer)) -ge -2 -a $(($1 - outer)) -le 2 -a $((8 * $3)) -lt "$inner" ]

# ---- either --view or --eye ----

for verb in "render --json" "probe --at 1,1"; do
    # shellcheck disable=SC2086 # a verb with an option
    exits "${verb%% *}: --view beside --eye" 2 "$leafcast" $verb "$two" --iso 50 --size 8x8 --view close --eye 90,80,70
    ok "is told" says 'either --view or --eye'
done
echo '[{"eye": [150, 80, 90]}, {}, {"view": "standard"}]' >"$tmp/path.json"
exits "a path's entry may say an eye instead" 0 "$leafcast" render "$two" --iso 50 --size 80x60 --json --view close --camera-path "$tmp/path.json"
# shellcheck disable=SC2046 # numbers
set -- $(covered)
ok "which is used, as are the views ($*)" [ "$1" != "$2" -a "$2" -gt "$3" ]
exits "but not both" 2 "$leafcast" render "$two" --iso 50 --size 8x8 --json --eye 150,80,90 --camera-path "$tmp/path.json"
printf '%s\n' '{"view": "close", "eye": [150, 80, 90]}' '{"eye": [150, 80, 90]}' >"$tmp/lines"
run "$leafcast" render "$two" --iso 50 --size 8x8 --view close --script "$tmp/lines"
ok "nor a script's line" says 'either --view or --eye'
ok "whose next one may" [ "$(grep -c covered_pixels "$tmp/out")" = 1 ]

# ---- a first picture, then the exact one in its place ----

draw_one() { # NAME OPTION...
    to=$1
    shift
    exits "draws $to" 0 "$leafcast" render "$two" --iso 50 --size 120x90 -o "$tmp/$to" "$@"
}
draw_one exact.png
draw_one twice.png --progressive --stats "$tmp/twice.json"
ok "ends with the same file" cmp -s "$tmp/exact.png" "$tmp/twice.png"
ok "says when the first one was there" says 'first picture in .* s: [0-9]* pixels were provisional'
ok "also as JSON" python3 -c 'import json, sys
x = json.load(open(sys.argv[1]))
assert 0 < x["first_picture"]["time_s"] < x["time_s"]["total"]
assert 0 <= x["first_picture"]["provisional_pixels"] <= 120 * 90 and x["provisional_pixels"] == 0' "$tmp/twice.json"
exits "a file that was there before" 1 "$leafcast" render "$two" --iso 50 --size 8x8 -o "$tmp/exact.png" --progressive
ok "stays" cmp -s "$tmp/exact.png" "$tmp/twice.png"
draw_one twice_0000.png --progressive --force
exits "many pictures" 0 "$leafcast" render "$two" --size 20x15 -o "$tmp/many.png" --progressive --iso-list 50,150
ok "are all there" [ -s "$tmp/many_0000.png" -a -s "$tmp/many_0001.png" ]
exits "standard output" 2 "$leafcast" render "$two" --iso 50 --size 8x8 --progressive -o -
ok "cannot be written twice" says 'writes a file twice'
exits "two ways" 2 "$leafcast" render "$two" --iso 50 --size 8x8 --progressive --preview -o "$tmp/x.png"
exits "a picture that may be refused" 2 "$leafcast" render "$two" --tf auto --certify --progressive -o "$tmp/x.png"
exits "a plane in no folder" 1 "$leafcast" render "$two" --iso 50 --progressive -o "$tmp/x.png" --depth-f64 "$tmp/no/z"
ok "leaves no first picture" [ ! -e "$tmp/x.png" ]
# The first one is seen: the exact one comes behind a plane that nobody reads from its pipe.
mkfifo "$tmp/plane"
exec 8<>"$tmp/plane"
"$leafcast" render "$two" --iso 50 --size 120x90 -o "$tmp/seen.png" --progressive --depth-f64 - >&8 2>"$tmp/log" &
child=$!
n=0
until [ -s "$tmp/seen.png" ] || [ $n -ge 200 ]; do
    n=$((n + 1))
    sleep 0.1
done
ok "a first picture has its name already" [ -s "$tmp/seen.png" ]
kill $child
wait $child || :
exec 8>&-

# Of a large volume, a preview reads little and draws a coarser level; the exact picture is the same as ever.
"$leafcast" generate noise --dims 256 -o "$tmp/large.nrrd" -q
exits "a large volume" 0 "$leafcast" convert "$tmp/large.nrrd" --compress none -o "$tmp/large.leaf" -q
exits "in a preview" 0 "$leafcast" render "$tmp/large.leaf" --iso 127.5 --size 64x48 --preview -o "$tmp/x.pfm" --force \
    --stats "$tmp/large.json" -q
ok "reads at most 8 MiB of it" python3 -c 'import json, sys
s = json.load(open(sys.argv[1]))
print(s["bytes"], s["provisional_pixels"])
sys.exit(not (s["bytes"]["active"] > 16 << 20 and s["bytes"]["read"] <= 8 << 20 and
              s["provisional_pixels"] == 64 * 48))' "$tmp/large.json"
exits "exact" 0 "$leafcast" render "$tmp/large.leaf" --iso 127.5 --size 64x48 -o "$tmp/x.png" --force -q
exits "exact behind a preview" 0 "$leafcast" render "$tmp/large.leaf" --iso 127.5 --size 64x48 --progressive -o "$tmp/y.png" -q
ok "is the same picture" cmp "$tmp/x.png" "$tmp/y.png"
finish
