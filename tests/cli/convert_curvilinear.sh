#!/bin/sh
# convert_curvilinear.sh - curvilinear grids from a file to pictures: generated ones of each shape, series of
# steps, real ones in PLOT3D (skipped without the data folder); what is refused, in words.
# marks: leaks
. tests/support/tap.sh

differ() { [ "$(cmp -s "$1" "$2"; echo $?)" = 1 ]; }
json_of() { # json_of FILE EXPRESSION: of info --json, as j
    "$leafcast" info --json "$1" | python3 -c 'import json, sys
j = json.load(sys.stdin)
sys.exit(not eval(sys.argv[1]))' "$2"
}
says() { cat "$tmp/out" "$tmp/err" | grep -q -- "$1"; }

for shape in warp annulus twisted; do
    exits "generate $shape" 0 "$leafcast" generate gyroid --curvilinear $shape --dims 20,12,40 -o "$tmp/$shape.vts" -q
    exits "info of the $shape" 0 "$leafcast" info "$tmp/$shape.vts"
    ok "says what it is" says '^zones *20 x 12 x 40 nodes$'
    exits "convert the $shape" 0 "$leafcast" convert "$tmp/$shape.vts" -o "$tmp/$shape.leaf"
    ok "no cell is folded" says '^cells .*handed$'
    exits "verify it" 0 "$leafcast" verify "$tmp/$shape.leaf"
    one_in 3 || continue
    exits "again, by one thread" 0 "$leafcast" convert "$tmp/$shape.vts" -o "$tmp/again.leaf" --threads 1 --force -q
    ok "the same bytes" cmp -s "$tmp/$shape.leaf" "$tmp/again.leaf"
    exits "render it" 0 "$leafcast" render "$tmp/$shape.leaf" --iso 0 --size 40x30 -o "$tmp/$shape.ppm"
    exits "within little memory" 0 "$leafcast" render "$tmp/$shape.leaf" --iso 0 --size 40x30 -o "$tmp/little.ppm" --memory 4M --threads 1 --force
    ok "the same picture" cmp -s "$tmp/$shape.ppm" "$tmp/little.ppm"
done
exits "info of a treelet file" 0 "$leafcast" info "$tmp/warp.leaf"
ok "says its cells" says '^curvilinear 8151 cells, 9600 nodes, 1 zones$'
ok "and suggests isovalues" says '^isovalues '
ok "there is no coarse grid" json_of "$tmp/warp.leaf" 'j["coarse_sets"] == 0 and j["coarse_bytes"] == 0'
exits "with one" 0 "$leafcast" convert "$tmp/warp.vts" --coarse -o "$tmp/coarse.leaf" -q
exits "which is sound" 0 "$leafcast" verify "$tmp/coarse.leaf"
exits "info tells" 0 "$leafcast" info "$tmp/coarse.leaf"
ok "of its bytes" says '^coarse *grids of 1 of 1 sets, [0-9]* bytes'
ok "and counts it" json_of "$tmp/coarse.leaf" 'j["coarse_sets"] == 1 and 0 < j["coarse_bytes"] < j["file_bytes"]'
exits "a level of it" 0 "$leafcast" render "$tmp/coarse.leaf" --iso 0 --lod 1 --preview -o "$tmp/p.pfm" --size 32x32
ok "is provisional" says "1024 pixels are provisional"
exits "a medium at that level" 0 "$leafcast" render "$tmp/coarse.leaf" --tf auto --lod 1 --preview -o "$tmp/p.pfm" --size 32x32 --force
exits "but in a preview there are no levels" 2 "$leafcast" render "$tmp/coarse.leaf" --iso 0 --lod 1 -o "$tmp/p.pfm" --force
exits "nor without a grid" 2 "$leafcast" render "$tmp/warp.leaf" --iso 0 --lod 1 --preview -o "$tmp/p.pfm" --force
ok "which is said" says 'convert --coarse'
"$leafcast" render "$tmp/coarse.leaf" --iso 0 --size 40x30 -o "$tmp/exact.ppm" -q
"$leafcast" render "$tmp/warp.leaf" --iso 0 --size 40x30 -o "$tmp/plain.ppm" -q
ok "exact pictures stay" cmp -s "$tmp/exact.ppm" "$tmp/plain.ppm"
exits "it does not grow" 2 "$leafcast" convert "$tmp/warp.vts" --coarse --append -o "$tmp/grows.leaf"
exits "a medium" 0 "$leafcast" render "$tmp/warp.leaf" --tf auto --size 40x30 -o "$tmp/medium.ppm"
exits "a slice" 0 "$leafcast" slice "$tmp/warp.leaf" --axis z --at 0.5 --size 60x50 -o "$tmp/slice.ppm"
exits "a point" 0 "$leafcast" probe "$tmp/warp.leaf" --point 0.5,0.5,0.5
ok "is in a cell" says '^hexahedron: [0-9]* [0-9]* [0-9]*$'
exits "convert --dry-run" 0 "$leafcast" convert "$tmp/warp.vts" --dry-run
ok "writes nothing, and says how much it would" says '^treelets *2$'

