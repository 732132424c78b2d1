#!/bin/sh
# view_page.sh - the page of leafcast view in a browser: every control, and pictures that are render's.
# marks: plain, long
. tests/support/tap.sh

need_view
need_browser
"$leafcast" generate gyroid --dims 48,40,44 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
"$leafcast" generate buckyball --tets --dims 11 --steps 4 --deform 0.4 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m_0000.mesh" "$tmp/m_0001.mesh" -o "$tmp/m.leaf" -q
"$python" -c '
import struct, sys
v = [-9999.0 if i % 5 == 0 else i % 7 for i in range(4096)]
open(sys.argv[1], "wb").write(struct.pack("<4096f", *v))' "$tmp/n_16x16x16_f32.raw"
"$leafcast" convert "$tmp/n_16x16x16_f32.raw" -o "$tmp/n.leaf" -q

client "the page" "$python" tests/support/view_page.py "$leafcast" "$tmp"
finish
