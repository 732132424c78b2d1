#!/bin/sh
# whole_cells.sh - convert --whole-cells: hexahedra, wedges, pyramids and tets of VTK's and Gmsh's files stay
# what they are; the same bytes in any memory; steps whose nodes move; what does not go with it.
# marks: long
. tests/support/tap.sh
says() { grep -q -- "$1" "$tmp/err"; }
json() { python3 -c 'import json,sys; x = json.load(open(sys.argv[1])); sys.exit(not eval(sys.argv[2]))' "$tmp/out" "$1"; }

cat >"$tmp/mix.py" <<'PY'
"""mix.py FORM N SHIFT: a bent mesh of N^3 cubes, some whole, some cut, as VTK has it (VTK, VTU, Gmsh); FORM2: of second order."""
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
kinds = {12: 5, 13: 6, 14: 7, 10: 4}
if form.endswith("2"): # nodes between corners, which are first
    form = form[:-1]
    more = {12: (25, 12), 13: (26, 9), 14: (27, 8), 10: (24, 6)}
    kinds = {25: 17, 26: 18, 27: 19, 24: 11}
    cells = [(more[t][0], c + [middle(c) for _ in range(more[t][1])]) for t, c in cells]
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
elif form == "mesh":
    rows = ("tets", 10), ("pyramids", 14), ("wedges", 13), ("hexahedra", 12)
    count = {t: sum(k == t for k, _ in cells) for _, t in rows}
    out.write(b"LEAFCAST MESH 2\nfield: other\nfield: f\npoints: %d\n" % len(points))
    out.write("".join("%s: %d\n" % (word, count[t]) for word, t in rows).encode() + b"\n")
    out.write(floats(flat, "<") + floats([0] * len(points), "<") + floats(values, "<"))
    out.write(ints([v for _, t in rows for k, c in cells if k == t for v in c], "<"))
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
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(points))]
    text += ["%d %r %r %r" % ((i + 1,) + p) for i, p in enumerate(points)] + ["$EndNodes", "$Elements", str(len(cells))]
    text += ["%d %d 2 0 0 %s" % (i + 1, kinds[t], " ".join(str(v + 1) for v in c)) for i, (t, c) in enumerate(cells)]
    text += ["$EndElements", "$NodeData", "1", '"f"', "1", "0", "3", "0", "1", str(len(points))]
    text += ["%d %r" % (i + 1, v) for i, v in enumerate(values)] + ["$EndNodeData"]
    out.write(("\n".join(text) + "\n").encode())
PY
make() { python3 "$tmp/mix.py" "$1" "$2" "$3" >"$4"; }

# ---- shapes and formats ----

for form in vtk vtu msh mesh; do
    make $form 6 0 "$tmp/s.$form"
    exits "$form" 0 "$leafcast" convert "$tmp/s.$form" --whole-cells --field f -o "$tmp/s_$form.leaf" --json
    ok "keeps each shape" json 'x["whole"] == [72, 108, 540, 0, 216, 0] and x["split"] == [0] * 4 and x["tets"] == 936'
    exits "is sound" 0 "$leafcast" verify "$tmp/s_$form.leaf"
    exits "draws" 0 "$leafcast" render "$tmp/s_$form.leaf" --iso 0.2 --size 64x48 -o "$tmp/$form.pfm" -q
done
ok "of VTK's two forms the same picture" cmp "$tmp/vtk.pfm" "$tmp/vtu.pfm"
ok "of Gmsh, too" cmp "$tmp/vtk.pfm" "$tmp/msh.pfm"
ok "of a mesh stream, too" cmp "$tmp/vtk.pfm" "$tmp/mesh.pfm"
exits "split" 0 "$leafcast" convert "$tmp/s.vtk" -o "$tmp/split.leaf" --json
ok "counts what was split" json 'x["split"] == [72, 108, 540, 0] and x["whole"] == [0] * 6'
exits "whole, in words" 0 "$leafcast" convert "$tmp/s.vtk" --whole-cells -o "$tmp/x.leaf" --force
ok "tells shapes" grep -q '^whole  *540 pyramids$' "$tmp/out"
ok "and cells" grep -q '^mesh  *936 cells, ' "$tmp/out"
exits "info" 0 "$leafcast" info "$tmp/s_vtk.leaf" --json
ok "tells what it is" json 'x["kind"] == "mixed mesh" and x["cells"] == 936 and x["folded"] == 0 and not x["moving"]'
exits "info, in words" 0 "$leafcast" info "$tmp/s_vtk.leaf"
ok "tells cells and nodes" grep -q '^mixed mesh  *936 cells, [0-9]* nodes$' "$tmp/out"

