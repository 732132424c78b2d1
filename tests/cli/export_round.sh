#!/bin/sh
# export_round.sh - round trips: a volume to a treelet file, to another format, and converted again, with
# the same samples and the same map to the bit, for every format and type; and what other libraries read.
# marks: long plain
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
verb() { "$leafcast" --list-verbs | grep -qx "$1"; }
left() { [ "$(find "$tmp" -name 'x*' | wc -l)" = "$1" ]; }

# plain FILE: a treelet file's samples and place, without a name.
plain() { "$leafcast" export "$1" -o - --format nrrd | LC_ALL=C sed '/^content: /d'; }
plain_is() {
    plain "$1" >"$tmp/one.nrrd"
    plain "$2" >"$tmp/other.nrrd"
    cmp "$tmp/one.nrrd" "$tmp/other.nrrd"
}

# ---- volumes: every type that is stored as it comes, upright, turned and sheared, and with constant parts ----
cat >"$tmp/make.py" <<'PY'
import random, struct, sys
kind, where, out = sys.argv[1:]
types = {"u8": ("uint8", "B", 0, 255), "i8": ("int8", "b", -128, 127), "u16": ("uint16", "H", 0, 65535),
         "i16": ("int16", "h", -32768, 32767), "f32": ("float", "I", 0, 0x7f7fffff)}
maps = {"upright": ("(0.5,0,0) (0,0.30000000000000004,0) (0,0,2)", "(0,0,0)"),
        "turned": ("(0,-1.5,0) (0.25,0,0.5) (0,0.125,3)", "(1,-25.5,0.1)")}
name, code, low, high = types[kind]
n = (37, 20, 45)
random.seed(kind)
samples = []
for z in range(n[2]):
    for y in range(n[1]):
        for x in range(n[0]):
            samples.append(5 if x >= 18 and z >= 9 else random.randint(low, high))
head = "NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n" % ((name,) + n)
head += "space dimension: 3\nspace directions: %s\nspace origin: %s\n\n" % maps[where]
with open(out, "wb") as f:
    f.write(head.encode() + struct.pack("<%d%s" % (len(samples), code), *samples))
PY

# comes_back FORMAT HOW: exported, converted, the same.
comes_back() {
    exits "$type, $where, to $1" 0 "$leafcast" export "$tmp/a.leaf" -o "$tmp/$1" -q
    case $1 in *%*) set -- "${1%/*}" ;; esac
    # NIfTI has no word for axes that nobody tells, MetaImage none for units.
    case $1 in *.nii*) axes="--axes none" ;; *.mha) axes="--axes none --unit=" ;; *) axes= ;; esac
    # shellcheck disable=SC2086 # words, or none
    exits "and back" 0 "$leafcast" convert "$tmp/$1" $axes -o "$tmp/b.leaf" -q --force
    ok "the same samples and map" plain_is "$tmp/a.leaf" "$tmp/b.leaf"
    rm -rf "${tmp:?}/$1"
}

for type in u8 i8 u16 i16 f32; do
    for where in upright turned; do
        python3 "$tmp/make.py" $type $where "$tmp/a.nrrd"
        "$leafcast" convert "$tmp/a.nrrd" -o "$tmp/a.leaf" -q --force
        plain "$tmp/a.leaf" >"$tmp/one.nrrd"
        ok "$type, $where: the treelet file has the input" cmp "$tmp/a.nrrd" "$tmp/one.nrrd"
        comes_back x.nrrd
        comes_back x.nrrd.gz
        comes_back x.nii
        comes_back x.nii.gz
        [ $where = turned ] || comes_back x.mha # likewise
        [ $where = turned ] || comes_back x.vti # of others direction times spacing rounds
        # A .vtr has axes, and stays one.
        if [ $where = upright ]; then
            exits "$type to x.vtr" 0 "$leafcast" export "$tmp/a.leaf" -o "$tmp/x.vtr" -q
            exits "and back" 0 "$leafcast" convert "$tmp/x.vtr" -o "$tmp/b.leaf" -q --force
            exits "and again" 0 "$leafcast" export "$tmp/b.leaf" -o - --format vtr
            ok "the same axes and samples" cmp "$tmp/x.vtr" "$tmp/out"
            rm "$tmp/x.vtr"
        fi
        if verb import-vdb; then comes_back x.vdb; else skip "vdb" "no OpenVDB here"; fi
        if verb import-images; then
            comes_back x.tif
            mkdir "$tmp/x"
            comes_back x/slice%03d.tif
        else
            skip "tiff" "no OpenImageIO here"
        fi
    done
