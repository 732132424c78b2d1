#!/bin/sh
# view_page_surface.sh - the page of leafcast view in a browser: a surface, which has no isovalues.
# marks: plain, long
. tests/support/tap.sh

need_view
need_browser
"$leafcast" generate gyroid --dims 24 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
"$leafcast" export "$tmp/g.leaf" --iso 128 -o "$tmp/s.ply" -q
"$leafcast" convert "$tmp/s.ply" -o "$tmp/s.leaf" -q
client "a surface" "$python" tests/support/view_page_surface.py "$leafcast" "$tmp"
finish
