#!/bin/sh
# in_place_hdf5.sh - treelet files that leave the samples of level 0 in the chunks of an HDF5 data set, whose importer
# tells where they are: the same samples, pictures and values as of a file with all; what stays refused, by name.
# marks: long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
python=$(python_with h5py)
if [ -z "$python" ] || ! "$leafcast" import-hdf5 --help >/dev/null 2>&1; then
    skip "HDF5 in place" "no python3-h5py, or no leafcast import-hdf5 here"
    finish
fi
in=$tmp/in
mkdir "$in"
"$python" - "$in" >"$tmp/list" <<'PY'
import sys, zlib, h5py, numpy as np
folder = sys.argv[1] + "/"
rng = np.random.default_rng(5)
a = np.cumsum(rng.integers(-3, 4, (40, 37, 41)), 2)
a = (a - a.min()).astype("u1")
def write(name, samples, options="", attributes={}, listed=True, fill=None, **more):
    with h5py.File(f"{folder}{name}.h5", "w", **({"userblock_size": more.pop("block")} if "block" in more else {})) as f:
        d = f.create_dataset("d", data=samples, fillvalue=fill, **more)
        d.attrs.update(attributes)
    if listed:
        print(name, options)
for t in "u1", "<i2", ">i2", "<u4", ">f4", "<f8":
    write(f"plain{t[-2:]}{'b' if t[0] == '>' else ''}", a.astype(t), chunks=(10, 12, 13))
