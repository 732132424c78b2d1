#!/bin/sh
# in_place.sh - treelet files that leave the samples of level 0 in the input (convert --in-place): the same samples and
# pictures as of a file with all, whatever the format; an input that is no longer the same is refused.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
differ() { ! cmp -s "$1" "$2"; }
size() { wc -c <"$1"; }

# ---- inputs ----

in=$tmp/in
mkdir "$in"
for type in u8 u16 f32; do
    run "$leafcast" generate noise --dims 70,45,39 --type $type -o "$in/$type.nrrd"
    run "$leafcast" convert "$in/$type.nrrd" -o "$tmp/$type.leaf"
    for form in npy mha vti nii; do
        run "$leafcast" export "$tmp/$type.leaf" -o "$in/$type.$form"
    done
done
# Forms that nothing here writes: other byte orders and types, several numbers a sample, slopes, steps.
python3 - "$in" <<'PY'
import random, struct, sys
folder = sys.argv[1] + "/"
random.seed(3)
dims = 41, 38, 35
n = dims[0] * dims[1] * dims[2]
def write(name, text, data):
    with open(folder + name, "wb") as f:
        f.write((text.encode() if isinstance(text, str) else text) + data)
def nrrd(name, type, data, sizes="41 38 35", more="", order="big"):
    write(name, f"NRRD0004\ntype: {type}\ndimension: {len(sizes.split())}\nsizes: {sizes}\nencoding: raw\n"
          f"endian: {order}\n{more}\n", data)
whole = [random.randrange(-900, 900) for _ in range(n)]
real = [random.gauss(0, 10) for _ in range(n)]
big16 = struct.pack(f">{n}h", *whole)
nrrd("big_i16.nrrd", "int16", big16)
nrrd("f64.nrrd", "double", struct.pack(f">{n}d", *real))
nrrd("i32.nrrd", "int32", struct.pack(f"<{n}i", *whole), order="little")
nrrd("u64.nrrd", "uint64", struct.pack(f">{n}Q", *[abs(x) for x in whole]))
nrrd("rgb.nrrd", "uint8", bytes(random.randrange(256) for _ in range(3 * n)), "3 41 38 35", "kinds: RGB-color space space space\n")
nrrd("vector.nrrd", "float", struct.pack(f">{3 * n}f", *[random.gauss(0, 1) for _ in range(3 * n)]), "3 41 38 35", "kinds: vector space space space\n")
nrrd("steps.nrrd", "uint8", bytes(random.randrange(256) for _ in range(4 * n)), "41 38 35 4", "kinds: space space space time\n")
write("detached.raw", b"a head of 17 bytes"[:17], big16)
write("detached.nhdr", "NRRD0004\ntype: int16\ndimension: 3\nsizes: 41 38 35\nencoding: raw\nendian: big\nbyte skip: 17\ndata file: detached.raw\n\n", b"")
write("plain.raw", b"", big16)
head = bytearray(352)
struct.pack_into(">i", head, 0, 348)
struct.pack_into(">8h", head, 40, 3, 41, 38, 35, 1, 1, 1, 1)
struct.pack_into(">2h", head, 70, 4, 16)
struct.pack_into(">8f", head, 76, 1, 1, 1, 1, 0, 0, 0, 0)
struct.pack_into(">3f", head, 108, 352, 0.25, -7)
head[344:348] = b"n+1\0"
write("slope.nii", bytes(head), big16)
nrrd("holes.nrrd", "float", struct.pack(f">{n}f", *[x if x > -8 else float("nan") for x in real]))
def legacy(name, dims, count, type, data):
    write(name, f"# vtk DataFile Version 3.0\nt\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS {dims}\nORIGIN 0 0 0\n"
          f"SPACING 1 1 1\nPOINT_DATA {count}\nSCALARS s {type} 1\nLOOKUP_TABLE default\n", data)
legacy("legacy.vtk", "41 38 35", n, "short", big16)
write("packed.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: gzip\n\n", __import__("gzip").compress(bytes(512)))
write("text.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 3 3\nencoding: text\n\n", b"1 2 3 " * 9)
nrrd("turned.nrrd", "uint8", bytes(3 * n), "38 35 41 3", "kinds: space space space vector\n")
PY

# ---- the same as with all samples ----