# ---- cells of higher order, by their corners ----

for form in vtk vtu msh; do
    make ${form}2 6 0 "$tmp/q.$form"
    exits "$form of second order" 3 "$leafcast" convert "$tmp/q.$form" -o "$tmp/none.leaf"
    ok "is refused, and told how it is taken" says '--by-corners takes it'
    exits "by corners" 0 "$leafcast" convert "$tmp/q.$form" --by-corners --whole-cells -o "$tmp/q.leaf" --force --json
    ok "is counted" json 'x["by_corners"] == 936 and x["whole"] == [72, 108, 540, 0, 216, 0]'
    exits "is sound" 0 "$leafcast" verify "$tmp/q.leaf"
    exits "draws" 0 "$leafcast" render "$tmp/q.leaf" --iso 0.2 --size 64x48 -o "$tmp/q_$form.pfm" -q
    ok "what the cells of first order do" cmp "$tmp/q_$form.pfm" "$tmp/vtk.pfm"
done
exits "tets of it" 0 "$leafcast" convert "$tmp/q.vtu" --by-corners -o "$tmp/q.leaf" --force
ok "say so" grep -q '^linear now  *936 cells of higher order, by their corners$' "$tmp/out"
exits "resampled" 0 "$leafcast" resample "$tmp/q.vtu" --by-corners --dims 9 -o -
mv "$tmp/out" "$tmp/q.nrrd"
exits "as those of first order" 0 "$leafcast" resample "$tmp/s.vtu" --dims 9 -o -
ok "are" cmp "$tmp/q.nrrd" "$tmp/out"
exits "a treelet file, resampled so" 2 "$leafcast" resample "$tmp/q.leaf" --by-corners --dims 9 -o -
exits "resampled whole" 0 "$leafcast" resample "$tmp/q.vtu" --by-corners --whole-cells --dims 9 -o -
ok "is another grid" [ "$(cmp -s "$tmp/q.nrrd" "$tmp/out"; echo $?)" = 1 ]
mv "$tmp/out" "$tmp/q.nrrd"
exits "whole cells" 0 "$leafcast" convert "$tmp/s.vtu" --whole-cells -o "$tmp/s.leaf" --force -q
exits "resampled as a treelet file" 0 "$leafcast" resample "$tmp/s.leaf" --dims 9 -o -
ok "are the same" cmp "$tmp/q.nrrd" "$tmp/out"
exits "a treelet file, to be kept whole" 2 "$leafcast" resample "$tmp/s.leaf" --whole-cells --dims 9 -o -
ok "says so" says '--whole-cells is for meshes, and .* is a treelet file'

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
exits "drawn in little memory" 0 "$leafcast" render "$tmp/b.leaf" --iso 0.2 --size 64x48 --memory 5M -o "$tmp/little.pfm" -q
exits "and in much" 0 "$leafcast" render "$tmp/b.leaf" --iso 0.2 --size 64x48 -o "$tmp/much.pfm" -q
ok "the same picture" cmp "$tmp/little.pfm" "$tmp/much.pfm"

# ---- compressed ----

exits "compressed" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells --compress zstd -o "$tmp/z.leaf" -q
ok "less than half" [ $((2 * $(wc -c <"$tmp/z.leaf"))) -lt "$(wc -c <"$tmp/b.leaf")" ]
exits "is sound" 0 "$leafcast" verify "$tmp/z.leaf"
for backend in mapped arena; do
    exits "drawn, $backend" 0 "$leafcast" render "$tmp/z.leaf" --iso 0.2 --size 64x48 --backend $backend --memory 6M \
        -o "$tmp/z.pfm" --force -q
    ok "the same picture" cmp "$tmp/z.pfm" "$tmp/much.pfm"
