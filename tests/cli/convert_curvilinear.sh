#!/bin/sh
# convert_curvilinear.sh - curvilinear grids from a file to pictures: generated ones of each shape, series of
# steps, real ones in PLOT3D (skipped without the data folder); what is refused, in words.
# marks: leaks
. tests/support/tap.sh

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
"$leafcast" generate drop --curvilinear warp --dims 8 -o "$tmp/fewer.vts" -q
exits "steps of other sizes" 3 "$leafcast" convert "$tmp/drop_0000.vts" "$tmp/fewer.vts" -o "$tmp/x.leaf"
ok "are refused by name" says 'fewer.vts: zone 0 has 8 x 8 x 8 nodes, but 9 x 9 x 9 in the first step'
ok "and leave nothing" [ ! -e "$tmp/x.leaf" ]

# What is not done with them.
exits "compressed" 3 "$leafcast" convert "$tmp/warp.vts" -o "$tmp/x.leaf" --compress zstd
ok "is refused" says 'are not compressed'
exits "further steps" 3 "$leafcast" convert "$tmp/warp.vts" -o "$tmp/warp.leaf" --append
ok "are refused" says 'of a kind that does not grow'
exits "or the first of such" 3 "$leafcast" convert "$tmp/warp.vts" -o "$tmp/x.leaf" --append
ok "likewise" says 'steps are not added'
exits "too little memory" 4 "$leafcast" convert "$tmp/warp.vts" -o "$tmp/x.leaf" --memory 500K
ok "says how much is needed" says 'MiB of memory (--memory)'
exits "options of regular grids" 2 "$leafcast" convert "$tmp/warp.vts" -o "$tmp/x.leaf" --spacing 2,2,2
exits "resample" 3 "$leafcast" resample "$tmp/warp.leaf" -o "$tmp/x.nrrd"
ok "takes meshes" says 'a curvilinear grid, of which none is resampled'
exits "export" 3 "$leafcast" export "$tmp/warp.leaf" --iso 0 -o "$tmp/x.ply"
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
    exits "a grid without a solution" 3 "$leafcast" convert "$data/bluntfin/bluntfinxyz.bin" -o "$tmp/x.leaf"
    ok "says what has its values" says '--solution'
else
    skip "the blunt fin" "no data folder"
fi
finish
