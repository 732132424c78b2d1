#!/bin/sh
# view_page_trial.sh - the page of leafcast view in a browser: units, colours, bad addresses, slices' windows.
# marks: plain, long
. tests/support/tap.sh

need_view
need_browser
"$leafcast" generate gyroid --dims 48,40,44 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
"$python" -c '
import struct, sys
c = range(33)
values = [((x - 16) ** 2 + (y - 16) ** 2 + (z - 16) ** 2) ** 0.5 for z in c for y in c for x in c]
open(sys.argv[1], "wb").write(struct.pack(f"<{len(values)}f", *values))' "$tmp/s_33x33x33_f32.raw"
"$leafcast" convert "$tmp/s_33x33x33_f32.raw" -o "$tmp/shells.leaf" -q
"$python" -c '
import struct, sys
c = range(33)
values = [max(0, 1 - ((x - 16) / 9) ** 2 - ((y - 16) / 9) ** 2 - ((z - 16) / 2) ** 2) for z in c for y in c for x in c]
open(sys.argv[1], "wb").write(struct.pack(f"<{len(values)}f", *values))' "$tmp/w_33x33x33_f32.raw"
"$leafcast" convert "$tmp/w_33x33x33_f32.raw" -o "$tmp/slab.leaf" -q

client "the page" "$python" tests/support/view_page_trial.py "$leafcast" "$tmp"
finish
