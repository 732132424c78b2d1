#!/bin/sh
# convert_vtk.sh - leafcast convert of VTK grids: fields, exit codes; and the same bytes from every
# form in which VTK itself writes a grid.
. tests/support/tap.sh

out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
convert() { run "$leafcast" convert "$@" -o "$out" --force; }

cat >"$tmp/two.vtk" <<'END'
# vtk DataFile Version 3.0
two tets and a triangle
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 float
0 0 0  1 0 0  0 1 0  0 0 1  1 1 1
CELLS 3 14
4 0 1 2 3
4 4 3 2 1
3 0 1 2
CELL_TYPES 3
10 10 5
POINT_DATA 5
VECTORS speed double
3 4 0  0 0 1  0 0 2  0 0 3  0 0 4
CELL_DATA 3
SCALARS load float
LOOKUP_TABLE default
10 20 30
END

exits "a small grid" 0 "$leafcast" convert "$tmp/two.vtk" -o "$out"
ok "tells its tets" says '^input  *5 points, 2 tets' out
ok "takes the magnitude" says '^values  *1 .. 5$' out
convert "$tmp/two.vtk" --field speed --component 2
ok "or a component" says '^values  *0 .. 4$' out
convert "$tmp/two.vtk" --field load --cells-to-points
ok "or averages of the cells" says '^values  *10 .. 20$' out
exits "what it makes is sound" 0 "$leafcast" verify "$out"

exits "a field that is not there" 2 "$leafcast" convert "$tmp/two.vtk" -o "$out" --force --field x
ok "what there is is told" says '"speed"; the cells have "load"' err
exits "a component that is not there" 2 \
    "$leafcast" convert "$tmp/two.vtk" -o "$out" --force --component 4
sed 's/^10 10 5$/10 24 5/' "$tmp/two.vtk" >"$tmp/curved.vtk"
exits "a quadratic cell" 3 "$leafcast" convert "$tmp/curved.vtk" -o "$out" --force
ok "is named" says 'quadratic tetrahedron' err
sed 's/^4 4 3 2 1$/5 4 3 2 1/' "$tmp/two.vtk" >"$tmp/damaged.vtk"
exits "a damaged grid" 3 "$leafcast" convert "$tmp/damaged.vtk" -o "$out" --force
ok "file, place and expectation" says 'damaged.vtk: byte [0-9]*: CELL_TYPES: cell 1 .* has 5 points, expected 4' err
sed 's/^4 4 3 2 1$/4 4 3 2 9/' "$tmp/two.vtk" >"$tmp/lost.vtk"
exits "an id that is no point" 0 "$leafcast" convert "$tmp/lost.vtk" -o "$out" --force
ok "is left out" says '^input  *5 points, 1 tets' out

# One converted file for each field; every other form must give the same bytes.
mkdir "$tmp/vtk"
run tests/support/write_vtk.py "$tmp/vtk"
if [ "$rc" = 77 ]; then
    skip "files by VTK" "no VTK here (python3-vtk9)"
else
    ok "VTK writes its forms" [ "$rc" = 0 ]
    cp "$tmp/out" "$tmp/forms"
    ok "all of them" [ "$(wc -l <"$tmp/forms")" = 18 ]
    for field in "--field real" "--field whole" "--component 2 --field" "--cells-to-points --field whole" \
        "--cells-to-points --component 3 --field"; do
        rm -f "$tmp/first.leaf"
        while read -r form; do
            name="a vector"
            # shellcheck disable=SC2086 # split on purpose
            case $field in
            *--field) convert "$tmp/vtk/$form" $field "$name" ;;
            *) convert "$tmp/vtk/$form" $field ;;
            esac
            [ -e "$tmp/first.leaf" ] || cp "$out" "$tmp/first.leaf"
            ok "$form $field" [ "$rc" = 0 ]
            ok "the same bytes" cmp -s "$tmp/first.leaf" "$out"
        done <"$tmp/forms"
    done
fi
finish