# Steps: one file each, whose nodes stay; and those of two shapes, which move.
"$leafcast" generate drop --curvilinear warp --dims 9 --steps 3 -o "$tmp/drop.vts" -q
exits "three steps" 0 "$leafcast" convert "$tmp/drop_????.vts" -o "$tmp/drop.leaf"
ok "nodes stay" says '^nodes *stay where they are$'
exits "are sound" 0 "$leafcast" verify "$tmp/drop.leaf"
exits "the last one is drawn" 0 "$leafcast" render "$tmp/drop.leaf" --step 2 --tf auto --size 20x20 -o "$tmp/drop.ppm"
"$leafcast" generate drop --curvilinear twisted --dims 9 -o "$tmp/turned.vts" -q
exits "nodes that move" 0 "$leafcast" convert "$tmp/drop_0000.vts" "$tmp/turned.vts" -o "$tmp/moving.leaf"
ok "are said to" says '^nodes *move from step to step$'
exits "are sound, too" 0 "$leafcast" verify "$tmp/moving.leaf"
for file in drop moving; do
    for time in 0 0.5 1; do
        exits "$file: time $time" 0 "$leafcast" render "$tmp/$file.leaf" --time $time --interpolate --tf auto \
            --size 20x20 -o "$tmp/$file$time.ppm"
    done
    for step in 0 1; do
        ok "$file: what is between is not step $step" sh -c '! cmp -s "$1" "$2"' - "$tmp/$file$step.ppm" \
            "$tmp/${file}0.5.ppm"
    done
done
"$leafcast" generate drop --curvilinear warp --dims 8 -o "$tmp/fewer.vts" -q
exits "steps of other sizes" 3 "$leafcast" convert "$tmp/drop_0000.vts" "$tmp/fewer.vts" -o "$tmp/x.leaf"
ok "are refused by name" says 'fewer.vts: zone 0 has 8 x 8 x 8 nodes, but 9 x 9 x 9 in the first step'
ok "and leave nothing" [ ! -e "$tmp/x.leaf" ]

