#!/bin/sh
# quadratic_cells.sh - convert --whole-cells of tets of ten nodes, of VTK's, Gmsh's files and mesh streams: the
# surface of a quadratic field is a sphere; out again, resampled, compressed, in steps, with coarse grids; what is
# refused.
# marks: long
. tests/support/tap.sh
says() { grep -q -- "$1" "$tmp/err"; }
json() { python3 -c 'import json,sys; x = json.load(open(sys.argv[1])); sys.exit(not eval(sys.argv[2]))' "$tmp/out" "$1"; }

cat >"$tmp/tens.py" <<'PY'
"""tens.py FORM N BEND: N^3 cubes of six tets of ten nodes, their edges bent by BEND; the value is x^2 + y^2 + z^2."""
import math, struct, sys
form, n, bend = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
m = 2 * n + 1
def place(i, j, k):
    x, y, z = (2 * v / (m - 1) - 1 for v in (i, j, k))
    return (x + bend * math.sin(3 * y + z), y + bend * math.sin(3 * z + x), z + bend * math.sin(3 * x + y))
points = [place(i, j, k) for k in range(m) for j in range(m) for i in range(m)]
values = [x * x + y * y + z * z for x, y, z in points]
edges = (0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)
orders = (0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (0, 2, 1), (2, 1, 0)
cells = []
for cube in range(n ** 3):
    for o in orders:
        c = [[cube % n, cube // n % n, cube // n // n]]
        for a in o:
            c.append([v + (b == a) for b, v in enumerate(c[-1])])
        at = [[2 * v for v in p] for p in c] + [[v + w for v, w in zip(c[a], c[b])] for a, b in edges]
        cells.append([i + m * (j + m * k) for i, j, k in at])
out = sys.stdout.buffer
flat = [v for p in points for v in p]
def floats(x, end): return struct.pack(end + "%df" % len(x), *x)
def ints(x, end): return struct.pack(end + "%di" % len(x), *x)
if form == "vtk":
    out.write(b"# vtk DataFile Version 3.0\ntens\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS %d float\n" % len(points) +
              floats(flat, ">") + b"\nCELLS %d %d\n" % (len(cells), 11 * len(cells)) +
              ints([v for c in cells for v in [10] + c], ">") + b"\nCELL_TYPES %d\n" % len(cells) +
              ints([24] * len(cells), ">") + b"\nPOINT_DATA %d\nSCALARS f float 1\nLOOKUP_TABLE default\n" % len(points) +
              floats(values, ">"))
elif form == "vtu":
    def array(name, kind, more, x): return '<DataArray type="%s" Name="%s" %s format="ascii">%s</DataArray>' % (kind, name, more, " ".join(map(repr, x)))
    out.write(('<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid><Piece NumberOfPoints="%d" NumberOfCells="%d"><PointData>' %
               (len(points), len(cells)) + array("f", "Float64", "", values) + "</PointData><Points>" +
               array("p", "Float64", 'NumberOfComponents="3"', flat) + "</Points><Cells>" +
               array("connectivity", "Int32", "", [v for c in cells for v in c]) +
               array("offsets", "Int32", "", [10 * (i + 1) for i in range(len(cells))]) +
               array("types", "Int32", "", [24] * len(cells)) + "</Cells></Piece></UnstructuredGrid></VTKFile>").encode())
elif form == "mesh":
    out.write(b"LEAFCAST MESH 2\nfield: f\npoints: %d\nquadratic tets: %d\n\n" % (len(points), len(cells)) +
              floats(flat, "<") + floats(values, "<") + ints([v for c in cells for v in c], "<"))
else:
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(points))]
    text += ["%d %r %r %r" % ((i + 1,) + p) for i, p in enumerate(points)] + ["$EndNodes", "$Elements", str(len(cells))]
    text += ["%d 11 2 0 0 %s" % (i + 1, " ".join(str(c[v] + 1) for v in (0, 1, 2, 3, 4, 5, 6, 7, 9, 8))) for i, c in enumerate(cells)]
    text += ["$EndElements", "$NodeData", "1", '"f"', "1", "0", "3", "0", "1", str(len(points))]
    text += ["%d %r" % (i + 1, v) for i, v in enumerate(values)] + ["$EndNodeData"]
    out.write(("\n".join(text) + "\n").encode())
PY
make() { python3 "$tmp/tens.py" "$1" "$2" "$3" >"$4"; }

# ---- formats ----

for form in vtk vtu msh mesh; do
    make $form 4 0.05 "$tmp/s.$form"
    exits "$form" 0 "$leafcast" convert "$tmp/s.$form" --whole-cells -o "$tmp/s_$form.leaf" --json
    ok "keeps the tets" json 'x["whole"] == [0, 0, 0, 0, 0, 384] and x["tets"] == 384 and x["vertices"] == 729'
    exits "is sound" 0 "$leafcast" verify "$tmp/s_$form.leaf"
    exits "draws" 0 "$leafcast" render "$tmp/s_$form.leaf" --iso 0.5 --size 64x48 -o "$tmp/$form.pfm" -q
    exits "split" 3 "$leafcast" convert "$tmp/s.$form" -o "$tmp/none.leaf"
    ok "is refused, and told how it is taken" says '--whole-cells'
    ok "and nothing is left" [ ! -e "$tmp/none.leaf" ]
    exits "info" 0 "$leafcast" info "$tmp/s.$form" --json
    ok "tells of them, and how they are taken" json 'x["quadratic"] == 384 == x["tets"] and " --whole-cells " in x["next"]'
done
for form in vtu msh mesh; do
    ok "of $form the same picture" cmp "$tmp/vtk.pfm" "$tmp/$form.pfm"
done
exits "in words" 0 "$leafcast" convert "$tmp/s.vtk" --whole-cells -o "$tmp/x.leaf"
ok "tells the shape" grep -q '^whole  *384 quadratic tets$' "$tmp/out"
exits "info" 0 "$leafcast" info "$tmp/x.leaf" --json
ok "tells how many" json 'x["cells"] == 384 and x["quadratic"] == 384 and x["folded"] == 0'
exits "by corners" 0 "$leafcast" convert "$tmp/s.vtk" --by-corners -o "$tmp/lin.leaf" --json
ok "they are linear" json 'x["by_corners"] == 384 and x["tets"] == 384'
exits "by corners, whole" 0 "$leafcast" convert "$tmp/s.vtk" --by-corners --whole-cells -o "$tmp/lin2.leaf" --json
ok "they are linear, too" json 'x["by_corners"] == 384 and x["whole"] == [0, 0, 0, 0, 384, 0]'

python3 - "$tmp/s.msh" >"$tmp/each.msh" <<'PY'
"""The same, the values at the nodes of each element."""
import sys
text = open(sys.argv[1]).read()
head, data = text.split("$NodeData")
values = dict(row.split() for row in data.split("\n")[9:-2])
rows = head.split("$Elements\n")[1].split("$EndElements")[0].split("\n")[1:-1]
out = [head.rstrip(), "$ElementNodeData", "1", '"f"', "1", "0", "3", "0", "1", str(len(rows))]
for row in rows:
    number, nodes = row.split()[0], row.split()[5:]
    out.append(" ".join([number, "10"] + [values[v] for v in nodes]))
print("\n".join(out + ["$EndElementNodeData"]))
PY
exits "values of each element's nodes" 0 "$leafcast" convert "$tmp/each.msh" --whole-cells -o "$tmp/each.leaf" -q
exits "drawn" 0 "$leafcast" render "$tmp/each.leaf" --iso 0.5 --size 64x48 -o "$tmp/each.pfm" -q
ok "the same picture" cmp "$tmp/vtk.pfm" "$tmp/each.pfm"

# ---- the surface of x^2 + y^2 + z^2 ----

cat >"$tmp/sphere.py" <<'PY'
"""sphere.py MOST: the hits of probe --json on standard input lie on the sphere of radius 0.7, to within MOST; there are two."""
import json, math, sys
hits = json.load(sys.stdin)["hits"]
off = [abs(math.dist(h["point"], (0, 0, 0)) - 0.7) for h in hits]
sys.exit(len(hits) != 2 or max(off) > float(sys.argv[1]))
PY
on_sphere() { "$leafcast" probe "$1" --iso 0.49 --ray="$2" --json | python3 "$tmp/sphere.py" "$3"; }
beside() { ! on_sphere "$@"; }
make vtk 4 0 "$tmp/straight.vtk"
exits "straight tets" 0 "$leafcast" convert "$tmp/straight.vtk" --whole-cells -o "$tmp/straight.leaf" -q
exits "linear ones" 0 "$leafcast" convert "$tmp/straight.vtk" --by-corners -o "$tmp/flat.leaf" -q
for along in 3,0.1,0.2,-1,0,0 0.3,3,-0.2,0,-1,0 2,2,2,-1,-1.03,-0.98 -3,1,0.5,1,-0.4,-0.1; do
    ok "a quadratic field's surface is exact, $along" on_sphere "$tmp/straight.leaf" "$along" 3e-7
    ok "of linear tets it is not" beside "$tmp/flat.leaf" "$along" 1e-3
done

# ---- out again ----

exits "cells" 0 "$leafcast" export "$tmp/s_vtk.leaf" -o "$tmp/again.vtu" --json
ok "all of them" json 'x["cells"] == 384 and x["vertices"] == 729'
exits "as they were" 0 "$leafcast" convert "$tmp/again.vtu" --whole-cells -o "$tmp/again.leaf" --json
ok "of their shape" json 'x["whole"] == [0, 0, 0, 0, 0, 384]'
exits "draw" 0 "$leafcast" render "$tmp/again.leaf" --iso 0.5 --size 64x48 -o "$tmp/again.pfm" -q
ok "the same picture" cmp "$tmp/again.pfm" "$tmp/vtk.pfm"
exits "a surface" 0 "$leafcast" export "$tmp/s_vtk.leaf" --iso 0.5 -o "$tmp/s.ply" --json
ok "closed: V - E + F is 2" json '2 * x["vertices"] - x["triangles"] == 4'
exits "resampled" 0 "$leafcast" resample "$tmp/straight.vtk" --whole-cells --dims 9 -o "$tmp/r.nrrd"
ok "its nodes have the field" python3 -c 'import struct, sys
data = open(sys.argv[1], "rb").read().split(b"\n\n", 1)[1]
f = struct.unpack("<729f", data)
at = [v / 4 - 1 for v in range(9)]
want = [x * x + y * y + z * z for z in at for y in at for x in at]
sys.exit(max(abs(a - b) for a, b in zip(f, want)) > 1e-6)' "$tmp/r.nrrd"
exits "resampled as a treelet file" 0 "$leafcast" resample "$tmp/straight.leaf" --dims 9 -o "$tmp/r2.nrrd"
ok "the same" cmp "$tmp/r.nrrd" "$tmp/r2.nrrd"

# ---- compressed, in little memory, with coarse grids, in steps ----

make vtk 12 0.05 "$tmp/b.vtk"
exits "in memory" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells -o "$tmp/b.leaf" --threads 2 -q
exits "a plan" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells -o "$tmp/n.leaf" --threads 2 --dry-run --json
least=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["memory_least"] // 2**20 + 1)' "$tmp/out")
exits "in so little memory" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells -o "$tmp/c.leaf" --memory "${least}M" --threads 2 -q
ok "the same bytes" cmp "$tmp/b.leaf" "$tmp/c.leaf"
exits "compressed" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells --compress zstd -o "$tmp/z.leaf" -q
ok "less than half" [ $((2 * $(wc -c <"$tmp/z.leaf"))) -lt "$(wc -c <"$tmp/b.leaf")" ]
exits "is sound" 0 "$leafcast" verify "$tmp/z.leaf"
for file in b z; do
    exits "drawn, $file" 0 "$leafcast" render "$tmp/$file.leaf" --iso 0.5 --size 64x48 --memory 6M -o "$tmp/$file.pfm" -q
done
ok "the same picture" cmp "$tmp/b.pfm" "$tmp/z.pfm"
exits "with a coarse grid" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells --coarse -o "$tmp/k.leaf" -q
exits "is sound, too" 0 "$leafcast" verify "$tmp/k.leaf"
exits "draws a preview" 0 "$leafcast" render "$tmp/k.leaf" --iso 0.5 --preview --lod 1 --size 64x48 -o "$tmp/k.pfm" -q
for step in 0 1; do
    make vtk 4 0.0$((5 + step)) "$tmp/t_$step.vtk"
done
exits "steps whose nodes move" 0 "$leafcast" convert "$tmp/t_0.vtk" "$tmp/t_1.vtk" --whole-cells -o "$tmp/t.leaf" --json
ok "move" json 'x["steps"] == 2'
exits "are sound" 0 "$leafcast" verify "$tmp/t.leaf"
exits "the second, alone" 0 "$leafcast" convert "$tmp/t_1.vtk" --whole-cells -o "$tmp/t1.leaf" -q
for file in t t1; do
    step=$([ $file = t ] && echo 1 || echo 0)
    exits "drawn, $file" 0 "$leafcast" render "$tmp/$file.leaf" --step "$step" --iso 0.5 --size 64x48 --eye 3,2,1 \
        --look-at 0,0,0 -o "$tmp/$file.pfm" -q
done
ok "the same picture" cmp "$tmp/t.pfm" "$tmp/t1.pfm"
exits "between them" 0 "$leafcast" render "$tmp/t.leaf" --time 0.5 --interpolate --iso 0.5 --size 64x48 -o "$tmp/t05.pfm" -q
finish
