#!/bin/sh
# inputs.sh - what convert, resample, tetrahedralize and info make of inputs: headers without end, options that an input
# cannot use.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }

# Headers of megabytes are read in their own length of time; each of these takes a minute where time grows with the
# square.
python3 - "$tmp" <<'PY'
import sys
folder = sys.argv[1] + "/"
nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
key, blank = "k" * 3000, " " * 3000
def write(name, text, samples=64):
    with open(folder + name, "wb") as f:
        f.write(text.encode() + bytes(samples))
write("pairs.nrrd", nrrd + "".join(f"{key}{i}:=x\n" for i in range(4000)) + "\n")
write("blanks.nrrd", nrrd + "".join(f"k{blank}{i}:=x\n" for i in range(4000)) + "\n")
write("comments.nrrd", nrrd + "# c\n" * 4000000 + "\n")
write("line.nrrd", nrrd + "# " + "c" * 16000000 + "\n\n")
write("twice.nrrd", nrrd + "".join(f"{key}{i}:=x\n" for i in range(4000)) + f" {key.upper()} 7:=x\n\n")
mha = "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\n"
write("keys.mha", mha + "".join(f"{key}{i} = x\n" for i in range(4000)) + "ElementDataFile = LOCAL\n")
grid = """DATASET UNSTRUCTURED_GRID
POINTS 4 float
0 0 0 1 0 0 0 1 0 0 0 1
CELLS 1 5
4 0 1 2 3
CELL_TYPES 1
10
POINT_DATA 4
"""
scalars = "SCALARS s%d float 1\nLOOKUP_TABLE default\n0 1 2 3\n"
write("arrays.vtk", "# vtk DataFile Version 3.0\nt\nASCII\n" + grid + "".join(scalars % i for i in range(100000)), 0)
write("title.vtk", "# vtk DataFile Version 3.0\n" + "t" * 16000000 + "\nASCII\n" + grid + scalars % 0, 0)
write("comments.csv", "# c\n" * 4000000 + "x,y,z\n0,0,0\n1,0,0\n0,1,0\n0,0,1\n", 0)
PY
for input in pairs.nrrd blanks.nrrd comments.nrrd line.nrrd keys.mha arrays.vtk title.vtk; do
    exits "a long header, $input" 0 timeout 30 "$leafcast" convert "$tmp/$input" -o "$tmp/$input.leaf"
done
exits "a key that comes twice in a long header" 3 timeout 30 "$leafcast" convert "$tmp/twice.nrrd" -o "$tmp/x.leaf"
ok "is told with its line" says 'line 4006: .*comes twice'
rm "$tmp"/*.nrrd "$tmp"/*.vtk
finish