# PLOT3D as text: half of a ring of two zones, whose nodes with i = j = 1 are blanked; a solution at rest.
text() { # text WHAT TIME: the grid, or the solution of a time
    awk -v what="$1" -v time="${2:-0}" 'BEGIN {
        split("5 4 3 3 4 6", n); print 2; print n[1], n[2], n[3]; print n[4], n[5], n[6]
        for (z = 0; z < 2; z++) {
            if (what == "q") print "0.5 0 1e6", time
            for (number = 1; number <= (what == "q" ? 5 : 4); number++)
                for (k = 0; k < n[3 * z + 3]; k++) for (j = 0; j < n[3 * z + 2]; j++) for (i = 0; i < n[3 * z + 1]; i++) {
                    a = 0.3 * (i + 4 * z); r = 1 + j
                    if (what == "q") printf "%.8E\n", number == 1 ? 1 + k + time : number == 5 ? 2 : 0
                    else if (number < 4) printf "%.8E ", number == 1 ? r * cos(a) : number == 2 ? r * sin(a) : k
                    else printf "%d ", i != 1 || j != 1
                }
            print ""
        }
    }'
}
text grid >"$tmp/ring.xyz"
for i in 0 1 2; do text q $i.5 >"$tmp/ring_$i.q"; done
exits "info of text" 0 "$leafcast" info "$tmp/ring.xyz"
ok "says what it is" says '^format *PLOT3D$'
ok "of two zones" says '^ *3 x 4 x 6 nodes$'
ok "some of whose nodes are blanked" says '^blanked *9 nodes are no part of the grid$'
exits "convert steps of text" 0 "$leafcast" convert "$tmp/ring.xyz" --solution "$tmp/ring_%d.q" -o "$tmp/ring.leaf"
ok "says its cells" says '^cells *[0-9]* right-handed, [0-9]* left-handed, 28 blanked$'
exits "info of the steps" 0 "$leafcast" info "$tmp/ring.leaf"
ok "says their times" says '^steps *3, times 0.5 .. 2.5$'
exits "verify it" 0 "$leafcast" verify "$tmp/ring.leaf"
sed '$d' "$tmp/ring_1.q" | sed '$d' >"$tmp/short.q"
exits "text that is cut" 3 "$leafcast" convert "$tmp/ring.xyz" --solution "$tmp/short.q" -o "$tmp/x.leaf"
ok "has too few numbers" says 'how many it has, 674, fit no layout of text'
sed 's/^2.00000000E+00$/2.0O/' "$tmp/ring_1.q" >"$tmp/letter.q"
exits "text with a letter O" 3 "$leafcast" convert "$tmp/ring.xyz" --solution "$tmp/letter.q" --field energy -o "$tmp/x.leaf"
ok "says the line" says 'letter.q: line [0-9]*: "2.0O", expected a number'

# A cell that VTK hides: as the same grid without it, but for that cell. Of three along k the second one.
bent() { # bent MARK
    printf '<VTKFile type="StructuredGrid"><StructuredGrid WholeExtent="0 1 0 1 0 3"><Piece Extent="0 1 0 1 0 3">'
    printf '<CellData><DataArray type="UInt8" Name="vtkGhostType" format="ascii">0 %s 0</DataArray></CellData>' "$1"
    printf '<PointData><DataArray type="Float32" Name="s" format="ascii">0 1 0 1 0 1 0 1 0 1 0 1 0 1 0 1</DataArray></PointData>'
    printf '<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">'
    for k in 0 1 2 3; do printf '0 0 %d 1 0 %d 0 1 %d.1 1 1.5 %d ' $k $k $k $k; done
    printf '</DataArray></Points></Piece></StructuredGrid></VTKFile>\n'
}
for mark in 0 1 32; do
    bent $mark >"$tmp/bent$mark.vts"
    exits "convert with a mark of $mark" 0 "$leafcast" convert "$tmp/bent$mark.vts" -o "$tmp/bent$mark.leaf"
    exits "verify it" 0 "$leafcast" verify "$tmp/bent$mark.leaf"
    for k in 0.5 1.5 2.5; do
        "$leafcast" probe "$tmp/bent$mark.leaf" --point 0.5,0.5,$k && echo in
    done >"$tmp/probes$mark" 2>&1
done
exits "the hidden one again" 0 "$leafcast" convert "$tmp/bent32.vts" -o "$tmp/bent32.leaf" --force
ok "is blanked" says '^cells *2 right-handed, 0 left-handed, 1 blanked$'
ok "and is not met" [ "$(grep -c '^hexahedron: ' "$tmp/probes32")" = 2 ]
ok "what a piece alone has twice is" [ "$(grep -c '^hexahedron: ' "$tmp/probes1")" = 3 ]
exits "info of the hidden one" 0 "$leafcast" info "$tmp/bent32.vts"
ok "counts the cells" says '^grid *16 nodes, 2 cells$'

