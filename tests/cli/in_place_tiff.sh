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
cat >"$tmp/tiff.py" <<'PY'
import ctypes, lzma, struct, sys, zlib
import numpy as np

def zstd(data):
    z = ctypes.CDLL("libzstd.so.1")
    z.ZSTD_compressBound.restype = z.ZSTD_compress.restype = ctypes.c_size_t
    room = ctypes.create_string_buffer(z.ZSTD_compressBound(ctypes.c_size_t(len(data))))
    size = z.ZSTD_compress(room, ctypes.c_size_t(len(room)), data, ctypes.c_size_t(len(data)), 3)
    return room.raw[:size]

PACK = {1: lambda b: b, 8: zlib.compress, 32946: zlib.compress, 34925: lzma.compress, 50000: zstd}

def pieces_of(page, rows, tile, planar, whole):
    """Strips or tiles of a page (y, x, channel), plane by plane."""
    planes = [page[:, :, c:c + 1] for c in range(page.shape[2])] if planar else [page]
    for p in planes:
        if tile:
            ty, tx = tile
            full = np.full((-(-p.shape[0] // ty) * ty, -(-p.shape[1] // tx) * tx, p.shape[2]), 77, p.dtype)
            full[:p.shape[0], :p.shape[1]] = p
            for y in range(0, full.shape[0], ty):
                for x in range(0, full.shape[1], tx):
                    yield full[y:y + ty, x:x + tx]
        else:
            for y in range(0, p.shape[0], rows):
                strip = p[y:y + rows]
                if whole and len(strip) < rows:
                    strip = np.concatenate([strip, np.full((rows - len(strip),) + strip.shape[1:], 9, p.dtype)])
                yield strip

def write(path, pages, rows=None, tile=None, planar=False, big_endian=False, big=False, compression=1, predictor=1,
          gap=0, apart=False, whole=False, tags=(), backwards=False, drop=()):
    """pages: (z, y, x) or (z, y, x, channel). gap: bytes between pieces. apart: directories between pages' data.
    whole: the last strip is as high as the others. tags: (tag, type, value) to add, or to put in place of others.
    backwards: pages lie in the file from the last to the first."""
    if pages.ndim == 3:
        pages = pages[..., None]
    order = ">" if big_endian else "<"
    kind = pages.dtype.kind
    out = bytearray((b"MM" if big_endian else b"II") +
                    (struct.pack(order + "HHHQ", 43, 8, 0, 0) if big else struct.pack(order + "HI", 42, 0)))
    count, height, width, channels = pages.shape
    rows = rows or height
    found = [None] * count
    for z in (range(count - 1, -1, -1) if backwards else range(count)):
        found[z] = []
        for piece in pieces_of(pages[z], rows, tile, planar, whole):
            if predictor == 2:
                bits = piece.view("u%d" % piece.dtype.itemsize)
                piece = bits.copy()
                piece[:, 1:] -= bits[:, :-1]
            data = PACK[compression](piece.astype(piece.dtype.newbyteorder(order)).tobytes())
            found[z].append((len(out), len(data)))
            out += data + b"\xaa" * gap
        if apart:
            out += b"\xbb" * 51
    link = 8 if big else 4
    for z in range(count):
        entries = {256: (4, [width]), 257: (4, [height]), 258: (3, [8 * pages.dtype.itemsize] * channels),
                   259: (3, [compression]), 262: (3, [2 if channels >= 3 else 1]), 277: (3, [channels]),
                   284: (3, [2 if planar else 1]), 339: (3, [{"u": 1, "i": 2, "f": 3}[kind]] * channels)}
        if channels == 4:
            entries[338] = 3, [2]
        if predictor != 1:
            entries[317] = 3, [predictor]
        offsets, sizes = [[f[i] for f in found[z]] for i in (0, 1)]
        wide = 16 if big else 4
        if tile:
            entries.update({322: (3, [tile[1]]), 323: (3, [tile[0]]), 324: (wide, offsets), 325: (4, sizes)})
        else:
            entries.update({278: (4, [rows]), 273: (wide, offsets), 279: (4, sizes)})
        for tag, type_, value in tags:
            entries[tag] = type_, (list(value) if isinstance(value, (list, tuple, bytes)) else [value])
        for tag in drop:
            entries.pop(tag, None)
        if len(out) % 2:
            out += b"\0"
        body = b""
        codes = {1: "B", 2: "B", 3: "H", 4: "I", 16: "Q"}
        for tag in sorted(entries):
            type_, values = entries[tag]
            data = struct.pack(order + "%d%s" % (len(values), codes[type_]), *values)
            if len(data) > link:
                at = len(out)
                out += data + b"\0" * (len(data) % 2)
                data = struct.pack(order + ("Q" if big else "I"), at)
            body += struct.pack(order + ("HHQ" if big else "HHI"), tag, type_, len(values)) + data.ljust(link, b"\0")
        at = len(out)
        where = 8 if big and z == 0 else 4 if z == 0 else linked
        out[where:where + link] = struct.pack(order + ("Q" if big else "I"), at)
        out += struct.pack(order + ("Q" if big else "H"), len(entries)) + body
        linked = len(out)
        out += b"\0" * link
    with open(path, "wb") as f:
        f.write(out)

def made(kind, *shape, seed=5):
    """Numbers of a kind: smooth ones with noise, which have all bits."""
    r = np.random.default_rng(seed)
    if kind[0] == "f":
        return (np.cumsum(r.normal(size=shape), 2) * (0.01 if kind == "f2" else 3)).astype(kind)
    top = np.iinfo(kind)
    a = np.cumsum(r.integers(-3, 4, shape), 2) * (1 if kind[1] == "1" else top.max // 400) + 60
    return np.where(r.random(shape) < 0.01, top.min, np.clip(a, top.min, top.max)).astype(kind)
PY
cat >"$tmp/make.py" <<'PY'
import sys
sys.path.insert(0, sys.argv[1])
from tiff import *
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
put("long", made("u2", 34, 3, 90000), rows=3, gap=2) # parts of a strip: rows
put("high", made("f4", 34, 4000, 33), rows=4000, apart=True)
put("many_rows", made("f8", 34, 3000, 40), rows=1500, gap=1)
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

# pair NAME OPTIONS... - NAME.tif as $tmp/NAME.leaf, in place, and $tmp/all.leaf: what they draw and tell.
pair() {
    name=$1
    shift
    exits "$name: in place" 0 "$leafcast" convert "$in/$name.tif" -o "$tmp/$name.leaf" --in-place --force "$@" --threads 3
    run "$leafcast" convert "$in/$name.tif" -o "$tmp/all.leaf" --compress zstd --force "$@"
    [ "$rc" = 0 ] || ok "$name: with all samples" false
    for file in "$name" all; do
        run "$leafcast" export "$tmp/$file.leaf" -o "$tmp/$file.raw" --format raw --force
        [ "$rc" = 0 ] || ok "$name: export of $file" false
        run "$leafcast" render "$tmp/$file.leaf" -o "$tmp/$file.ppm" --size 80x70 --tf auto --force --memory 40M --threads 4
        [ "$rc" = 0 ] || ok "$name: render of $file" false
    done
    for what in raw ppm; do
        ok "$name, $what: the same" cmp "$tmp/$name.$what" "$tmp/all.$what"
    done
    exits "$name: sound" 0 "$leafcast" verify "$tmp/$name.leaf"
}
while read -r name options; do
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
ok "rows of 180 KB: one each" [ "$(table long)" = $((34 * 3)) ]
ok "one strip of 528 KB: parts of 497 rows" [ "$(table high)" = $((34 * 9)) ]
ok "strips of 480 KB: parts of 150 of 1500 rows" [ "$(table many_rows)" = $((34 * 20)) ]
ok "all channels" [ "$(table luminance_planes)" = $((38 * 7 * 3)) ]
ok "one of three" [ "$(table one_of_rgb_planes)" = $((38 * 7)) ]
exits "info" 0 "$leafcast" info "$tmp/packed_u2.leaf"
ok "says in which file level 0 is" grep -q "level 0  *in place, in .*in/packed_u2.tif$" "$tmp/out"

# ---- what stays refused ----

refused() {
    exits "$1: refused" 3 "$leafcast" convert "$in/$1" -o "$tmp/r.leaf" --in-place
    ok "$1: told" says "$1: $2"
    ok "$1: nothing is left" [ ! -e "$tmp/r.leaf" ]
}
converted() {
    exits "$1: converted otherwise" 0 "$leafcast" convert "$in/$1" -o "$tmp/r.leaf" --force
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
mkdir "$in/folder" "$in/slices"
cp "$in/whole_u2.tif" "$in/folder"
refused folder "$stays: it is a folder: name the TIFF in it"
cp "$in/whole_u2.tif" "$in/slices/1.tif"
cp "$in/whole_u2.tif" "$in/slices/2.tif"
refused slices "$stays: its slices are files of their own"
converted slices

# ---- a file that changes ----

cp "$in/half_way.tif" "$tmp/c.tif"
run "$leafcast" convert "$tmp/c.tif" -o "$tmp/c.leaf" --in-place
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
    code, said = call("convert", folder + "/broken.tif", "-o", folder + "/broken.leaf", "--in-place", "--force", "--memory", "256M")
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
