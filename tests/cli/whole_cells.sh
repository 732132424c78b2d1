#!/bin/sh
# whole_cells.sh - convert --whole-cells: hexahedra, wedges, pyramids and tets of VTK's and Gmsh's files stay
# what they are; the same bytes in any memory; steps whose nodes move; what does not go with it.
# marks: long
. tests/support/tap.sh
says() { grep -q -- "$1" "$tmp/err"; }
json() { python3 -c 'import json,sys; x = json.load(open(sys.argv[1])); sys.exit(not eval(sys.argv[2]))' "$tmp/out" "$1"; }

cat >"$tmp/mix.py" <<'PY'
"""mix.py FORM N SHIFT: a bent mesh of N^3 cubes, some whole, some cut, as VTK has it (VTK, VTU, Gmsh)."""
import math, struct, sys
form, n, shift = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
def bend(x, y, z):
    return (x + 0.08 * math.sin(4 * y) * math.cos(3 * z) + shift * y, y + 0.08 * math.sin(4 * z + 1) * math.cos(3 * x),
            z + 0.08 * math.sin(4 * x + 2) * math.cos(3 * y))
at = range(n + 1)
points = [bend(i / n, j / n, k / n) for k in at for j in at for i in at]
cells = []
def node(i, j, k): return i + (n + 1) * (j + (n + 1) * k)
def middle(ids):
    points.append(tuple(sum(points[v][a] for v in ids) / len(ids) for a in range(3)))
    return len(points) - 1
for k in range(n):
    for j in range(n):
        for i in range(n):
            v = [node(i + a, j + b, k + c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
            if (i + j) % 2 == 0 and (i + k) % 3:
                cells.append((12, v))
            elif (i + j) % 2 == 0:
                m = middle(v)
                for q in ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)):
                    cells.append((14, [v[x] for x in q] + [m]))
            else:
                for h, t in enumerate(((0, 1, 2), (0, 2, 3))):
                    w = [v[x] for x in t] + [v[x + 4] for x in t]
                    if (k + h) % 2:
                        cells.append((13, w))
                        continue
                    m = middle(w)
                    for q in ((0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)):
                        cells.append((14, [w[x] for x in q] + [m]))
                    for q in ((0, 1, 2), (3, 5, 4)):
                        cells.append((10, [w[x] for x in q] + [m]))
values = [math.sin(6 * x) * math.cos(6 * y) + math.sin(6 * z + shift) for x, y, z in points]
out = sys.stdout.buffer
def floats(x, end): return struct.pack(end + "%df" % len(x), *x)
def ints(x, end): return struct.pack(end + "%di" % len(x), *x)
flat = [c for p in points for c in p]
if form == "vtk":
    ids = [x for _, c in cells for x in [len(c)] + c]
    out.write(b"# vtk DataFile Version 3.0\nmix\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS %d float\n" % len(points) +
              floats(flat, ">") + b"\nCELLS %d %d\n" % (len(cells), len(ids)) + ints(ids, ">") +
              b"\nCELL_TYPES %d\n" % len(cells) + ints([t for t, _ in cells], ">") +
              b"\nPOINT_DATA %d\nSCALARS f float 1\nLOOKUP_TABLE default\n" % len(points) + floats(values, ">"))
elif form == "vtu":
    ends, end = [], 0
    for _, c in cells:
        end += len(c)
        ends.append(end)
    def array(name, kind, more, x): return '<DataArray type="%s" Name="%s" %s format="ascii">%s</DataArray>' % (kind, name, more, " ".join(map(repr, x)))
    out.write(('<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid><Piece NumberOfPoints="%d" NumberOfCells="%d"><PointData>' %
               (len(points), len(cells)) + array("f", "Float64", "", values) + "</PointData><Points>" +
               array("p", "Float64", 'NumberOfComponents="3"', flat) + "</Points><Cells>" +
               array("connectivity", "Int32", "", [v for _, c in cells for v in c]) + array("offsets", "Int32", "", ends) +
               array("types", "Int32", "", [t for t, _ in cells]) + "</Cells></Piece></UnstructuredGrid></VTKFile>").encode())
else:
    kinds = {12: 5, 13: 6, 14: 7, 10: 4}
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(points))]
    text += ["%d %r %r %r" % ((i + 1,) + p) for i, p in enumerate(points)] + ["$EndNodes", "$Elements", str(len(cells))]
    text += ["%d %d 2 0 0 %s" % (i + 1, kinds[t], " ".join(str(v + 1) for v in c)) for i, (t, c) in enumerate(cells)]
    text += ["$EndElements", "$NodeData", "1", '"f"', "1", "0", "3", "0", "1", str(len(points))]
    text += ["%d %r" % (i + 1, v) for i, v in enumerate(values)] + ["$EndNodeData"]
    out.write(("\n".join(text) + "\n").encode())
PY
make() { python3 "$tmp/mix.py" "$1" "$2" "$3" >"$4"; }

# ---- shapes and formats ----

