#!/bin/sh
# zarr.sh - arrays that Python's zarr wrote, and images as OME-Zarr has them: samples, chunks, packers,
# fill values, spacings; within any memory.
# marks: long
. tests/support/tap.sh

export PYTHONDONTWRITEBYTECODE=1
python=$(python_with zarr)
if [ -z "$python" ]; then
    skip "folders of zarr" "no python3-zarr here"
    finish
fi
cat >"$tmp/lib.py" <<'PY'
import sys, json, os, shutil
sys.path.insert(0, "tests/support")
import numpy as np, zarr, numcodecs
from grid_truth import same, refused, end
tmp = sys.argv[1]
rng = np.random.default_rng(3)
path = f"{tmp}/a.zarr"
names = {"u1": "u8", "i1": "i8", "u2": "u16", "i2": "i16", "u4": "u32", "i4": "i32", "u8": "u64", "i8": "i64",
         "f2": "f16", "f4": "f32", "f8": "f64"}
def some(name, shape):
    a = rng.standard_normal(shape) * 100
    return np.abs(a).astype(name) if name[0] == "u" else a.astype(name)
def read_as(a):
    name = a.dtype.newbyteorder("=").str[1:]
    return a.astype({"f2": "f4", "u8": "f8", "i8": "f8", "b1": "u1"}.get(name, name))
def save(a, path=path, **more):
    shutil.rmtree(path, ignore_errors=True)
    z = zarr.open_array(path, mode="w", shape=a.shape, dtype=a.dtype, **more)
    z[...] = a
    return z
PY
begin() { cat "$tmp/lib.py" - >"$tmp/test.py"; }

begin <<'PY'
for name, source in names.items():
    for order in "<>":
        a = some(name, (7, 9, 11)).astype(np.dtype(name).newbyteorder(order))
        save(a, chunks=(3, 4, 5))
        same(path, read_as(a), np.eye(4), source=source)
a = rng.random((7, 9, 11)) > 0.5
save(a, chunks=(3, 4, 5))
same(path, a.astype("u1"))
a = some("i2", (13, 9, 11))
for chunks in (13, 9, 11), (1, 1, 1), (1, 9, 11), (20, 20, 20), (5, 2, 7), (13, 1, 1):
    for order in "CF":
        for separator in "./":
            save(a, chunks=chunks, order=order, dimension_separator=separator)
            same(path, a)
            same(path, a, None, ("--slices", 5))
end()
PY
exits "types, chunks, orders, separators" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
a = np.cumsum(some("f4", (20, 30, 40)), 2).astype("f4")
nc = numcodecs
packers = [None, nc.Zlib(5), nc.GZip(5), nc.Zstd(3), nc.LZ4(), nc.BZ2(5), nc.LZMA(preset=1)]
packers += [nc.Blosc(cname, 5, shuffle) for cname in nc.blosc.list_compressors() for shuffle in (0, 1, 2)]
for packer in packers:
    save(a, chunks=(8, 16, 32), compressor=packer)
    same(path, a)
