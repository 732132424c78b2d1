#!/bin/sh
# view_page_trial.sh - the page of leafcast view in a browser: units, colours, bad addresses, slices' windows.
# marks: plain, long
. tests/support/tap.sh

need_view
need_browser
"$leafcast" generate gyroid --dims 48,40,44 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q

client "the page" "$python" tests/support/view_page_trial.py "$leafcast" "$tmp"
finish
