#!/bin/sh
# view_trial.sh - leafcast view under hostile requests, beside pages that must not notice, and under pages that change
# everything at random. A few of each; at length, with files of one's own:
#   python3 tests/support/view_hostile.py build/leafcast FOLDER 100000    (FOLDER with g.leaf, m.leaf as below)
#   python3 tests/support/view_wander.py build/leafcast FOLDER 3600s F.leaf ...
# marks: threads, long
. tests/support/tap.sh

need_view
"$leafcast" generate gyroid --dims 48,40,44 -o "$tmp/g.nrrd" -q
mkdir "$tmp/hostile" "$tmp/wander"
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/hostile/g.leaf" -q
"$leafcast" generate buckyball --tets --dims 11 --steps 2 --deform 0.4 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m_0000.mesh" "$tmp/m_0001.mesh" --coarse -o "$tmp/hostile/m.leaf" -q
"$leafcast" generate drop --curvilinear warp --dims 11 --steps 2 -o "$tmp/c.vts" -q
"$leafcast" convert "$tmp/c_0000.vts" "$tmp/c_0001.vts" -o "$tmp/hostile/c.leaf" -q
"$leafcast" export "$tmp/hostile/c.leaf" -o "$tmp/x.vtu" -q
"$leafcast" convert "$tmp/x.vtu" --whole-cells -o "$tmp/hostile/x.leaf" -q

client "hostile" python3 tests/support/view_hostile.py "$leafcast" "$tmp/hostile" 600
client "at random" python3 tests/support/view_wander.py "$leafcast" "$tmp/wander" 500 \
    "$tmp/hostile/g.leaf" "$tmp/hostile/m.leaf" "$tmp/hostile/c.leaf" "$tmp/hostile/x.leaf"
finish
