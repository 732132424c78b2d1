#!/bin/sh
# view_server.sh - leafcast view as a browser meets it: the page, refusals, pictures, picks, floods, the end.
# marks: threads, long
. tests/support/tap.sh

need_view
"$leafcast" generate gyroid --dims 48,40,44 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/bare.leaf" --levels 1 --treelet 16 -q
"$leafcast" generate buckyball --tets --dims 11 --steps 2 --deform 0.4 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m_0000.mesh" "$tmp/m_0001.mesh" -o "$tmp/m.leaf" -q

exits "without a file" 2 "$leafcast" view
exits "a port that is none" 2 "$leafcast" view "$tmp/g.leaf" --port 65536
exits "a file that is none" 3 "$leafcast" view "$tmp/g.nrrd"
exits "instructions that are none" 2 "$leafcast" view "$tmp/g.leaf" --isa none
exits "an address that is none" 1 timeout 20 "$leafcast" view "$tmp/g.leaf" --address 192.0.2.1
exits "--memory: too little" 4 "$leafcast" view "$tmp/g.leaf" --memory 1K

# A million tets are many where sanitizers watch.
if [ -z "$watched" ]; then
    "$leafcast" generate buckyball --tets --dims 58 -o "$tmp/l.mesh" -q
    "$leafcast" convert "$tmp/l.mesh" -o "$tmp/l.leaf" -q
    run timeout -s INT 2 "$leafcast" view "$tmp/l.leaf" "$tmp/m.leaf"
    ok "a large mesh without a coarse grid is told of" [ "$(grep -c "no coarse grid" "$tmp/err")" = 1 ]
    "$leafcast" convert "$tmp/l.mesh" --coarse -o "$tmp/l.leaf" --force -q
    run timeout -s INT 2 "$leafcast" view "$tmp/l.leaf" "$tmp/m.leaf"
    ok "one with it is not" [ "$(grep -c "no coarse grid" "$tmp/err")" = 0 ]
    "$leafcast" generate gyroid --dims 110 -o "$tmp/l.nrrd" -q
    "$leafcast" convert "$tmp/l.nrrd" -o "$tmp/l.leaf" --force --levels 1 -q
    run timeout -s INT 2 "$leafcast" view "$tmp/l.leaf" "$tmp/g.leaf"
    ok "nor is a grid, but of its coarse levels" [ "$(grep -c "l.leaf has no coarse levels" "$tmp/err")" = 1 ]
    "$leafcast" convert "$tmp/l.nrrd" -o "$tmp/l.leaf" --force -q
    run timeout -s INT 2 "$leafcast" view "$tmp/l.leaf" "$tmp/g.leaf"
    ok "a grid with them is not" [ "$(grep -c "has no coarse" "$tmp/err")" = 0 ]
fi

# What a page is told has one thread, and levels that are not there have those of levels that are.
clients="view_told view_bare"
[ "$watched" != threads ] || clients=
for client in $clients view_drawn view_server; do
    client "$client" python3 "tests/support/$client.py" "$leafcast" "$tmp"
done
finish
