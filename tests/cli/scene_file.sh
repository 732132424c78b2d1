#!/bin/sh
# scene_file.sh - leafcast render scene.json: objects, places, instances; every key has a row in the manual, and a value
# here that it takes.
# marks: threads leaks
. tests/support/tap.sh

says() { grep -qF -- "$1" "$tmp/$2"; }
page=scripts/man/leafcast-scene.5

run "$leafcast" generate gyroid --dims 33 --type f32 -o "$tmp/grid.nrrd" -q
exits "a grid" 0 "$leafcast" convert "$tmp/grid.nrrd" -o "$tmp/grid.leaf" --treelet 16 -q
run "$leafcast" generate sphere --tets --dims 33 -o "$tmp/tets.mesh" -q
exits "a mesh" 0 "$leafcast" convert "$tmp/tets.mesh" -o "$tmp/tets.leaf" -q

# scene NAME JSON: $tmp/NAME.json. draw NAME OPTION...: its picture, depths in $tmp/NAME.f64.
scene() { printf '%s\n' "$2" >"$tmp/$1.json"; }
draw() {
    name=$1
    shift
    exits "$name" 0 "$leafcast" render "$tmp/$name.json" -q -o "$tmp/$name.ppm" --depth-f64 "$tmp/$name.f64" --force "$@"
}
same() { ok "$1 is $2" cmp "$tmp/$1.ppm" "$tmp/$2.ppm" && ok "to the bit" cmp "$tmp/$1.f64" "$tmp/$2.f64"; }
view='"eye": [150, 110, 90], "look-at": [30, 20, 16], "size": [80, 60]'
lit='"light": [[1, 0.4, 2]], "shadows": true, "ambient": 0.1'

# ---- the same structs as --and ----
scene both '{"objects": [
    {"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "colour": "red", "opacity": 0.5}, {"isovalue": 0.6, "colour": [0, 1, 0]}]},
    {"file": "tets.leaf", "iso": 0.35, "colour": "blue"}], '"$view, $lit}"
draw both
exits "--and" 0 "$leafcast" render "$tmp/grid.leaf" --iso 0.2,0.6 --colour red --colour 0,1,0 --opacity 0.5 --opacity 1 \
    --and "$tmp/tets.leaf" --iso 0.35 --colour blue --eye 150,110,90 --look-at 30,20,16 --size 80x60 \
    --light 1,0.4,2 --shadows --ambient 0.1 -q -o "$tmp/and.ppm" --depth-f64 "$tmp/and.f64"
same both and
draw both --treelet-limit 1 --threads 3
same both and
ok "something is seen" sh -c "[ \$(od -An -v -tf8 -w8 '$tmp/and.f64' | grep -c inf) -lt 4700 ]"

# ---- the command line replaces ----
exits "another eye and size" 0 "$leafcast" render "$tmp/both.json" --eye 100,130,60 --size 40x30 --light 0,0,1 -q -o "$tmp/flags.ppm"
scene asked '{"objects": [
    {"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "colour": "red", "opacity": 0.5}, {"isovalue": 0.6, "colour": [0, 1, 0]}]},
    {"file": "tets.leaf", "iso": 0.35, "colour": "blue"}],
    "camera": {"eye": [100, 130, 60], "look-at": [30, 20, 16]}, "size": [40, 30], "light": [0, 0, 1], "shadows": true, "ambient": 0.1}'