# pair NAME INPUT OPTIONS... - $tmp/NAME.leaf, in place, and $tmp/all.leaf.
pair() {
    name=$1
    input=$2
    shift 2
    exits "$name: in place" 0 "$leafcast" convert "$in/$input" -o "$tmp/$name.leaf" --in-place "$@" --threads 3
    exits "$name: sound" 0 "$leafcast" verify "$tmp/$name.leaf"
    one_in 4 || return 0 # export and render read samples as verify does
    run "$leafcast" convert "$in/$input" -o "$tmp/all.leaf" --compress zstd --force "$@"
    # Coarse levels and the directory: smooth ones much less.
    ok "$name: $(size "$tmp/$name.leaf") bytes are an index" [ "$(size "$tmp/$name.leaf")" -lt "$(size "$tmp/all.leaf")" ]
    for what in "export raw" "export raw --level 1" "render depth" "render tf"; do
        case $what in
        export*)
            set -- export -o
            ;;
        render*) set -- render -o ;;
        esac
        case $what in
        *"--level 1") more="--level 1 --format raw" ;;
        export*) more="--format raw" ;;
        *depth) more="--size $picture --format ppm --depth-f64 $tmp/depth.bin" ;;
        *) more="--size $picture --format ppm --tf auto" ;;
        esac
        for file in "$name" all; do
            # shellcheck disable=SC2086 # split on purpose
            run "$leafcast" "$1" "$tmp/$file.leaf" -o "$tmp/$file.bin" --force $more
            [ "$rc" = 0 ] || ok "$name: $what of $file" false
            case $what in *depth) mv "$tmp/depth.bin" "$tmp/$file.depth" ;; esac
        done
        ok "$name, $what: the same" cmp "$tmp/$name.bin" "$tmp/all.bin"
        case $what in *depth) ok "$name: and the same depths" cmp "$tmp/$name.depth" "$tmp/all.depth" ;; esac
    done
}
for type in u8 u16 f32; do
    for form in nrrd npy mha vti nii; do
        one_in 3 "$type" u8 || continue # how formats tell their types is seen elsewhere
        pair ${type}_$form $type.$form
    done
done
pair big_i16 big_i16.nrrd
pair f64 f64.nrrd
pair i32 i32.nrrd
pair u64 u64.nrrd
pair rgb rgb.nrrd
pair one_of_rgb rgb.nrrd --component 2
pair vector vector.nrrd
pair step steps.nrrd --step 2
pair detached detached.nhdr
pair raw plain.raw --dims 41,38,35 --type i16 --big-endian
pair slope slope.nii
pair legacy legacy.vtk
pair missing big_i16.nrrd --missing 12
pair holes holes.nrrd
pair holes_too holes.nrrd --missing 1
pair treelets u8.nrrd --treelet 16 --halo 0
pair wide u16.nrrd --treelet 64 --compress zstd:9 --spacing 1,2,3 --name else

# ---- data sets of HDF5 that are one piece of their file ----

python=$(python_with h5py)
if [ -z "$python" ]; then
    skip "HDF5" "no python3-h5py here"
else
    "$python" - "$in" <<'PY'
import sys, h5py, numpy
folder = sys.argv[1] + "/"
a = (numpy.random.default_rng(1).random((40, 37, 41)) * 200).astype("u1")
def write(name, samples, attributes={}, **more):
    block = {"userblock_size": more.pop("block")} if "block" in more else {}
    with h5py.File(folder + name + ".h5", "w", **block) as f:
        d = f.create_dataset("d", data=samples, **more)
        d.attrs.update(attributes)
for name in "<i2", ">i2", "<f4", ">f8", "<u4":
    write("whole" + name[1:] + "lb"[name[0] == ">"], a.astype(name))
write("series", numpy.stack([a, a[::-1], a[:, ::-1]]))
write("behind", a, block=1024)
write("scaled", a, {"scale_factor": 0.5})
write("filled", a, {"_FillValue": numpy.uint8(7)})
write("half", a.astype("<f2"))
PY
    for name in wholei2l wholei2b wholef4l wholef8b wholeu4l behind; do
        pair h5_$name $name.h5
    done
    pair h5_step series.h5 --step 2
    for name in scaled filled half; do
        exits "HDF5, $name: refused" 3 "$leafcast" convert "$in/$name.h5" -o "$tmp/r.leaf" --in-place
        ok "HDF5, $name: told" says "$name.h5: --in-place takes samples that lie in one file"
    done
fi

# ---- what is read, and where it lies ----

