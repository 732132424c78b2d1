#!/bin/sh
# colour_by.sh - --colour-by: fields of the same file and of others, of grids, meshes, curvilinear grids and triangles;
# steps, scenes, probes; what is refused.
# marks: threads leaks
. tests/support/tap.sh
command -v python3 >/dev/null || { skip "--colour-by" "no python3 here"; finish; }

says() { grep -qF -- "$1" "$tmp/err"; }
# draw NAME INPUT OPTION...: $tmp/NAME.ppm.
draw() {
    name=$1
    shift
    exits "$name" 0 "$leafcast" render "$@" --size 60x50 -q -o "$tmp/$name.ppm" --force
}
same() { ok "$1 is $2" cmp "$tmp/$1.ppm" "$tmp/$2.ppm"; }
differ() { ok "$1 is not $2" [ "$(cmp "$tmp/$1.ppm" "$tmp/$2.ppm" 2>&1)" ]; }

# Steps 0 and 1 of a grid, of a mesh of it, and of a bent grid, each with fields speed and heat.
cat >"$tmp/make.py" <<'PY'
import math, sys
folder, n = sys.argv[1], 18
def speed(x, y, z, s): return math.sqrt((x - 8.3) ** 2 + (y - 8.1) ** 2 + (z - 8.7 - s) ** 2)
def heat(x, y, z, s): return x + 0.5 * math.sin(y + s) - 0.25 * z * (1 + s)
nodes = [(x, y, z) for z in range(n) for y in range(n) for x in range(n)]
def head(f, kind): print("# vtk DataFile Version 3.0\ntest\nASCII\nDATASET", kind, file=f)
def data(f, s, names):
    print("POINT_DATA", len(nodes), file=f)
    for name in names:
        print("SCALARS", name, "float 1\nLOOKUP_TABLE default", file=f)
        for p in nodes: print("%.9g" % globals()[name](*p, s), file=f)