exits "said in the file" 0 "$leafcast" render "$tmp/asked.json" -q -o "$tmp/asked.ppm"
ok "is the same" cmp "$tmp/flags.ppm" "$tmp/asked.ppm"
scene one '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "colour": "red", "opacity": 0.5}, {"isovalue": 0.6, "colour": [0, 1, 0]}]}], '"$view, $lit}"
draw one --and "$tmp/tets.leaf" --iso 0.35 --colour blue
same one and
# ---- glass ----
# glass NAME FIRST SECOND: the grid and the mesh, with these keys besides.
glass() {
    scene "$1" '{"objects": [{"file": "grid.leaf", "colour": ["red", "white"], '"$2"'}, {"file": "tets.leaf", "colour": "blue", '"$3"'}], '"$view}"
    draw "$1"
}
differ() { ok "$1 is another than $2" sh -c "! cmp -s '$tmp/$1.ppm' '$tmp/$2.ppm'"; }
clear='"iso": [0.2, 0.6], "opacity": [0.3, 0.5]'
tets='"iso": 0.35, "opacity": 0.3'
glass four "$clear, \"refract\": [1.5, 1.2]" "$tets, \"refract\": 1.4"
glass four-each "$clear, \"refract\": [\"1.5,4\", [1.2, 4]]" "$tets, \"refract\": \"1.4,4\""
same four-each four
glass one-said "$clear, \"refract\": [1.5, 1.2]" "$tets, \"refract\": \"1.4,1\""
glass one-first "$clear, \"refract\": [\"1.5,1\", 1.2]" "$tets, \"refract\": 1.4"
glass one-each "$clear, \"refract\": [\"1.5,1\", \"1.2,1\"]" "$tets, \"refract\": \"1.4,1\""
same one-said one-each
same one-first one-each
differ one-each four
glass beside-mirror "$clear, \"refract\": [1.5, 1.2]" "$tets, \"reflect\": \"0.3,1\""
glass four-beside "$clear, \"refract\": [\"1.5,4\", 1.2]" "$tets, \"reflect\": \"0.3,1\""
same beside-mirror four-beside
scene surfaces '{"objects": [{"file": "grid.leaf", "surfaces": [
    {"isovalue": 0.2, "colour": "red", "opacity": 0.3, "refraction": 1.5}, {"isovalue": 0.6, "colour": "white", "opacity": 0.5, "refraction": 1.2}]},
    {"file": "tets.leaf", "surfaces": [{"isovalue": 0.35, "colour": "blue", "opacity": 0.3, "refraction": 1.4, "bounces": 1}]}], '"$view}"
draw surfaces
same surfaces one-each
"$leafcast" export "$tmp/grid.leaf" --iso 0.2 -o "$tmp/s.ply" -q
"$leafcast" convert "$tmp/s.ply" -o "$tmp/tri.leaf" -q
exits "glass that values colour" 0 "$leafcast" render "$tmp/tri.leaf" --opacity 0.5 --refract 1.5 --tf auto --size 80x60 -q -o "$tmp/bent.ppm"
exits "and straight" 0 "$leafcast" render "$tmp/tri.leaf" --opacity 0.5 --tf auto --size 80x60 -q -o "$tmp/straight.ppm"
differ bent straight
glass of-values "$clear, \"refract\": [1.5, 1.2]" "$tets"'}, {"file": "tri.leaf", "tf": "auto", "opacity": 0.5, "refract": 1.4'
glass of-no-values "$clear, \"refract\": [1.5, 1.2]" "$tets"'}, {"file": "tri.leaf", "tf": "auto", "opacity": 0.5'
differ of-values of-no-values
scene mirrors '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "colour": "red", "reflectivity": 0.6, "bounces": 3}]}], '"$view}"
scene reflect '{"objects": [{"file": "grid.leaf", "iso": 0.2, "colour": "red", "reflect": "0.6,3"}], '"$view}"
scene shallow '{"objects": [{"file": "grid.leaf", "iso": 0.2, "colour": "red", "reflect": 0.6}], '"$view}"
draw mirrors
draw reflect
draw shallow
same mirrors reflect
differ mirrors shallow

exits "--iso beside a scene" 2 "$leafcast" render "$tmp/both.json" --iso 1 -o "$tmp/x.ppm"
ok "is refused" says "a scene file says what is shown" err
exits "--follow-links without one" 2 "$leafcast" render "$tmp/grid.leaf" --iso 0.2 --follow-links -o "$tmp/x.ppm"

# ---- places ----
# place NAME TRANSFORM: the grid and the mesh, the mesh there.
place() { scene "$1" '{"objects": [{"file": "grid.leaf", "iso": 0.2, "colour": "red"}, {"file": "tets.leaf", "iso": 0.35, "colour": "blue", '"$2"'}], '"$view, $lit}"; draw "$1"; }
place plain '"field": 0'
place unit '"transform": [1,0,0,0, 0,1,0,0, 0,0,1,0]'
same unit plain
place turn '"transform": [{"translate": [1, 2, 3]}, {"rotate": [0, 0, 2], "degrees": 90}, {"scale": 0.5}, {"translate": [60, 0, 0]}]'
place matrix '"transform": [0,-0.5,0,59, 0.5,0,0,0.5, 0,0,0.5,1.5]'
same turn matrix
ok "which is elsewhere" sh -c "! cmp -s '$tmp/turn.f64' '$tmp/plain.f64'"
place back '"transform": [{"matrix": [1,0,0,1, 0,1,0,2, 0,0,1,3]}, {"rotate": [0, 0, -1], "degrees": 270}, {"scale": [0.5, 0.5, 0.5]}], "instances": [{"translate": [60, 0, 0]}]'
same back matrix

