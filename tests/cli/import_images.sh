#!/bin/sh
# import_images.sh - stacks of images through the importer: the samples and distances that tifffile and
# oiiotool read back; order of names; channels; slices that do not fit; broken files; budgets.
# marks: long plain leaks
. tests/support/tap.sh

if ! "$leafcast" --list-verbs | grep -qx import-images; then
    skip "leafcast import-images" "no OpenImageIO here"
    finish
fi
says() { grep -q -- "$1" "$tmp/err"; }
prints() { grep -qE -- "$1" "$tmp/out"; }
absent() { [ -z "$(find "$tmp" -name "$1*")" ]; }
header() { grep -aqx -- "$1" "$tmp/out.nrrd"; }
first_bytes() { # first_bytes BYTES SLICES: of each slice, which has so many
    tail -c "$(($1 * $2))" "$tmp/out.nrrd" | od -An -v -tu1 -w"$1" |
        awk '{ line = line (NR > 1 ? " " : "") $1 } END { print line }'
}

# ---- files without any library: PGM ----
mkdir "$tmp/stack"
for i in 1 2 3 9 10 11 100; do
    { printf 'P5 4 3 255\n'; printf "\\$(printf %o "$i")%.0s" 1 2 3 4 5 6 7 8 9 10 11 12; } >"$tmp/stack/img$i.pgm"
done
cp "$tmp/stack/img1.pgm" "$tmp/stack/.hidden.pgm"
echo "no image" >"$tmp/stack/notes.txt"
exits "a folder" 0 "$leafcast" import-images "$tmp/stack" -o "$tmp/out.nrrd" --force
ok "in the order in which people count" [ "$(first_bytes 12 7)" = "1 2 3 9 10 11 100" ]
ok "of a slice each" header "sizes: 4 3 7"
ok "at distances of 1" header 'space directions: (1,0,0) (0,1,0) (0,0,1)'
"$leafcast" import-images "$tmp/stack" | "$leafcast" convert - -o "$tmp/piped.leaf" --name s -q
exits "convert takes the folder" 0 "$leafcast" convert "$tmp/stack" -o "$tmp/pgms.leaf" --name s
ok "and says with what" grep -q 'PNM, read by leafcast import-images' "$tmp/err"
ok "with the same bytes" cmp -s "$tmp/piped.leaf" "$tmp/pgms.leaf"

# ---- colours, as one number each ----
{ printf 'P6 2 2 255\n'; printf '\377\000\001\000\002\000\003\000\000\377\377\377'; } >"$tmp/bytes.ppm"
{ printf 'P6 2 2 65535\n'; printf '\377\377\000\200\000\201\001\001\000\000\002\002%.0s' 1 2; } >"$tmp/words.ppm"
numbers() { tail -c "$1" "$tmp/out.nrrd" | od -An -v -tfF -w"$1" | tr -s ' '; }
exits "bytes" 0 "$leafcast" import-images "$tmp/bytes.ppm" --field rgb -o "$tmp/out.nrrd" --force
ok "are 65536 r + 256 g + b" [ "$(numbers 16)" = " 16711681 512 196608 16777215" ]
ok "terrain, to be draped" header 'leafcast terrain:=yes'
exits "16 bits" 0 "$leafcast" import-images "$tmp/words.ppm" --field rgb -o "$tmp/out.nrrd" --force
ok "are the nearest bytes" [ "$(numbers 16)" = " 16711681 65538 16711681 65538" ]
exits "grey images" 3 "$leafcast" import-images "$tmp/stack/img1.pgm" --field rgb -o "$tmp/none.nrrd"
ok "have no colours" says 'img1.pgm: page 0: expected red, green and blue of 8 or 16 bits: it has 1 channels of uint8'
exits "an image in place" 0 "$leafcast" convert "$tmp/bytes.ppm" --field rgb -q -o "$tmp/photo.leaf"
exits "keeps the name" 0 "$leafcast" info "$tmp/photo.leaf"
ok "by which it is draped" prints '^field *rgb$'

