#!/bin/sh
# in_place_tiff.sh - treelet files that leave the samples of level 0 in the pages of a TIFF: the same samples and
# pictures as of a file with all, whatever the pages; what stays refused, by name; pages that change or cannot be.
# marks: long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
python=$(python_with numpy)
if [ -z "$python" ] || ! "$leafcast" import-images --help >/dev/null 2>&1; then
    skip "TIFF in place" "no python3-numpy, or no leafcast import-images here"
    finish
fi
in=$tmp/in
mkdir "$in"
cat >"$tmp/make.py" <<'PY'
import sys
sys.path.insert(0, "tests/support")
from write_tiff import *
folder = sys.argv[1] + "/in/"
def put(name, pages, options="", listed=True, **more):
    write(folder + name + ".tif", pages, **more)
    if listed:
        print(name, options)
for i, kind in enumerate("u2 f4 i4 u1 i2 f8 i1 u4 f2".split()):
    a = made(kind, 38, 37, 41)
    big = bool(i & 1)
    forms = [("whole", dict(big_endian=big, big=not big)),                        # one piece, x fastest
             ("strips", dict(rows=5, big_endian=not big, gap=3)),                 # the last one is lower
             ("packed", dict(rows=8, compression=8, big_endian=not big)),
             ("predicted", dict(rows=(7, 37, 1)[i % 3], compression=(8, 32946, 34925)[i % 3], predictor=2, big_endian=big)),
             ("tiles", dict(tile=(16, 32), big_endian=big, big=big)),
             ("predicted_tiles", dict(tile=(32, 16), compression=8, predictor=2, big_endian=not big))]
    for j, (form, how) in enumerate(forms):
        if (i == 0 or j % 3 == i % 3 or (kind == "f8" and j < 4)) and not (kind == "f8" and "tile" in how):
            put(form + "_" + kind, a, **how)
a = made("u2", 38, 37, 41)
put("apart", a, apart=True)
put("backwards", a, backwards=True)
put("strips_in_turn", a, rows=5)                     # strips without gaps: one piece again
few = 4  # pages, as each is large
put("long", made("u2", few, 3, 90000), rows=3, gap=2) # parts of a strip: rows
put("high", made("f4", few, 4000, 33), rows=4000, apart=True)
put("many_rows", made("f8", few, 3000, 40), rows=1500, gap=1)
put("whole_last", a, rows=10, compression=8, whole=True)
put("whole_last_raw", a, rows=10, whole=True)
put("zstd", a, rows=11, compression=50000)
put("rows_not_told", a, drop=(278,), apart=True)
put("upside_down", a, rows=7, gap=1, tags=[(274, 3, 4)])
rgb = made("u1", 38, 37, 41, 3)
put("one_of_rgb", rgb, "--component 2", rows=6)
put("one_of_rgb_planes", rgb, "--component 3", rows=6, planar=True)
put("one_of_rgb_packed", rgb, "--component 1", rows=6, compression=8, predictor=2, big_endian=True)
put("one_of_planes_tiles", made("i2", 38, 37, 41, 3), "--component 2", tile=(16, 16), planar=True, compression=8, predictor=2)
put("luminance", made("f4", 38, 37, 41, 3), rows=6, gap=4)
put("luminance_planes", made("f4", 38, 37, 41, 3), rows=6, planar=True, compression=8, predictor=2)
put("luminance_f8", made("f8", 38, 37, 41, 4), rows=4, big_endian=True)
put("luminance_f2", made("f2", 38, 37, 41, 3), rows=37)
put("alpha", made("u2", 38, 37, 41, 2), rows=9, tags=[(338, 3, 1)])
text = b"ImageJ=1.53\nimages=76\nchannels=2\nslices=38\nhyperstack=true\n\0"
two = made("u2", 76, 37, 41)
put("hyper", two, "--component 2", rows=37, tags=[(270, 2, text)])
text = b"ImageJ=1.53\nimages=76\nslices=38\nframes=2\nhyperstack=true\n\0"
put("steps", two, "--step 1", compression=8, rows=10, tags=[(270, 2, text)])
put("steps_whole", two, "--step 1", tags=[(270, 2, text)])
ome = (b'<?xml version="1.0"?><OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06"><Image ID="Image:0"><Pixels ID="Pixels:0" '
       b'DimensionOrder="XYCTZ" Type="uint16" SizeX="41" SizeY="37" SizeC="2" SizeZ="38" SizeT="1" PhysicalSizeX="2"/></Image></OME>\0')
