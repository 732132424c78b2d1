#!/bin/sh
# convert_vtk_parts.sh - VTK's files that name files: parallel meshes, blocks, collections as time series; and structured
# grids. First by hand, then as VTK itself writes them, against what VTK itself reads.
# marks: long
. tests/support/tap.sh

out=$tmp/a.leaf
says() { grep -qF -- "$1" "$tmp/$2"; }
convert() { run "$leafcast" convert "$@" -o "$out" --force; }
refused() { # refused NAME WORDS INPUT [OPTION..]: with these words
    title=$1
    words=$2
    shift 2
    rm -f "$out"
    exits "$title" 3 "$leafcast" convert "$@" -o "$out"
    ok "says \"$words\"" says "$words" err
    ok "leaves nothing behind" [ ! -e "$out" ]
}

# ---- by hand: a tet, and one beside it that shares a face ----

array() { printf '<DataArray type="%s" Name="%s" NumberOfComponents="%s" format="ascii">%s</DataArray>' "$@"; }
# mesh FILE POINTS VALUES [TYPE [GHOST]]: four points, one cell.
mesh() {
    cat >"$tmp/$1" <<END
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="5" NumberOfCells="2"><PointData>$(array Float32 "${6:-v}" 1 "$3")</PointData>
<CellData>$(array Float32 c 1 "10 30")$(array UInt8 "${4:-vtkGhostType}" 1 "${5:-0 0}")</CellData>
<Points>$(array Float32 p 3 "$2")</Points><Cells>$(array Int32 connectivity 1 "0 1 2 3 1 2 3 4")
$(array Int32 offsets 1 "4 8")$(array UInt8 types 1 "10 10")</Cells></Piece></UnstructuredGrid></VTKFile>
END
}
list() { # list FILE TYPE ELEMENT..
    file=$1 type=$2
    shift 2
    printf '<VTKFile type="%s" version="1.0"><%s>%s</%s></VTKFile>\n' "$type" "$type" "$*" "$type" >"$tmp/$file"
}
here="0 0 0 1 0 0 0 1 0 0 0 1 1 1 1"
there="9 0 0 10 0 0 9 1 0 9 0 1 10 1 1"
mesh a.vtu "$here" "1 2 3 4 5"
mesh b.vtu "$there" "6 7 8 9 10"
mesh ghost.vtu "$there" "6 7 8 9 10" vtkGhostType "0 1"
mesh level.vtu "$there" "6 7 8 9 10" vtkGhostLevels "2 0"
mesh hidden.vtu "$there" "6 7 8 9 10" vtkGhostType "32 4"
mesh other.vtu "$there" "6 7 8 9 10" vtkGhostType "0 0" w
mesh later.vtu "$here" "11 12 13 14 15"
list a.pvtu PUnstructuredGrid '<Piece Source="a.vtu"/><Piece Source="b.vtu"/>'
exits "two pieces" 0 "$leafcast" convert "$tmp/a.pvtu" -o "$out"
ok "become one mesh" says "10 points, 4 tets" out
ok "with the values of both" says "1 .. 10" out
exits "which is sound" 0 "$leafcast" verify "$out"
run "$leafcast" info "$tmp/a.pvtu"
ok "the second lies where it is" says "bounds      0 .. 10" out
for kind in ghost level hidden; do
    list g.pvtu PUnstructuredGrid "<Piece Source=\"a.vtu\"/><Piece Source=\"$kind.vtu\"/>"
    convert "$tmp/g.pvtu"
    ok "$kind: three tets" says "10 points, 3 tets" out
    ok "one is told" says "ghosts      1 cells" out