write("gzip", a.astype("<u2"), chunks=(16, 16, 16), compression="gzip")
write("shuffled", a.astype(">i4"), chunks=(16, 16, 16), compression="gzip", shuffle=True)
write("summed", a.astype("<f4"), chunks=(7, 37, 41), compression="gzip", shuffle=True, fletcher32=True)
write("only_summed", a, chunks=(9, 9, 9), fletcher32=True)
write("lzf", a.astype("<f4"), chunks=(10, 12, 13), compression="lzf", shuffle=True)
write("noise", rng.integers(0, 256, a.shape).astype("u1"), chunks=(10, 12, 13), compression="lzf")
write("large", a, chunks=(40, 37, 41), compression="gzip")
write("grows", a, chunks=(9, 9, 9), maxshape=(None, None, None), compression="gzip")
write("steps", np.stack([a, a[::-1], a[:, ::-1]]), "--step 2", chunks=(2, 10, 10, 10), compression="gzip")
write("three", np.stack([a, a[::-1], a[:, ::-1]], -1), "", chunks=(10, 10, 10, 2))
write("one_of_three", np.stack([a, a[::-1], a[:, ::-1]], -1), "--component 2", chunks=(10, 10, 10, 3), compression="gzip")
write("vector", rng.standard_normal((30, 29, 28, 2)).astype("<f4"), "", chunks=(10, 10, 10, 2))
write("channel", np.stack([[a, a[::-1]], [a[:, ::-1], a // 2]]), "--step 1 --component 2", chunks=(1, 1, 10, 10, 10))
for fill in 0, 7: # chunks that were never written
    with h5py.File(f"{folder}sparse{fill}.h5", "w") as f:
        d = f.create_dataset("d", (90, 80, 70), "<i2", chunks=(30, 30, 30), fillvalue=fill, compression="gzip")
        d[30:60, 30:60, 30:60] = 100
        d[31:50, 35:55, 31:51] = a[:19, :20, :20]
    print(f"sparse{fill}")
with h5py.File(folder + "skipped.h5", "w") as f: # chunks without some of the filters
    d = f.create_dataset("d", (20, 20, 20), "<u2", chunks=(10, 10, 10), compression="gzip", shuffle=True)
    for i in range(8):
        at = tuple(10 * (i >> k & 1) for k in (2, 1, 0))
        part = a[at[0]:at[0] + 10, at[1]:at[1] + 10, at[2]:at[2] + 10].astype("<u2")
        data = part.tobytes()
        if not i & 1:
            data = np.frombuffer(data, "u1").reshape(-1, 2).T.tobytes()
        if not i & 2:
            data = zlib.compress(data)
        d.id.write_direct_chunk(at, data, filter_mask=i & 3)
print("skipped")
with h5py.File(folder + "two.h5", "w") as f:
    f.create_dataset("large", data=a, chunks=(10, 10, 10))
    f.create_dataset("small", data=a[:20, :20, :20], chunks=(6, 6, 6), compression="gzip")
print("two --field /small")
# What stays refused.
write("scaleoffset", a, listed=False, chunks=(10, 10, 10), scaleoffset=0)
write("behind", a, listed=False, chunks=(10, 10, 10), block=1024)
write("scaled", a, listed=False, attributes={"scale_factor": 0.5}, chunks=(10, 10, 10))
write("filled", a, listed=False, attributes={"_FillValue": np.uint8(7)}, chunks=(10, 10, 10))
write("half", a.astype("<f2"), listed=False, chunks=(10, 10, 10))
import ctypes, ctypes.util # edges that are stored without the filters
for name in "libhdf5_serial.so.103", "libhdf5.so", ctypes.util.find_library("hdf5_serial"), ctypes.util.find_library("hdf5"):
    try:
        library = ctypes.CDLL(name)
        break
    except (OSError, TypeError):
        library = None
with h5py.File(folder + "edges.h5", "w", libver="latest") as f:
    plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plist.set_chunk((16, 16, 16))
    plist.set_deflate(4)
    if library and library.H5Pset_chunk_opts(ctypes.c_int64(plist.id), ctypes.c_uint(2)) == 0:
        space = h5py.h5s.create_simple(a.shape)
        d = h5py.h5d.create(f.id, b"d", h5py.h5t.STD_U8LE, space, dcpl=plist)
        d.write(h5py.h5s.ALL, h5py.h5s.ALL, a)
        open(folder + "edges", "w").close()
with h5py.File(folder + "linked.h5", "w") as f:
    f["d"] = h5py.ExternalLink("gzip.h5", "/d")
PY

# pair NAME OPTIONS... - NAME.h5 as $tmp/NAME.leaf, in place, and $tmp/all.leaf: what they draw and tell.
pair() {
    name=$1
    shift
    exits "$name: in place" 0 "$leafcast" convert "$in/$name.h5" -o "$tmp/$name.leaf" --in-place --force "$@" --threads 3
    exits "$name: sound" 0 "$leafcast" verify "$tmp/$name.leaf"
    one_in 4 || return 0 # export, render and probe read samples as verify does
    run "$leafcast" convert "$in/$name.h5" -o "$tmp/all.leaf" --compress zstd --force "$@"
    [ "$rc" = 0 ] || ok "$name: with all samples" false
    for file in "$name" all; do
        run "$leafcast" export "$tmp/$file.leaf" -o "$tmp/$file.raw" --format raw --force
        [ "$rc" = 0 ] || ok "$name: export of $file" false
        run "$leafcast" render "$tmp/$file.leaf" -o "$tmp/$file.ppm" --size $picture --tf auto --force --memory 40M --threads 4
        [ "$rc" = 0 ] || ok "$name: render of $file" false
        run "$leafcast" probe "$tmp/$file.leaf" --point 3.25,4.5,5.75 --json
        [ "$rc" = 0 ] || ok "$name: probe of $file" false
        grep -v '"rerun"' "$tmp/out" >"$tmp/$file.told"
    done
    for what in raw ppm told; do
        ok "$name, $what: the same" cmp "$tmp/$name.$what" "$tmp/all.$what"
    done
}
while read -r name options; do
    # shellcheck disable=SC2086
    pair "$name" $options
done <"$tmp/list"
ok "these were $(wc -l <"$tmp/list") data sets" [ "$(wc -l <"$tmp/list")" -gt 20 ]
exits "info" 0 "$leafcast" info "$tmp/gzip.leaf"
ok "says in which file level 0 is" grep -q "level 0  *in place, in .*in/gzip.h5$" "$tmp/out"

# ---- codecs that the library has of plugins ----

# A plugin for each, as small as can be: the importer reads samples with it for coarse levels, the index without.
mkdir "$tmp/plugins"
cat >"$tmp/plugin.c" <<'C'
#include <H5PLextern.h>
#include <blosc.h>
#include <stdlib.h>
#include <zstd.h>
#ifdef BLOSC
enum { ID = 32001 };
static size_t take(const void *in, size_t bytes, void **out) {
    size_t size = 0, packed, block;
    blosc_cbuffer_sizes(in, &size, &packed, &block);
    *out = malloc(size);
    return bytes >= 16 && blosc_decompress_ctx(in, *out, size, 1) == (int)size ? size : 0;
}
#else
enum { ID = 32015 };
static size_t take(const void *in, size_t bytes, void **out) {
    const size_t size = ZSTD_getFrameContentSize(in, bytes);
    *out = malloc(size);
    return ZSTD_decompress(*out, size, in, bytes) == size ? size : 0;
}
#endif
static size_t filter(unsigned flags, size_t n, const unsigned v[], size_t bytes, size_t *room, void **buffer) {
    void *out = NULL;
    const size_t size = flags & H5Z_FLAG_REVERSE ? take(*buffer, bytes, &out) : 0;
    free(*buffer);
    *buffer = out;
    *room = size;
    return size;
}
static const H5Z_class2_t row = {H5Z_CLASS_T_VERS, ID, 1, 1, "row", NULL, NULL, filter};
H5PL_type_t H5PLget_plugin_type(void) { return H5PL_TYPE_FILTER; }
const void *H5PLget_plugin_info(void) { return &row; }
C
cat >"$tmp/packed.py" <<'PY'
import ctypes, sys
import h5py, numpy as np
folder = sys.argv[1] + "/"
r = np.random.default_rng(6)
a = np.cumsum(r.integers(-3, 4, (40, 37, 41)), 2).astype("<i2")
zstd, blosc = ctypes.CDLL("libzstd.so.1"), ctypes.CDLL("libblosc.so.1")
zstd.ZSTD_compress.restype = ctypes.c_size_t
def by_zstd(data):
    room = ctypes.create_string_buffer(2 * len(data) + 1000)
    n = zstd.ZSTD_compress(room, ctypes.c_size_t(len(room)), data, ctypes.c_size_t(len(data)), 3)
    return room.raw[:n]
def by_blosc(data):
    room = ctypes.create_string_buffer(2 * len(data) + 1000)
    n = blosc.blosc_compress_ctx(5, 1, ctypes.c_size_t(2), ctypes.c_size_t(len(data)), data, room, ctypes.c_size_t(len(room)), b"lz4", ctypes.c_size_t(0), 1)
    return room.raw[:n]
def shuffled(data):
    return np.frombuffer(data, "u1").reshape(-1, 2).T.tobytes()
for name, id, pack, shuffle in ("zstd", 32015, by_zstd, False), ("zstd_shuffled", 32015, by_zstd, True), ("blosc", 32001, by_blosc, False):
    with h5py.File(folder + name + ".h5", "w") as f:
        plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        chunk = 10, 12, 13
        plist.set_chunk(chunk)
        if shuffle:
            plist.set_shuffle()
        plist.set_filter(id, h5py.h5z.FLAG_OPTIONAL, (0,) * 7)
        d = h5py.h5d.create(f.id, b"d", h5py.h5t.STD_I16LE, h5py.h5s.create_simple(a.shape), dcpl=plist)
        for z in range(0, 40, 10):
            for y in range(0, 37, 12):
                for x in range(0, 41, 13):
                    part = np.zeros(chunk, a.dtype)
                    b = a[z:z + 10, y:y + 12, x:x + 13]
                    part[:b.shape[0], :b.shape[1], :b.shape[2]] = b
                    data = part.tobytes()
                    d.write_direct_chunk((z, y, x), pack(shuffled(data) if shuffle else data), 0)
PY
plugin() {
    # shellcheck disable=SC2046
    ${CC:-cc} -shared -fPIC -o "$tmp/plugins/lib$1.so" "$tmp/plugin.c" "-D$1" $(pkg-config --cflags hdf5-serial) -lblosc -lzstd
}
if "$python" "$tmp/packed.py" "$in" 2>/dev/null && plugin BLOSC 2>/dev/null && plugin ZSTD 2>/dev/null; then
    exits "without a plugin" 3 "$leafcast" convert "$in/zstd.h5" -o "$tmp/r.leaf" --in-place
    export HDF5_PLUGIN_PATH="$tmp/plugins"
    for name in zstd zstd_shuffled blosc; do
        pair $name
        chunks=$(od -An -tu4 -j 1500 -N4 "$tmp/$name.leaf" | tr -d ' ')
        ok "$name: $chunks chunks" [ "$chunks" = 64 ]
    done
    unset HDF5_PLUGIN_PATH
    exits "the index needs no plugin" 0 "$leafcast" verify "$tmp/blosc.leaf"
else
    skip "codecs of plugins" "no compiler, libblosc, libzstd or headers of HDF5 here"
fi

# ---- what stays refused ----

refused() {
    # shellcheck disable=SC2086
    exits "$1: refused" 3 "$leafcast" convert "$in/$1.h5" -o "$tmp/r.leaf" --in-place ${3-}
    ok "$1: told" says "$1.h5: --in-place$2"
    ok "$1: nothing is left" [ ! -e "$tmp/r.leaf" ]
    # shellcheck disable=SC2086
    exits "$1: converted otherwise" 0 "$leafcast" convert "$in/$1.h5" -o "$tmp/r.leaf" ${3-}
    rm -f "$tmp/r.leaf"
}
refused scaleoffset ": it cannot stay as it is stored: scaleoffset"
refused behind ": it cannot stay as it is stored: a user block in front"
refused linked ": it cannot stay as it is stored: it is a data set of another file" "--field /d"
for name in scaled filled half; do
    refused $name ": it cannot stay as it is stored: numbers whose type, scale or fill value HDF5 undoes"
done
if [ -e "$in/edges" ]; then
    refused edges ": it cannot stay as it is stored: chunks at the edge without filters"
else
    skip "edges without filters" "this library of HDF5 is not found"
fi
exits "--chunks is for convert" 3 "$leafcast" import-hdf5 --chunks "$in/half.h5" -o "$tmp/x"
ok "and says so" says "half.h5: --chunks: it has none"

# ---- a file that changes ----

cp "$in/shuffled.h5" "$tmp/c.h5"
run "$leafcast" convert "$tmp/c.h5" -o "$tmp/c.leaf" --in-place
touch -r "$tmp/c.h5" "$tmp/time"
touch -d '2001-01-01' "$tmp/c.h5"
exits "another time: refused" 3 "$leafcast" verify "$tmp/c.leaf"
ok "by name" says "c.h5: has another time than when"
"$python" - "$tmp/c.h5" <<'PY'
import sys, h5py
with h5py.File(sys.argv[1], "r") as f:
    d = f["d"]
    at = d.id.get_chunk_info(5)
with open(sys.argv[1], "r+b") as f:
    f.seek(at.byte_offset + 20)
    f.write(b"\0" * 40)
PY
touch -r "$tmp/time" "$tmp/c.h5"
exits "a damaged chunk: refused" 3 "$leafcast" verify "$tmp/c.leaf"
ok "by its byte" says "c.h5: the chunk at byte [0-9]*: \|c.h5: chunk.* the samples of treelet"
truncate -s -100 "$tmp/c.h5"
touch -r "$tmp/time" "$tmp/c.h5"
exits "shorter: refused" 3 "$leafcast" verify "$tmp/c.leaf"
ok "by its length" says "c.h5: has [0-9]* bytes; it had"
finish
