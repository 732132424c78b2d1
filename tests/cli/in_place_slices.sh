#!/bin/sh
# in_place_slices.sh - treelet files that leave the samples of level 0 in a folder of TIFFs, one a slice, as scanners
# write them: the same samples and pictures as of a file with all; few open files; files that change or are not there,
# by name; folders whose files are not alike.
# marks: long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
python=$(python_with numpy)
if [ -z "$python" ] || ! "$leafcast" import-images --help >/dev/null 2>&1; then
    skip "slices in place" "no python3-numpy, or no leafcast import-images here"
    finish
fi
in=$tmp/in
mkdir "$in"
cat >"$tmp/make.py" <<'PY'
import os, sys
sys.path.insert(0, "tests/support")
from write_tiff import *
folder = sys.argv[1] + "/in/"
def slices(name, pages, options="", listed=True, first=8, **more):
    """A file a slice; the numbers in their names are not all as long."""
    os.mkdir(folder + name)
    for z in range(len(pages)):
        write("%s%s/slice%d.tif" % (folder, name, first + z), pages[z:z + 1], **more)
    if listed:
        print(name, options)
a = made("u2", 38, 37, 41)
for kind, name, how in (("u1", "whole", {}), ("u2", "strips", dict(rows=5, gap=3)), ("f4", "strips", dict(rows=6)),
                        ("u2", "packed", dict(rows=8, compression=8)), ("f8", "packed", dict(rows=7, compression=50000)),
                        ("u1", "tiles", dict(tile=(16, 32))), ("i2", "predicted", dict(rows=9, compression=34925, predictor=2)),
                        ("f4", "tiles_packed", dict(tile=(16, 16), compression=8, predictor=2, big=True))):
    for big_endian in (False, True):
        slices("%s_%s_%s" % (name, kind, "big" if big_endian else "little"), made(kind, 38, 37, 41),
               big_endian=big_endian, **how)
slices("planes", made("u1", 38, 37, 41, 3), "--component 2", rows=6, planar=True, compression=8)
slices("luminance", made("f4", 38, 37, 41, 3), rows=6)
os.mkdir(folder + "pages")            # files of several pages
write(folder + "pages/1.tif", a[:11], rows=8)
write(folder + "pages/2.tif", a[11:12], rows=8)
write(folder + "pages/10.tif", a[12:], rows=8, gap=5)
print("pages")
slices("many", made("u1", int(sys.argv[2]), 20, 21), listed=False)
# What is refused.
slices("orders", a, listed=False)
write(folder + "orders/slice20.tif", a[12:13], big_endian=True)
slices("packings", a, listed=False)
write(folder + "packings/slice20.tif", a[12:13], compression=8)
slices("shapes", a, listed=False)
write(folder + "shapes/slice20.tif", a[12:13, :, :40])
slices("types", a, listed=False)
write(folder + "types/slice20.tif", made("u1", 1, 37, 41))
for name in "dangling", "piped":
    slices(name, a, listed=False)
    os.remove(folder + name + "/slice20.tif")
os.symlink("/nowhere/slice20.tif", folder + "dangling/slice20.tif")
os.mkfifo(folder + "piped/slice20.tif")
slices("cut", a, listed=False)
os.truncate(folder + "cut/slice20.tif", 1000)
PY
many=${watched:+120}
many=${many:-600}
"$python" "$tmp/make.py" "$tmp" $many >"$tmp/list" || ok "files to read" false

# index NAME OPTIONS... - the folder NAME as $tmp/NAME.leaf, in place. -q saves a start of the importer: see in_place_tiff.sh.
index() {
    name=$1
    shift
    exits "$name: in place" 0 "$leafcast" convert "$in/$name" -o "$tmp/$name.leaf" -q --in-place --force "$@"
}
while read -r name options; do
    one_in 4 "$name" "strips_u2_little strips_u2_big packed_u2_big planes luminance pages" || continue # all forms of files are among them
    # shellcheck disable=SC2086
    index "$name" $options
    exits "$name: sound" 0 "$leafcast" verify "$tmp/$name.leaf"
    # shellcheck disable=SC2086
    run "$leafcast" convert "$in/$name" -o "$tmp/all.leaf" -q --compress zstd --force $options
    for file in "$name" all; do
        run "$leafcast" export "$tmp/$file.leaf" -o "$tmp/$file.raw" --format raw --force
        [ "$rc" = 0 ] || ok "$name: export of $file" false
        run "$leafcast" render "$tmp/$file.leaf" -o "$tmp/$file.ppm" --size $picture --tf auto --force --memory 40M --threads 4
        [ "$rc" = 0 ] || ok "$name: render of $file" false
    done
    for what in raw ppm; do
        ok "$name, $what: the same" cmp "$tmp/$name.$what" "$tmp/all.$what"
    done
done <"$tmp/list"
ok "these were $(wc -l <"$tmp/list") folders" [ "$(wc -l <"$tmp/list")" = 19 ]
exits "info" 0 "$leafcast" info "$tmp/strips_u2_little.leaf"
ok "says in which folder level 0 is" grep -q "level 0  *in place, in .*in/strips_u2_little$" "$tmp/out"

# ---- few are open ----