# A grid in pieces is the grid: the same bytes. Bent rows of 7 nodes, cut at the fourth; with a layer of cells that both have, marked.
cut_grid() { # cut_grid FIRST LAST DUPLICATE: nodes i of FIRST to LAST; cells that begin at DUPLICATE are another piece's
    awk -v first="$1" -v last="$2" -v twice="$3" 'BEGIN {
        printf "<VTKFile type=\"StructuredGrid\"><StructuredGrid WholeExtent=\"0 6 0 4 0 2\"><Piece Extent=\"%d %d 0 4 0 2\">", first, last
        printf "<CellData><DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">"
        for (k = 0; k < 2; k++) for (j = 0; j < 4; j++) for (i = first; i < last; i++) printf "%d ", i == twice
        printf "</DataArray></CellData><PointData><DataArray type=\"Float32\" Name=\"s\" format=\"ascii\">"
        for (k = 0; k < 3; k++) for (j = 0; j < 5; j++) for (i = first; i <= last; i++) printf "%d ", i * j + k
        printf "</DataArray></PointData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
        for (k = 0; k < 3; k++) for (j = 0; j < 5; j++) for (i = first; i <= last; i++) printf "%g %g %g ", i, j + i * i / 8, k + i * j / 50
        print "</DataArray></Points></Piece></StructuredGrid></VTKFile>"
    }'
}
cut_grid 0 6 -1 >"$tmp/uncut.vts"
cut_grid 0 4 3 >"$tmp/cut_0.vts"
cut_grid 3 6 -1 >"$tmp/cut_1.vts"
printf '<VTKFile type="PStructuredGrid"><PStructuredGrid WholeExtent="0 6 0 4 0 2" GhostLevel="1"><Piece Extent="0 4 0 4 0 2" Source="cut_0.vts"/><Piece Extent="3 6 0 4 0 2" Source="cut_1.vts"/></PStructuredGrid></VTKFile>' >"$tmp/cut.pvts"
printf '<VTKFile type="Collection"><Collection><DataSet timestep="3" file="cut.pvts"/><DataSet timestep="1" file="uncut.vts"/></Collection></VTKFile>' >"$tmp/cut.pvd"
exits "convert a grid" 0 "$leafcast" convert "$tmp/uncut.vts" -o "$tmp/uncut.leaf" -q
exits "and in pieces" 0 "$leafcast" convert "$tmp/cut.pvts" -o "$tmp/cut.leaf" -q
ok "is the same file" cmp -s "$tmp/uncut.leaf" "$tmp/cut.leaf"
exits "info of pieces" 0 "$leafcast" info "$tmp/cut.pvts"
ok "tells one zone" says '^zones *7 x 5 x 3 nodes$'
exits "a collection of both" 0 "$leafcast" convert "$tmp/cut.pvd" -o "$tmp/both.leaf"
ok "has nodes that stay" says '^nodes *stay where they are$'
exits "info of both" 0 "$leafcast" info "$tmp/both.leaf"
ok "says their times" says '^steps *2, times 1 .. 3$'
ok "and that they are the same" says '^series *1 payloads are the same as earlier ones'
exits "the second step" 0 "$leafcast" convert "$tmp/cut.pvd" --step 1 -o "$tmp/later.leaf" -q
ok "is the same file, too" cmp -s "$tmp/uncut.leaf" "$tmp/later.leaf"

# Compressed.
exits "a larger one" 0 "$leafcast" generate gyroid --curvilinear warp --dims 40 -o "$tmp/large.vts" -q
for codec in none zstd zstd:19; do
    exits "compressed by $codec" 0 "$leafcast" convert "$tmp/large.vts" -o "$tmp/$codec.leaf" --compress $codec -q
    exits "is sound" 0 "$leafcast" verify "$tmp/$codec.leaf"
    exits "is drawn" 0 "$leafcast" render "$tmp/$codec.leaf" --size 64x48 -o "$tmp/$codec.pfm" -q
    ok "as the raw file is" cmp "$tmp/none.pfm" "$tmp/$codec.pfm"
done
ok "less than a fifth" [ $((5 * $(wc -c <"$tmp/zstd.leaf"))) -lt "$(wc -c <"$tmp/none.leaf")" ]
exits "of two steps" 0 "$leafcast" convert "$tmp/cut.pvd" -o "$tmp/both_z.leaf" --compress zstd -q
exits "info" 0 "$leafcast" info "$tmp/both_z.leaf"
ok "says what it is compressed by" says 'treelets of 32^3 cells, zstd:'
exits "are sound" 0 "$leafcast" verify "$tmp/both_z.leaf"

