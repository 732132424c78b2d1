#!/bin/sh
# scene.sh - leafcast render --and: several volumes in a picture; --ortho: parallel rays.
# marks: threads leaks
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/$2"; }
gone() { for f; do [ ! -e "$f" ] || return 1; done; }
numbers() { od -An -v -tf8 -w8 "$1"; }
# nearest A B BOTH: of each pixel the smaller depth; and each of the two is it somewhere.
nearest() {
    numbers "$1" >"$tmp/1" && numbers "$2" >"$tmp/2" && numbers "$3" >"$tmp/3" || return 1
    paste "$tmp/1" "$tmp/2" "$tmp/3" | awk '
        function depth(text) { return text == "inf" ? 1e300 : text + 0 }
        { a = depth($1); b = depth($2); both = depth($3)
          if (both != (a < b ? a : b)) wrong++
          if (a < b) first++; if (b < a) second++ }
        END { exit wrong > 0 || first < 20 || second < 20 || NR < 4000 }'
}

view="--eye 90,70,60 --look-at 16,16,16 --size 80x60 -q"
run "$leafcast" generate gyroid --dims 33 --type f32 -o "$tmp/grid.nrrd" -q
exits "a grid" 0 "$leafcast" convert "$tmp/grid.nrrd" -o "$tmp/grid.leaf" --treelet 16 -q
run "$leafcast" generate sphere --tets --dims 33 -o "$tmp/tets.mesh" -q
exits "a mesh in the same place" 0 "$leafcast" convert "$tmp/tets.mesh" -o "$tmp/tets.leaf" -q
mesh_iso=0.35
exits "the grid alone" 0 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 $view --depth-f64 "$tmp/grid.f64"
exits "the mesh alone" 0 "$leafcast" render "$tmp/tets.leaf" --iso "$mesh_iso" $view --depth-f64 "$tmp/tets.f64"
exits "both" 0 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --and "$tmp/tets.leaf" --iso "$mesh_iso" $view --depth-f64 "$tmp/both.f64" --stats "$tmp/both.json"
ok "the nearer one is seen" nearest "$tmp/grid.f64" "$tmp/tets.f64" "$tmp/both.f64"
exits "the other way round" 0 "$leafcast" render "$tmp/tets.leaf" --iso "$mesh_iso" --and "$tmp/grid.leaf" --iso 0.2 $view --depth-f64 "$tmp/turned.f64"
ok "is the same" cmp "$tmp/both.f64" "$tmp/turned.f64"
exits "one treelet of each at a time" 0 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --and "$tmp/tets.leaf" --iso "$mesh_iso" $view --treelet-limit 1 --threads 3 --depth-f64 "$tmp/limited.f64"
ok "is the same, too" cmp "$tmp/both.f64" "$tmp/limited.f64"
exits "without isovalues" 0 "$leafcast" render "$tmp/grid.leaf" --and "$tmp/tets.leaf" --color red $view -o "$tmp/both.png"
exits "a volume that is not there" 1 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --and "$tmp/none.leaf" --iso 1 $view -o "$tmp/x.png"
ok "is named" says 'none.leaf' err
exits "layers of the other alone" 0 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --layers 2 --and "$tmp/tets.leaf" --iso "$mesh_iso" --opacity 0.4 $view -o "$tmp/layers.png"
exits "layers of none" 2 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --layers 2 --and "$tmp/tets.leaf" --iso "$mesh_iso" $view -o "$tmp/x.png"
exits "more colours than isovalues" 2 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --and "$tmp/tets.leaf" --iso 1 --color red --color blue $view -o "$tmp/x.png"
exits "the same volume twice is two volumes" 0 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --and "$tmp/grid.leaf" --iso 0.2 $view --depth-f64 "$tmp/twice.f64"
ok "with the same surface" cmp "$tmp/grid.f64" "$tmp/twice.f64"
ok "nothing else was written" gone "$tmp/x.png"

# ---- parallel rays ----
exits "an orthographic picture" 0 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 $view --ortho 60 --depth-f64 "$tmp/ortho.f64"
ok "is another one" sh -c "! cmp -s '$tmp/grid.f64' '$tmp/ortho.f64'"
exits "of the view that fits" 0 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --ortho 60 --size 40x40 -o "$tmp/o.png" --fail-empty -q
for height in 0 -1 nan x; do
    exits "--ortho $height" 2 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --ortho "$height" -o "$tmp/x.png"
done
finish