index many
cp "$tmp/many.leaf" "$tmp/copy.leaf"
# shellcheck disable=SC3045 # of dash and bash
exits "$many files, of which 40 may be open" 0 sh -c 'ulimit -n 40; exec "$@"' sh "$leafcast" verify "$tmp/many.leaf" --threads 4
# shellcheck disable=SC3045
exits "drawn, too" 0 sh -c 'ulimit -n 40; exec "$@"' sh "$leafcast" render "$tmp/many.leaf" -o "$tmp/many.ppm" --size 90x90 \
    --tf auto --threads 4 --memory 60M

# ---- moved, damaged, not to be written to ----

mkdir "$tmp/elsewhere"
mv "$in/many" "$tmp/elsewhere/many"
exits "the folder is gone" 1 "$leafcast" verify "$tmp/many.leaf"
ok "which is said" says "many.leaf: its samples lie in another file: .*in/many/slice8.tif: cannot open"
mkdir "$tmp/elsewhere/below"
mv "$tmp/many.leaf" "$tmp/elsewhere/below/many.leaf"
mkdir "$tmp/elsewhere/in"
mv "$tmp/elsewhere/many" "$tmp/elsewhere/in/many"
mv "$tmp/elsewhere/below/many.leaf" "$tmp/elsewhere/many.leaf"
exits "moved together" 0 "$leafcast" verify "$tmp/elsewhere/many.leaf"
cp "$tmp/elsewhere/many.leaf" "$tmp/sound.leaf"
printf 'X' | dd of="$tmp/elsewhere/many.leaf" bs=1 seek=9000 conv=notrunc 2>/dev/null
exits "damaged" 3 "$leafcast" verify "$tmp/elsewhere/many.leaf"
exits "repaired" 0 "$leafcast" verify "$tmp/elsewhere/many.leaf" --repair "$tmp/copy.leaf"
ok "to the same bytes" cmp "$tmp/elsewhere/many.leaf" "$tmp/sound.leaf"
exits "no output may be a slice" 2 "$leafcast" export "$tmp/packed_u2_big.leaf" -o "$in/packed_u2_big/slice9.tif" --force
ok "which is said" says "slice9.tif"

# ---- files that change ----

file=$in/strips_u2_big/slice30.tif
leaf=$tmp/strips_u2_big.leaf
cp -p "$file" "$tmp/kept.tif"
gone() {
    exits "$1" "$2" "$leafcast" render "$leaf" -o "$tmp/gone.ppm" --size 40x40 --tf auto
    ok "$1: by name" says "slice30.tif: $3"
    ok "$1: no picture" [ ! -e "$tmp/gone.ppm" ]
    cp -p "$tmp/kept.tif" "$file"
}
rm "$file"
gone "a slice that is not there" 1 "cannot open"
touch -d '2001-01-01' "$file"
gone "another time" 3 "has another time than when"
truncate -s -100 "$file"
touch -r "$tmp/kept.tif" "$file"
gone "cut short" 3 "has [0-9]* bytes; it had"
exits "as it was" 0 "$leafcast" render "$leaf" -o "$tmp/gone.ppm" --size 40x40 --tf auto

# Gone while others draw: the first picture has read nothing near it, the second one needs it.
cat >"$tmp/between.py" <<'PY'
import json, os, subprocess, sys
leafcast, leaf, file, out = sys.argv[1:]
p = subprocess.Popen([leafcast, "render", leaf, "--script", "-", "--size", "40x40", "--memory", "40M"], text=True,
                     stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
def ask(**what):
    p.stdin.write(json.dumps(what) + "\n")
    p.stdin.flush()
    return p.stdout.readline()
first = ask(iso=[1e9], output=out + "1.ppm")
os.remove(file)
second = ask(iso=[3000], output=out + "2.ppm")
p.stdin.close()
p.wait()
said = second + p.stderr.read()
print(first, said, p.returncode)
sys.exit(not (os.path.exists(out + "1.ppm") and not os.path.exists(out + "2.ppm") and "slice30.tif: cannot open" in said))
PY
exits "gone between two pictures" 0 "$python" "$tmp/between.py" "$leafcast" "$leaf" "$file" "$tmp/between"
cp -p "$tmp/kept.tif" "$file"

# ---- what stays refused ----

refused() {
    exits "$1: refused" 3 "$leafcast" convert "$in/$1" -o "$tmp/r.leaf" -q --in-place
    ok "$1: told" says "$2"
    ok "$1: nothing is left" [ ! -e "$tmp/r.leaf" ]
}
stays="--in-place: it cannot stay as it is stored"
refused orders "$stays: slice20.tif is stored in another way"
refused packings "$stays: slice20.tif is stored in another way"
refused shapes "slice20.tif: slice 12 (page 0) has 40 x 37 pixels"
refused piped "slice20.tif: has the name of an image, but is no regular file"
exits "a link to nothing" 1 "$leafcast" convert "$in/dangling" -o "$tmp/r.leaf" --in-place
ok "a link to nothing: told" says "slice20.tif: cannot open"
refused types "slice20.tif: slice 12 (page 0) has 41 x 37 pixels, 1 channels, u8"
refused cut "slice20.tif: "
finish