run "$leafcast" render "$tmp/u8_nrrd.leaf" --size 60x50 -o "$tmp/p.ppm" --stats "$tmp/stats"
ok "reading counts both files" python3 -c '
import json, sys
b = json.load(open(sys.argv[1]))["bytes"]
sys.exit(not (b["file"] < b["read"] <= b["active"] and b["visible"] <= b["read"]))' "$tmp/stats"
exits "info" 0 "$leafcast" info "$tmp/u8_nrrd.leaf"
ok "says where level 0 is" grep -q "level 0  *in place, in .*u8.nrrd" "$tmp/out"
mkdir "$tmp/deep" "$tmp/deep/er"
(cd "$tmp/deep" && "$leafcast" convert ../in/u8.nrrd -o er/x.leaf --in-place >/dev/null 2>&1)
exits "a file made elsewhere finds its input" 0 "$leafcast" verify "$tmp/deep/er/x.leaf"
ok "its bytes are the same but for the path" [ "$(size "$tmp/deep/er/x.leaf")" = "$(size "$tmp/u8_nrrd.leaf")" ]
mkdir "$tmp/moved"
mkdir "$tmp/moved/a"
mv "$in" "$tmp/moved/in"
cp "$tmp/deep/er/x.leaf" "$tmp/moved/a/x.leaf"
exits "without its input" 1 "$leafcast" render "$tmp/u8_nrrd.leaf" -o "$tmp/q.ppm"
ok "by name" says "u8_nrrd.leaf: its samples lie in another file: .*u8.nrrd"
mkdir "$tmp/moved/a/b"
mv "$tmp/moved/a/x.leaf" "$tmp/moved/a/b/x.leaf"
ln -s a/b/x.leaf "$tmp/moved/link.leaf"
exits "both moved, by a link from another folder" 0 "$leafcast" info "$tmp/moved/link.leaf"
exits "both moved" 0 "$leafcast" verify "$tmp/moved/a/b/x.leaf"
mv "$tmp/moved/in" "$in"
for how in "--threads 1" "--threads 3 --memory 40M" "--checkpoint 0"; do
    # shellcheck disable=SC2086
    run "$leafcast" convert "$in/u8.nrrd" -o "$tmp/again.leaf" --in-place --force $how
    ok "the same bytes with $how" cmp "$tmp/again.leaf" "$tmp/u8_nrrd.leaf"
done

# ---- an input that changes ----

changed() {
    exits "$1: refused" 3 "$leafcast" render "$tmp/c.leaf" --size 40x30 -o "$tmp/q.ppm"
    ok "$1: $2" says "$2"
    exits "$1: not sound" 3 "$leafcast" verify "$tmp/c.leaf"
    ok "$1: no picture" [ ! -e "$tmp/q.ppm" ]
}
begin_changed() {
    cp "$in/u8.nrrd" "$tmp/c.nrrd"
    run "$leafcast" convert "$tmp/c.nrrd" -o "$tmp/c.leaf" --in-place --force
    touch -r "$tmp/c.nrrd" "$tmp/time"
}
begin_changed
touch -d '2001-01-01' "$tmp/c.nrrd"
changed "another time" "c.nrrd: has another time than when .*c.leaf was made"
touch -r "$tmp/time" "$tmp/c.nrrd"
exits "the old time" 0 "$leafcast" verify "$tmp/c.leaf"
printf x >>"$tmp/c.nrrd"
touch -r "$tmp/time" "$tmp/c.nrrd"
changed "longer" "c.nrrd: has [0-9]* bytes; it had [0-9]*"
begin_changed
dd if=/dev/zero of="$tmp/c.nrrd" bs=1 seek=60000 count=20000 conv=notrunc 2>/dev/null
touch -r "$tmp/time" "$tmp/c.nrrd"
changed "other samples, secretly" "c.nrrd: the samples of treelet [0-9]* have the checksum"
exits "drawn without them, if that is allowed" 1 "$leafcast" render "$tmp/c.leaf" --size 40x30 -o "$tmp/q.ppm" --allow-missing
rm "$tmp/q.ppm"
mkfifo "$tmp/pipe"
mv "$tmp/pipe" "$tmp/c.nrrd"
exits "a pipe in its place" 1 timeout 20 "$leafcast" verify "$tmp/c.leaf"

# ---- what cannot stay in place ----