done
exits "a plan" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells --compress zstd -o "$tmp/n.leaf" --threads 2 --dry-run --json
least=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["memory_least"] // 2**20 + 1)' "$tmp/out")
exits "compressed in so little memory" 0 "$leafcast" convert "$tmp/b.vtk" --whole-cells --compress zstd \
    -o "$tmp/c.leaf" --force --memory "${least}M" --threads 2 -q
ok "the same bytes" cmp "$tmp/z.leaf" "$tmp/c.leaf"

# ---- out again ----

exits "cells" 0 "$leafcast" export "$tmp/s_vtk.leaf" -o "$tmp/again.vtu" --json
ok "all of them" json 'x["cells"] == 936'
exits "as they were" 0 "$leafcast" convert "$tmp/again.vtu" --whole-cells -o "$tmp/again.leaf" --json
ok "of each shape" json 'x["whole"] == [72, 108, 540, 0, 216, 0]'
exits "draw" 0 "$leafcast" render "$tmp/again.leaf" --iso 0.2 --size 64x48 -o "$tmp/again.pfm" -q
ok "the same picture" cmp "$tmp/again.pfm" "$tmp/vtk.pfm"
for memory in 3M 2G; do
    exits "a surface, $memory" 0 "$leafcast" export "$tmp/b.leaf" --iso 0.2 --memory $memory -o "$tmp/$memory.ply" --json
    ok "of triangles" json 'x["triangles"] > 1000'
done
ok "the same bytes" cmp "$tmp/3M.ply" "$tmp/2G.ply"

# ---- polyhedra ----

cat >"$tmp/foam.py" <<'PY'
"""foam.py N: truncated octahedra that fill a box, as a legacy file of VTK has polyhedra."""
import itertools, math, sys
n = int(sys.argv[1])
corners = {p for s in itertools.product((1, -1), repeat=2) for p in itertools.permutations((0, s[0], 2 * s[1]))}
ways = [(tuple(s * (a == b) for b in range(3)), 2) for a in range(3) for s in (-1, 1)]
ways += [(s, 3) for s in itertools.product((-1, 1), repeat=3)]
def around(way, height):
    on = sorted(v for v in corners if sum(x * y for x, y in zip(v, way)) == height)
    face = [on.pop()]
    while on: # the nearest is the next
        face.append(on.pop(min(range(len(on)), key=lambda i: math.dist(face[-1], on[i]))))
    return face
faces = [around(*way) for way in ways]
ids, cells = {}, []
for i, j, k, o in itertools.product(range(n), range(n), range(n), (0, 2)):
    at = (4 * i + o, 4 * j + o, 4 * k + o)
    cells.append([[ids.setdefault(tuple(map(sum, zip(v, at))), len(ids)) for v in f] for f in faces])
rows = [[len(c)] + [x for f in c for x in [len(f)] + f] for c in cells]
print("# vtk DataFile Version 3.0\nfoam\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d float" % len(ids))
print("\n".join("%d %d %d" % p for p in ids))
print("CELLS %d %d" % (len(rows), sum(len(r) + 1 for r in rows)))
print("\n".join(" ".join(map(str, [len(r)] + r)) for r in rows))
print("CELL_TYPES %d\n%s\nPOINT_DATA %d\nSCALARS f float 1\nLOOKUP_TABLE default" % (len(rows), "42 " * len(rows), len(ids)))
print("\n".join("%r" % (p[0] + 2 * p[1] + 3 * p[2]) for p in ids))
PY
python3 "$tmp/foam.py" 5 >"$tmp/foam.vtk"
exits "polyhedra" 0 "$leafcast" convert "$tmp/foam.vtk" -o "$tmp/foam.leaf" --json
ok "become tets" json 'x["polyhedra"] == 250 and x["tets"] == 250 * 60 and x["split"] == [0] * 4'
exits "in little memory" 0 "$leafcast" convert "$tmp/foam.vtk" -o "$tmp/foam2.leaf" --memory 8M
ok "the same" cmp "$tmp/foam.leaf" "$tmp/foam2.leaf"
ok "are told" grep -q '^split  *250 polyhedra, about middles' "$tmp/out"
exits "whole" 0 "$leafcast" convert "$tmp/foam.vtk" --whole-cells -o "$tmp/foam_whole.leaf" --json
ok "become pyramids and tets" json 'x["polyhedra"] == 250 and x["tets"] == 250 * 54 and x["whole"] == [0] * 6'
for file in foam foam_whole; do
    exits "$file is sound" 0 "$leafcast" verify "$tmp/$file.leaf"
    exits "a point in $file" 0 "$leafcast" probe "$tmp/$file.leaf" --point 9.7,8.1,7.3 --json
    ok "has the linear field's value" json 'abs(x["value"] - (9.7 + 2 * 8.1 + 3 * 7.3)) < 1e-5'
