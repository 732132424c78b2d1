#!/bin/sh
# view_page_scene.sh - the page of leafcast view in a browser: a scene of several objects.
# marks: plain, long
. tests/support/tap.sh

need_view
need_browser
"$leafcast" generate gyroid --dims 33 --type f32 -o "$tmp/grid.nrrd" -q
"$leafcast" convert "$tmp/grid.nrrd" -o "$tmp/grid.leaf" --treelet 16 -q
"$leafcast" generate sphere --tets --dims 17 -o "$tmp/tets.mesh" -q
"$leafcast" convert "$tmp/tets.mesh" -o "$tmp/tets.leaf" -q
"$leafcast" export "$tmp/grid.leaf" --iso 0.2 -o "$tmp/s.ply" -q
"$leafcast" convert "$tmp/s.ply" -o "$tmp/tri.leaf" -q
cat >"$tmp/scene.json" <<'J'
{"objects": [
    {"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "colour": "red", "opacity": 0.5}, {"isovalue": 0.6, "colour": [0, 1, 0]}]},
    {"file": "tets.leaf", "iso": 0.35, "transform": [{"scale": 0.7}, {"translate": [40, 0, 0]}],
     "instances": [{"translate": [0, 0, 0]}, {"translate": [0, 30, 0]}]},
    {"file": "tri.leaf", "transform": {"translate": [0, 0, 40]}},
    {"file": "grid.leaf", "tf": "auto", "transform": {"translate": [40, 0, 40]}}],
 "light": [[1, 0.4, 2, 1.5]], "shadows": true, "ambient": 0.1, "occlusion": "5,1", "light-samples": 2}
J
printf '%s\n' '-1 0 0 1 0' '1 1 0 0 0.1' >"$tmp/curve.txt"
cat >"$tmp/more.json" <<'J'
{"objects": [
    {"file": "grid.leaf", "tf": "curve.txt"},
    {"file": "tets.leaf", "iso": 0.35, "colour-by": "grid.leaf", "window": [0, 1], "transform": {"translate": [6, 2, 2]}},
    {"file": "tri.leaf", "colour": "rebeccapurple", "transform": {"translate": [0, 0, 40]}},
    {"file": "grid.leaf", "iso": [0.2, 0.6], "reflect": ["0.5,2", 0], "transform": {"translate": [40, 0, 0]}}],
 "camera": {"look_at": [30, 16, 30], "eye": [150, -90, 90]}, "clip_box": [0, 0, 0, 60, 28, 60], "caps": "viridis", "shading": "phong",
 "background": "0.9,0.9,1", "legend": true}
J
cat >"$tmp/glass.json" <<'J'
{"objects": [{"file": "grid.leaf", "iso": [0.2, 0.6], "opacity": [0.5, 1], "refract": ["1.5,3", 1]},
             {"file": "tri.leaf", "colour": "white", "opacity": 0.5, "refract": 1.4, "transform": {"translate": [0, 0, 40]}},
             {"file": "tets.leaf", "iso": 0.35, "transform": {"translate": [40, 0, 0]}}]}
J
"$leafcast" generate buckyball --tets --dims 11 --steps 2 --deform 0.4 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m_0000.mesh" "$tmp/m_0001.mesh" -o "$tmp/m.leaf" -q
cat >"$tmp/steps.json" <<'J'
{"objects": [{"file": "m.leaf", "iso": 0.3}, {"file": "m.leaf", "iso": 0.5, "transform": {"translate": [12, 0, 0]}}, {"file": "grid.leaf", "iso": 0.2}]}
J
client "a scene" "$python" tests/support/view_page_scene.py "$leafcast" "$tmp"
finish