refused() {
    title=$1
    want=$2
    word=$3
    shift 3
    exits "$title" "$want" "$leafcast" convert "$@" -o "$tmp/r.leaf" --in-place
    ok "$title: $word" says "$word"
    ok "$title: nothing is left" [ ! -e "$tmp/r.leaf" ]
    ok "$title: nor unfinished" [ ! -e "$tmp/r.leaf.unfinished" ]
}
refused "packed samples" 3 "packed.nrrd: --in-place takes samples that lie in one file" "$in/packed.nrrd"
refused "text" 3 "text.nrrd: --in-place takes samples that lie in one file" "$in/text.nrrd"
refused "another order" 3 "turned.nrrd: --in-place takes samples that lie in one file" "$in/turned.nrrd" --component 2
refused "several steps" 3 "steps.nrrd: --in-place takes one field at one step" "$in/steps.nrrd" --steps all
refused "several files" 3 "--in-place takes one field at one step" "$in/u8.nrrd" "$in/u8.npy"
exits "an output in no folder" 1 "$leafcast" convert "$in/u8.nrrd" -o "$tmp/nowhere/r.leaf" --in-place --dry-run
ok "says that its folder is not there" says "nowhere/r.leaf: its folder: No such file"
long=$tmp/way
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15; do
    long=$long/$(printf '%0248d' $i)
done
if mkdir -p "$long" 2>/dev/null && cp "$in/u8.nrrd" "$long/in.nrrd"; then
    exits "a long way" 0 "$leafcast" convert "$long/in.nrrd" -o "$tmp/far.leaf" --in-place
    exits "is found again" 0 "$leafcast" verify "$tmp/far.leaf"
    deep=$long/$(printf '%0240d' 1)
    mkdir "$deep" && cp "$in/u8.nrrd" "$deep/in.nrrd"
    refused "a longer way" 3 "has more than 3967 bytes" "$deep/in.nrrd"
fi
refused "without compression" 2 "--in-place compresses: without --compress none" "$in/u8.nrrd" --compress none
run sh -c '"$1" convert - -o "$2/r.leaf" --in-place <"$3"' sh "$leafcast" "$tmp" "$in/u8.nrrd"
ok "standard input" says "convert: -: --in-place takes samples that lie in one file"
cp "$in/u8.nrrd" "$tmp/named.leaf"
exits "the input as output" 2 "$leafcast" convert "$tmp/named.leaf" -o "$tmp/named.leaf" --in-place --force
ok "stays what it was" cmp "$in/u8.nrrd" "$tmp/named.leaf"

# ---- where all samples are one value, nothing is stored of them: verify looks all the same ----

python3 - "$tmp" <<'PY'
import json, os, sys
n = 70
a = bytearray(n ** 3)
for z in range(20):
    for y in range(20):
        a[(z * n + y) * n:(z * n + y) * n + 20] = bytes(range(1, 21))
open(sys.argv[1] + "/empty_70x70x70_uint8.raw", "wb").write(a)
folder = sys.argv[1] + "/empty.zarr"
os.mkdir(folder)
json.dump({"zarr_format": 2, "shape": [n] * 3, "chunks": [35] * 3, "dtype": "|u1", "compressor": None, "fill_value": 0,
           "order": "C", "filters": None}, open(folder + "/.zarray", "w"))
first = b"".join(a[(z * n + y) * n:(z * n + y) * n + 35] for z in range(35) for y in range(35))
open(folder + "/0.0.0", "wb").write(first)
PY
run "$leafcast" convert "$tmp/empty_70x70x70_uint8.raw" -o "$tmp/e1.leaf" --in-place
run "$leafcast" convert "$tmp/empty.zarr" -o "$tmp/e2.leaf" --in-place --allow-missing
for n in 1 2; do
    exits "zeros left where they are" 0 "$leafcast" verify "$tmp/e$n.leaf"
done
touch -r "$tmp/empty_70x70x70_uint8.raw" "$tmp/time"
printf 'x' | dd of="$tmp/empty_70x70x70_uint8.raw" bs=1 seek=$((69 * 70 * 70)) conv=notrunc 2>/dev/null
touch -r "$tmp/time" "$tmp/empty_70x70x70_uint8.raw"
exits "one that is not zero any more" 3 "$leafcast" verify "$tmp/e1.leaf"
ok "is found" says "empty_70x70x70_uint8.raw.*the samples of treelet [0-9]* are not all the same, as they were"
head -c $((35 * 35 * 35)) "$tmp/empty_70x70x70_uint8.raw" >"$tmp/empty.zarr/1.1.1"
exits "a chunk that has come" 3 "$leafcast" verify "$tmp/e2.leaf"
ok "is found, too" says "empty.zarr.*the samples of treelet [0-9]* are not all the same, as they were"
finish
