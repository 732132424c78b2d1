#!/bin/sh
# in_place_zarr.sh - treelet files that leave the samples of level 0 in the chunks of a Zarr array: the same samples,
# pictures and values as of a file with all, whatever the array, the memory and the threads; what is read of chunks;
# arrays and chunks that are no longer the same.
# marks: long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
size() { wc -c <"$1"; }
in=$tmp/in
mkdir "$in"

# pair NAME INPUT OPTIONS... - $tmp/NAME.leaf, in place, and $tmp/all.leaf: what they draw and tell.
pair() {
    name=$1
    input=$2
    shift 2
    exits "$name: in place" 0 "$leafcast" convert "$in/$input" -o "$tmp/$name.leaf" --in-place --force "$@" --threads 3
    exits "$name: sound" 0 "$leafcast" verify "$tmp/$name.leaf"
    one_in 4 || return 0 # export, render and probe read samples as verify does
    run "$leafcast" convert "$in/$input" -o "$tmp/all.leaf" --compress zstd --force "$@"
    [ "$rc" = 0 ] || ok "$name: with all samples" false
    for file in "$name" all; do
        run "$leafcast" export "$tmp/$file.leaf" -o "$tmp/$file.raw" --format raw --force
        [ "$rc" = 0 ] || ok "$name: export of $file" false
        run "$leafcast" render "$tmp/$file.leaf" -o "$tmp/$file.ppm" --size $picture --force --depth-f64 "$tmp/$file.depth"
        [ "$rc" = 0 ] || ok "$name: render of $file" false
        run "$leafcast" probe "$tmp/$file.leaf" --point 3.25,4.5,5.75 --json
        [ "$rc" = 0 ] || ok "$name: probe of $file" false
        grep -v '"rerun"' "$tmp/out" >"$tmp/$file.told"
    done
    for what in raw ppm depth told; do
        ok "$name, $what: the same" cmp "$tmp/$name.$what" "$tmp/all.$what"
    done
}

# ---- what leafcast writes itself ----

for type in u8 u16 f32; do
    run "$leafcast" generate noise --dims 90,65,59 --type $type -o "$tmp/$type.nrrd"
    run "$leafcast" convert "$tmp/$type.nrrd" -o "$tmp/own.leaf" --force
    run "$leafcast" export "$tmp/own.leaf" -o "$in/$type.zarr"
    pair own_$type $type.zarr
done
pair missing u16.zarr --missing 30000
pair treelets u8.zarr --treelet 16 --halo 0
pair wide u16.zarr --treelet 64 --compress zstd:9 --spacing 1,2,3 --name else
exits "info" 0 "$leafcast" info "$tmp/own_u8.leaf"
ok "says in which folder level 0 is" grep -q "level 0  *in place, in .*in/u8.zarr/0$" "$tmp/out"
exits "stat" 0 "$leafcast" info "$tmp/own_u8.leaf" --json
ok "for programs, too" grep -q '"in_place": ".*in/u8.zarr/0"' "$tmp/out"

# ---- any memory, any threads ----

run "$leafcast" convert "$in/u16.zarr" -o "$tmp/own_u16.all.leaf"
for memory in 20M 64M; do
    for threads in 1 4; do
        for file in own_u16 own_u16.all; do
            run "$leafcast" render "$tmp/$file.leaf" --size 90x80 --tf auto -o "$tmp/$file.ppm" --force --memory $memory --threads $threads --stats "$tmp/$file.json"
            [ "$rc" = 0 ] || ok "$file with $memory, $threads threads" false
        done
        ok "the same with $memory, $threads threads" cmp "$tmp/own_u16.ppm" "$tmp/own_u16.all.ppm"
        ok "and not more memory" python3 -c '
import json, sys
sys.exit(json.load(open(sys.argv[1]))["peak_budget_bytes"] > int(sys.argv[2]) << 20)' "$tmp/own_u16.json" "${memory%M}"
    done
done
for how in "--threads 1" "--threads 3 --memory 40M" "--checkpoint 0"; do
    # shellcheck disable=SC2086
    run "$leafcast" convert "$in/u8.zarr" -o "$tmp/again.leaf" --in-place --force $how
    ok "the same bytes with $how" cmp "$tmp/again.leaf" "$tmp/own_u8.leaf"
done
exits "too little memory for a chunk" 4 "$leafcast" render "$tmp/own_u16.leaf" --size 9x8 -o "$tmp/q.ppm" --memory 1M
ok "says so" says "in/u16.zarr/0: to read a chunk: no room for"

# ---- what is read ----

# With room for all chunks each is read once, and no more than that is counted.
python3 - "$in/u16.zarr/0" >"$tmp/packed" <<'PY'
import os, sys
print(sum(os.path.getsize(f"{at}/{n}") for at, _, names in os.walk(sys.argv[1]) for n in names if n != ".zarray"))
PY
run "$leafcast" render "$tmp/own_u16.leaf" --size 60x50 --mip -o "$tmp/p.ppm" --stats "$tmp/stats"
run "$leafcast" render "$tmp/own_u16.leaf" --size 60x50 --tf auto -o "$tmp/p.ppm" --force --stats "$tmp/stats"
ok "reading counts the bytes of chunks, packed" python3 -c '
import json, sys
b, packed = json.load(open(sys.argv[1]))["bytes"], int(open(sys.argv[2]).read())
sys.exit(not (packed <= b["read"] <= packed + b["file"]))' "$tmp/stats" "$tmp/packed"

