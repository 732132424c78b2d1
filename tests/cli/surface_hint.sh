#!/bin/sh
# surface_hint.sh - triangles given to convert: what is named works, and leads to a mesh.
. tests/support/tap.sh
cd "$tmp" || exit 1

# One closed surface in each form that people have.
cat >t.msh <<'X'
$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
$EndNodes
$Elements
4
1 2 2 1 1 1 3 2
2 2 2 1 1 1 2 4
3 2 2 1 1 2 3 4
4 2 2 1 1 1 4 3
$EndElements
X
cat >t.vtk <<'X'
# vtk DataFile Version 3.0
triangles
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 4 float
0 0 0 1 0 0 0 1 0 0 0 1
CELLS 4 16
3 0 2 1
3 0 1 3
3 1 2 3
3 0 3 2
CELL_TYPES 4
5 5 5 5
POINT_DATA 4
SCALARS v float 1
LOOKUP_TABLE default
0 1 2 3
X
printf 'OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n' >t.off
{
    printf 'ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n'
    printf 'element face 4\nproperty list uchar int vertex_indices\nend_header\n'
    printf '0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n'
} >surface.ply

for form in t.msh t.vtk; do
    exits "$form: triangles alone" 3 "$leafcast" convert $form -o x.leaf --allow-empty
    ok "are told as such" grep -q "no tets; a surface of triangles is converted as .ply: .meshio convert IN surface.ply" err
    ok "and how it is filled" grep -q "leafcast tetrahedralize surface.ply -o F.mesh" err
    exits "$form given to tetrahedralize" 3 "$leafcast" tetrahedralize $form -o x.mesh
    ok "is told the same way" grep -q "meshio convert.*leafcast tetrahedralize" err
done
for form in t.off surface.ply; do
    exits "$form" 0 "$leafcast" info $form
    ok "is known as triangles" grep -q "^surface  *4 triangles, 4 points$" out
    exits "$form resampled" 3 "$leafcast" resample $form --dims 8 -o x.nrrd
    ok "is refused" grep -q "a surface, which fills no volume" err
    exits "$form is converted as it is" 0 "$leafcast" convert $form -o x.leaf --force
done
[ -x "$(dirname "$(readlink -f "$leafcast")")/../libexec/leafcast-tetgen" ] || {
    skip "what is named" "no TetGen here"
    finish
}
for form in t.off surface.ply; do
    exits "$form filled" 0 "$leafcast" tetrahedralize $form -o F.mesh --force
    exits "and converted" 0 "$leafcast" convert F.mesh -o F.leaf --force
done
finish
