#!/bin/sh
# view_page_crash.sh - the page of leafcast view in a browser, when the process that draws crashes.
# marks: long
. tests/support/tap.sh

need_view
need_browser
"$leafcast" generate gyroid --dims 48,40,44 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
"$leafcast" generate buckyball --tets --dims 11 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m.mesh" -o "$tmp/m.leaf" -q
client "the page at a crash" "$python" tests/support/view_page_crash.py "$leafcast" "$tmp"
finish
