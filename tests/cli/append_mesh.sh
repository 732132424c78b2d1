#!/bin/sh
# append_mesh.sh - leafcast convert --append and --watch of meshes: pictures, probes and ranges of each step are those of
# the step converted alone; what is no further step is named, and leaves the file as it was.
. tests/support/tap.sh

out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/err"; }
sum() { sha256sum <"$out"; }
unchanged() { [ "$(sum)" = "$before" ] && [ -z "$(find "$tmp" -name 'a.leaf?*')" ]; }
# What a step looks like, what a point of it is, and its range: of file $1, the rest are options.
seen() {
    file=$1
    shift
    "$leafcast" render "$file" "$@" --iso 0.4 --size 120x120 -o "$tmp/x.ppm" --force -q && sha256sum <"$tmp/x.ppm"
    "$leafcast" probe "$file" "$@" --point 7.1,6.2,8.3 --json | grep -v '"rerun"\|"field"\|"step"\|"time"\|"file"'
    "$leafcast" export "$file" "$@" -o "$tmp/x.vtu" --force -q && LC_ALL=C sed "1,/^<AppendedData/d" "$tmp/x.vtu" | sha256sum
}
same_step() {
    seen "$out" --step "$1" >"$tmp/got" && seen "$tmp/$2.leaf" >"$tmp/want" && [ -s "$tmp/want" ] &&
        cmp -s "$tmp/got" "$tmp/want"
}

for i in 0 1 2; do
    "$leafcast" generate noise --tets --dims 16 --seed $((i + 5)) -o "$tmp/s$i.mesh" -q
done

for options in "" "--compress zstd --gradients"; do
    rm -f "$out"
    # shellcheck disable=SC2086 # split on purpose
    for i in 0 1 2; do "$leafcast" convert "$tmp/s$i.mesh" -o "$tmp/s$i.leaf" --name a --force -q $options; done
    # shellcheck disable=SC2086 # likewise
    exits "what is not there is made${options:+ with $options}" 0 "$leafcast" convert --append "$tmp/s0.mesh" -o "$out" \
        --times 0 $options
    one=$(wc -c <"$out")
    exits "a step" 0 "$leafcast" convert --append "$tmp/s1.mesh" -o "$out" --times 0.5
    ok "says so" says 'a.leaf: 1 step added, 2 now'
    exits "two at once" 0 "$leafcast" convert --append "$tmp/s2.mesh" "$tmp/s1.mesh" -o "$out" --times 2,3
    ok "what is there costs next to nothing" [ "$(wc -c <"$out")" -lt $((3 * one)) ]
    exits "verify" 0 "$leafcast" verify "$out"
    for step in "0 s0" "1 s1" "2 s2" "3 s1"; do
        # shellcheck disable=SC2086 # likewise
        ok "step $step" same_step $step
    done
done
run "$leafcast" info "$out"
ok "all are there" grep -q '^steps  *4, times 0 .. 3' "$tmp/out"
ok "nothing is beside it" [ -z "$(find "$tmp" -name 'a.leaf?*')" ]

# ---- what is no further step ----

before=$(sum)
"$leafcast" generate noise --tets --dims 16 --spacing 2 -o "$tmp/large.mesh" -q
"$leafcast" generate noise --tets --dims 16,16,15 -o "$tmp/short.mesh" -q
"$leafcast" generate noise --dims 16 -o "$tmp/g.nrrd" -q
sed 's/^field: noise/field: sound/' "$tmp/s1.mesh" >"$tmp/other.mesh"
while IFS='|' read -r name options said; do
    # shellcheck disable=SC2046 # split on purpose
    exits "$name" 2 "$leafcast" convert --append -o "$out" $(echo "$options" | sed "s|@|$tmp/|g")
    ok "says why" says "$said"
    ok "nothing changes" unchanged
done <<'ROWS'
other places|@large.mesh --times 9|large.mesh: no further step of .*a.leaf: .*its points lie elsewhere, or its tets join others
another size|@short.mesh --times 9|it has 18900 tets, expected 20250
another field|@other.mesh --times 9|field 0 is sound, expected noise
no time|@s1.mesh|it has no time: --times gives it
an early time|@s1.mesh --times 3|its time 3 is not behind the last one, 3
other treelets|@s1.mesh --times 9 --treelet-tets 300|has treelets of 4096 tets: --treelet-tets asks for something else
other leaves|@s1.mesh --times 9 --leaf-tets 3|has leaves of 12 tets: --leaf-tets asks for something else
another tree|@s1.mesh --times 9 --build sah|--build is not what the file was made with
as it is|@s1.mesh --times 9 --compress none|has compressed samples: --compress asks for something else
coarse grids|@s1.mesh --times 9 --coarse|--append goes without
a grid|@g.nrrd --times 9|it is a grid, and the file is of none
ROWS
"$leafcast" convert "$tmp/s0.mesh" -o "$tmp/n.leaf" -q
exits "gradients that it has not" 2 "$leafcast" convert --append "$tmp/s1.mesh" -o "$tmp/n.leaf" --gradients
ok "says why" says 'has no gradients: --gradients asks for something else'
"$leafcast" convert "$tmp/s0.mesh" -o "$tmp/c.leaf" --coarse -q
exits "to one with coarse grids" 3 "$leafcast" convert --append "$tmp/s1.mesh" -o "$tmp/c.leaf"
ok "says why" says 'no step can be added: it has coarse grids'
"$leafcast" generate noise --tets --dims 9 --steps 4 --deform 0.2 -o "$tmp/d.mesh" -q
exits "points that move" 2 "$leafcast" convert --append "$tmp/d_0000.mesh" "$tmp/d_0001.mesh" -o "$tmp/d.leaf"
ok "says so" says 'points that move from step to step: all steps of such a mesh are converted at once'
ok "makes nothing" [ ! -e "$tmp/d.leaf" ]
exits "the first of them" 0 "$leafcast" convert --append "$tmp/d_0000.mesh" -o "$tmp/d.leaf"
exits "the second" 2 "$leafcast" convert --append "$tmp/d_0001.mesh" -o "$tmp/d.leaf"
ok "says what has moved" says 'no further step of .*its points lie elsewhere'
"$leafcast" convert "$tmp/d_0000.mesh" "$tmp/d_0001.mesh" -o "$tmp/m.leaf" -q
exits "to one that moves" 3 "$leafcast" convert --append "$tmp/d_0001.mesh" -o "$tmp/m.leaf"
ok "says why" says 'no step can be added: its vertices move'

# ---- as files come ----

mkdir "$tmp/run"
out=$tmp/w.leaf
for i in 0 1 2; do "$leafcast" convert "$tmp/s$i.mesh" -o "$tmp/s$i.leaf" --name w --force -q; done
"$leafcast" convert --watch "$tmp/run/f_%d.mesh" -o "$out" --until 4 --settle 0.2 -q 2>"$tmp/watched" &
pid=$!
for i in 1 2 3 4; do
    cp "$tmp/s$((i % 3)).mesh" "$tmp/run/f_$i.part"
    mv "$tmp/run/f_$i.part" "$tmp/run/f_$i.mesh"
done
wait "$pid"
rc=$?
ok "enough steps end a watch (got $rc)" [ "$rc" = 0 ]
for i in 1 2 3 4; do
    ok "file $i is in its place" same_step $((i - 1)) s$((i % 3))
done
exits "verify" 0 "$leafcast" verify "$out"

finish