# Instances are objects of the same file; behind a transform of all of them.
scene instances '{"objects": [{"file": "tets.leaf", "iso": 0.35, "colour": "blue", "transform": {"scale": 0.5},
    "instances": [{"translate": [0, 0, 0]}, {"translate": [20, 0, 0]}, [{"rotate": [1, 1, 0], "degrees": 40}, {"translate": [40, 0, 5]}], {"translate": [60, 30, 0]}, {"translate": [0, 30, 0]}]}], '"$view, $lit}"
draw instances
scene objects '{"objects": ['"$(for t in '{"translate": [0, 0, 0]}' '{"translate": [20, 0, 0]}' '{"rotate": [1, 1, 0], "degrees": 40}, {"translate": [40, 0, 5]}' '{"translate": [60, 30, 0]}' '{"translate": [0, 30, 0]}'; do
    printf '%s{"file": "tets.leaf", "iso": 0.35, "colour": "blue", "transform": [{"scale": 0.5}, %s]}' "${comma:-}" "$t"
    comma=,
done)], $view, $lit}"
draw objects
same instances objects
exits "their counts" 0 "$leafcast" render "$tmp/instances.json" --json -q -o "$tmp/instances.ppm" --force
# The file is read once: 1 volume's treelets; a ray asks few of 5.
ok "are of one file" python3 - "$tmp/out" <<'P'
import json, sys
s = json.load(open(sys.argv[1]))
assert s["objects"] < 3 * s["primary_rays"], s["objects"]
P
scene fit '{"objects": [{"file": "tets.leaf", "iso": 0.35, "transform": {"translate": [1000, 0, 0]}}], "size": [40, 30]}'
exits "the view that fits is where the objects are" 0 "$leafcast" render "$tmp/fit.json" --fail-empty -q -o "$tmp/fit.ppm"

# ---- media ----
scene medium '{"objects": [{"file": "grid.leaf", "tf": "curve.txt", "transform": {"scale": 2}}, {"file": "tets.leaf", "opacity": "0:0,0.5:0.3"}], '"$view}"
printf '%s\n' '-1 0 0 1 0' '1 1 0 0 0.1' >"$tmp/curve.txt"
exits "a medium in a volume that is scaled" 0 "$leafcast" render "$tmp/medium.json" -q -o "$tmp/medium.ppm"
rm "$tmp/medium.ppm"

# ---- files elsewhere ----
mkdir "$tmp/in"
printf '%s\n' '{"objects": [{"file": "../grid.leaf", "iso": 0.2}], "size": [20, 20]}' >"$tmp/in/out.json"
exits "a file outside of the folder" 3 "$leafcast" render "$tmp/in/out.json" -q -o "$tmp/x.ppm"
ok "is refused" says "--follow-links" err
exits "but where it is allowed" 0 "$leafcast" render "$tmp/in/out.json" --follow-links -q -o "$tmp/x.ppm"
rm "$tmp/x.ppm"
exits "onto an input" 2 "$leafcast" render "$tmp/both.json" -q -o "$tmp/both.json" --force
ok "the scene is whole" says '"objects"' both.json

