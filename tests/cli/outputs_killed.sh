#!/bin/sh
# outputs_killed.sh - what a killed run left under a temporary name: the next run to the same output says so and removes
# it; what a live run writes stays.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
disk=$tmp/disk
mkdir "$disk"
run "$leafcast" generate noise --dims 64 -o "$tmp/g.nrrd"
run "$leafcast" generate noise --dims 12 --tets -o "$tmp/m.mesh"
run "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/good.leaf"
run "$leafcast" resample "$tmp/m.mesh" --dims 9 -o "$tmp/good.nrrd"
ok "there is what to compare with" [ -s "$tmp/good.leaf" ] && [ -s "$tmp/good.nrrd" ]
names() { find "$disk" -type f | sed "s|^$disk/||" | sort | tr '\n' ' '; }

# start PIPE WORDS... - a verb that reads from a pipe, of which it gets only half; $pid, ended by stop or let_go.
start() {
    pipe=$tmp/$1
    input=$2
    shift 2
    mkfifo "$pipe"
    "$leafcast" "$@" <"$pipe" >/dev/null 2>"$tmp/err.$$" &
    pid=$!
    exec 7>"$pipe"
    rm "$pipe"
    head -c 100000 "$input" >&7
    wait_for
}
# Until it has begun its output, which it does before it reads.
wait_for() {
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        [ -z "$(find "$disk" -name '*.partial-*' -o -name output)" ] || return 0
        sleep 0.25
    done
    return 1
}
kill_it() {
    kill -9 "$pid"
    wait "$pid" 2>/dev/null
    exec 7>&-
}

ok "a conversion has begun" start pipe "$tmp/g.nrrd" convert - -o "$disk/k.leaf"
ok "in a folder of its own" [ "$(names)" = "k.leaf.unfinished/output " ]
exits "another run meanwhile" 1 "$leafcast" convert "$tmp/g.nrrd" -o "$disk/k.leaf"
ok "says who is in the way" says 'k.leaf: another process is making it'
exits "also with --force" 1 "$leafcast" convert "$tmp/g.nrrd" -o "$disk/k.leaf" --force
exits "also with --resume" 1 "$leafcast" convert "$tmp/g.nrrd" -o "$disk/k.leaf" --resume
ok "it changes nothing" [ "$(names)" = "k.leaf.unfinished/output " ]
tail -c +100001 "$tmp/g.nrrd" >&7
exec 7>&-
wait "$pid"
rc=$?
ok "the first ends well (got $rc)" [ "$rc" = 0 ]
ok "with its output" cmp "$tmp/good.leaf" "$disk/k.leaf"
ok "and nothing else" [ "$(ls "$disk")" = "k.leaf" ]
rm "$disk/k.leaf"

ok "a conversion has begun again" start pipe "$tmp/g.nrrd" convert - -o "$disk/k.leaf"
kill_it
ok "killed: it left its folder" [ "$(names)" = "k.leaf.unfinished/output " ]
exits "a run to another output" 0 "$leafcast" convert "$tmp/g.nrrd" -o "$disk/k.leaf2"
ok "leaves it there" [ "$(names)" = "k.leaf.unfinished/output k.leaf2 " ]
rm "$disk/k.leaf2"
exits "the next run to the same" 0 "$leafcast" convert "$tmp/g.nrrd" -o "$disk/k.leaf"
ok "removes it" [ "$(ls "$disk")" = "k.leaf" ]
ok "the same bytes" cmp "$tmp/good.leaf" "$disk/k.leaf"
rm "$disk/k.leaf"

# A mesh that becomes a treelet file first: of two temporary names.
ok "resampling has begun" start pipe "$tmp/m.mesh" resample - --dims 9 -o "$disk/r.nrrd"
kill_it
ok "killed: it left something" [ -n "$(names)" ]
exits "the next run" 0 "$leafcast" resample "$tmp/m.mesh" --dims 9 -o "$disk/r.nrrd"
ok "says so" says 'removed .*/r.nrrd.partial-1, which a killed run left'
ok "leaves only its output" [ "$(names)" = "r.nrrd " ]
ok "the same bytes" cmp "$tmp/good.nrrd" "$disk/r.nrrd"
rm "$disk/r.nrrd"
TMPDIR=$disk
export TMPDIR
ok "to standard output: by way of TMPDIR" start pipe "$tmp/m.mesh" resample - --dims 9 -o -
kill_it
ok "killed: it left something there" [ -n "$(names)" ]
exits "the next run" 0 "$leafcast" resample "$tmp/m.mesh" --dims 9 -o -
ok "removes it" [ -z "$(names)" ]
ok "the same bytes" cmp "$tmp/good.nrrd" "$tmp/out"
unset TMPDIR

# Volumes that bench makes for itself.
TMPDIR=$disk
export TMPDIR
"$leafcast" bench intersectors --form brief --runs 1000 >/dev/null 2>&1 &
pid=$!
ok "a measurement has begun" wait_for
sleep 0.3
kill -9 "$pid"
wait "$pid" 2>/dev/null
sleep 1 # a verb that it ran may end first
ok "killed: it left its folder" [ -n "$(names)" ]
exits "the next one" 0 "$leafcast" bench intersectors --form brief --runs 1 --ray-cells 9
ok "says so" says 'removed .*/leafcast-bench-.*, which a killed run left'
ok "leaves nothing" [ -z "$(ls -A "$disk")" ]
unset TMPDIR
rm -rf "${disk:?}"/*

# Pictures and depths.
for output in "-o $disk/p.png" "--depth-f64 $disk/p.f64"; do
    # shellcheck disable=SC2086 # split on purpose
    "$leafcast" render "$tmp/good.leaf" --iso 100 --size 600,600 --repeat 10000 $output >/dev/null 2>&1 &
    pid=$!
    ok "drawing has begun: ${output%% *}" wait_for
    kill -9 "$pid"
    wait "$pid" 2>/dev/null
    # shellcheck disable=SC2086
    exits "the next run" 0 "$leafcast" render "$tmp/good.leaf" --iso 100 --size 60,60 $output
    ok "says so" says 'removed .*partial-1, which a killed run left'
    ok "leaves only its output" [ "$(names)" = "${output##*/} " ]
    rm "$disk"/p.*
done
finish
