#!/bin/sh
# view_crash.sh - leafcast view whose process that draws crashes: a picture and a message are lost, no page, no state.
# marks: threads, long
. tests/support/tap.sh

need_view
"$leafcast" generate gyroid --dims 48,40,44 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
"$leafcast" generate buckyball --tets --dims 11 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m.mesh" -o "$tmp/m.leaf" -q

client "crashes" python3 tests/support/view_crash.py "$leafcast" "$tmp"
finish