# A budget is the user's, of which the importer has half.
exits "convert with too little memory" 4 "$leafcast" convert "$tmp/stack" -o "$tmp/little.leaf" --memory 700K --threads 1
needed=$(sed -n 's/.* a memory budget of 0 MiB is too small: this input needs \([0-9]*\) MiB .*importer$/\1/p' "$tmp/err")
ok "what it needs is told ($needed)" [ -n "$needed" ]
exits "and does" 0 "$leafcast" convert "$tmp/stack" -o "$tmp/little.leaf" --memory "${needed}M" --threads 1 --name s
ok "the same bytes" cmp -s "$tmp/pgms.leaf" "$tmp/little.leaf"
exits "files that are named" 0 "$leafcast" import-images "$tmp/stack/img10.pgm" "$tmp/stack/img9.pgm" \
    "$tmp/stack/img100.pgm" -o "$tmp/out.nrrd" --force
ok "in the same order" [ "$(first_bytes 12 3)" = "9 10 100" ]
exits "--as-given" 0 "$leafcast" import-images "$tmp/stack/img10.pgm" "$tmp/stack/img9.pgm" \
    "$tmp/stack/img100.pgm" -o "$tmp/out.nrrd" --force --as-given
ok "as they are given" [ "$(first_bytes 12 3)" = "10 9 100" ]
exits "--spacing" 0 "$leafcast" import-images "$tmp/stack" --spacing 0.5,0.25,-2 -o "$tmp/out.nrrd" --force
ok "is in the map" header 'space directions: (0.5,0,0) (0,0.25,0) (0,0,-2)'
for bad in 1,2 0,1,1 1,1,x inf,1,1; do
    exits "--spacing $bad" 2 "$leafcast" import-images "$tmp/stack" --spacing $bad -o "$tmp/no.nrrd"
done
exits "a pipe" 0 sh -c "'$leafcast' import-images '$tmp/stack' | '$leafcast' convert - -o '$tmp/stack.leaf'"
exits "--list" 0 "$leafcast" import-images "$tmp/stack" --list
ok "says channels, sizes, type" prints '^Y +4 x 3 x 7 +u8$'

# ---- what is refused ----
refused() { # refused NAME CODE WORDS ARGUMENT...
    refused_words=$3
    refused_name=$1
    refused_code=$2
    shift 3
    exits "$refused_name" "$refused_code" "$leafcast" import-images "$@" -o "$tmp/refused.nrrd"
    ok "says so" says "$refused_words"
    ok "leaves nothing" absent refused
}
mkdir "$tmp/odd" "$tmp/none"
cp "$tmp/stack/img1.pgm" "$tmp/stack/img2.pgm" "$tmp/odd"
printf 'P5 3 4 255\n123456789012' >"$tmp/odd/img3.pgm"
refused "a slice of another size" 3 "img3.pgm: slice 2 .* 3 x 4 .* slice 0 has 4 x 3" "$tmp/odd"
printf 'P5 4 3 65535\n123456789012123456789012' >"$tmp/odd/img3.pgm"
refused "a slice of another type" 3 "img3.pgm: slice 2 .*u16; slice 0 .*u8" "$tmp/odd"
refused "a folder without images" 3 "no image in this folder" "$tmp/none"
refused "a file that is none" 3 "notes.txt" "$tmp/stack/notes.txt"
refused "a file that is not there" 1 "cannot open" "$tmp/nowhere.tif"
exits "one slice is no volume" 3 "$leafcast" convert "$tmp/stack/img1.pgm" -o "$tmp/one.leaf"
ok "which is told" grep -q "at least 2 on every axis (convert --heights" "$tmp/err"
exits "but terrain" 0 "$leafcast" convert --heights "$tmp/stack/img1.pgm" -o "$tmp/one.leaf"
refused "a channel that is not there" 2 "have 1" "$tmp/stack" --component 2
refused "a channel of no such name" 3 'no channel "heat"' "$tmp/stack" --field heat
refused "a step that is not there" 2 "step" "$tmp/stack" --step 1
refused "a slice beyond --memory" 4 "no room" "$tmp/stack" --memory 1K