done

# ---- steps ----

for i in 0 1 2; do make vtk 6 0.0$i "$tmp/m_$i.vtk"; done
exits "nodes that move" 0 "$leafcast" convert "$tmp/m_0.vtk" "$tmp/m_1.vtk" "$tmp/m_2.vtk" --whole-cells -o "$tmp/m.leaf" --json
ok "do" json 'x["moving"]'
exits "are sound" 0 "$leafcast" verify "$tmp/m.leaf"
exits "compressed, too" 0 "$leafcast" convert "$tmp/m_0.vtk" "$tmp/m_1.vtk" "$tmp/m_2.vtk" --whole-cells --compress zstd:9 -o "$tmp/mz.leaf"
exits "are sound" 0 "$leafcast" verify "$tmp/mz.leaf"
for file in m mz; do
    "$leafcast" render "$tmp/$file.leaf" --step 2 --iso 0.2 --size 64x48 -o "$tmp/$file.pfm" --force -q || true
done
ok "the same picture" cmp "$tmp/m.pfm" "$tmp/mz.pfm"
for i in 0 1 2; do
    exits "step $i alone" 0 "$leafcast" convert "$tmp/m_$i.vtk" --whole-cells -o "$tmp/m_$i.leaf" -q
    for file in m m_$i; do
        step=0
        [ $file != m ] || step=$i
        "$leafcast" render "$tmp/$file.leaf" --step $step --iso 0.2 --size 64x48 --eye 0.5,0.6,4 --look-at 0.5,0.5,0.5 -o "$tmp/$file.pfm" --force -q || true
    done
    ok "looks the same in the series" cmp "$tmp/m.pfm" "$tmp/m_$i.pfm"
done
exits "a moved step as VTU" 0 "$leafcast" export "$tmp/m.leaf" --step 2 -o "$tmp/moved.vtu" -q
exits "is a mesh" 0 "$leafcast" convert "$tmp/moved.vtu" --whole-cells -o "$tmp/moved.leaf" -q
for file in m m_2 moved; do
    step=0
    [ $file != m ] || step=2
    exits "surface of $file" 0 "$leafcast" export "$tmp/$file.leaf" --step $step --iso 0.2 -o - --format stl
    wc -c <"$tmp/out" >"$tmp/$file.size"
done
ok "as large in the series as alone" cmp "$tmp/m.size" "$tmp/m_2.size"
ok "and from what was exported" cmp "$tmp/m.size" "$tmp/moved.size"
exits "another topology" 3 "$leafcast" convert "$tmp/m_0.vtk" "$tmp/b.vtk" --whole-cells -o "$tmp/x.leaf" --force
ok "is refused" says 'm_0.vtk has, found more\|must be the same at each step'

# ---- steps that are added later ----

# Points that stay, values that change: the values of other files of the mesh.
for i in 0 1 2; do
    python3 - "$tmp/s.vtu" "$tmp/a_$i.vtu" $i <<'PY'
import re, sys
text, i = open(sys.argv[1]).read(), int(sys.argv[3])
def other(m): return m[1] + " ".join(repr(float(x) + 0.1 * i) for x in m[2].split()) + m[3]
open(sys.argv[2], "w").write(re.sub(r'(<DataArray [^>]*Name="f"[^>]*>)([^<]*)(</DataArray>)', other, text, count=1))
PY
    exits "step $i alone" 0 "$leafcast" convert "$tmp/a_$i.vtu" --whole-cells -o "$tmp/a_$i.leaf" -q
