#!/bin/sh
# render_budgets.sh - leafcast render: the same bits for any budget, backend and number of threads; signals end it.
# marks: threads
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/$2"; }
leaf=$tmp/v.leaf
dims=75,70,66
[ -z "$watched" ] || dims=44,40,36 # the fewer treelets, the less often one makes room for another
run "$leafcast" generate gyroid --dims $dims -o "$tmp/v.nrrd"
exits "a volume to draw" 0 "$leafcast" convert "$tmp/v.nrrd" -o "$leaf" --treelet 16 -q

# EXR has all planes; its helper takes half a second to start.
side=60 form=exr
[ -x "$(dirname "$leafcast")/../libexec/leafcast-write-image" ] || form=pfm
[ -z "$watched" ] || side=24 form=pfm
rich="--iso 90 --iso 128 --iso 170 --opacity 0.4 --opacity 0.5 --opacity 0.6 --light 1,0.4,2 --point-light 200,-90,120
    --shadows --shading phong --size ${side}x$side --view close -q"
draw() { # draw NAME FLAG...
    tap_name=$1
    shift
    "$leafcast" render "$leaf" $rich "$@" -o "$tmp/$tap_name.$form" --depth-f64 "$tmp/$tap_name.f64" --force
}
alike() { draw now "$@" && cmp "$tmp/now.f64" "$tmp/all.f64" && cmp "$tmp/now.$form" "$tmp/all.$form"; }
ok "shadows and three transparent surfaces" draw all
for limit in 1 2 17; do
    one_in 3 || continue # with more of them threads wait less
    ok "the same bits with $limit treelets" alike --treelet-limit $limit
done
for backend in arena mapped; do
    ok "the same bits from the $backend backend" alike --backend $backend
    one_in 2 || continue
    ok "and with one treelet there" alike --backend $backend --treelet-limit 1
done
ok "the same bits from one thread" alike --threads 1
ok "the same bits from five, three treelets" alike --threads 5 --treelet-limit 3
ok "the same bits after a sweep" alike --sweep
ok "the same bits from scalar kernels" alike --isa scalar
ok "another intersector" draw other --intersector midpoint
ok "draws other bits" sh -c '! cmp -s "$1" "$2"' - "$tmp/all.f64" "$tmp/other.f64"

# The process alone: timeout would signal its group as well, and a second Ctrl-C ends it at once.
timeout --foreground --preserve-status -s INT 1 "$leafcast" render "$leaf" --iso 128 --size 2000x2000 --repeat 1000 --depth-f64 "$tmp/stop.f64" 2>"$tmp/err"
rc=$?
ok "Ctrl-C: exit 130 (got $rc)" [ "$rc" = 130 ]
ok "says so" says 'stopped by signal 2' err
timeout --preserve-status -s TERM 1 sh -c "sleep 5 | exec '$leafcast' render '$leaf' --iso 128 --script -" 2>"$tmp/err"
rc=$?
ok "a waiting script ends at a signal (got $rc)" [ "$rc" = 143 ]
ok "leaves nothing half-written" [ -z "$(find "$tmp" -name 'stop*' -o -name '*.partial*')" ]
finish