# Its surface, and its hexahedra as a mesh, which draw the same.
exits "a surface" 0 "$leafcast" export "$tmp/warp.leaf" --iso 0.2 -o "$tmp/warp.ply" --json
ok "has triangles" grep -q '"triangles": *[1-9]' "$tmp/out"
exits "samples" 3 "$leafcast" export "$tmp/warp.leaf" -o "$tmp/x.nrrd"
ok "it has none of a grid" says 'which has no samples of a grid'
exits "its cells" 0 "$leafcast" export "$tmp/warp.leaf" -o "$tmp/warp.vtu" --json
ok "are counted" grep -q '"cells": *[1-9]' "$tmp/out"
exits "as a mesh" 0 "$leafcast" convert "$tmp/warp.vtu" --whole-cells -o "$tmp/as_mesh.leaf" -q
for file in warp as_mesh; do
    "$leafcast" render "$tmp/$file.leaf" --iso 0.2 --view standard --size 64x48 -o "$tmp/$file.pfm" -q || true
done
ok "look the same" cmp "$tmp/warp.pfm" "$tmp/as_mesh.pfm"
for file in warp as_mesh; do
    exits "info of $file" 0 "$leafcast" info "$tmp/$file.leaf" --iso 0.2
    sed -n 's/^isovalue 0.2: \([1-9][0-9]* active cells\).*/\1/p' "$tmp/out" >"$tmp/$file.active"
done
ok "have active cells" [ -s "$tmp/warp.active" ]
ok "and as many of them" cmp "$tmp/warp.active" "$tmp/as_mesh.active"

# Steps that are added later.
"$leafcast" convert "$tmp/drop_0001.vts" -o "$tmp/alone.leaf" -q || true
for how in none zstd; do
    exits "all at once, $how" 0 "$leafcast" convert "$tmp/drop_????.vts" --compress $how -o "$tmp/all.leaf" --force -q
    rm -f "$tmp/grown.leaf"
    exits "the first, $how" 0 "$leafcast" convert "$tmp/drop_0000.vts" --append --compress $how -o "$tmp/grown.leaf" -q
    exits "the others" 0 "$leafcast" convert "$tmp/drop_0001.vts" "$tmp/drop_0002.vts" --append --times 1,2 -o "$tmp/grown.leaf"
    exits "are sound" 0 "$leafcast" verify "$tmp/grown.leaf"
    exits "info" 0 "$leafcast" info "$tmp/grown.leaf"
    ok "tells three" says '^steps *3'
    ok "costs values alone" [ "$(wc -c <"$tmp/grown.leaf")" -lt $((2 * $(wc -c <"$tmp/alone.leaf"))) ]
    for step in 0 1 2; do
        for file in grown all; do
            "$leafcast" render "$tmp/$file.leaf" --step $step --iso 0.3 --size 64x48 -o "$tmp/$file.pfm" --force -q || true
        done
        ok "step $step is the one of the series" cmp "$tmp/grown.pfm" "$tmp/all.pfm"
        cp "$tmp/grown.pfm" "$tmp/step_$step.pfm"
    done
    ok "which differ" differ "$tmp/step_1.pfm" "$tmp/step_2.pfm"
done
"$leafcast" render "$tmp/alone.leaf" --iso 0.3 --size 64x48 -o "$tmp/alone.pfm" -q || true
"$leafcast" render "$tmp/grown.leaf" --step 1 --iso 0.3 --size 64x48 -o "$tmp/grown.pfm" --force -q || true
ok "a step is the one alone" cmp "$tmp/grown.pfm" "$tmp/alone.pfm"
cksum <"$tmp/grown.leaf" >"$tmp/before"
refused() { # refused WHAT STATUS FILE WORDS
    exits "$1" "$2" "$leafcast" convert "$tmp/$3" --append -o "$tmp/grown.leaf"
    ok "is told" says "$4"
    ok "and leaves the file" [ "$(cksum <"$tmp/grown.leaf")" = "$(cat "$tmp/before")" ]
}
exits "watched" 0 "$leafcast" convert --watch "$tmp/drop_%04d.vts" -o "$tmp/watched.leaf" --until 3 --settle 0.1 -q
exits "a watched file" 0 "$leafcast" info "$tmp/watched.leaf"
ok "has three steps" says '^steps *3'
refused "nodes elsewhere" 2 turned.vts 'nodes of treelet 0 lie elsewhere, or are blanked otherwise'
refused "other sizes" 2 fewer.vts 'zone 0 has 8 x 8 x 8 nodes, expected 9 x 9 x 9'
refused "a mesh" 2 warp.vtu 'the file is of none\|no further step'
exits "nodes that move" 2 "$leafcast" convert "$tmp/drop_0000.vts" "$tmp/turned.vts" --append -o "$tmp/x.leaf"
ok "do not grow" says 'nodes that move from step to step'
ok "and leave nothing" [ ! -e "$tmp/x.leaf" ]
exits "to one that moves" 3 "$leafcast" convert "$tmp/turned.vts" --append -o "$tmp/moving.leaf"
ok "is refused" says 'its nodes move'
exits "a grid behind a mesh" 2 "$leafcast" convert "$tmp/drop_0000.vts" --append -o "$tmp/as_mesh.leaf"
ok "is refused, too" says 'no further step\|it is a curvilinear grid'

