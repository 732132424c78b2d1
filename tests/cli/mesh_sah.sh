#!/bin/sh
# mesh_sah.sh - trees by the surface area heuristic: other files, sound, the same pictures.
. tests/support/tap.sh

"$leafcast" generate noise --tets --dims 24 --deform 0.5 -o "$tmp/m.mesh" -q
"$leafcast" generate noise --tets --dims 12 --deform 0.5 --steps 3 -o "$tmp/s_%04d.mesh" -q
convert() { "$leafcast" convert "$@" --force -q; }

exits "by keys" 0 convert "$tmp/m.mesh" -o "$tmp/bih.leaf"
exits "by keys, said" 0 convert "$tmp/m.mesh" -o "$tmp/said.leaf" --build bih
ok "is the same" cmp "$tmp/bih.leaf" "$tmp/said.leaf"
exits "by areas" 0 convert "$tmp/m.mesh" -o "$tmp/sah.leaf" --build sah --threads 1
ok "is another" sh -c "! cmp -s '$tmp/bih.leaf' '$tmp/sah.leaf'"
exits "with more threads" 0 convert "$tmp/m.mesh" -o "$tmp/two.leaf" --build sah --threads 3
ok "the same bytes" cmp "$tmp/sah.leaf" "$tmp/two.leaf"
exits "is sound" 0 "$leafcast" verify "$tmp/sah.leaf"
for iso in 0.4 0.5; do
    for kind in bih sah; do
        exits "a picture at $iso, $kind" 0 "$leafcast" render "$tmp/$kind.leaf" --iso $iso \
            --size 200x150 --depth-f64 "$tmp/$kind.depth" --force
    done
    ok "the same bits" cmp "$tmp/bih.depth" "$tmp/sah.depth"
    ok "and something to be seen" python3 -c "import array, math, sys
z = array.array('d', open('$tmp/sah.depth', 'rb').read())
sys.exit(not 1000 < sum(map(math.isfinite, z)))"
done
exits "one tet a leaf" 0 convert "$tmp/m.mesh" -o "$tmp/one.leaf" --build sah --leaf-tets 1
exits "is sound" 0 "$leafcast" verify "$tmp/one.leaf"
exits "a moving series" 0 convert "$tmp"/s_*.mesh -o "$tmp/series.leaf" --build sah
exits "is sound" 0 "$leafcast" verify "$tmp/series.leaf"
exits "usage" 2 convert "$tmp/m.mesh" -o "$tmp/x.leaf" --build kd
finish