done
# NumPy's keep what they are, not where.
exits "NumPy" 0 "$leafcast" export "$tmp/a.leaf" -o "$tmp/x.npy"
ok "tells what is lost" grep -q "does not tell where its samples lie" "$tmp/err"
exits "and back" 0 "$leafcast" convert "$tmp/x.npy" -o "$tmp/b.leaf" -q --force
exits "as raw" 0 "$leafcast" export "$tmp/b.leaf" -o "$tmp/y.raw" -q
tail -c "$(wc -c <"$tmp/y.raw")" "$tmp/a.nrrd" >"$tmp/samples"
ok "the same bytes" cmp "$tmp/samples" "$tmp/y.raw"
if python3 -c 'import numpy' 2>/dev/null; then
    ok "NumPy reads the same" python3 -c 'import numpy, sys
a = numpy.load(sys.argv[1]); assert a.shape[::-1] == (37, 20, 45) and a.tobytes() == open(sys.argv[2], "rb").read(), a.shape' \
        "$tmp/x.npy" "$tmp/y.raw"
else
    skip "NumPy" "it is not here"
fi
rm "$tmp/x.npy" "$tmp/y.raw"
# Raw samples say nothing of themselves.
exits "raw" 0 "$leafcast" export "$tmp/a.leaf" -o "$tmp/x.raw" -q
tail -c "$(wc -c <"$tmp/x.raw")" "$tmp/a.nrrd" >"$tmp/samples"
ok "are the input's bytes" cmp "$tmp/samples" "$tmp/x.raw"
rm "$tmp/x.raw"

# ---- a box, a level, a pipe, several fields ----
python3 "$tmp/make.py" u16 turned "$tmp/a.nrrd"
"$leafcast" convert "$tmp/a.nrrd" -o "$tmp/a.leaf" -q --force
for part in "--box 3,5,7,20,19,40" "--level 1"; do
    # shellcheck disable=SC2086 # split on purpose
    "$leafcast" export "$tmp/a.leaf" $part -o "$tmp/part.nrrd" -q --force
    "$leafcast" convert "$tmp/part.nrrd" -o "$tmp/part.leaf" -q --force
    for format in vdb tif; do
        # shellcheck disable=SC2086
        exits "$part to .$format" 0 "$leafcast" export "$tmp/a.leaf" $part -o "$tmp/x.$format" -q
        case $format in vdb) verb import-vdb || continue ;; *) verb import-images || continue ;; esac
        "$leafcast" convert "$tmp/x.$format" -o "$tmp/b.leaf" -q --force
        ok "is that part" plain_is "$tmp/part.leaf" "$tmp/b.leaf"
    done
    rm -f "$tmp"/x.*
done
for format in vdb tiff; do
    run "$leafcast" export "$tmp/a.leaf" --format $format -o "$tmp/x.$format" --threads 1
    exits ".$format to a pipe, with more threads" 0 "$leafcast" export "$tmp/a.leaf" --format $format -o - --threads 4
    size=$(wc -c <"$tmp/out")
    ok "of the same length" [ "$size" = "$(wc -c <"$tmp/x.$format")" ]
    [ $format = vdb ] || ok "the same bytes" cmp "$tmp/out" "$tmp/x.$format"
    cp "$tmp/out" "$tmp/x.piped.vdb"
    if [ $format = vdb ] && verb import-vdb; then
        exits "which is read without offsets" 0 "$leafcast" convert "$tmp/x.piped.vdb" -o "$tmp/b.leaf" -q --force
        ok "as the same" plain_is "$tmp/a.leaf" "$tmp/b.leaf"
    fi
    rm "$tmp"/x.*
done

# ---- what other programs read ----
python3 "$tmp/make.py" f32 turned "$tmp/a.nrrd"
"$leafcast" convert "$tmp/a.nrrd" -o "$tmp/a.leaf" -q --force
"$leafcast" export "$tmp/a.leaf" -o "$tmp/a.raw" -q
"$leafcast" export "$tmp/a.leaf" -o "$tmp/a.vdb" -q
if command -v vdb_print >/dev/null; then
    exits "vdb_print" 0 vdb_print -l "$tmp/a.vdb"
    ok "finds the whole grid" grep -q 'Bounding box of active voxels: \[0, 0, 0\] -> \[36, 19, 44\]' "$tmp/out"
    ok "and its map" grep -q '\[1, -25.5, 0.1, 1\]' "$tmp/out"
else
    skip "vdb_print" "it is not here"