done
run "$leafcast" convert "$tmp/g.pvtu" -o "$out" --force --json
ok "also as JSON" says '"ghosts": 1' out
convert "$tmp/a.pvtu" --cells-to-points --field c
ok "arrays of the cells" says "10 .. 30" out
list none.pvtu PUnstructuredGrid ''
refused "no piece" "it names no file" "$tmp/none.pvtu"
list lost.pvtu PUnstructuredGrid '<Piece Source="a.vtu"/><Piece Source="gone.vtu"/>'
exits "a piece that is not there" 1 "$leafcast" convert "$tmp/lost.pvtu" -o "$out" --force
ok "is named, with its place" says "lost.pvtu: line 1: the file that it names: $tmp/gone.vtu: cannot open: No such file" err
list circle.pvtu PUnstructuredGrid '<Piece Source="circle.pvtu"/>'
refused "a file that names itself" "is PUnstructuredGrid" "$tmp/circle.pvtu"
list odd.pvtu PUnstructuredGrid '<Piece/>'
refused "a piece without a file" "expected the attribute Source" "$tmp/odd.pvtu"
list unlike.pvtu PUnstructuredGrid '<Piece Source="a.vtu"/><Piece Source="other.vtu"/>'
refused "a piece without the array" 'other.vtu: piece 1 has no array "v"' "$tmp/unlike.pvtu"

# ---- blocks ----

list two.vtm vtkMultiBlockDataSet '<Block index="0"><DataSet index="0" file="a.vtu"/><DataSet index="1"/></Block><DataSet
index="1" file="b.vtu"/>'
exits "two blocks" 0 "$leafcast" convert "$tmp/two.vtm" -o "$out" --force
ok "become one mesh" says "10 points, 4 tets" out
list unlike.vtm vtkMultiBlockDataSet '<DataSet index="0" file="a.vtu"/><DataSet index="1" file="other.vtu"/>'
refused "blocks with other arrays" "give one of them itself: \"$tmp/a.vtu\", \"$tmp/other.vtu\"" "$tmp/unlike.vtm"
list loop.vtm vtkMultiBlockDataSet '<DataSet index="0" file="loop.vtm"/>'
refused "blocks that name themselves" "is vtkMultiBlockDataSet" "$tmp/loop.vtm"

# ---- collections ----

step() { printf '<DataSet timestep="%s" part="%s" file="%s"/>' "$@"; }
list t.pvd Collection "$(step 2.5 0 later.vtu)$(step -1 0 a.vtu)"
exits "a collection" 0 "$leafcast" convert "$tmp/t.pvd" -o "$out" --force
ok "is all of its steps" says "steps       2" out
run "$leafcast" info "$out"
ok "by their times" says "times -1 .. 2.5" out
"$leafcast" convert "$tmp/a.vtu" "$tmp/later.vtu" --times=-1,2.5 -o "$tmp/named.leaf" -q
ok "as if they were named" cmp -s "$out" "$tmp/named.leaf"
run "$leafcast" info --quick "$tmp/t.pvd"
ok "info tells the steps" says "steps       2, the first is taken here" out
ok "and the times" says "times       -1 .. 2.5" out
convert "$tmp/t.pvd" --step 1
"$leafcast" convert "$tmp/later.vtu" -o "$tmp/named.leaf" -q --force
ok "--step takes one" cmp -s "$out" "$tmp/named.leaf"
convert "$tmp/t.pvd" --steps 1
run "$leafcast" info --json "$out"
ok "--steps too" says '"value_min": 11' out
convert "$tmp/t.pvd" --times 3,4 --fields all
run "$leafcast" info "$out"
ok "--times replaces them" says "times 3 .. 4" out
exits "a step that is not there" 2 "$leafcast" convert "$tmp/t.pvd" --step 2 -o "$out" --force
ok "there are two" says "no step 2: there are 2, counted from 0" err
exits "steps that are not there" 2 "$leafcast" convert "$tmp/t.pvd" --steps 0:4 -o "$out" --force
exits "a mesh of one file" 2 "$leafcast" convert "$tmp/a.vtu" --step 1 -o "$out" --force
ok "has no steps" says "no step 1: there is 1" err
exits "or a step that would be taken anyway" 2 "$leafcast" convert "$tmp/a.vtu" --step 0 -o "$out" --force
ok "is for others" says "--step is for formats of several steps" err
list parts.pvd Collection "$(step 0 0 a.vtu)$(step 0 1 b.vtu)$(step 1 0 a.vtu)$(step 1 1 b.vtu)"
convert "$tmp/parts.pvd"
ok "parts of one time are one mesh" says "10 points, 4 tets" out
ok "at both times" says "steps       2" out
list lost.pvd Collection "$(step 0 0 a.vtu)$(step 1 0 gone.vtu)"
exits "a step's file that is not there" 1 "$leafcast" convert "$tmp/lost.pvd" -o "$out" --force
ok "is named before work begins" says "lost.pvd: line 1: the file that it names: $tmp/gone.vtu" err
list odd.pvd Collection "$(step x 0 a.vtu)"
refused "a time that is no number" 'timestep="x", expected 1 numbers' "$tmp/odd.pvd"
list odd.pvd Collection "$(step inf 0 a.vtu)"
refused "a time without end" 'timestep' "$tmp/odd.pvd"
list odd.pvd Collection '<DataSet timestep="0"/>'
refused "a step without a file" 'expected the attribute file' "$tmp/odd.pvd"
list loop.pvd Collection "$(step 0 0 loop.pvd)"
refused "a collection of itself" 'is Collection' "$tmp/loop.pvd"
cp "$tmp/a.vtu" "$tmp/raw.vti"
list odd.pvd Collection "$(step 0 0 raw.vti)"
refused "a grid that is none" 'expected a grid of VTK' "$tmp/odd.pvd"
ln "$tmp/later.vtu" "$tmp/precious.leaf"
exits "an output that is a later step's file" 2 "$leafcast" convert "$tmp/t.pvd" -o "$tmp/precious.leaf" --force
ok "is an input" says "later.vtu, an input" err
ok "and stays" grep -q "11 12 13 14 15" "$tmp/later.vtu"

