#!/bin/sh
# convert_fields.sh - leafcast convert of meshes with many fields, in every format that has several: each is that of
# a conversion of it alone, the same bytes whatever the memory, and a file is parsed once for all of them.
# marks: long
. tests/support/tap.sh

out=$tmp/all.leaf
same() { cmp -s "$tmp/$1" "$tmp/$2"; }
tets() { "$leafcast" export "$1" -o "$tmp/$2.vtu" --force -q --field "$3" --step "$4"; }

# A lattice of tets, with FIELDS arrays of the points and as many of the cells.
python3 - "$tmp" <<'PY'
import base64, math, struct, sys
folder, n, fields = sys.argv[1] + "/", 14, 6
points = [(x + 0.1 * y, y, z) for z in range(n) for y in range(n) for x in range(n)]
cells = []
for z in range(n - 1):
    for y in range(n - 1):
        for x in range(n - 1):
            v = [x + i + n * (y + j + n * (z + k)) for k in (0, 1) for j in (0, 1) for i in (0, 1)]
            cells += [(v[0], v[a], v[b], v[7]) for a, b in ((1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1))]
def of_point(f, p, step=0):
    return [math.sin(p[0] * (f + 1) / 3), p[1] * f, p[2] ** 2 / (f + 1)][f % 3] + step
def of_cell(f, i):
    return (i * (f + 3)) % 101
value = [[of_point(f, p) for p in points] for f in range(fields)]
cell_value = [[of_cell(f, i) for i in range(len(cells))] for f in range(fields)]

# VTK: ASCII, one array a vector.
def vtk(name, step):
    with open(folder + name, "w") as f:
        f.write("# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d float\n" % len(points))
        f.writelines("%g %g %g\n" % p for p in points)
        f.write("CELLS %d %d\n" % (len(cells), 5 * len(cells)))
        f.writelines("4 %d %d %d %d\n" % c for c in cells)
        f.write("CELL_TYPES %d\n" % len(cells) + "10\n" * len(cells))
        for owner, values in ("POINT", value), ("CELL", cell_value):
            f.write("%s_DATA %d\n" % (owner, len(values[0])))
            if owner == "POINT":
                f.write("SCALARS vtkGhostType unsigned_char 1\nLOOKUP_TABLE default\n" + "0\n" * len(points))
            for k, array in enumerate(values):
                if k == 4:
                    f.write("VECTORS f4 float\n")
                    f.writelines("%.9g %.9g 0\n" % (v + step, v) for v in array)
                else:
                    f.write("SCALARS f%d float 1\nLOOKUP_TABLE default\n" % k)
                    f.writelines("%.9g\n" % (v + step) for v in array)
vtk("a.vtk", 0)
vtk("b.vtk", 1)

# VTU: two pieces, base64.
def array(name, form, numbers, more=""):
    data = struct.pack("<%d%s" % (len(numbers), form[0]), *numbers)
    text = base64.b64encode(struct.pack("<I", len(data)) + data).decode()
    return '<DataArray type="%s" Name="%s" format="binary"%s>%s</DataArray>\n' % (form[1], name, more, text)
F, I, U = ("f", "Float32"), ("i", "Int32"), ("B", "UInt8")
with open(folder + "a.vtu", "w") as f:
    f.write('<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>\n')
    half = len(cells) // 2
    for part in range(2):
        own = cells[part * half:(part + 1) * half if part == 0 else None]
        f.write('<Piece NumberOfPoints="%d" NumberOfCells="%d"><PointData>' % (len(points), len(own)))
        for k in range(fields):
            f.write(array("f%d" % k, F, [v + part for v in value[k]]))
        f.write("</PointData><CellData>")
        for k in range(fields):
            f.write(array("f%d" % k, F, cell_value[k][part * half:][:len(own)]))
        f.write("</CellData><Points>" + array("p", F, [x + 50 * part for p in points for x in p], ' NumberOfComponents="3"'))
        f.write("</Points><Cells>" + array("connectivity", I, [v for c in own for v in c]))
        f.write(array("offsets", I, [4 * i + 4 for i in range(len(own))]))
        f.write(array("types", U, [10] * len(own)) + "</Cells></Piece>\n")
    f.write("</UnstructuredGrid></VTKFile>\n")

# Gmsh: data of nodes, of elements, and of elements' nodes.
with open(folder + "a.msh", "w") as f:
    f.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n" % len(points))
    f.writelines("%d %g %g %g\n" % (i + 5, *p) for i, p in enumerate(points))
    f.write("$EndNodes\n$Elements\n%d\n" % len(cells))
    f.writelines("%d 4 2 0 1 %d %d %d %d\n" % (i + 9, *(v + 5 for v in c)) for i, c in enumerate(cells))
    f.write("$EndElements\n")
    def rows(kind, name, lines):
        f.write('$%s\n1\n"%s"\n1\n0\n3\n0\n1\n%d\n' % (kind, name, len(lines)) + "".join(lines) + "$End%s\n" % kind)
    for k in range(fields):
        if k % 2:
            rows("ElementNodeData", "f%d" % k, ["%d 4 %s\n" % (i + 9, " ".join("%.9g" % value[k][v] for v in c))
                                                for i, c in enumerate(cells) if i % 7])
        else:
            rows("NodeData", "f%d" % k, ["%d %.9g\n" % (i + 5, v) for i, v in enumerate(value[k])])
    for k in range(fields):
        rows("ElementData", "f%d" % k, ["%d %.9g\n" % (i + 9, v) for i, v in enumerate(cell_value[k]) if (i + k) % 5])