put("ome", two, "--component 2", rows=8, big_endian=True, tags=[(270, 2, ome)])
# What stays refused.
put("white", a, listed=False, tags=[(262, 3, 0)])
put("turned_bits", made("u1", 38, 37, 41), listed=False, tags=[(266, 3, 2)])
put("colours", rgb, listed=False)
put("palette", made("u1", 38, 37, 41), listed=False, tags=[(262, 3, 3), (320, 3, [i % 256 * 256 for i in range(768)])])
put("double_tiles", made("f8", 38, 37, 41), listed=False, tile=(16, 16))
put("lzw", a, listed=False)
put("half_way", made("u4", 38, 37, 41), listed=False, rows=9, gap=2)
put("hostile", a, listed=False, rows=5, compression=8, predictor=2)
put("uneven", a, listed=False, rows=5, compression=8, predictor=2) # page 20 without differences
data = bytearray(open(folder + "uneven.tif", "rb").read())
at = struct.unpack_from("<I", data, 4)[0]
for page in range(38):
    n = struct.unpack_from("<H", data, at)[0]
    for e in range(n):
        tag = struct.unpack_from("<H", data, at + 2 + 12 * e)[0]
        if tag == 317 and page == 20:
            struct.pack_into("<H", data, at + 2 + 12 * e + 8, 1)
    at = struct.unpack_from("<I", data, at + 2 + 12 * n)[0]
open(folder + "uneven.tif", "wb").write(data)
PY
"$python" "$tmp/make.py" "$tmp" >"$tmp/list" || ok "files to read" false

# pair NAME OPTIONS... - NAME.tif as $tmp/NAME.leaf, in place, and $tmp/all.leaf: what they draw and tell. -q: what else
# there is to choose is not looked for, which saves a start of the importer, half a second each.
pair() {
    name=$1
    shift
    exits "$name: in place" 0 "$leafcast" convert "$in/$name.tif" -o "$tmp/$name.leaf" -q --in-place --force "$@" --threads 3
    exits "$name: sound" 0 "$leafcast" verify "$tmp/$name.leaf"
    one_in 4 || return 0 # export and render read samples as verify does
    run "$leafcast" convert "$in/$name.tif" -o "$tmp/all.leaf" -q --compress zstd --force "$@"
    [ "$rc" = 0 ] || ok "$name: with all samples" false
    for file in "$name" all; do
        run "$leafcast" export "$tmp/$file.leaf" -o "$tmp/$file.raw" --format raw --force
        [ "$rc" = 0 ] || ok "$name: export of $file" false
        run "$leafcast" render "$tmp/$file.leaf" -o "$tmp/$file.ppm" --size $picture --tf auto --force --memory 40M --threads 4
        [ "$rc" = 0 ] || ok "$name: render of $file" false
    done
    for what in raw ppm; do
        ok "$name, $what: the same" cmp "$tmp/$name.$what" "$tmp/all.$what"
    done
}
told="whole_u2 whole_f8 strips_in_turn steps_whole strips_u2 tiles_u2 long high many_rows luminance_planes"
while read -r name options; do
    one_in 5 "$name" "$told one_of_rgb_planes packed_u2" || continue # all forms of pages are among those told of below
    # shellcheck disable=SC2086
    pair "$name" $options
done <"$tmp/list"
ok "these were $(wc -l <"$tmp/list") stacks" [ "$(wc -l <"$tmp/list")" -gt 45 ]

# ---- one piece, or chunks ----

table() { od -An -tu4 -j 1500 -N4 "$tmp/$1.leaf" | tr -d ' '; } # entries of its table of chunks
for name in whole_u2 whole_f8 strips_in_turn steps_whole; do
    ok "$name: one piece" [ "$(table $name)" = 0 ]
done
ok "strips: so many chunks" [ "$(table strips_u2)" = $((38 * 8)) ]
ok "tiles: so many" [ "$(table tiles_u2)" = $((38 * 3 * 2)) ]
ok "rows of 180 KB: one each" [ "$(table long)" = $((4 * 3)) ]
ok "one strip of 528 KB: parts of 497 rows" [ "$(table high)" = $((4 * 9)) ]
ok "strips of 480 KB: parts of 150 of 1500 rows" [ "$(table many_rows)" = $((4 * 20)) ]
ok "all channels" [ "$(table luminance_planes)" = $((38 * 7 * 3)) ]
ok "one of three" [ "$(table one_of_rgb_planes)" = $((38 * 7)) ]
exits "info" 0 "$leafcast" info "$tmp/packed_u2.leaf"
ok "says in which file level 0 is" grep -q "level 0  *in place, in .*in/packed_u2.tif$" "$tmp/out"