for packer in packers: # what is cut or too long is found
    save(a, chunks=(8, 16, 32), compressor=packer)
    chunk = f"{path}/1.1.0"
    data = open(chunk, "rb").read()
    open(chunk, "wb").write(data[:len(data) // 2])
    refused(path, "1.1.0: ")
    open(chunk, "wb").write(data[:5])
    refused(path, "1.1.0: ")
end()
PY
exits "packers" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
# Filters, alone and in rows: as Python's zarr undoes them.
nc = numcodecs
whole, real = some("i4", (9, 10, 11)), np.cumsum(some("f8", (9, 10, 11)), 2)
cases = [(whole.astype(t), [nc.Shuffle(np.dtype(t).itemsize)]) for t in ("u1", "<i2", ">u4", "<f8", "<i8", "<f2")]
cases += [((abs(whole) if "u" in t else whole).astype(t), [nc.Delta(t)]) for t in ("u1", "i1", "<u2", ">u2", "<i4", "<i8", ">u8", "<f4", ">f8")]
cases += [(np.cumsum(whole % 5, 2).astype("<u2"), [nc.Delta("<u2", "i1")]), ((whole % 100).astype("<i4"), [nc.Delta("<i4", ">i2")])]
cases += [((real % 1000).astype(t), [nc.FixedScaleOffset(offset, scale, t, coded)]) for t in ("<f4", "<f8", ">f4")
          for offset, scale, coded in ((0, 10, "<u2"), (500, 8, "<i2"), (-3.25, 0.1, "u1"), (1, 3, "<f4"), (1, 3, "<f8"), (0, 1, ">i4"))]
cases += [((whole % 1000).astype("<i4"), [nc.FixedScaleOffset(7, 0.5, "<i4", "<i2")])]
cases += [(real.astype(t), [nc.Quantize(3, t, coded)]) for t in ("<f4", "<f8") for coded in ("<f4", "<f8")]
cases += [((whole % 100).astype(a), [nc.AsType(b, a)]) for a, b in (("<f4", "u1"), ("<f8", ">f4"), ("<i4", "<i2"), ("<u2", "<f8"))]
cases += [((whole % 100).astype("<f8"), [nc.AsType("<i4", "<f8"), nc.Delta("<i4"), nc.Shuffle(4)]),
          ((real % 1000).astype(">f4"), [nc.FixedScaleOffset(0, 100, ">f4", ">u4"), nc.Shuffle(4)])]
for a, filters in cases:
    for more in dict(compressor=None), dict(compressor=nc.Zlib(1), order="F", chunks=(4, 10, 3)):
        save(a, filters=filters, **dict(dict(chunks=(4, 5, 11)), **more))
        same(path, read_as(zarr.open_array(path, mode="r")[...]))
import json
save(whole.astype("<i4"), chunks=(4, 5, 11), compressor=None, filters=[nc.Delta("<i4")])
head = json.load(open(f"{path}/.zarray"))
for filters, words in (([{"id": "fletcher32"}], '"fletcher32"; supported are shuffle, delta'), ([{}], '""; supported'), ([7], '""; supported'),
                       ([{"id": "delta", "dtype": "<i2"}], "of the type that the array has"), ([{"id": "delta", "dtype": "<x4"}], "is not undone"),
                       ([{"id": "delta", "dtype": "<i4", "astype": "<f4"}], "is not undone"), ([{"id": "delta", "dtype": 3}], "is not undone"),
                       ([{"id": "astype", "decode_dtype": "<i4", "encode_dtype": "<i8"}], "is not undone"),
                       ([{"id": "astype", "decode_dtype": "<i4", "encode_dtype": "|b1"}], "is not undone"),
                       ([{"id": "fixedscaleoffset", "dtype": "<i4", "astype": "<i2", "scale": 0, "offset": 0}], "expected a scale"),
                       ([{"id": "fixedscaleoffset", "dtype": "<i4", "astype": "<f4", "scale": 1, "offset": 0}], "does not fit"),
                       ([{"id": "shuffle", "elementsize": 7}], "does not fit"), ([{"id": "shuffle", "elementsize": 1 << 40}], "is not undone"),
                       ([{"id": "shuffle", "elementsize": -1}], "is not undone"), ([{"id": "astype", "decode_dtype": "<i4", "encode_dtype": "<i2"}], "bytes expected"),
                       ([{"id": "shuffle"}] * 9, "more than 8")):
    json.dump(dict(head, filters=filters), open(f"{path}/.zarray", "w"))
    refused(path, words)
end()
PY
exits "filters" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
# Chunks that are missing are the fill value.
for name, fill in ("f4", np.nan), ("f4", -2.5), ("f8", np.inf), ("u1", 7), ("i8", -2**40), ("f2", 0.5), ("i2", None), ("u8", 2**53):
    shutil.rmtree(path, ignore_errors=True)
    z = zarr.open_array(path, mode="w", shape=(7, 9, 11), chunks=(3, 4, 5), dtype=name, fill_value=fill)
    z[3:6, 4:8, 5:10] = some(name, (3, 4, 5))
    want = z[...]
    if fill is None:
        want[:] = 0
        want[3:6, 4:8, 5:10] = z[3:6, 4:8, 5:10]
    same(path, read_as(want))
a = some("i2", (6, 5, 7, 9))
save(a, chunks=(2, 3, 4, 5))
for step in range(6):
    same(path, a[step], None, ("--step", step))
refused(path, "no step 6: there are 6", "--step", 6)
a = some("f4", (5, 7, 9, 3))
for chunks in (2, 3, 4, 3), (2, 3, 4, 2):
    save(a, chunks=chunks)
    same(path, a[..., 1], None, ("--component", 2))
    w = a.astype("f8")
    same(path, np.sqrt(w[..., 0] ** 2 + w[..., 1] ** 2 + w[..., 2] ** 2).astype("f4"))
a = some("u2", (2, 3, 5, 7, 9))
save(a, chunks=(1, 2, 2, 4, 4))
same(path, a[1, 2], None, ("--step", 1, "--component", 3))
# Memory for less than a layer of chunks.
a = some("f4", (40, 64, 100))
save(a, chunks=(40, 16, 16))
for memory in 0, 500_000, 1_000_000:
    same(path, a, None, ("--memory", memory, "--slices", 3))
refused(path, "", "--memory", 60_000)
end()
PY
exits "fill values, steps, numbers, memory" 0 "$python" "$tmp/test.py" "$tmp"

begin <<'PY'
def scale(*v): return {"type": "scale", "scale": list(v)}
def shift(*v): return {"type": "translation", "translation": list(v)}
group = f"{tmp}/ome.zarr"
full, half = some("u2", (2, 3, 8, 10, 12)), some("u2", (2, 3, 4, 5, 6))
axes = [{"name": "t", "type": "time"}, {"name": "c", "type": "channel"}] + [{"name": n, "type": "space", "unit": "micrometer"} for n in "zyx"]
shutil.rmtree(group, ignore_errors=True)
zarr.open_group(group, mode="w")
save(full, f"{group}/0", chunks=(1, 1, 4, 5, 6), dimension_separator="/")
save(half, f"{group}/1", chunks=(1, 1, 4, 5, 6), dimension_separator="/")
json.dump({"multiscales": [{"version": "0.4", "name": "cells", "axes": axes, "datasets": [
    {"path": "0", "coordinateTransformations": [scale(1, 1, 2.5, 0.5, 0.25), shift(0, 0, 10, 20, 30)]},
    {"path": "1", "coordinateTransformations": [scale(1, 1, 5, 1, 0.5)]}],
    "coordinateTransformations": [scale(1, 1, 2, 2, 2)]}]}, open(f"{group}/.zattrs", "w"))
world = [[0.5, 0, 0, 60], [0, 1, 0, 40], [0, 0, 5, 20]]
same(group, full[0, 0], world)
same(group, full[1, 2], world, ("--step", 1, "--component", 3))
refused(group, "no component 4", "--component", 4)
# Axes of another order, version 0.3, without transformations.
a = some("f4", (6, 5, 3, 7))
shutil.rmtree(group)
zarr.open_group(group, mode="w")
save(a, f"{group}/data", chunks=(4, 2, 2, 3))
json.dump({"multiscales": [{"axes": ["x", "z", "c", "y"], "datasets": [{"path": "data"}]}]}, open(f"{group}/.zattrs", "w"))
same(group, a[:, :, 1, :].transpose(1, 2, 0), np.eye(4), ("--component", 2))
# Groups: the one array, or by name.
g = f"{tmp}/group.zarr"
shutil.rmtree(g, ignore_errors=True)
zarr.open_group(g, mode="w")
save(a[:, :, 0], f"{g}/one")
same(g, a[:, :, 0])
save(a[:, :, 1], f"{g}/two")
refused(g, "2 arrays or groups: one, two: --field NAME takes one")
end()
PY
exits "OME-Zarr, groups" 0 "$python" "$tmp/test.py" "$tmp"

exits "convert" 0 "$leafcast" convert "$tmp/ome.zarr" --component 3 -o "$tmp/a.leaf"
exits "by name" 0 "$leafcast" convert "$tmp/group.zarr" --field two -o "$tmp/b.leaf"
exits "no such name" 2 "$leafcast" convert "$tmp/group.zarr" --field three -o "$tmp/c.leaf"
exits "info" 0 "$leafcast" info "$tmp/ome.zarr" --json
ok "tells the format" grep -q '"format": "Zarr"' "$tmp/out"
mkdir "$tmp/v3.zarr"
echo '{"zarr_format": 3, "node_type": "array"}' >"$tmp/v3.zarr/zarr.json"
exits "version 3" 3 "$leafcast" convert "$tmp/v3.zarr" -o "$tmp/c.leaf"
ok "is named" grep -q 'Zarr of version 3; version 2 is read' "$tmp/err"
finish