# ---- what is wrong, and where ----
wrong() {
    scene wrong "$1"
    exits "wrong: $2" "${3:-2}" "$leafcast" render "$tmp/wrong.json" -q -o "$tmp/x.ppm"
    ok "and so it is said" says "$2" err
}
wrong '{"objects": [{"file": "grid.leaf"' 'wrong.json: line 2' 3
wrong '{"size": [8, 8]}' 'neither a treelet file nor a scene: a scene has "objects"' 3
wrong '{"objects": []}' 'objects: an array of 1 to 4096'
wrong '{"objects": [{"iso": 1}]}' 'objects[0]: an object has a "file"'
wrong '{"objects": [{"file": "grid.leaf"}, {"file": "tets.leaf", "colr": "red"}]}' 'objects[1]: there is no "colr"'
wrong '{"objects": [{"file": "grid.leaf", "eye": [1,2,3]}]}' 'objects[0]: there is no "eye"'
wrong '{"objects": [{"file": "grid.leaf"}], "shadow": true}' 'the picture: there is no "shadow"'
wrong '{"objects": [{"file": "grid.leaf"}], "iso": 0.2}' '"iso" is of one of the objects'
wrong '{"objects": [{"file": "grid.leaf"}], "camera": {"eyes": [1,2,3]}}' 'camera: there is no "eyes"'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2}, {"isovalue": "x"}]}]}' 'objects[0].surfaces[1]: a surface is'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "opacity": 1.5}]}]}' '"opacity" takes a number, 1e-37 to 1'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "opacity": 1e-60}]}]}' 'objects[0].surfaces[0]: "opacity" takes a number, 1e-37 to 1'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "opacity": 1.00000000001}]}]}' '"opacity" takes a number, 1e-37 to 1'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "reflectivity": -1e-60}]}]}' '"reflectivity" takes a number, 0 to 1'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "refraction": 4.00000001}]}]}' '"refraction" takes a number, 0.25 to 4'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "refraction": 1.5, "bounces": 9}]}]}' '"bounces" takes a whole number, 1 to 8'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "refraction": 1.5, "bounces": 1.5}]}]}' '"bounces" takes a whole number, 1 to 8'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "bounces": 2}]}]}' 'objects[0].surfaces[0]: "bounces" is of "reflectivity" and "refraction"'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "colour": "blurple"}]}]}' 'blurple'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "shine": 1}]}]}' 'objects[0].surfaces[0]: there is no "shine"'
wrong '{"objects": [{"file": "grid.leaf", "surfaces": []}]}' 'objects[0].surfaces: an array of 1 to 32 surfaces'
for beside in '"iso": 0.2|iso|isovalue' '"color": "red"|colour|colour' '"opacity": [0.5]|opacity|opacity' \
    '"reflect": "0.5,2"|reflect|reflectivity' '"refract": 1.5|refract|refraction'; do
    pair=${beside%%|*} flag=${beside#*|} key=${beside##*|}
    wrong '{"objects": [{"file": "tets.leaf", "iso": 0.3}, {"file": "grid.leaf", '"$pair"', "surfaces": [{"isovalue": 0.2}]}]}' \
        'wrong.json: objects[1]: "'"${flag%%|*}"'" beside "surfaces": it is "'"$key"'" of each of these'
done
wrong '{"objects": [{"file": "grid.leaf", "iso": 0.2, "opacity": 0.5, "refract": [1.5, 2]}]}' '2 of --refract for 1 of --iso: the k-th belongs to the k-th; bounces are in its text: "INDEX,BOUNCES"'
wrong '{"objects": [{"file": "grid.leaf", "iso": 0.2, "reflect": [0.5, 1]}]}' '2 of --reflect for 1 of --iso: the k-th belongs to the k-th; bounces are in its text: "WEIGHT,BOUNCES"'
wrong '{"objects": [{"file": "grid.leaf", "iso": 0.2, "refract": 1.5}, {"file": "tets.leaf", "iso": 0.35, "opacity": 0.5}]}' '--refract: nothing is seen through'
wrong '{"objects": [{"file": "grid.leaf", "transform": [1,2,3]}]}' 'objects[0].transform: a transform is 12 numbers'
wrong '{"objects": [{"file": "grid.leaf", "transform": {"scale": 0}}]}' 'objects[0].transform: leafcast_shown.place'
wrong '{"objects": [{"file": "grid.leaf", "transform": {"scale": [1, 1, 1e-9]}}]}' 'it flattens space'
wrong '{"objects": [{"file": "grid.leaf", "transform": [{"rotate": [0,0,0], "degrees": 1}]}]}' '"rotate" takes an axis'
wrong '{"objects": [{"file": "grid.leaf", "transform": [{"rotate": [0,0,1]}]}]}' '"degrees" beside it'
wrong '{"objects": [{"file": "grid.leaf", "transform": [{"degrees": 3}]}]}' 'a step is one of'
wrong '{"objects": [{"file": "grid.leaf", "transform": [{"scale": 1, "degrees": 3}]}]}' '"degrees" is of "rotate"'
wrong '{"objects": [{"file": "grid.leaf", "transform": [{"scale": 1, "translate": [1,2,3]}]}]}' 'are two steps'
wrong '{"objects": [{"file": "grid.leaf", "transform": [{"turn": 1}]}]}' 'there is no "turn"'
wrong '{"objects": [{"file": "grid.leaf", "instances": []}]}' 'objects[0].instances: an array of 1 to 16777216'
wrong '{"objects": [{"file": "grid.leaf", "instances": [{"scale": 1}, {"scale": "x"}]}]}' 'objects[0].instances[1]: "scale" takes'
wrong '{"objects": [{"file": "none.leaf"}]}' 'none.leaf' 1
ok "nothing was written" [ ! -e "$tmp/x.ppm" ]

# ---- every key ----
# Keys that the program knows, by what it says of one that it does not: PLACE KEY. Each needs a row of the manual, in an
# .It line, and a value below.
cat >"$tmp/keys.py" <<'P'
import json, re, subprocess, sys
leafcast, folder, page = sys.argv[1:]
grid = {"file": "grid.leaf", "iso": 0.2}
tile = {"scene": "one.json", "edges": ["a", "b", "a", "b"]}
tiles = {"tiles": [tile], "counts": [2, 2], "size": [40, 40]}
def render(scene):
    with open(folder + "/key.json", "w") as f:
        json.dump(scene, f)
    r = subprocess.run([leafcast, "render", folder + "/key.json", "-q", "-o", folder + "/key.ppm", "--force"],
                       capture_output=True, text=True)
    return r.returncode, r.stderr
said = set(re.findall(r"[a-z][a-z-]*", " ".join(l for l in open(page) if l.startswith(".It Cm"))))
options = re.findall(r"--([a-z][a-z0-9-]+)", subprocess.run([leafcast, "render", "--help-all"],
                     capture_output=True, text=True).stdout)
def own(scene):
    return re.search(r"\(keys: ([a-z ]*)", render(scene)[1]).group(1).split()
places = {
    "object": lambda k, v: {"objects": [dict(grid, **{k: v})], "size": [8, 8]},
    "picture": lambda k, v: {"objects": [grid], "size": [8, 8], k: v},
    "surface": lambda k, v: {"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, k: v}]}], "size": [8, 8]},
    "step": lambda k, v: {"objects": [dict(grid, transform={k: v})], "size": [8, 8]},
    "scene": lambda k, v: {"objects": [dict({"scene": "one.json"}, **{k: v})], "size": [8, 8]},
    "tiles": lambda k, v: {"objects": [dict(tiles, **{k: v})], "size": [8, 8]},
    "tile": lambda k, v: {"objects": [dict(tiles, tiles=[dict(tile, **{k: v})])], "size": [8, 8]},
}
known = {p: set(own(make("no-such-key", 1))) for p, make in places.items()}
for p in "object", "picture":
    for o in set(options):
        err = render(places[p](o, True))[1]
        if "there is no" not in err and "is of one of the objects" not in err:
            known[p].add(o)
# A scene that each key takes; None: it needs other keys, or another file, and is drawn elsewhere in this test or said
# why not.
full = {
    "object": {"file": "grid.leaf", "iso": [0.2, 0.4], "colour": ["red"], "opacity": [0.5], "colour-by": "tets.leaf",
               "tf": "auto", "colour-map": "viridis", "window": [0, 1], "opacity-length": 3.0,
               "field": "0", "reflect": "0.5,2", "refract": None, "step": 0, "time": 0, "interpolate": None, "transform": {"scale": 2},
               "instances": [{"scale": 1}], "surfaces": None},
    "picture": {"objects": [grid], "camera": {"eye": [1, 2, 300]}, "view": "close", "eye": [1, 2, 300],
                "look-at": [1, 2, 3], "up": [0, 1, 0], "fov": 30, "ortho": 60, "size": [9, 9], "samples": 4,
                "shading": "flat", "normals": "analytic", "light": [[1, 0, 0], [0, 1, 0]], "point-light": [1, 2, 300], "light-samples": None, "occlusion": 5,
                "shadows": None, "ambient": 0.2, "specular": None, "shininess": None, "background": "black",
                "clip-box": [1, 1, 1, 20, 20, 20], "clip-plane": [1, 0, 0, -5], "caps": None, "layers": None,
                "lod": 1, "preview": True, "sweep": True, "intersector": "linear", "project": None, "error": None,
                "homogeneous": None, "medium": None, "shade-medium": None, "legend": None, "annotate": None,
                "title": "x", "unit": None},
    "surface": {"isovalue": 0.3, "colour": "red", "color": "red", "opacity": 0.5, "reflectivity": 0.3, "refraction": 1.5,
                "bounces": None},
    "scene": {"scene": "one.json", "transform": {"scale": 2}, "instances": [{"scale": 1}, {"scale": 2}]},
    "tiles": {"tiles": [tile], "counts": [3, 1], "size": [9, 9], "origin": [1, 2, 3], "seed": 5, "ground": None,
              "between": [-1, 1]},
    "tile": tile,
    "step": {"translate": [1, 2, 3], "rotate": None, "degrees": None, "scale": 2, "matrix": [1,0,0,0,0,1,0,0,0,0,1,0]},
}
pairs = [  # those that need each other
    {"objects": [grid], "light": [1, 0, 0], "shadows": True, "shading": "phong", "specular": 0.4, "shininess": 20},
    {"objects": [grid], "light": [1, 0, 0, 5], "light-samples": 4, "shadows": True},
    {"objects": [grid], "clip-plane": [1, 0, 0, -5], "caps": True},
    {"objects": [{"file": "grid.leaf", "iso": 0.2, "opacity": 0.5}], "layers": 1},
    {"objects": [{"file": "grid.leaf", "iso": [0.2, 0.4], "opacity": 0.5, "refract": ["1.5,3", 1]}]},
    {"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.3, "reflectivity": 0.5, "bounces": 3}]}]},
    {"objects": [{"file": "grid.leaf"}], "project": "max", "legend": True},
    {"objects": [{"file": "grid.leaf", "tf": "auto"}], "error": 0.01, "homogeneous": 0.01},
    {"objects": [{"file": "grid.leaf", "tf": "auto"}], "medium": "steps=0.5"},
    {"objects": [{"file": "grid.leaf", "tf": "auto"}], "shade-medium": True},
    {"objects": [{"file": "grid.leaf", "time": 0, "interpolate": True, "iso": 0.2}]},
    {"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.3}],
                  "transform": {"rotate": [0, 0, 1], "degrees": 20}}]},
]
bad = []
for p in known:
    for k in sorted(known[p]):
        if k not in full[p]:
            bad.append("%s: \"%s\" has no value in tests/cli/scene_file.sh" % (p, k))
        if k not in said:
            bad.append("%s: \"%s\" has no row in %s" % (p, k, page))
    for k, v in full[p].items():
        if k not in known[p]:
            bad.append("%s: \"%s\" is no key" % (p, k))
        elif v is not None and k not in ("tf", "colour-map", "window", "opacity-length"):
            code, err = render(places[p](k, v))
            if code:
                bad.append("%s: \"%s\": %s" % (p, k, err))
drawn = set()
for scene in pairs:
    scene["size"] = [12, 12]
    code, err = render(scene)
    drawn |= set(re.findall(r'"([a-z-]+)":', json.dumps(scene)))
    if code:
        bad.append(json.dumps(scene) + ": " + err)
code, err = render({"objects": [{"file": "grid.leaf", "opacity": "0.2:0.1,0.5:0.3", "opacity-length": 3.0},
                                {"file": "grid.leaf", "colour-map": "viridis", "window": [0, 1]},
                                {"file": "grid.leaf", "tf": "auto"}], "size": [8, 8]})
drawn |= {"annotate", "unit"}  # they need a font
drawn |= {"ground"}  # tests/cli/scene_groups.sh
bad += [err] if code else []
for p in full:
    bad += ["%s: \"%s\" is not drawn" % (p, k) for k, v in full[p].items() if v is None and k not in drawn]
print("\n".join(bad), file=sys.stderr)
sys.exit(bool(bad))
P
run python3 "$tmp/keys.py" "$leafcast" "$tmp" "$page"
ok "every key is in the manual, and is taken" [ "$rc" = 0 ]
finish