# ---- what stays refused ----

refused() {
    exits "$1: refused" 3 "$leafcast" convert "$in/$1" -o "$tmp/r.leaf" -q --in-place
    ok "$1: told" says "$1: $2"
    ok "$1: nothing is left" [ ! -e "$tmp/r.leaf" ]
}
converted() {
    exits "$1: converted otherwise" 0 "$leafcast" convert "$in/$1" -o "$tmp/r.leaf" -q --force
    rm -f "$tmp/r.leaf"
}
stays="--in-place: it cannot stay as it is stored"
refused white.tif "$stays: white is zero"
refused turned_bits.tif "$stays: bits from right to left"
refused colours.tif "$stays: the luminance of colours is rounded to whole numbers"
refused palette.tif "$stays: colours of a palette"
refused uneven.tif "$stays: page 20 is stored in another way"
for name in white turned_bits colours palette uneven; do
    converted $name.tif
done
refused double_tiles.tif "page 0 has tiles of doubles, of which the library makes zeros"
if command -v tiffcp >/dev/null && tiffcp -c lzw "$in/lzw.tif" "$in/in_lzw.tif"; then
    refused in_lzw.tif "$stays: LZW"
    converted in_lzw.tif
else
    skip "LZW" "no tiffcp here"
fi

# ---- a file that changes ----

cp "$in/half_way.tif" "$tmp/c.tif"
run "$leafcast" convert "$tmp/c.tif" -o "$tmp/c.leaf" -q --in-place
touch -r "$tmp/c.tif" "$tmp/time"
touch -d '2001-01-01' "$tmp/c.tif"
exits "another time: refused" 3 "$leafcast" verify "$tmp/c.leaf"
ok "by name" says "c.tif: has another time than when"
printf 'XXXX' | dd of="$tmp/c.tif" bs=1 seek=60000 conv=notrunc 2>/dev/null
touch -r "$tmp/time" "$tmp/c.tif"
exits "other samples: refused" 3 "$leafcast" verify "$tmp/c.leaf"
ok "by name" says "c.tif: chunk.* the samples of treelet"

# ---- hostile files: refused by name, or read as a whole conversion does ----

cat >"$tmp/break.py" <<'PY'
import random, subprocess, sys
leafcast, source, folder, count, seed = sys.argv[1:4] + [int(a) for a in sys.argv[4:6]]
random.seed(seed)
whole = open(source, "rb").read()
wrong = refused = 0
words = [0, 1, 255, 65535, 2**31 - 1, 2**31, 2**32 - 1]
def call(*words):
    r = subprocess.run([leafcast, *words], timeout=100, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    return r.returncode, r.stderr.decode(errors="replace")
for k in range(count):
    data = bytearray(whole)
    for i in range(random.choice((1, 1, 3))):
        at = random.randrange(len(data) - 4)
        if k % 3:   # the directories are behind the data
            at = random.randrange(len(data) * 3 // 4, len(data) - 4)
        data[at:at + 4] = random.choice((random.choice(words), random.randrange(len(data)))).to_bytes(4, "little")
    if k % 7 == 0:
        del data[random.randrange(len(data)):]
    with open(folder + "/broken.tif", "wb") as f:
        f.write(data)
    code, said = call("convert", folder + "/broken.tif", "-o", folder + "/broken.leaf", "-q", "--in-place", "--force", "--memory", "256M")
    refused += code != 0
    if code not in (0, 3, 4) or (code and "broken.tif" not in said):
        wrong += 1
        print("copy %d: exit %s: %s" % (k, code, said))
    if code == 0:
        code, said = call("verify", folder + "/broken.leaf")
        if code != 0:
            wrong += 1
            print("copy %d: verify: exit %s: %s" % (k, code, said))
print("%d of %d refused" % (refused, count))
sys.exit(wrong > 0 or refused < count // 5)
PY
for name in hostile half_way; do
    exits "$name: broken copies" 0 "$python" "$tmp/break.py" "$leafcast" "$in/$name.tif" "$tmp" 10 7
done
finish