# ---- broken copies: each is refused, or gives samples where a value alone was hit ----
cat >"$tmp/break.py" <<'PY'
import os, random, subprocess, sys
# libpng leaves OpenImageIO by longjmp() where a file ends, past strings that are freed by nobody.
os.environ["LSAN_OPTIONS"] = "detect_leaks=0"
leafcast, path, broken, count, seed = sys.argv[1:4] + [int(a) for a in sys.argv[4:6]]
random.seed(seed)
whole = open(path, "rb").read()
files = [broken] if path.endswith("tif") else [path, broken]
bad = errors = 0
for k in range(2 * count):
    data = bytearray(whole[: len(whole) * k // count] if k < count else whole)
    for i in range(0 if k < count else random.choice((1, 4, 16))):
        data[random.randrange(min(len(data), random.choice((100, 1000, 1 << 60))))] = random.randrange(256)
    with open(broken, "wb") as f:
        f.write(data)
    try:
        r = subprocess.run([leafcast, "import-images", *files, "--memory", "256M"], timeout=60,
                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        code, words = r.returncode, r.stderr
    except subprocess.TimeoutExpired:
        code, words = "a hang", b""
    errors += code != 0
    if code not in ((3, 4) if k < count else (0, 3, 4)) or (code and b"leafcast import-images: " not in words):
        bad += 1
        print("seed %d, copy %d: exit %s: %s" % (seed, k, code, words.decode(errors="replace")))
print("%d of %d refused" % (errors, 2 * count))
sys.exit(bad > 0 or errors < count)
PY

# ---- TIFF of tifffile ----
python=
for p in python3 /usr/bin/python3; do
    [ -n "$python" ] || ! "$p" -c 'import numpy, tifffile' 2>/dev/null || python=$p
done
if [ -z "$python" ]; then
    skip "stacks that tifffile wrote" "no python3-tifffile here"
    finish
fi
mkdir "$tmp/t"
cat >"$tmp/make.py" <<'PY'
import sys
import numpy as np, tifffile as t
folder = sys.argv[1] + "/"
r = np.random.default_rng(14)
def whole(kind, *shape):
    i = np.iinfo(kind)
    return r.integers(i.min, i.max, shape, dtype=kind, endpoint=True)
for kind in "u1 i1 u2 i2 u4 i4".split():
    t.imwrite(folder + kind + ".tif", whole(kind, 5, 11, 9))
for kind in "f2 f4 f8".split():
    t.imwrite(folder + kind + ".tif", r.normal(size=(5, 11, 9)).astype(kind))
t.imwrite(folder + "swapped.tif", whole("u2", 5, 11, 9), byteorder=">")
t.imwrite(folder + "big.tif", whole("u2", 7, 50, 40), bigtiff=True)
t.imwrite(folder + "bigswapped.tif", whole("i2", 7, 50, 40), bigtiff=True, byteorder=">")
t.imwrite(folder + "tiles.tif", whole("u2", 5, 50, 40), tile=(16, 32), compression="zlib")
t.imwrite(folder + "strips.tif", whole("u1", 5, 200, 40), rowsperstrip=7, compression="zlib")
t.imwrite(folder + "predict.tif", whole("u2", 5, 30, 40), compression="zlib", predictor=2)
t.imwrite(folder + "imagej.tif", whole("u2", 5, 11, 9), imagej=True, resolution=(2.0, 4.0),
          metadata={"spacing": 3.5, "unit": "um", "axes": "ZYX"})
t.imwrite(folder + "ome.tif", whole("u1", 5, 11, 9), ome=True,
          metadata={"axes": "ZYX", "PhysicalSizeX": 0.25, "PhysicalSizeY": 0.5, "PhysicalSizeZ": 2.0})
t.imwrite(folder + "cm.tif", whole("u1", 5, 11, 9), resolution=(100, 50), resolutionunit="CENTIMETER")
t.imwrite(folder + "inch.tif", whole("u1", 5, 11, 9), resolution=(100, 50), resolutionunit="INCH")
t.imwrite(folder + "rgb.tif", whole("u1", 5, 11, 9, 3), photometric="rgb")
t.imwrite(folder + "hyper.tif", whole("u2", 3, 4, 2, 11, 9), imagej=True, metadata={"axes": "TZCYX"})
t.imwrite(folder + "order.tif", whole("u2", 3, 2, 4, 11, 9), ome=True, metadata={"axes": "TCZYX"})
for i in range(12):
    t.imwrite(folder + "pair_%d.tif" % i, whole("u1", 2, 11, 9))
PY
exits "files of tifffile" 0 "$python" "$tmp/make.py" "$tmp/t"
cat >"$tmp/compare.py" <<'PY'
"""compare.py F.nrrd INDEX F.tif...: the samples that tifffile reads, at an index of the axes in front."""
import sys
import numpy as np, tifffile as t
head, raw = open(sys.argv[1], "rb").read().split(b"\n\n", 1)
f = dict(l.split(": ", 1) for l in head.decode().split("\n") if ": " in l)
kind = {"uint8": "u1", "int8": "i1", "uint16": "u2", "int16": "i2", "uint32": "u4", "int32": "i4",
        "float": "f4", "double": "f8"}[f["type"]]
got = np.frombuffer(raw, "<" + kind).reshape([int(n) for n in f["sizes"].split()][::-1])
want = np.concatenate([t.imread(p) for p in sys.argv[3:]])
want = eval("want[%s]" % sys.argv[2]) if sys.argv[2] else want
if want.dtype == np.float16:
    want = want.astype("f4")
sys.exit(0 if got.dtype == want.dtype.newbyteorder("=") and np.array_equal(got, want)
         else "%s %s, not %s %s" % (got.dtype, got.shape, want.dtype, want.shape))
PY
like() { # like NAME INDEX [ARGUMENT...]: what comes in is what tifffile reads
    like_name=$1
    like_index=$2
    shift 2
    exits "$like_name.tif${*:+, $*}" 0 "$leafcast" import-images "$tmp/t/$like_name.tif" -o "$tmp/out.nrrd" --force "$@"
    ok "has tifffile's samples" "$python" "$tmp/compare.py" "$tmp/out.nrrd" "$like_index" "$tmp/t/$like_name.tif"
}
for name in u1 i1 u2 i2 u4 i4 f2 f4 f8 swapped big bigswapped tiles strips predict; do
    like $name ""
done
like imagej ""
ok "ImageJ's distances" header 'space directions: (0.5,0,0) (0,0.25,0) (0,0,3.5)'
like ome ""
ok "OME's distances" header 'space directions: (0.25,0,0) (0,0.5,0) (0,0,2)'
like cm ""
ok "centimetres to millimetres" header 'space directions: (0.1,0,0) (0,0.2,0) (0,0,0.1)'
like inch ""
ok "inches to millimetres" header 'space directions: (0.254,0,0) (0,0.508,0) (0,0,0.254)'
like inch "" --spacing 1,2,3
ok "--spacing overrides them" header 'space directions: (1,0,0) (0,2,0) (0,0,3)'
like rgb "..., 1" --component 2
like rgb "..., 2" --field B
like hyper "0, :, 0"
like hyper "2, :, 1" --step 2 --component 2
like order "1, 1" --step 1 --component 2
exits "--list of steps" 0 "$leafcast" import-images "$tmp/t/hyper.tif" --list --json
ok "counts them" grep -q '"shape"' "$tmp/out"
ok "as the fourth" [ "$(tr -d ' \n' <"$tmp/out" | grep -c '\[9,11,4,3\]')" = 1 ]
refused "a step beyond them" 2 "has 3" "$tmp/t/hyper.tif" --step 3
refused "a channel beyond them" 2 "has 2" "$tmp/t/hyper.tif" --component 3
set --
for i in 0 1 2 3 4 5 6 7 8 9 10 11; do set -- "$@" "$tmp/t/pair_$i.tif"; done
exits "files of two pages each" 0 "$leafcast" import-images "$tmp"/t/pair_*.tif -o "$tmp/out.nrrd" --force
ok "are slices one after another" "$python" "$tmp/compare.py" "$tmp/out.nrrd" "" "$@"
for name in imagej tiles big; do
    exits "broken copies of $name.tif" 0 python3 "$tmp/break.py" "$leafcast" "$tmp/t/$name.tif" \
        "$tmp/broken.tif" 17 "${SEED:-14}"
done
mkdir "$tmp/folder"
cp "$tmp"/t/pair_?.tif "$tmp/folder"
exits "convert takes a folder" 0 "$leafcast" convert "$tmp/folder" -o "$tmp/folder.leaf"

# ---- one slice at a time: 256 slices of 256 KiB, 64 MiB, in a tenth of that beside the library ----
"$python" -c 'import sys, numpy as np, tifffile as t
with t.TiffWriter(sys.argv[1]) as w:
    for z in range(256): w.write(np.full((512, 512), z, "u1"), contiguous=False)' "$tmp/long.tif"
exits "a long stack in --memory 1M" 0 "$leafcast" import-images "$tmp/long.tif" --memory 1M -o "$tmp/out.nrrd" --force
ok "is all there" "$python" -c 'import sys, numpy as np
v = np.fromfile(sys.argv[1], "u1")[-(256 << 18):].reshape(256, -1)
sys.exit(not np.array_equal(v, np.arange(256, dtype="u1")[:, None] + 0 * v))' "$tmp/out.nrrd"

# ---- other formats: oiiotool writes them, and as TIFF, which tifffile reads ----
if ! command -v oiiotool >/dev/null; then
    skip "images that oiiotool wrote" "no oiiotool here"
    finish
fi
for k in 1 2; do
    noise="--pattern noise:type=uniform:seed=$k 64x48 3"
    # shellcheck disable=SC2086 # arguments
    oiiotool $noise -d uint8 -o "$tmp/j$k.jpg" -o "$tmp/k$k.png" -d uint16 -o "$tmp/p$k.png" \
        -d float -o "$tmp/f$k.exr" -d half -o "$tmp/e$k.exr" --tile 16 16 -o "$tmp/t$k.exr"
    for name in j$k.jpg k$k.png p$k.png f$k.exr e$k.exr t$k.exr; do
        oiiotool "$tmp/$name" --tile 0 0 --planarconfig contig --compression none -o "$tmp/$name.tif"
    done
done
cat >"$tmp/channels.py" <<'PY'
"""channels.py F.nrrd C F...: channel C (3: luminance) of images, as TIFFs of the same have it."""
import sys
import numpy as np, tifffile as t
head, raw = open(sys.argv[1], "rb").read().split(b"\n\n", 1)
f = dict(l.split(": ", 1) for l in head.decode().split("\n") if ": " in l)
got = np.frombuffer(raw, {"uint8": "u1", "uint16": "u2", "float": "f4"}[f["type"]])
c = int(sys.argv[2])
want = np.stack([t.imread(p + ".tif") for p in sys.argv[3:]])
if want.dtype == np.float16:
    want = want.astype("f4")
if c < 3:
    sys.exit(0 if got.dtype == want.dtype and np.array_equal(got, want[..., c].ravel()) else "differ")
y = (want.astype("f8") @ np.array([0.2126, 0.7152, 0.0722])).ravel()
sys.exit(0 if np.abs(got - y).max() <= (1e-6 if got.dtype == "f4" else 0.5000001) else "differ")
PY
for kind in j.jpg k.png p.png f.exr e.exr t.exr; do
    set -- "$tmp/${kind%.*}1.${kind#*.}" "$tmp/${kind%.*}2.${kind#*.}"
    exits "$kind: luminance" 0 "$leafcast" import-images "$@" -o "$tmp/out.nrrd" --force
    ok "is Rec. 709's of what is stored" "$python" "$tmp/channels.py" "$tmp/out.nrrd" 3 "$@"
    exits "$kind: --component 1" 0 "$leafcast" import-images "$@" --component 1 -o "$tmp/out.nrrd" --force
    ok "is red" "$python" "$tmp/channels.py" "$tmp/out.nrrd" 0 "$@"
done
exits "--field B" 0 "$leafcast" import-images "$@" --field B -o "$tmp/out.nrrd" --force
ok "is blue" "$python" "$tmp/channels.py" "$tmp/out.nrrd" 2 "$@"
for name in j1.jpg p1.png t1.exr; do
    exits "broken copies of $name" 0 python3 "$tmp/break.py" "$leafcast" "$tmp/$name" \
        "$tmp/broken.${name#*.}" 17 "${SEED:-14}"
done
oiiotool --pattern noise:type=uniform 16x12 5 --chnames a,b,c,d,e -d half -o "$tmp/c1.exr" -o "$tmp/c2.exr"
refused "channels that are no colours" 3 "its channels are no colours: .*; --component" "$tmp/c1.exr" "$tmp/c2.exr"
exits "but one of them" 0 "$leafcast" import-images "$tmp/c1.exr" "$tmp/c2.exr" --field d -o "$tmp/out.nrrd" --force
finish