# ---- an array that changes ----

changed() {
    exits "$1: refused" "$3" "$leafcast" render "$tmp/c.leaf" --size 40x30 --tf auto -o "$tmp/q.ppm"
    ok "$1: $2" says "$2"
    exits "$1: not sound" "$3" "$leafcast" verify "$tmp/c.leaf"
    ok "$1: no picture" [ ! -e "$tmp/q.ppm" ]
}
begin_changed() {
    rm -rf "$tmp/c.zarr"
    cp -rp "$in/u8.zarr" "$tmp/c.zarr"
    run "$leafcast" convert "$tmp/c.zarr" -o "$tmp/c.leaf" --in-place --force
}
begin_changed
touch -d '2001-01-01' "$tmp/c.zarr/0/.zarray"
exits "its time does not count: its bytes do" 0 "$leafcast" verify "$tmp/c.leaf"
mkdir "$tmp/elsewhere"
cp -r "$tmp/c.zarr" "$tmp/c.leaf" "$tmp/elsewhere"
mv "$tmp/c.zarr" "$tmp/away"
exits "copies of both, without their times" 0 "$leafcast" verify "$tmp/elsewhere/c.leaf"
mv "$tmp/away" "$tmp/c.zarr"
touch -r "$tmp/c.zarr/0/.zarray" "$tmp/time"
printf ' ' >>"$tmp/c.zarr/0/.zarray"
touch -r "$tmp/time" "$tmp/c.zarr/0/.zarray"
changed "longer" "c.zarr/0/.zarray: has [0-9]* bytes; it had [0-9]*" 3
begin_changed
chunk=$(cd "$tmp/c.zarr/0" && find . -type f ! -name .zarray | sort | sed -n 1p)
run "$leafcast" generate noise --dims 90,65,59 --type u8 --seed 9 -o "$tmp/other.nrrd"
run "$leafcast" convert "$tmp/other.nrrd" -o "$tmp/other.leaf"
run "$leafcast" export "$tmp/other.leaf" -o "$tmp/other.zarr"
cp "$tmp/other.zarr/0/$chunk" "$tmp/c.zarr/0/$chunk"
changed "another chunk" "c.zarr/0: chunk.* the samples of treelet [0-9]* have the checksum" 3
exits "drawn without it, if that is allowed" 1 "$leafcast" render "$tmp/c.leaf" --size 40x30 --tf auto -o "$tmp/q.ppm" --allow-missing
ok "no copy of the index is called for" says "with --repair COPY it mends a treelet file, not an input in which samples were left"
rm -f "$tmp/q.ppm"
rm "$tmp/c.zarr/0/$chunk"
changed "a chunk that is gone" "c.zarr/0: chunk.* is not there: the samples of treelet [0-9]* have the checksum" 3
ok "is named" says ", of which $(echo "$chunk" | cut -c3-) is not there"
printf x >"$tmp/c.zarr/0/$chunk"
changed "a damaged chunk" "c.zarr/0/.*: " 3
rm "$tmp/c.zarr/0/$chunk"
mkfifo "$tmp/c.zarr/0/$chunk"
exits "a pipe in its place" 3 timeout 20 "$leafcast" verify "$tmp/c.leaf"
ok "is told as that" says "c.zarr/0/.*: is a named pipe, expected a regular file"
rm "$tmp/c.zarr/0/$chunk"
cp "$in/u8.zarr/0/$chunk" "$tmp/moved"
ln -s "$tmp/moved" "$tmp/c.zarr/0/$chunk"
exits "a link to another folder" 3 "$leafcast" export "$tmp/c.leaf" -o "$tmp/q.raw" --format raw
ok "what helps is told" says "lies outside of its folder, which was not allowed when this index was made of it: convert it again with --follow-links"
exits "that helps" 0 "$leafcast" convert "$tmp/c.zarr" -o "$tmp/linked.leaf" --in-place --follow-links
exits "indeed" 0 "$leafcast" verify "$tmp/linked.leaf"
mv "$tmp/c.zarr" "$tmp/d.zarr"
exits "without its array" 1 "$leafcast" render "$tmp/c.leaf" -o "$tmp/q.ppm"
ok "by name" says "c.leaf: its samples lie in another file: .*c.zarr/0/.zarray"

# ---- an order that is none ----

cp -r "$in/u8.zarr" "$tmp/x.zarr"
sed 's/"order": *"C"/"order": "X"/' "$in/u8.zarr/0/.zarray" >"$tmp/x.zarr/0/.zarray"
exits "another order" 3 "$leafcast" convert "$tmp/x.zarr" -o "$tmp/x.leaf"
ok "is named" says 'x.zarr/0/.zarray: "order": expected "C" or "F"'