# ---- by VTK ----

mkdir "$tmp/vtk"
writer=tests/support/write_vtk_parts.py
run $writer "$tmp/vtk"
if [ "$rc" = 77 ]; then
    skip "files by VTK" "no VTK here (python3-vtk9)"
    finish
    exit
fi
ok "VTK writes its forms" [ "$rc" = 0 ]
cp "$tmp/out" "$tmp/forms"
ok "all of them" [ "$(wc -l <"$tmp/forms")" = 35 ]
while IFS="$(printf '\t')" read -r form what more; do
    case $what in
    mesh)
        convert "$tmp/vtk/$form"
        ok "$form" [ "$rc" = 0 ]
        exits "$form to .vtu" 0 "$leafcast" export "$out" -o "$tmp/vtk/back.vtu" --force
        run $writer "$tmp/vtk" measure back.vtu
        ok "tets, volume and values" [ "$(cat "$tmp/out")" = "$more" ]
        ;;
    grid*)
        convert "$tmp/vtk/$more"
        cp "$out" "$tmp/expected.leaf"
        field=p
        [ "$what" = grid ] || field=c
        convert "$tmp/vtk/$form" --field $field
        ok "$form $what" [ "$rc" = 0 ]
        # A series has times, which the file of one grid has not.
        [ "${form##*.}" = pvd ] && convert "$tmp/vtk/$form" --step 0 --field $field
        ok "the bytes of what VTK reads" cmp -s "$out" "$tmp/expected.leaf"
        ;;
    turned)
        run "$leafcast" info --quick --json "$tmp/vtk/$form"
        map=$(tr -d '\n ' <"$tmp/out" | sed 's/.*"to_world":\[\([^]]*\)\].*/\1/' | tr , ' ')
        # shellcheck disable=SC2086 # twelve numbers
        run $writer "$tmp/vtk" place "$form" $map
        ok "$form lies where VTK says" [ "$rc" = 0 ]
        ;;
    refused) refused "$form" "$more" "$tmp/vtk/$form" ;;
    esac
done <"$tmp/forms"

convert "$tmp/vtk/series/grids.pvd"
ok "a series of grids" says "steps       2" out
cp "$out" "$tmp/series.leaf"
convert "$tmp/vtk/series/grid0.vti" "$tmp/vtk/series/grid1.vti" --times 0.5,2
ok "as if they were named" cmp -s "$tmp/series.leaf" "$out"
refused "a series of other meshes" "expected 343 points, as $tmp/vtk/series/part0.vtu has, found more" "$tmp/vtk/series/meshes.pvd"
finish
