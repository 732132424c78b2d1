#!/bin/sh
# convert_vtk_grid.sh - leafcast convert of VTK's grids: fields, exit codes; packed files; and the same
# bytes as from what VTK itself reads, for every form in which it writes a grid.
# marks: long
. tests/support/tap.sh

out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
convert() { run "$leafcast" convert "$@" -o "$out" --force; }

cat >"$tmp/small.vtk" <<'END'
# vtk DataFile Version 3.0
a grid of 2 x 3 x 2 nodes
ASCII
DATASET STRUCTURED_POINTS
DIMENSIONS 2 3 2
ORIGIN 1 2 3
SPACING 1 1 2
POINT_DATA 12
SCALARS heat short
LOOKUP_TABLE default
1 2 3 4 5 6 7 8 9 10 11 12
VECTORS speed float
3 4 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 2
END
exits "a small grid" 0 "$leafcast" convert "$tmp/small.vtk" -o "$out"
ok "takes the first array" says '^values  *1 .. 12$' out
convert "$tmp/small.vtk" --field speed
ok "or the magnitude of another" says '^values  *0 .. 5$' out
convert "$tmp/small.vtk" --field speed --component 2
ok "or a component" says '^values  *0 .. 4$' out
exits "what it makes is sound" 0 "$leafcast" verify "$out"
run "$leafcast" info "$tmp/small.vtk"
ok "info tells where it lies" says '^origin  *1 2 3$' out
exits "a field that is not there" 2 "$leafcast" convert "$tmp/small.vtk" -o "$out" --force --field x
ok "what there is is told" says 'the points have "heat", "speed", the cells none' err
sed 's/^1 2 3 4/1 2 3x 4/' "$tmp/small.vtk" >"$tmp/damaged.vtk"
exits "a damaged grid" 3 "$leafcast" convert "$tmp/damaged.vtk" -o "$out" --force
ok "file, place and expectation" says 'damaged.vtk: byte [0-9]*: array "heat": before byte [0-9]*: "3x", expected' err
convert "$tmp/small.vtk"
cp "$out" "$tmp/plain.leaf"
gzip -k "$tmp/small.vtk"
exits "packed by gzip" 0 "$leafcast" convert "$tmp/small.vtk.gz" -o "$out" --force
ok "the same bytes" cmp -s "$tmp/plain.leaf" "$out"

mkdir "$tmp/vtk"
run tests/support/write_vtk_grid.py "$tmp/vtk"
if [ "$rc" = 77 ]; then
    skip "files by VTK" "no VTK here (python3-vtk9)"
else
    ok "VTK writes its forms" [ "$rc" = 0 ]
    cp "$tmp/out" "$tmp/forms"
    ok "all of them" [ "$(cut -f 1 "$tmp/forms" | sort -u | wc -l)" = 114 ]
    while IFS="$(printf '\t')" read -r form field expected; do
        convert "$tmp/vtk/$expected"
        cp "$out" "$tmp/expected.leaf"
        convert "$tmp/vtk/$form" --field "$field"
        ok "$form, $field" [ "$rc" = 0 ]
        # A magnitude is rounded, which a file says: of one, samples and place alone.
        if [ "$field" = "a vector" ]; then
            "$leafcast" export "$tmp/expected.leaf" -o "$tmp/expected.nrrd" --force -q
            "$leafcast" export "$out" -o "$tmp/got.nrrd" --force -q
            ok "the samples of what VTK reads" cmp -s "$tmp/expected.nrrd" "$tmp/got.nrrd"
        else
            ok "the bytes of what VTK reads" cmp -s "$tmp/expected.leaf" "$out"
        fi
    done <"$tmp/forms"
fi
finish