# As a regular grid.
exits "resampled" 0 "$leafcast" resample "$tmp/warp.leaf" --dims 17 -o "$tmp/warp.nrrd"
ok "has more than half of the box" [ "$(sed -n 's/^in the mesh \([0-9]*\) of .*/\1/p' "$tmp/out")" -gt 2456 ]
exits "without a size" 0 "$leafcast" resample "$tmp/warp.leaf" -o "$tmp/warp.nrrd" --force --json
exits "converted" 0 "$leafcast" convert "$tmp/warp.nrrd" -o "$tmp/regular.leaf" -q

# What is not done with them.
exits "too little memory" 4 "$leafcast" convert "$tmp/warp.vts" -o "$tmp/x.leaf" --memory 500K
ok "says how much is needed" says 'MiB of memory (--memory)'
exits "options of regular grids" 2 "$leafcast" convert "$tmp/warp.vts" -o "$tmp/x.leaf" --spacing 2,2,2
exits "a bench of another kind's" 3 "$leafcast" bench nodes "$tmp/warp.leaf" --iso 0 --size 16x16 --runs 1
exits "and of masks" 3 "$leafcast" bench isovalues "$tmp/warp.leaf" --iso 0 --size 16x16 --runs 1
exits "a shape that is none" 2 "$leafcast" generate gyroid --curvilinear torus --dims 9 -o "$tmp/x.vts"

