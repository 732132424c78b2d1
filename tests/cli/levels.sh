#!/bin/sh
# levels.sh - levels of detail beyond the last one, of each pair of flags: the last one's picture, or exit 2.
# marks: long
. tests/support/tap.sh

"$leafcast" generate gyroid --dims 80,40,44 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
"$leafcast" generate gyroid --dims 20,24,28 -o "$tmp/small.nrrd" -q
"$leafcast" convert "$tmp/small.nrrd" -o "$tmp/small.leaf" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/bare.leaf" --levels 1 -q
"$leafcast" generate buckyball --tets --dims 9 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m.mesh" -o "$tmp/m.leaf" -q
"$leafcast" convert "$tmp/m.mesh" --coarse=64 -o "$tmp/coarse.leaf" -q

client "levels" python3 tests/support/level_pairs.py "$leafcast" "$tmp"
finish