# TetGen.
with open(folder + "a.node", "w") as f:
    f.write("%d 3 %d 0\n" % (len(points), fields))
    f.writelines("%d %g %g %g %s\n" % (i, *p, " ".join("%.9g" % value[k][i] for k in range(fields)))
                 for i, p in enumerate(points))
with open(folder + "a.ele", "w") as f:
    f.write("%d 4 %d\n" % (len(cells), fields))
    f.writelines("%d %d %d %d %d %s\n" % (i, *c, " ".join("%d" % cell_value[k][i] for k in range(fields)))
                 for i, c in enumerate(cells))
PY

# fields NAME STEPS PREFIX FIRST [OPTION..] -- INPUT.. - all fields, PREFIX0 .. or from 1 on, each as alone; little memory.
fields() {
    name=$1 steps=$2 prefix=$3 number=$4
    shift 4
    exits "$name: all fields" 0 "$leafcast" convert "$@" --fields all -o "$out" --force
    exits "$name: is sound" 0 "$leafcast" verify "$out"
    exits "$name: an isovalue of the third" 0 "$leafcast" info "$out" --field "${prefix}2" --iso 0.25
    ok "$name: is said to be" grep -q "^isovalue 0.25 of ${prefix}2" "$tmp/out"
    ok "$name: six of them" [ "$("$leafcast" info "$out" --json | grep -c "\"name\": \"${prefix}[0-9]\"")" = 6 ]
    for how in "--memory 5M --threads 1" "--memory 7M --threads 2"; do
        # shellcheck disable=SC2086 # split on purpose
        exits "$name: $how" 0 "$leafcast" convert "$@" --fields all -o "$tmp/little.leaf" --force $how
        ok "$name: the same bytes" same all.leaf little.leaf
    done
    last=$((number + 5))
    while [ $number -le $last ]; do
        run "$leafcast" convert "$@" --field "$prefix$number" -o "$tmp/one.leaf" --force
        step=0
        while [ $step -lt "$steps" ]; do
            tets "$out" set "$prefix$number" $step
            tets "$tmp/one.leaf" one "$prefix$number" $step
            ok "$name: $prefix$number at step $step" same set.vtu one.vtu
            step=$((step + 1))
        done
        number=$((number + 1))
    done
    # Another order, and some of them.
    run "$leafcast" convert "$@" --field "${prefix}3" --field "${prefix}2" -o "$tmp/two.leaf" --force
    tets "$out" set "${prefix}2" 0
    tets "$tmp/two.leaf" one "${prefix}2" 0
    ok "$name: two, the other way round" same set.vtu one.vtu
}

fields "VTK" 1 f 0 "$tmp/a.vtk"
fields "VTK, cells" 1 f 0 --cells-to-points "$tmp/a.vtk"
fields "VTK, two steps" 2 f 0 "$tmp/a.vtk" "$tmp/b.vtk"
fields "VTU" 1 f 0 "$tmp/a.vtu"
fields "VTU, cells" 1 f 0 --cells-to-points "$tmp/a.vtu"
fields "Gmsh" 1 f 0 "$tmp/a.msh"
fields "Gmsh, cells" 1 f 0 --cells-to-points "$tmp/a.msh"
fields "TetGen" 1 attr 1 "$tmp/a.node"
fields "TetGen, regions" 1 region 1 --cells-to-points "$tmp/a.ele"
exits "a field that is not there" 2 "$leafcast" convert "$tmp/a.vtk" --field f1 --field f9 -o "$out" --force
exits "in the second step alone" 2 sh -c 'sed s/f1/g1/ "$2/b.vtk" >"$2/c.vtk"; "$1" convert "$2/a.vtk" "$2/c.vtk" \
    --fields all -o "$2/x.leaf"' sh "$leafcast" "$tmp"

# Bytes read: those of a file once for its scan, and once for each array that is taken.
bytes() { tests/support/bytes_read.py "$leafcast" convert "$@" -o "$tmp/x.leaf" --force; }
if [ "$(tests/support/bytes_read.py true)" = unknown ]; then
    skip "bytes read" "no /proc/PID/io here"
else
    for file in a.vtk a.vtu a.msh; do
        size=$(wc -c <"$tmp/$file")
        all=$(bytes "$tmp/$file" --fields all)
        ok "$file is read for its scan, and once for its arrays: $all bytes of $size" [ "$all" -lt $((size * 3)) ]
    done
    size=$(cat "$tmp/a.node" "$tmp/a.ele" | wc -c)
    all=$(bytes "$tmp/a.node" --fields all)
    ok "a.node and a.ele are read once: $all bytes of $size" [ "$all" -lt $((size * 3 / 2)) ]
    all=$(bytes "$tmp/a.node" "$tmp/a.node" "$tmp/a.node" --fields all)
    ok "and once for each of three steps: $all bytes" [ "$all" -lt $((size * 9 / 2)) ]
fi
finish
