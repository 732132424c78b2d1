#!/bin/sh
# view_scene.sh - leafcast view scene.json: what may be given, and pictures, picks and refusals of scenes.
# marks: long
. tests/support/tap.sh

need_view
says() { grep -qF -- "$1" "$tmp/err"; }
"$leafcast" generate gyroid --dims 33 --type f32 -o "$tmp/grid.nrrd" -q
"$leafcast" convert "$tmp/grid.nrrd" -o "$tmp/grid.leaf" --treelet 16 -q
"$leafcast" generate sphere --tets --dims 17 -o "$tmp/tets.mesh" -q
"$leafcast" convert "$tmp/tets.mesh" -o "$tmp/tets.leaf" -q
"$leafcast" export "$tmp/grid.leaf" --iso 0.2 -o "$tmp/s.ply" -q
"$leafcast" convert "$tmp/s.ply" -o "$tmp/tri.leaf" -q
printf '%s\n' '-1 0 0 1 0' '1 1 0 0 0.1' >"$tmp/curve.txt"

scene() { printf '%s\n' "$1" >"$tmp/x.json"; }
scene '{"objects": [{"file": "grid.leaf", "iso": 0.2}]}'
exits "a scene and a file" 2 "$leafcast" view "$tmp/x.json" "$tmp/grid.leaf"
ok "is refused" says "looked at alone"
exits "--follow-links without a scene" 2 "$leafcast" view "$tmp/grid.leaf" --follow-links
ok "is refused, too" says "--follow-links is of scene files"
printf '%s\n' '{"objects": [{"file": "grid.leaf", "iso": 0.2}]}' >"$tmp/one.json"
scene '{"objects": [{"scene": "one.json", "instances": [{"scale": 1}, {"scale": 2}]}]}'
exits "a scene that is placed many times" 2 "$leafcast" view "$tmp/x.json"
ok "is refused" says "as groups, are of leafcast render"
scene '{"objects": [{"file": "grid.leaf", "iso": 0.2}, {"file": "none.leaf"}]}'
exits "a file that is not there" 1 "$leafcast" view "$tmp/x.json"
ok "is named" says none.leaf
scene '{"objects": [{"file": "grid.leaf", "iso": 0.2}, {"file": "tets.leaf", "isos": 3}]}'
exits "a key that is none" 2 "$leafcast" view "$tmp/x.json"
ok "is named with its place" says 'objects[1]: there is no "isos"'
scene '{"objects": [{"file": "grid.leaf", "iso": 0.2}], "shadows": true}'
exits "what render refuses" 2 "$leafcast" view "$tmp/x.json"
ok "is refused alike" says "--shadows: the light at the eye"
mkdir "$tmp/in"
printf '%s\n' '{"objects": [{"file": "../grid.leaf", "iso": 0.2}]}' >"$tmp/in/out.json"
exits "a file outside of the folder" 3 "$leafcast" view "$tmp/in/out.json"
ok "is refused with the option that allows it" says --follow-links
run timeout -s INT 2 "$leafcast" view "$tmp/in/out.json" --follow-links
ok "which does" grep -q '^http://' "$tmp/out"

client "scenes" python3 tests/support/view_scene.py "$leafcast" "$tmp" "${MESSAGES:-600}"
finish
