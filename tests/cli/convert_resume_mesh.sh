#!/bin/sh
# convert_resume_mesh.sh - conversions of meshes that are killed, in any part, and go on with --resume to the same bytes.
# marks: long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
out=$tmp/x.leaf
work=$tmp/x.leaf.unfinished
alone() { [ "$(find "$tmp" -maxdepth 1 -name 'x.leaf*' | wc -l)" = 1 ]; }
run "$leafcast" generate buckyball --tets --dims 56 -o "$tmp/b.mesh"
run "$leafcast" generate noise --tets --dims 56 --deform 0.5 --steps 3 -o "$tmp/s_%d.mesh"
steps="$tmp/s_0.mesh $tmp/s_1.mesh $tmp/s_2.mesh"

# Two fields, as VTK text.
awk -v n=44 'BEGIN {
    print "# vtk DataFile Version 3.0\ntwo fields\nASCII\nDATASET UNSTRUCTURED_GRID"
    printf "POINTS %d float\n", n * n * n
    for (z = 0; z < n; z++) for (y = 0; y < n; y++) for (x = 0; x < n; x++) print x, y, z
    m = 6 * (n - 1) ^ 3
    printf "CELLS %d %d\n", m, 5 * m
    split("1,3 1,5 2,3 2,6 4,5 4,6", pair)
    for (z = 0; z + 1 < n; z++) for (y = 0; y + 1 < n; y++) for (x = 0; x + 1 < n; x++)
        for (i = 1; i <= 6; i++) {
            split(pair[i], c, ",")
            print 4, x + n * (y + n * z), at(c[1]), at(c[2]), at(7)
        }
    printf "CELL_TYPES %d\n", m
    for (i = 0; i < m; i++) print 10
    printf "POINT_DATA %d\n", n * n * n
    print "SCALARS one float 1\nLOOKUP_TABLE default"
    for (i = 0; i < n * n * n; i++) print sin(i / 7)
    print "SCALARS two float 1\nLOOKUP_TABLE default"
    for (i = 0; i < n * n * n; i++) print cos(i / 99)
}
function at(corner) {
    return x + corner % 2 + n * (y + int(corner / 2) % 2 + n * (z + int(corner / 4)))
}' >"$tmp/two.vtk"

# kill_when FILE PAUSE ARGUMENTS... - begin or go on, saving at each chance; kill it once a state is saved and FILE is in
# the folder, after a pause. Fails if the conversion ends first.
kill_when() {
    what=$1
    pause=$2
    shift 2
    "$leafcast" convert "$@" -o "$out" --checkpoint 0 -q 2>"$tmp/err" &
    pid=$!
    while kill -0 $pid 2>/dev/null; do
        [ ! -e "$work/$what" ] || [ ! -s "$work/state-0" ] || break
    done
    sleep "$pause"
    kill -9 $pid 2>/dev/null
    rc=0
    wait $pid 2>/dev/null || rc=$?
    [ $rc = 137 ]
}

# goes_on NAME ARGUMENTS... - killed in each part, and going on at once; then killed again and again.
goes_on() {
    name=$1
    shift
    run "$leafcast" convert "$@" -o "$tmp/good.leaf" --force
    ok "$name: converts" [ "$rc" = 0 ]
    early=0 tried=0
    for when in "points 0" "runs 0" "runs 0.02" "output 0" "output 0.03"; do
        one_in 3 || continue # each of them for other arguments
        tried=$((tried + 1))
        # shellcheck disable=SC2086 # split on purpose
        kill_when $when "$@" && early=$((early + 1))
        [ -e "$out" ] || exits "$name: going on (killed at $when)" 0 "$leafcast" convert "$@" -o "$out" --resume
        ok "the same bytes" cmp "$tmp/good.leaf" "$out"
        ok "and nothing else" alone
        rm -f "$out"
    done
    ok "most ended early ($early of $tried)" [ $((2 * early)) -ge $tried ]
    one_in 6 || return 0 # each of the parts has gone on above
    kill_when points 0 "$@"
    for when in "runs 0" "runs 0.01" "output 0" "output 0.02"; do
        # shellcheck disable=SC2086
        [ -e "$out" ] || kill_when $when "$@" --resume
    done
    [ -e "$out" ] || exits "$name: by and by" 0 "$leafcast" convert "$@" -o "$out" --resume
    ok "the same bytes" cmp "$tmp/good.leaf" "$out"
    rm -f "$out"
}
goes_on "a mesh" "$tmp/b.mesh" --memory 10M --threads 2
goes_on "with gradients, compressed" "$tmp/b.mesh" --memory 16M --threads 2 --gradients --compress zstd
# shellcheck disable=SC2086 # a list of names without blanks
goes_on "moving steps" $steps --memory 20M --threads 2 --gradients
# shellcheck disable=SC2086
goes_on "moving steps in memory" $steps --threads 2
goes_on "whole cells" "$tmp/b.mesh" --memory 16M --threads 2 --whole-cells
goes_on "fields" "$tmp/two.vtk" --fields all --memory 12M --threads 1
goes_on "with a coarse grid" "$tmp/b.mesh" --memory 16M --threads 2 --coarse=20