# ---- what Python's zarr writes ----

python=$(python_with zarr)
if [ -z "$python" ]; then
    skip "arrays of Python's zarr" "no python3-zarr here"
    finish
fi
PYTHONDONTWRITEBYTECODE=1 "$python" - "$in" >"$tmp/list" <<'PY'
import json, sys
import numpy as np, zarr, numcodecs as nc
folder, n = sys.argv[1] + "/", 0
rng = np.random.default_rng(3)
def save(a, options="", **more):
    global n
    n += 1
    z = zarr.open_array(f"{folder}p{n}.zarr", mode="w", shape=a.shape, dtype=a.dtype, **more)
    z[...] = a
    print(f"p{n}", options)
def some(name, shape=(21, 19, 23)):
    a = np.cumsum(rng.standard_normal(shape), -1) * 10
    return np.abs(a).astype(name) if "u" in name else a.astype(name)
for name in "u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f2", "f4", "f8":
    for order in "<>":
        save(some(name).astype(np.dtype(name).newbyteorder(order)), chunks=(8, 7, 9), order="F" if order == ">" else "C")
save(rng.random((21, 19, 23)) > 0.5, chunks=(8, 7, 9))
a = some("f4")
packers = [None, nc.Zlib(5), nc.GZip(5), nc.Zstd(3), nc.LZ4(), nc.BZ2(5), nc.LZMA(preset=1)]
packers += [nc.Blosc(cname, 5, shuffle) for cname in nc.blosc.list_compressors() for shuffle in (0, 1, 2)]
for packer in packers:
    save(a, chunks=(8, 16, 32), compressor=packer)
whole, real = some("i4"), some("f8")
for t in "<i2", ">u4", "<f8":
    save((abs(whole) if "u" in t else whole).astype(t), chunks=(4, 5, 11), filters=[nc.Shuffle(np.dtype(t).itemsize)], compressor=nc.Zlib(1))
for t in "u1", "<u2", ">u2", "<i8", "<f4", ">f8":
    save((abs(whole) if "u" in t else whole).astype(t), chunks=(4, 5, 11), filters=[nc.Delta(t)])
save((whole % 100).astype("<i4"), chunks=(9, 9, 9), filters=[nc.Delta("<i4", ">i2")])
for offset, scale, coded in (0, 10, "<u2"), (-3.25, 0.1, "u1"), (1, 3, "<f4"), (0, 1, ">i4"):
    save((abs(real) % 100).astype("<f4"), chunks=(9, 9, 9), filters=[nc.FixedScaleOffset(offset, scale, "<f4", coded)])
save(real, chunks=(9, 9, 9), filters=[nc.Quantize(3, "<f8", "<f4")])
save((whole % 100).astype("<f8"), chunks=(9, 9, 9), filters=[nc.AsType("<i4", "<f8"), nc.Delta("<i4"), nc.Shuffle(4)], order="F")
for fill in np.nan, -2.5:
    z = zarr.open_array(f"{folder}fill{fill}.zarr", mode="w", shape=(40, 38, 36), chunks=(13, 14, 15), dtype="f4", fill_value=fill)
    z[13:26, 14:28, 15:30] = some("f4", (13, 14, 15))
    print(f"fill{fill}")
for chunks in (1, 19, 23), (21, 1, 1), (64, 64, 64), (1, 1, 1):
    save(some("u2"), chunks=chunks, dimension_separator="/")
save(some("i2", (4, 18, 19, 20)), "--step 2", chunks=(3, 7, 8, 9))
save(some("f4", (18, 19, 20, 3)), "", chunks=(7, 8, 9, 2))
save(some("f4", (18, 19, 20, 3)), "--component 2", chunks=(7, 8, 9, 3))
save(some("u2", (2, 3, 18, 19, 20)), "--step 1 --component 3", chunks=(1, 2, 7, 8, 9))
save(some("u2", (2, 3, 18, 19, 20)), "--step 1 --component 3", chunks=(2, 1, 7, 8, 9), order="F")
zarr.open_group(f"{folder}ome.zarr", mode="w")
for i, shape in enumerate([(3, 20, 22, 24), (3, 10, 11, 12)]):
    z = zarr.open_array(f"{folder}ome.zarr/{i}", mode="w", shape=shape, chunks=(1, 7, 8, 9), dtype=">u2", dimension_separator="/")
    z[...] = some("u2", shape)
json.dump({"multiscales": [{"version": "0.4", "axes": [{"name": x} for x in "czyx"], "datasets": [{"path": "0"}, {"path": "1"}]}]},
          open(f"{folder}ome.zarr/.zattrs", "w"))
print("ome")
print("ome --field 1 --component 2")
PY
while read -r name options; do
    # shellcheck disable=SC2086
    pair "$name" "$name.zarr" $options
done <"$tmp/list"
ok "these were $(wc -l <"$tmp/list") arrays" [ "$(wc -l <"$tmp/list")" -gt 70 ]
finish
