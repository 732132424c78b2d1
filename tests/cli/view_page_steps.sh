#!/bin/sh
# view_page_steps.sh - the page of leafcast view in a browser: 100 steps played twice, and steps that come.
# marks: plain, long
. tests/support/tap.sh

need_view
need_browser
"$leafcast" generate jets --dims 24 --steps 100 -o "$tmp/s.nrrd" -q
"$leafcast" convert "$tmp"/s_*.nrrd -o "$tmp/all.leaf" --treelet 16 -q
client "steps" "$python" tests/support/view_page_steps.py "$leafcast" "$tmp"
finish