fi
python=$(python_with tifffile)
if [ -n "$python" ]; then
    "$leafcast" export "$tmp/a.leaf" -o "$tmp/a.tif" -q
    cat >"$tmp/read.py" <<'PY'
import sys, numpy, tifffile
with tifffile.TiffFile(sys.argv[1]) as t:
    assert t.is_ome and len(t.series) == 1 and len(t.pages) == 45, t
    got = t.asarray()
    x = t.pages[0].tags["XResolution"].value
    assert abs(x[0] / x[1] * 1.5 - 1) < 1e-8, x
want = numpy.fromfile(sys.argv[2], "<f4").reshape(45, 20, 37)
assert got.dtype == want.dtype and got.shape == want.shape and got.tobytes() == want.tobytes()
PY
    exits "tifffile reads the same" 0 "$python" "$tmp/read.py" "$tmp/a.tif" "$tmp/a.raw"
else
    skip "tifffile" "it is not here"
fi
python=$(python_with nibabel)
if [ -n "$python" ]; then
    "$leafcast" export "$tmp/a.leaf" -o "$tmp/a.nii.gz" -q
    cat >"$tmp/read.py" <<'PY'
import sys, numpy, nibabel
t = nibabel.load(sys.argv[1])
want = numpy.fromfile(sys.argv[2], "<f4").reshape(45, 20, 37).T
got = numpy.asarray(t.dataobj)
assert got.shape == want.shape and got.astype("<f4").tobytes() == want.tobytes()
assert (t.affine[:3] == [[0, .25, 0, 1], [-1.5, 0, .125, -25.5], [0, .5, 3, .1]]).all(), t.affine
PY
    exits "nibabel reads the same" 0 "$python" "$tmp/read.py" "$tmp/a.nii.gz" "$tmp/a.raw"
else
    skip "nibabel" "it is not here"
fi
python=$(python_with vtkmodules.vtkIOXML)
if [ -n "$python" ]; then
    "$leafcast" export "$tmp/a.leaf" -o "$tmp/a.vti" -q
    cat >"$tmp/read.py" <<'PY'
import sys
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
r = vtkXMLImageDataReader()
r.SetFileName(sys.argv[1])
r.Update()
v = r.GetOutput()
assert v.GetDimensions() == (37, 20, 45), v.GetDimensions()
a = v.GetPointData().GetScalars()
assert memoryview(a).tobytes() == open(sys.argv[2], "rb").read()
p = [0, 0, 0]
v.TransformIndexToPhysicalPoint(2, 3, 4, p)
assert max(abs(p[0] - 1.75), abs(p[1] + 28), abs(p[2] - 13.6)) < 1e-9, p
PY
    exits "VTK reads the same" 0 "$python" "$tmp/read.py" "$tmp/a.vti" "$tmp/a.raw"
else
    skip "VTK" "it is not here"
fi

# ---- nothing half-written ----
mkdir "$tmp/s"
exits "slices" 0 "$leafcast" export "$tmp/a.leaf" -o "$tmp/s/x%03d.tif"
ok "are files" left 45
exits "that are there already" 1 "$leafcast" export "$tmp/a.leaf" -o "$tmp/s/x%03d.tif"
ok "are left" left 45
rm "$tmp"/s/*
for out in "s/x%03d.tif" x.tif x.vdb; do
    # shellcheck disable=SC2016
    exits "a file that may not grow: $out" 4 sh -c 'ulimit -f 2; exec "$1" export "$2" -o "$3"' sh "$leafcast" "$tmp/a.leaf" "$tmp/$out"
    ok "leaves nothing" left 0
    exits "too little memory: $out" 4 "$leafcast" export "$tmp/a.leaf" -o "$tmp/$out" --memory 150K
    ok "leaves nothing, too" left 0
    exits "packed: $out" 2 "$leafcast" export "$tmp/a.leaf" -o "$tmp/$out.gz"
done
exits "a pattern that is none" 2 "$leafcast" export "$tmp/a.leaf" -o "$tmp/x%s.tif"
seq 1 3 16 >"$tmp/axis"
"$leafcast" generate gyroid --dims 6 -o - -q | tail -c 216 >"$tmp/even.raw"
"$leafcast" convert "$tmp/even.raw" --dims 6,6,6 --type u8 --axis-x "$tmp/axis" -o "$tmp/r.leaf" -q
for format in vdb tif; do
    exits "uneven axes as .$format" 3 "$leafcast" export "$tmp/r.leaf" -o "$tmp/x.$format"
    ok "says so" says uneven
done
ok "none of them leaves a file" left 0
finish
