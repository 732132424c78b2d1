#!/bin/sh
# volume_files.sh - NRRD and MetaImage headers whose samples lie in several files: lists and patterns, packed or not, with
# what is to be passed over in each; and those that do not fit.
. tests/support/tap.sh

export PYTHONDONTWRITEBYTECODE=1
python=$(python_with numpy)
if [ -z "$python" ]; then
    skip "samples in several files" "no numpy here"
    finish
fi
cat >"$tmp/test.py" <<'PY'
import bz2, gzip, os, sys, zlib
sys.path.insert(0, "tests/support")
import numpy as np
from grid_truth import same, refused, end
tmp = sys.argv[1]
os.mkdir(tmp + "/s")
A = np.random.default_rng(3).integers(0, 60000, (6, 4, 5)).astype("<u2")
def put(name, data):
    with open(f"{tmp}/{name}", "wb") as f:
        f.write(data if isinstance(data, bytes) else data.encode())
    return f"{tmp}/{name}"
def parts(count, pack=lambda b: b, front=b"", behind=b"", numbers=None):
    for k, slab in enumerate(np.split(A, count)):
        put("s/a%03d.raw" % (numbers[k] if numbers else k + 1), front + pack(slab.tobytes()) + behind)
def nrrd(data, encoding="raw", more=""):
    return put("a.nhdr", "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 5 4 6\nendian: little\nencoding: %s\n%sdata file: %s" %
               (encoding, more, data))
def meta(data, more=""):
    return put("a.mhd", "NDims = 3\nDimSize = 5 4 6\n%sElementType = MET_USHORT\nElementDataFile = %s" % (more, data))
LIST = lambda count, end="\n": "LIST\n" + "\n".join("s/a%03d.raw" % (k + 1) for k in range(count)) + end
PATTERN = lambda count: "s/a%%03d.raw 1 %d 1\n" % count
for count in 1, 2, 3, 6:
    parts(count)
    for word in LIST(count), LIST(count, "\n\n"), LIST(count, ""), PATTERN(count):
        same(nrrd(word), A)
        same(meta(word), A)
        same(nrrd(word.replace("LIST", "LIST 2") if "LIST" in word else word.replace(" 1\n", " 1 2\n")), A)
for name, pack in ("gzip", gzip.compress), ("gz", lambda b: zlib.compress(b, 9)), ("bzip2", bz2.compress):
    parts(3, pack)
    same(nrrd(LIST(3), name), A)
    parts(2, lambda b: pack(b"front" + b))
    same(nrrd(PATTERN(2), name, "byte skip: 5\n"), A)
    refused(nrrd(PATTERN(2), name, "byte skip: -1\n"), "raw encoding")
parts(3, zlib.compress)
same(meta(LIST(3), "CompressedData = True\n"), A)
parts(3, front=b"one\ntwo\nxy", behind=b"tail")
same(nrrd(LIST(3), more="line skip: 2\nbyte skip: 2\n"), A)
same(nrrd(LIST(3), more="byte skip: -5\n"), A)
parts(3, front=b"header")
same(meta(PATTERN(3), "HeaderSize = 6\n"), A)
same(meta(PATTERN(3), "HeaderSize = -1\n"), A)
parts(3, numbers=(12, 7, 2))
same(nrrd("s/a%03d.raw 12 2 -5\n"), A)
# One that does not fit.
parts(3)
refused(nrrd(LIST(4)), "a004.raw")
put("s/a004.raw", b"")
refused(nrrd(LIST(4)), "ends before its 60 bytes of samples do")
refused(nrrd("LIST\n" + "s/a001.raw\n" * 7), "are not shared equally by 7 files")
refused(nrrd("LIST\n"), "its list names no file")
put("s/a002.raw", A[2:4].tobytes()[:-1])
refused(nrrd(LIST(3)), "a002.raw: ends before its 80 bytes of samples do")
put("s/a002.raw", gzip.compress(A[2:4].tobytes())[:-9])
put("s/a001.raw", gzip.compress(A[:2].tobytes()))
refused(nrrd(LIST(2), "gzip"), "a001.raw: ends before its 120 bytes")
refused(nrrd(LIST(2), "text"), "samples as text in several files")
for pattern in "s/a%03x.raw 1 3 1", "s/a%03d.raw 1 3 0", "s/a%03d.raw 3 1 1", "s/a%03d.raw 1", "s/a%03d.raw -1 3 1":
    refused(nrrd(pattern + "\n"), "expected the pattern of names")
refused(nrrd("LIST\n../outside.raw\n"), "outside")
end()
PY
ok "samples in several files" "$python" "$tmp/test.py" "$tmp"
finish