for form in vtk vtu msh; do
    make $form 6 0 "$tmp/s.$form"
    exits "$form" 0 "$leafcast" convert "$tmp/s.$form" --whole-cells -o "$tmp/s_$form.leaf" --json
    ok "keeps each shape" json 'x["whole"] == [72, 108, 540, 0, 216] and x["split"] == [0] * 4 and x["tets"] == 936'
    exits "is sound" 0 "$leafcast" verify "$tmp/s_$form.leaf"
    exits "draws" 0 "$leafcast" render "$tmp/s_$form.leaf" --iso 0.2 --size 64x48 -o "$tmp/$form.pfm" -q
done
ok "of VTK's two forms the same picture" cmp "$tmp/vtk.pfm" "$tmp/vtu.pfm"
ok "of Gmsh, too" cmp "$tmp/vtk.pfm" "$tmp/msh.pfm"
exits "split" 0 "$leafcast" convert "$tmp/s.vtk" -o "$tmp/split.leaf" --json
ok "counts what was split" json 'x["split"] == [72, 108, 540, 0] and x["whole"] == [0] * 5'
exits "whole, in words" 0 "$leafcast" convert "$tmp/s.vtk" --whole-cells -o "$tmp/x.leaf" --force
ok "tells shapes" grep -q '^whole  *540 pyramids$' "$tmp/out"
ok "and cells" grep -q '^mesh  *936 cells, ' "$tmp/out"
exits "info" 0 "$leafcast" info "$tmp/s_vtk.leaf" --json
ok "tells what it is" json 'x["kind"] == "mixed mesh" and x["cells"] == 936 and x["folded"] == 0 and not x["moving"]'
exits "info, in words" 0 "$leafcast" info "$tmp/s_vtk.leaf"
ok "tells cells and nodes" grep -q '^mixed mesh  *936 cells, [0-9]* nodes$' "$tmp/out"

# ---- memory ----

make vtk 32 0 "$tmp/b.vtk"
exits "in memory" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells -o "$tmp/b.leaf" --threads 2 -q
for threads in 1 3; do
    exits "a plan for $threads threads" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells -o "$tmp/n.leaf" --threads $threads --dry-run --json
    least=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["memory_least"] // 2**20 + 1)' "$tmp/out")
    exits "in so little memory" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells -o "$tmp/c.leaf" --force \
        --memory "${least}M" --threads $threads --json
    ok "through scratch files" json 'x["spill_bytes"] > 0'
    ok "the same bytes" cmp "$tmp/b.leaf" "$tmp/c.leaf"
done
exits "in too little" 4 "$leafcast" convert "$tmp/b.vtk" --whole-cells -o "$tmp/c.leaf" --force --memory 2M
ok "says what would do" says 'this mesh needs [0-9]* MiB'
exits "drawn in little memory" 0 "$leafcast" render "$tmp/b.leaf" --iso 0.2 --size 64x48 --memory 4M -o "$tmp/little.pfm" -q
exits "and in much" 0 "$leafcast" render "$tmp/b.leaf" --iso 0.2 --size 64x48 -o "$tmp/much.pfm" -q
ok "the same picture" cmp "$tmp/little.pfm" "$tmp/much.pfm"

# ---- steps ----

for i in 0 1 2; do make vtk 6 0.0$i "$tmp/m_$i.vtk"; done
exits "nodes that move" 0 "$leafcast" convert "$tmp/m_0.vtk" "$tmp/m_1.vtk" "$tmp/m_2.vtk" --whole-cells -o "$tmp/m.leaf" --json
ok "do" json 'x["moving"]'
exits "are sound" 0 "$leafcast" verify "$tmp/m.leaf"
for i in 0 1 2; do
    exits "step $i alone" 0 "$leafcast" convert "$tmp/m_$i.vtk" --whole-cells -o "$tmp/m_$i.leaf" -q
    for file in m m_$i; do
        step=0
        [ $file != m ] || step=$i
        "$leafcast" render "$tmp/$file.leaf" --step $step --iso 0.2 --size 64x48 --eye 0.5,0.6,4 --look-at 0.5,0.5,0.5 -o "$tmp/$file.pfm" --force -q || true
    done
    ok "looks the same in the series" cmp "$tmp/m.pfm" "$tmp/m_$i.pfm"
done
exits "another topology" 3 "$leafcast" convert "$tmp/m_0.vtk" "$tmp/b.vtk" --whole-cells -o "$tmp/x.leaf" --force
ok "is refused" says 'm_0.vtk has, found more\|must be the same at each step'

# ---- what does not go with it ----

while read -r option; do
    # shellcheck disable=SC2086 # split on purpose
    exits "--whole-cells $option" 2 "$leafcast" convert "$tmp/s.vtk" --whole-cells $option -o "$tmp/x.leaf" --force
    ok "says so" says "--whole-cells"
done <<'X'
--gradients
--coarse
--build sah
--compress zstd
--leaf-tets 4
--treelet-tets 16384
X
exits "steps that are added later" 2 "$leafcast" convert "$tmp/s.vtk" --whole-cells --append -o "$tmp/new.leaf"
ok "says so" says "--whole-cells goes without --append"
exits "--compress none" 0 "$leafcast" convert "$tmp/s.vtk" --whole-cells --compress none -o "$tmp/x.leaf" --force -q
exits "a grid" 2 "$leafcast" convert "$tmp/s.vtk" --dims 2,2,2 --type u8 --whole-cells -o "$tmp/x.leaf" --force
finish