done
for how in none zstd; do
    exits "all at once, $how" 0 "$leafcast" convert "$tmp/a_0.vtu" "$tmp/a_1.vtu" "$tmp/a_2.vtu" --whole-cells --compress $how -o "$tmp/all.leaf" --force -q
    rm -f "$tmp/grown.leaf"
    exits "the first, $how" 0 "$leafcast" convert "$tmp/a_0.vtu" --whole-cells --append --compress $how -o "$tmp/grown.leaf" -q
    exits "the next" 0 "$leafcast" convert "$tmp/a_1.vtu" --append -o "$tmp/grown.leaf"
    exits "the last, which says what it is" 0 "$leafcast" convert "$tmp/a_2.vtu" --whole-cells --append -o "$tmp/grown.leaf"
    exits "is sound" 0 "$leafcast" verify "$tmp/grown.leaf"
    exits "info" 0 "$leafcast" info "$tmp/grown.leaf" --json
    ok "has three steps" json 'x["steps"] == 3 and x["kind"] == "mixed mesh"'
    ok "costs values alone" [ "$(wc -c <"$tmp/grown.leaf")" -lt $((2 * $(wc -c <"$tmp/a_0.leaf"))) ]
    for i in 0 1 2; do
        for file in grown all a_$i; do
            step=$i
            [ $file != a_$i ] || step=0
            "$leafcast" render "$tmp/$file.leaf" --step $step --iso 0.2 --size 64x48 -o "$tmp/$file.pfm" --force -q || true
        done
        ok "step $i is the one of the series" cmp "$tmp/grown.pfm" "$tmp/all.pfm"
        ok "and the one alone" cmp "$tmp/grown.pfm" "$tmp/a_$i.pfm"
    done
done
make vtk 6 0.1 "$tmp/elsewhere.vtk"
exits "points elsewhere" 2 "$leafcast" convert "$tmp/elsewhere.vtk" --append -o "$tmp/grown.leaf"
ok "are named" says 'comes out otherwise\|no further step'
exits "other cells" 2 "$leafcast" convert "$tmp/b.vtk" --append -o "$tmp/grown.leaf"
ok "are counted" says 'it has [0-9]* cells, expected 936'
exits "whole cells behind tets" 0 "$leafcast" convert "$tmp/a_0.vtu" --append -o "$tmp/tets.leaf" -q
exits "are refused" 2 "$leafcast" convert "$tmp/a_1.vtu" --whole-cells --append -o "$tmp/tets.leaf"
exits "points that move" 2 "$leafcast" convert "$tmp/m_0.vtk" "$tmp/m_1.vtk" --whole-cells --append -o "$tmp/moves.leaf"
ok "do not grow" says 'points that move from step to step'

# ---- what does not go with it ----

while read -r option; do
    # shellcheck disable=SC2086 # split on purpose
    exits "--whole-cells $option" 2 "$leafcast" convert "$tmp/s.vtk" --whole-cells $option -o "$tmp/x.leaf" --force
    ok "says so" says "--whole-cells"
done <<'X'
--gradients
--build sah
--leaf-tets 4
--treelet-tets 16384
X
# ---- with a coarse grid ----

exits "--coarse" 0 "$leafcast" convert "$tmp/s.vtk" --whole-cells --coarse=24 -o "$tmp/coarse.leaf" --force -q
exits "which is sound" 0 "$leafcast" verify "$tmp/coarse.leaf"
exits "a level of it" 0 "$leafcast" render "$tmp/coarse.leaf" --iso 0.3 --lod 1 --preview -o "$tmp/p.pfm" --size 32x32 --force
ok "is provisional" says "1024 pixels are provisional"
exits "info" 0 "$leafcast" info "$tmp/coarse.leaf"
ok "tells of it" grep -q '^coarse *grids of 1 of 1 sets, [0-9]* bytes' "$tmp/out"

exits "--compress none" 0 "$leafcast" convert "$tmp/s.vtk" --whole-cells --compress none -o "$tmp/x.leaf" --force -q
exits "a grid" 2 "$leafcast" convert "$tmp/s.vtk" --dims 2,2,2 --type u8 --whole-cells -o "$tmp/x.leaf" --force
finish