# What is done does not depend on memory and threads. Less memory than the first run planned with is refused.
run "$leafcast" convert "$tmp/b.mesh" -o "$tmp/good.leaf" --force
for threads in 1 4 2; do
    one_in 3 || continue
    ok "killed while building" kill_when output 0 "$tmp/b.mesh" --memory 12M --threads 2
    exits "with less memory" 4 "$leafcast" convert "$tmp/b.mesh" -o "$out" --resume --memory 9M --threads $threads
    ok "says what would do" says 'a memory budget of 9 MiB is too small: this mesh needs 1[0-2] MiB'
    ok "which changes nothing" [ -s "$work/runs" ]
    memory=12M
    [ $threads = 2 ] || memory=100M
    exits "with $memory, $threads threads" 0 "$leafcast" convert "$tmp/b.mesh" -o "$out" --resume --memory $memory --threads $threads
    ok "says from where" says 'x.leaf: goes on at [1-9][0-9]* %'
    ok "the same bytes" cmp "$tmp/good.leaf" "$out"
    rm -f "$out"
done

# Sorted tets are kept once: the tets as they were read are gone.
ok "killed while building" kill_when output 0.02 "$tmp/b.mesh" --memory 12M --threads 2
ok "the tets as they were read are gone" [ ! -e "$work/tets" ]
exits "not asked to go on" 1 "$leafcast" convert "$tmp/b.mesh" -o "$out" --memory 12M
ok "both ways out are told" says 'x.leaf.unfinished: work that ended early is there, [0-9]* % done: --resume goes on with it, --force begins again'
exits "another option" 2 "$leafcast" convert "$tmp/b.mesh" -o "$out" --memory 12M --resume --gradients
rm -rf "$work"
# Whole cells are looked up until the end: in a file that may have changed.
ok "killed with whole cells" kill_when output 0.02 "$tmp/b.mesh" --whole-cells --memory 16M --threads 2
ok "their file is there" [ -s "$work/tets" ]
python3 -c 'import os, sys; f = open(sys.argv[1], "r+b"); f.write(b"\xff" * os.path.getsize(sys.argv[1]))' "$work/tets"
exits "cells of no points" 3 "$leafcast" convert "$tmp/b.mesh" -o "$out" --whole-cells --memory 16M --threads 2 --resume
ok "are told" says 'have changed meanwhile; --force begins again'
rm -rf "$work"
ok "killed while building" kill_when output 0.02 "$tmp/b.mesh" --memory 12M --threads 2
truncate -s 1000 "$work/runs"
exits "a file cut short" 3 "$leafcast" convert "$tmp/b.mesh" -o "$out" --memory 12M --resume
ok "is told" says 'x.leaf.unfinished/state-[01]: is not what this program wrote there; --force begins again'
rm -rf "$work"

# A mesh that fits into memory is not saved.
"$leafcast" convert "$tmp/b.mesh" -o "$out" --checkpoint 0 -q &
pid=$!
sleep 0.05
kill -9 $pid 2>/dev/null
wait $pid 2>/dev/null
[ -e "$out" ] || ok "there is no state" [ ! -s "$work/state-0" ]
exits "and the next run begins again" 0 "$leafcast" convert "$tmp/b.mesh" -o "$out" --force
ok "to the same bytes" cmp "$tmp/good.leaf" "$out"
ok "and nothing else" alone
finish
