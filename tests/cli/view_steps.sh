#!/bin/sh
# view_steps.sh - leafcast view of a series: 100 steps played twice are those that render draws; steps that come are shown.
# marks: threads, long
. tests/support/tap.sh

need_view
steps=${watched:+30} # each is drawn in the same way
"$leafcast" generate jets --dims 24 --steps ${steps:-100} -o "$tmp/s.nrrd" -q
"$leafcast" convert "$tmp"/s_*.nrrd -o "$tmp/all.leaf" --treelet 16 -q
client "steps" python3 tests/support/view_steps.py "$leafcast" "$tmp"
finish