def bent(x, y, z): return x + 0.1 * math.sin(y), y + 0.05 * math.sin(z), z
for s in (0, 1):
    for names, stem in ((("speed", "heat"), "both"), (("heat",), "heat")):
        with open("%s/%s_%d.vtk" % (folder, stem, s), "w") as f:
            head(f, "STRUCTURED_POINTS")
            print("DIMENSIONS", n, n, n, "\nORIGIN 0 0 0\nSPACING 1 1 1", file=f)
            data(f, s, names)
    with open("%s/bent_%d.vtk" % (folder, s), "w") as f:
        head(f, "STRUCTURED_GRID")
        print("DIMENSIONS", n, n, n, "\nPOINTS", len(nodes), "float", file=f)
        for p in nodes: print("%.9g %.9g %.9g" % bent(*p), file=f)
        data(f, s, ("speed", "heat"))
    with open("%s/tets_%d.vtk" % (folder, s), "w") as f:
        head(f, "UNSTRUCTURED_GRID")
        print("POINTS", len(nodes), "float", file=f)
        for p in nodes: print("%g %g %g" % p, file=f)
        cells = []
        for z in range(n - 1):
            for y in range(n - 1):
                for x in range(n - 1):
                    c = [x + i % 2 + n * (y + i // 2 % 2 + n * (z + i // 4)) for i in range(8)]
                    cells += [[c[i] for i in t] for t in ((0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7))]
        print("CELLS", len(cells), 5 * len(cells), file=f)
        for t in cells: print(4, *t, file=f)
        print("CELL_TYPES", len(cells), file=f)
        print("10\n" * len(cells), end="", file=f)
        data(f, s, ("speed", "heat"))
with open(folder + "/fields.vtk", "w") as f:
    head(f, "STRUCTURED_POINTS")
    print("DIMENSIONS 6 5 1\nORIGIN 0 0 0\nSPACING 3 3 1\nPOINT_DATA 30", file=f)
    for name, value in (("height", lambda i, j: 8 + (i - j) % 3), ("rain", lambda i, j: i * j)):
        print("SCALARS", name, "float 1\nLOOKUP_TABLE default", file=f)
        for n in range(30): print(value(n % 6, n // 6), file=f)
with open(folder + "/sheet.ply", "w") as f:
    print("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z", file=f)
    print("property float load\nproperty float age\nelement face 2\nproperty list uchar int vertex_indices\nend_header", file=f)
    for x, y in ((0, 0), (17, 0), (0, 17), (17, 17)): print(x, y, 9, x - y, x * y, file=f)
    print("3 0 1 2\n3 1 3 2", file=f)
PY
python3 "$tmp/make.py" "$tmp"
for kind in both bent tets; do
    exits "$kind" 0 "$leafcast" convert "$tmp/${kind}_0.vtk" "$tmp/${kind}_1.vtk" --fields all -q -o "$tmp/$kind.leaf"
done
exits "heat" 0 "$leafcast" convert "$tmp/heat_0.vtk" "$tmp/heat_1.vtk" -q -o "$tmp/heat.leaf"
exits "heat at once" 0 "$leafcast" convert "$tmp/heat_1.vtk" -q -o "$tmp/heat_1.leaf"
exits "a step of both" 0 "$leafcast" convert "$tmp/both_1.vtk" --fields all -q -o "$tmp/both_1.leaf"
exits "gradients" 0 "$leafcast" convert "$tmp/tets_0.vtk" --gradients -q -o "$tmp/smooth.leaf"
printf 'ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 8\n7 8 9\n8 9 10\n9 8 7\n' >"$tmp/hill.asc"
exits "terrain" 0 "$leafcast" convert "$tmp/hill.asc" -q -o "$tmp/hill.leaf"
printf 'ncols 5\nnrows 4\nxllcorner 1\nyllcorner 2\ncellsize 3.5\n1 2 3 4 5\n9 8 7 -9999 1\n1 2 9 4 6\n4 3 2 1 0\n' >"$tmp/rain.asc"
exits "terrain with two fields" 0 "$leafcast" convert "$tmp/fields.vtk" --heights --fields all -q -o "$tmp/fields.leaf"
exits "a raster to drape" 0 "$leafcast" convert "$tmp/rain.asc" -q -o "$tmp/rain.leaf"
exits "triangles" 0 "$leafcast" convert "$tmp/sheet.ply" --fields all -q -o "$tmp/sheet.leaf"

# ---- a field of the same file, or the same of another ----

view='--eye 50,40,34 --look-at 8,8,8'
# shellcheck disable=SC2086 # split on purpose
{
    draw plain "$tmp/both.leaf" --iso 6 $view
    draw own "$tmp/both.leaf" --iso 6 --colour-by heat $view
    differ own plain
    draw american "$tmp/both.leaf" --iso 6 --color-by heat --color-map viridis $view
    same american own
    draw number "$tmp/both.leaf" --iso 6 --colour-by 1 $view
    same number own
    draw other "$tmp/both.leaf" --iso 6 --colour-by "$tmp/heat.leaf" $view
    same other own
    draw named "$tmp/both.leaf" --iso 6 --colour-by "$tmp/both.leaf:heat" $view
    same named own
    draw little "$tmp/both.leaf" --iso 6 --colour-by heat $view --treelet-limit 1 --threads 3
    same little own
    draw window "$tmp/both.leaf" --iso 6 --colour-by heat --window 3,9 --colour-map cool-warm $view
    differ window own
    draw outside "$tmp/both.leaf" --iso 6 --colour-by "$tmp/heat.leaf" --clip-box 2,0,0,17,17,17 --colour red $view
    draw lit "$tmp/both.leaf" --iso 6 --colour-by heat --light 1,0,1 --shadows --opacity 0.5 --occlusion 5,4 $view
    draw lit_little "$tmp/both.leaf" --iso 6 --colour-by heat --light 1,0,1 --shadows --opacity 0.5 --occlusion 5,4 $view --treelet-limit 1 --threads 2
    same lit_little lit
    for kind in bent tets; do
        draw "$kind" "$tmp/$kind.leaf" --iso 6 --colour-by heat $view
        draw "${kind}_plain" "$tmp/$kind.leaf" --iso 6 $view
        differ "$kind" "${kind}_plain"
        draw "${kind}_by_grid" "$tmp/$kind.leaf" --iso 6 --colour-by "$tmp/heat.leaf" $view
    done
    draw faceted "$tmp/tets.leaf" --iso 6 --colour-by "$tmp/heat.leaf" --normals faceted $view
    same faceted tets_by_grid
    draw smooth "$tmp/smooth.leaf" --iso 6 --colour-by "$tmp/heat.leaf" --normals smooth $view
    differ smooth faceted
    draw sheet "$tmp/sheet.leaf" --field load --colour-by age $view
    draw sheet_age "$tmp/sheet.leaf" --field age --colour-map viridis $view
    same sheet sheet_age
    draw sheet_heat "$tmp/sheet.leaf" --colour-by "$tmp/heat.leaf" $view
    differ sheet_heat sheet
    draw hill "$tmp/hill.leaf" $view
    draw hill_heat "$tmp/hill.leaf" --colour-by "$tmp/heat.leaf" $view
    differ hill_heat hill
    draw draped "$tmp/hill.leaf" --colour-by "$tmp/rain.leaf" $view
    differ draped hill
    draw draped_little "$tmp/hill.leaf" --colour-by "$tmp/rain.leaf" $view --treelet-limit 1 --threads 3
    same draped_little draped
    draw own_field "$tmp/fields.leaf" --colour-by rain $view
    draw own_shape "$tmp/fields.leaf" $view
    draw other_field "$tmp/fields.leaf" --colour-by "$tmp/fields.leaf:rain" $view
    differ own_field own_shape
    same other_field own_field
    draw over_grid "$tmp/both.leaf" --iso 6 --colour-by "$tmp/rain.leaf" $view
    differ over_grid own

    # ---- steps ----
    draw later "$tmp/both.leaf" --step 1 --iso 6 --colour-by heat $view
    draw alone "$tmp/both_1.leaf" --iso 6 --colour-by heat $view
    same later alone
    differ later own
    draw later_other "$tmp/both.leaf" --step 1 --iso 6 --colour-by "$tmp/heat.leaf" $view
    same later_other later
    draw still "$tmp/both.leaf" --step 1 --iso 6 --colour-by "$tmp/heat_1.leaf" $view
    same still later
    draw between "$tmp/both.leaf" --time 0.5 --interpolate --iso 6 --colour-by heat $view
    differ between later
    draw between_other "$tmp/both.leaf" --time 0.5 --interpolate --iso 6 --colour-by "$tmp/heat.leaf" $view
    same between between_other
    exits "two steps" 0 "$leafcast" render "$tmp/both.leaf" --steps 0:1 --iso 6 --colour-by heat --window -5,17 $view --size 60x50 -q -o "$tmp/s.ppm"
    draw second "$tmp/both.leaf" --step 1 --iso 6 --colour-by heat --window -5,17 $view
    ok "the second is that step" cmp "$tmp/s_0001.ppm" "$tmp/second.ppm"

    # ---- several volumes, and scenes ----
    draw first "$tmp/both.leaf" --iso 6 --and "$tmp/tets.leaf" --iso 3 --colour-by heat $view --opacity 0.5
    draw second_alone "$tmp/both.leaf" --iso 6 --and "$tmp/tets.leaf" --iso 3 $view --opacity 0.5
    mkdir "$tmp/there"
    cp "$tmp/both.leaf" "$tmp/heat.leaf" "$tmp/there"
    places='"eye": [50, 40, 34], "look-at": [8, 8, 8], "size": [60, 50]'
    for by in heat heat.leaf both.leaf:heat; do
        echo '{"objects": [{"file": "both.leaf", "iso": 6, "colour-by": "'$by'", "transform": [1,0,0,0, 0,1,0,0, 0,0,1,0]}], '"$places}" >"$tmp/there/$by.json"
        draw scene "$tmp/there/$by.json"
        same scene own
    done
    echo '{"objects": [{"file": "both.leaf", "iso": 6, "color-by": "heat", "instances": [{"translate": [0, 0, 0]}, {"translate": [4, 8, 32]}]}], '"$places}" >"$tmp/there/moved.json"
    draw moved "$tmp/there/moved.json" --eye 54,48,66 --look-at 12,16,40
    draw two_places "$tmp/there/moved.json" --eye 54,48,66 --look-at 12,16,40 --clip-plane 0,0,1,-25
    same_share=$(cmp -l "$tmp/two_places.ppm" "$tmp/own.ppm" | wc -l)
    ok "a field moves with its object ($same_share bytes differ)" [ "$same_share" -lt 100 ]
    one='{"file": "both.leaf", "iso": 6, "colour-by": "heat.leaf"}'
    many=$(yes "$one," | head -69)
    echo '{"objects": ['"$many $one], $places}" >"$tmp/there/many.json"
    exits "70 objects where 40 files may be open" 0 sh -c 'ulimit -n 40; exec "$@"' sh "$leafcast" render "$tmp/there/many.json" -q -o "$tmp/many.ppm"
    ok "open what colours them once" cmp "$tmp/many.ppm" "$tmp/own.ppm"
    echo '{"objects": [{"file": "both.leaf", "iso": 6, "colour-by": "../heat.leaf"}], '"$places}" >"$tmp/there/up.json"
    exits "a file elsewhere" 3 "$leafcast" render "$tmp/there/up.json" -q -o "$tmp/x.ppm"
    draw up "$tmp/there/up.json" --follow-links
    same up own
}

# ---- probes, and what is told ----

probe() { python3 -c 'import json, sys; x = json.load(open(sys.argv[1])); print('"$1"')' "$tmp/out"; }
exits "a probe" 0 "$leafcast" probe "$tmp/both.leaf" --iso 6 --at 30,25 --size 60x50 --eye 50,40,34 --look-at 8,8,8 --colour-by heat --json
told=$(probe 'repr(x["hits"][0]["colour_by_value"])')
point=$(probe '",".join(map(repr, x["hits"][0]["point"]))')
exits "the point" 0 "$leafcast" probe "$tmp/both.leaf" --field heat --point "$point" --json
ok "has the value ($told)" [ "$(probe 'repr(x["value"])')" = "$told" ]
exits "and of another file" 0 "$leafcast" probe "$tmp/both.leaf" --point "$point" --colour-by "$tmp/heat.leaf" --json
ok "the same" [ "$(probe 'repr(x["colour_by_value"])')" = "$told" ]
exits "a line to run again" 0 "$leafcast" probe "$tmp/both.leaf" --iso 6 --at 30,25 --size 60x50 --colour-by heat
ok "names it" grep -q '^rerun: .*--colour-by heat' "$tmp/out"
exits "statistics" 0 "$leafcast" render "$tmp/both.leaf" --iso 6 --colour-by heat --size 60x50 --json -q
ok "name it" grep -q '"colour_by": "heat"' "$tmp/out"
exits "a place between two rows" 0 "$leafcast" probe "$tmp/rain.leaf" --point 6.25,5.5,99 --json
ok "has the value between ($(probe 'repr(x["value"])'))" [ "$(probe 'x["value"] == 2.5')" = True ]
exits "a place beside it" 0 "$leafcast" probe "$tmp/rain.leaf" --point 0,4,0 --json
ok "has none" [ "$(probe 'x["inside"]')" = False ]
exits "a legend" 0 "$leafcast" render "$tmp/both.leaf" --iso 6 --colour-by heat --size 200x200 --legend -q -o "$tmp/legend.ppm"
exits "none" 0 "$leafcast" render "$tmp/both.leaf" --iso 6 --colour-by heat --size 200x200 -q -o "$tmp/bare.ppm"
ok "is drawn" [ "$(cmp -l "$tmp/legend.ppm" "$tmp/bare.ppm" | wc -l)" -gt 2000 ]

# ---- where it lies, and what it was ----

# Values x, in a world of RAS axes: in one of LPS axes it lies at x and y from -17 to 0, where the surface is not.
python3 - "$tmp/ras.nrrd" <<'PY'
import struct, sys
with open(sys.argv[1], "wb") as f:
    f.write(b"NRRD0004\ntype: float\ndimension: 3\nspace: right-anterior-superior\nsizes: 18 18 18\nencoding: raw\nendian: little\n"
            b"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n\n")
    f.write(b"".join(struct.pack("<18f", *range(18)) for _ in range(18 * 18)))
PY
exits "a file that names its axes" 0 "$leafcast" convert "$tmp/ras.nrrd" -q -o "$tmp/ras.leaf"
value() { # value OPTION...: that of the middle pixel
    "$leafcast" probe "$tmp/both.leaf" --iso 6 --size 60x50 --at 30,25 --colour-by "$tmp/ras.leaf" --json "$@" |
        python3 -c 'import json, sys; j = json.load(sys.stdin); h = j["hits"][0]
print(h["colour_by_value"], j["origin"][0] + h["t"] * j["direction"][0])'
}
value >"$tmp/value" || cat "$tmp/value"
ok "has its value at x" awk '{ exit !($1 > 0 && ($1 - $2) ^ 2 < 1e-10) }' "$tmp/value"
ok "and is turned with the picture's world" [ "$(value --axes LPS | cut -d' ' -f1)" = None ]
sed 's/right-anterior/left-posterior/' "$tmp/ras.nrrd" >"$tmp/lps.nrrd"
exits "another's axes" 0 "$leafcast" convert "$tmp/lps.nrrd" -q -o "$tmp/lps.leaf"
draw beside "$tmp/both.leaf" --iso 6 --colour-by "$tmp/ras.leaf" --and "$tmp/lps.leaf" --iso 30
draw turned "$tmp/both.leaf" --iso 6 --axes LPS --colour-by "$tmp/ras.leaf"
same beside turned
exits "one step" 0 "$leafcast" convert "$tmp/heat_0.vtk" -q -o "$tmp/once.leaf"
cat >"$tmp/lines" <<X
{"step": 1, "colour_by": "$tmp/heat.leaf", "output": "$tmp/l1.ppm"}
{"step": 0, "colour_by": "$tmp/once.leaf", "output": "$tmp/l2.ppm"}
X
view='--eye 40,30,25 --look-at 8,8,8'
# shellcheck disable=SC2086 # words
exits "lines of a script, by one file and another" 0 "$leafcast" render "$tmp/both.leaf" --iso 6 $view --size 60x50 --script "$tmp/lines" -q --force
# shellcheck disable=SC2086 # words
draw l3 "$tmp/both.leaf" --iso 6 $view --step 0 --colour-by "$tmp/once.leaf"
same l2 l3
echo '{"field": "heat", "iso": 4, "colour_by": "heat", "output": "'"$tmp/l4.ppm"'"}' >"$tmp/line"
(echo '{"colour_by": "heat", "output": "'"$tmp/l1.ppm"'"}' && cat "$tmp/line") >"$tmp/lines"
exits "then by the field that is shown" 1 "$leafcast" render "$tmp/both.leaf" --iso 6 --size 60x50 --script "$tmp/lines" -q --force
ok "is refused as ever" says "that is the field whose isosurfaces are shown"

# ---- an image over terrain ----

if "$leafcast" --list-verbs | grep -qx import-images; then
    { printf 'P6 2 2 255\n'; printf '\377\200\000%.0s' 1 2 3 4; } >"$tmp/orange.ppm"
    { printf 'P6 2 2 255\n'; printf '\377\200\000\000\000\377%.0s' 1 2; } >"$tmp/two.ppm"
    for image in orange two; do
        exits "$image" 0 "$leafcast" convert "$tmp/$image.ppm" --field rgb --spacing 20,20,1 -q -o "$tmp/$image.leaf"
    done
    draw draped "$tmp/hill.leaf" --colour-by "$tmp/orange.leaf"
    draw orange "$tmp/hill.leaf" --colour '#ff8000'
    same draped orange
    draw two "$tmp/hill.leaf" --colour-by "$tmp/two.leaf"
    differ two orange
    echo '{"objects": [{"file": "hill.leaf", "colour_by": "two.leaf"}]}' >"$tmp/draped.json"
    draw scene "$tmp/draped.json"
    same scene two
    exits "an image with a map" 2 "$leafcast" render "$tmp/hill.leaf" --colour-by "$tmp/two.leaf" --colour-map grey --size 8x8 -o "$tmp/x.ppm"
    ok "has its own colours" says "two.leaf: that is an image, which has its own colours"
    exits "an image alone" 2 "$leafcast" render "$tmp/two.leaf" --size 8x8 -o "$tmp/x.ppm"
    ok "has no elevations" says 'field "rgb" of this heights is an image'
else
    skip "images over terrain" "no OpenImageIO here"
fi

# ---- refused, in a line ----

cp "$tmp/heat.leaf" "$tmp/heat.ppm"
while IFS='|' read -r code said options; do
    # shellcheck disable=SC2086 # split on purpose
    # shellcheck disable=SC2046 # several words
    exits "$options" "$code" "$leafcast" render "$tmp/both.leaf" --iso 6 --size 8x8 -o "$tmp/x.ppm" --force $(echo "$options" | sed "s|@|$tmp/|g")
    ok "says: $said" says "$said"
    ok "in a line" [ "$(grep -c . "$tmp/err")" = 1 ]
done <<'X'
2|"cold" is neither a file nor a field: no field is called "cold"|--colour-by cold
2|that is the field whose isosurfaces are shown|--colour-by speed
2|heat.leaf:cold: no field is called "cold"|--colour-by @heat.leaf:cold
2|it has no values at points|--colour-by @sheet.leaf
2|without --opacity V:A|--colour-by heat --opacity 6:0.5
3|sheet.ply: |--colour-by @sheet.ply
2|input|--colour-by @heat.ppm -o @heat.ppm
X
ok "an input stays" cmp "$tmp/heat.leaf" "$tmp/heat.ppm"
exits "terrain by its elevation" 2 "$leafcast" render "$tmp/hill.leaf" --colour-by 0 --size 8x8 -o "$tmp/x.ppm"
ok "is told" says "that is the field whose elevations are shown"
exits "a projection" 2 "$leafcast" render "$tmp/both.leaf" --project max --colour-by heat --size 8x8 -o "$tmp/x.ppm"
ok "has no surface" says "--colour-by: there is no surface without --iso"
exits "steps of others" 0 "$leafcast" convert "$tmp/heat_0.vtk" "$tmp/heat_1.vtk" --times 3,4 -q -o "$tmp/timed.leaf"
exits "at other times" 2 "$leafcast" render "$tmp/both.leaf" --step 1 --iso 6 --colour-by "$tmp/timed.leaf" --size 8x8 -o "$tmp/x.ppm"
ok "are told" says "its step 1 is at time 4, what is shown there at 1"
finish