# The blunt fin and the combustor: big-endian C binary, the fin's solution with zeros behind it.
data=${LEAFCAST_DATA:-../shared/data}
if [ -d "$data/bluntfin" ]; then
    exits "the blunt fin" 0 "$leafcast" convert "$data/bluntfin/bluntfinxyz.bin" --solution "$data/bluntfin/bluntfinq.bin" -o "$tmp/fin.leaf"
    ok "all of its cells are right-handed" says '^cells *37479 right-handed, 0 left-handed$'
    ok "its density" says '^values *0.1925999.* 4.97749'
    exits "is sound" 0 "$leafcast" verify "$tmp/fin.leaf"
    [ -n "$watched" ] || exits "its pressure and Mach number" 0 "$leafcast" convert "$data/bluntfin/bluntfinxyz.bin" --solution "$data/bluntfin/bluntfinq.bin" --field pressure --field mach -o "$tmp/two.leaf"
    exits "the combustor" 0 "$leafcast" convert "$data/combustor/combxyz.bin" --solution "$data/combustor/combq.bin" -o "$tmp/comb.leaf"
    ok "has two folded cells" says '^cells *43006 right-handed, 0 left-handed, 2 folded or flat$'
    exits "what comes next" 0 "$leafcast" info "$data/bluntfin/bluntfinxyz.bin" --solution "$data/bluntfin/bluntfinq.bin" --quick
    ok "names the solution" says '^next  *leafcast convert .*bluntfinxyz.bin --solution .*bluntfinq.bin -o bluntfinxyz.leaf$'
    # Steps: solutions whose times are 1, 2 and 4, the others of another density.
    for i in 1 2 3; do
        cp "$data/bluntfin/bluntfinq.bin" "$tmp/q_$i.q" && chmod u+w "$tmp/q_$i.q"
    done
    put() { dd of="$tmp/q_$1.q" bs=1 seek="$2" conv=notrunc 2>/dev/null; }
    printf '\077\200\0\0' | put 1 24
    printf '\100\0\0\0' | put 2 24
    printf '\100\200\0\0' | put 3 24
    for i in 2 3; do
        dd if="$tmp/q_1.q" bs=4096 skip=2 count=20 2>/dev/null | put $i 40960
    done
    fin=$data/bluntfin/bluntfinxyz.bin
    exits "three solutions" 0 "$leafcast" convert "$fin" --solution "$tmp/q_%d.q" -o "$tmp/steps.leaf"
    ok "nodes stay" says '^nodes *stay where they are$'
    exits "info of the three" 0 "$leafcast" info "$tmp/steps.leaf"
    ok "says their times" says '^steps *3, times 1 \.\. 4$'
    ok "and what is stored once" says '^series *2 payloads are the same as earlier ones'
    exits "the second alone" 0 "$leafcast" convert "$fin" --solution "$tmp/q_2.q" -o "$tmp/second.leaf" -q
    exits "as a step of two" 0 "$leafcast" convert "$fin" --solution "$tmp/q_1.q" --solution "$tmp/q_2.q" --step 1 -o "$tmp/chosen.leaf" -q
    ok "is the same file" cmp -s "$tmp/second.leaf" "$tmp/chosen.leaf"
    "$leafcast" render "$tmp/second.leaf" --iso 1 --size 40x30 -o "$tmp/second.ppm" -q
    for i in 0 1; do
        "$leafcast" render "$tmp/steps.leaf" --step $i --iso 1 --size 40x30 -o "$tmp/step$i.ppm" -q
    done
    ok "and the same picture" cmp -s "$tmp/second.ppm" "$tmp/step1.ppm"
    ok "which is not that of the first" differ "$tmp/step0.ppm" "$tmp/step1.ppm"
    rm -f "$tmp/later.leaf"
    for i in 1 2 3; do
        exits "solution $i, added" 0 "$leafcast" convert "$fin" --solution "$tmp/q_$i.q" --times $((i * i)) -o "$tmp/later.leaf" --append -q
    done
    exits "info of what they became" 0 "$leafcast" info "$tmp/later.leaf"
    ok "says the times" says "^steps *3, times 1 .. 9$"
    ok "and what is stored once" says 'the same as earlier ones'
    "$leafcast" render "$tmp/later.leaf" --step 1 --iso 1 --size 40x30 -o "$tmp/later.ppm" -q
    ok "and looks the same" cmp "$tmp/second.ppm" "$tmp/later.ppm"
    exits "info of an input of steps" 0 "$leafcast" info "$fin" --solution "$tmp/q_*.q" --quick
    ok "says so" says '^steps *3, the first is taken here$'
    exits "solutions and functions that do not match" 2 "$leafcast" convert "$fin" --solution "$tmp/q_?.q" --functions "$tmp/q_1.q" --functions "$tmp/q_2.q" -o "$tmp/x.leaf"
    ok "are counted" says '3 solutions and 2 files of functions'
    exits "an output that is a solution" 2 "$leafcast" convert "$fin" --solution "$tmp/q_?.q" -o "$tmp/q_3.q" --force
    exits "times that fall" 0 "$leafcast" convert "$fin" --solution "$tmp/q_2.q" --solution "$tmp/q_1.q" -o "$tmp/fall.leaf"
    ok "are left out" says 'its times do not ascend: 0, 1, .. instead'
    exits "resumed" 0 "$leafcast" convert "$fin" --solution "$tmp/q_%d.q" -o "$tmp/steps.leaf" --resume
    ok "it is whole already" says 'nothing is done'
    sleep 0.01
    touch "$tmp/q_3.q"
    exits "with a solution that is newer" 1 "$leafcast" convert "$fin" --solution "$tmp/q_%d.q" -o "$tmp/steps.leaf" --resume
    ok "it is not" says 'was written after it'

    exits "a grid without a solution" 3 "$leafcast" convert "$data/bluntfin/bluntfinxyz.bin" -o "$tmp/x.leaf"
    ok "says what has its values" says '--solution'
else
    skip "the blunt fin" "no data folder"
fi
finish
