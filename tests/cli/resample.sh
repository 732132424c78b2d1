#!/bin/sh
# resample.sh - leafcast resample: meshes and treelet files of them to grids, pipes, exit codes.
# marks: leaks
. tests/support/tap.sh

out=$tmp/a.nrrd
left() { [ "$(find "$tmp" -name '*.nrrd*' -o -name '*.leaf*' | wc -l)" = "$1" ]; }
samples() { tail -c "$2" "$1" >"$tmp/samples"; }
floats() { samples "$1" $(($2 * 4)) && samples "$tmp/samples" $(($2 * 4)); }

"$leafcast" generate buckyball --tets --dims 17 -o "$tmp/b.mesh"
"$leafcast" generate buckyball --dims 17 --type f32 -o - >"$tmp/b.grid"
"$leafcast" convert "$tmp/b.mesh" -q -o "$tmp/b.mleaf" >"$tmp/log"

exits "a mesh stream on its own points" 0 "$leafcast" resample "$tmp/b.mesh" --dims 17 -o "$out"
ok "says how many nodes are in the mesh" grep -q "in the mesh 4913 of 4913 nodes" "$tmp/out"
floats "$out" 4913 && cp "$tmp/samples" "$tmp/first"
floats "$tmp/b.grid" 4913
ok "has the values of the points, to the bit" cmp "$tmp/samples" "$tmp/first"
ok "leaves nothing else" left 1
exits "an existing output" 1 "$leafcast" resample "$tmp/b.mesh" --dims 17 -o "$out"
exits "the treelet file, by a pipe, one thread" 0 \
    "$leafcast" resample "$tmp/b.mleaf" --dims 17 --threads 1 -o -
ok "gives the same bytes" cmp "$tmp/out" "$out"
# shellcheck disable=SC2016
exits "a mesh on standard input" 0 sh -c '"$1" resample - --dims 17 --memory 8M -o - <"$2"' sh "$leafcast" "$tmp/b.mesh"
sed 's/^content: .*//' "$out" >"$tmp/named"
floats "$tmp/out" 4913 && cp "$tmp/samples" "$tmp/first"
floats "$out" 4913
ok "gives the same samples" cmp "$tmp/first" "$tmp/samples"
# shellcheck disable=SC2016
exits "on to convert" 0 sh -c '"$1" resample "$2" --spacing 0.5 -q -o - | "$1" convert - -o "$3" && "$1" verify "$3"' \
    sh "$leafcast" "$tmp/b.mleaf" "$tmp/b.vleaf"
ok "a grid of twice the points" grep -q "33 x 33 x 33 f32" "$tmp/out"
exits "a part, and beyond" 0 "$leafcast" resample "$tmp/b.mleaf" --dims 9,9,9 --bounds=-8,0,0,8,16,16 --json --force -o "$out"
ok "half of it is outside" grep -q '"held": 405,' "$tmp/out"
exits "without a size" 0 "$leafcast" resample "$tmp/b.mleaf" --force -o "$out"
ok "has as many nodes as there are vertices" grep -q "^grid        17 x 17 x 17" "$tmp/out"
rm -f "$out" "$tmp/b.vleaf"

"$leafcast" generate buckyball --tets --dims 9 --deform 0.9 --steps 4 -o "$tmp/s_%04d.mesh"
"$leafcast" convert "$tmp"/s_000?.mesh -q -o "$tmp/s.mleaf" >"$tmp/log"
for step in 0 1 3; do
    "$leafcast" resample "$tmp/s_000$step.mesh" --dims 14 --bounds 0,0,0,8,8,8 -o - >"$tmp/alone"
    exits "step $step of a moving series" 0 \
        "$leafcast" resample "$tmp/s.mleaf" --step $step --field buckyball --dims 14 --bounds 0,0,0,8,8,8 -o -
    floats "$tmp/out" 2744 && cp "$tmp/samples" "$tmp/first"
    floats "$tmp/alone" 2744
    ok "is that mesh" cmp "$tmp/samples" "$tmp/first"
done
"$leafcast" generate drop --curvilinear warp --dims 9,7,12 --steps 2 -o "$tmp/w.vts" -q
for step in 0 1; do
    "$leafcast" convert "$tmp/w_000$step.vts" -o "$tmp/w.mleaf" -q --force
    exits "a curvilinear grid, step $step" 0 "$leafcast" resample "$tmp/w_000$step.vts" --dims 14 -o -
    cp "$tmp/out" "$tmp/first"
    exits "and its treelet file" 0 "$leafcast" resample "$tmp/w.mleaf" --dims 14 -o -
    ok "are the same" cmp "$tmp/out" "$tmp/first"
done
printf '<VTKFile type="Collection"><Collection>%s%s</Collection></VTKFile>' '<DataSet timestep="0" file="w_0000.vts"/>' \
    '<DataSet timestep="2" file="w_0001.vts"/>' >"$tmp/w.pvd"
exits "a step of a collection" 0 "$leafcast" resample "$tmp/w.pvd" --step 1 --dims 14 -o -
ok "is that step" cmp "$tmp/out" "$tmp/first"
exits "a step that it has not" 2 "$leafcast" resample "$tmp/w.pvd" --step 2 --dims 14 -o "$out"
exits "--by-corners of it" 2 "$leafcast" resample "$tmp/w.pvd" --by-corners -o "$out"
ok "would change nothing" grep -q -- "--by-corners is for meshes" "$tmp/err"
rm -f "$tmp"/w*
exits "a step that is not there" 2 "$leafcast" resample "$tmp/s.mleaf" --step 4 -o "$out"
exits "a field that is not there" 2 "$leafcast" resample "$tmp/s.mleaf" --field x -o "$out"
exits "a step of a mesh" 2 "$leafcast" resample "$tmp/b.mesh" --step 0 -o "$out"

exits "too little memory" 4 "$leafcast" resample "$tmp/b.mleaf" --memory 64K -o "$out"
exits "a grid" 3 sh -c "'$leafcast' convert '$tmp/b.grid' -q -o '$tmp/g.vleaf' >/dev/null && '$leafcast' resample '$tmp/g.vleaf' -o '$out'"
ok "is told to be one" grep -q "of which none is resampled" "$tmp/err"
"$leafcast" export "$tmp/g.vleaf" -o "$tmp/g.nrrd" -q
exits "a grid that is no treelet file" 3 "$leafcast" resample "$tmp/g.nrrd" -o "$out"
ok "is told to be one, too" grep -q "g.nrrd: a grid, which is regular already" "$tmp/err"
rm "$tmp/g.nrrd"
exits "no mesh" 3 "$leafcast" resample tests/README.md -o "$out"
exits "a file that is not there" 1 "$leafcast" resample "$tmp/none.mesh" -o "$out"
exits "a folder that is not there" 1 "$leafcast" resample "$tmp/b.mleaf" -o "$tmp/none/a.nrrd"
for wrong in "--dims 1" "--dims 3,3" "--dims 1.5" "--spacing 0" "--spacing nan" "--dims 9 --spacing 1" \
    "--bounds 0,0,0,1,1" "--bounds 0,0,0,1,1,0" "--component 1" "--step -1"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "usage: resample $wrong" 2 "$leafcast" resample "$tmp/b.mleaf" $wrong -o "$out"
done
exits "no output" 2 "$leafcast" resample "$tmp/b.mleaf"
rm -f "$tmp/g.vleaf"
ok "none of them leaves a file" left 0
finish
