#!/bin/sh
# terrain.sh - elevations that lie on a map: GeoTIFF through the importer, models of the U.S. Geological Survey; where
# they lie, what has no data, and that their surfaces are the same as those of an Arc ASCII grid.
# marks: long leaks
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
header() { grep -aqxF -- "$1" "$tmp/out.nrrd"; }
hits() { # hits F.leaf X Y: what a ray from above meets
    "$leafcast" probe "$1" --ray "$2,$3,1e5,0,0,-1" 2>/dev/null | grep -v '^rerun'
}
misses() { hits "$@" | grep -qx 'count: 0'; }

# ---- what all of them are held against ----
cat >"$tmp/area.asc" <<'ASC'
ncols 4
nrows 3
xllcorner 1000
yllcorner 1910
cellsize 30
NODATA_value -9999
1 2 3 4
5 -9999 7 8
9 10 11 12
ASC
exits "an Arc ASCII grid" 0 "$leafcast" convert "$tmp/area.asc" -o "$tmp/area.leaf"
"$leafcast" info "$tmp/area.leaf" --json >"$tmp/area.json"
ok "counts each node without data once" grep -q '"non_finite": 1,' "$tmp/area.json"
for file in area.asc area.leaf; do
    exits "a look at $file" 0 "$leafcast" info "$tmp/$file"
    ok "shows its elevations" grep -q '^histogram of .* bars by cube roots$' "$tmp/out"
    ok "suggests no isovalue" sh -c "! grep -q isovalue '$tmp/out'"
    exits "and as JSON" 0 "$leafcast" info "$tmp/$file" --json
    ok "none" sh -c "tr -d ' \\n' <'$tmp/out' | grep -qF '\"suggested\":[]'"
done
exits "an isovalue of terrain" 2 "$leafcast" info "$tmp/area.leaf" --iso 5
ok "is none" says "a surface of patches, which has no isosurfaces"
hits "$tmp/area.leaf" 1090 1940 >"$tmp/want"
ok "a ray meets it" grep -qx 'count: 1' "$tmp/want"

# ---- as triangles ----

exits "as triangles" 0 "$leafcast" export "$tmp/area.leaf" -o "$tmp/area.ply" --json
ok "two of each of two cells" grep -q '"triangles": 4,' "$tmp/out"
ok "at their six nodes" grep -q '"vertices": 6,' "$tmp/out"
exits "taken back" 0 "$leafcast" convert "$tmp/area.ply" -q -o "$tmp/flat.leaf"
hits "$tmp/flat.leaf" 1090 1940 | grep '^ *point' >"$tmp/there"
grep '^ *point' "$tmp/want" >"$tmp/here"
ok "are met at a node where its patches are" cmp "$tmp/there" "$tmp/here"
exits "a box of them" 0 "$leafcast" export "$tmp/area.leaf" --box 2,0,0,3,1,1 -o "$tmp/box.stl" --json
ok "has one cell" grep -q '"triangles": 2,' "$tmp/out"
exits "an isosurface of terrain" 2 "$leafcast" export "$tmp/area.leaf" --iso 5 -o "$tmp/x.ply"
ok "is none" says "a surface of triangles, to become .ply"
exits "cells of terrain" 3 "$leafcast" export "$tmp/area.leaf" -o "$tmp/x.vtu"
ok "are none" says "export it as .ply, .stl or .vtp"
if command -v python3 >/dev/null; then
    python3 -c 'import math
print("ncols 150\nnrows 90\nxllcorner 0\nyllcorner 0\ncellsize 2\nNODATA_value -9999")
for j in range(90): print(*["-9999" if (i - 70) ** 2 + (j - 60) ** 2 < 90 else round(9 * math.sin(i / 7) * math.cos(j / 9), 3) for i in range(150)])' >"$tmp/wide.asc"
    exits "six treelets" 0 "$leafcast" convert "$tmp/wide.asc" -q -o "$tmp/wide.leaf"
    exits "welded" 0 "$leafcast" export "$tmp/wide.leaf" -o "$tmp/wide.ply" -q
    exits "each edge between two cells" 0 python3 - "$tmp/wide.ply" <<'PY'
import collections, struct, sys
data = open(sys.argv[1], "rb").read()
head, body = data.split(b"end_header\n", 1)
vertices, faces = [int(l.split()[2]) for l in head.decode().splitlines() if l.startswith("element")]
assert b"property double z\nproperty float value" in head, head
at = [struct.unpack_from("<dddf", body, 28 * i) for i in range(vertices)]
assert all(abs(p[2] - p[3]) < 1e-6 for p in at) and len({p[:2] for p in at}) == vertices
edges, area = collections.Counter(), 0.0
for i in range(faces):
    n, *c = struct.unpack_from("<Biii", body, 28 * vertices + 13 * i)
    assert n == 3
    (ax, ay), (bx, by), (cx, cy) = [at[k][:2] for k in c]
    area += 0.5 * ((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))
    edges.update((c[k], c[(k + 1) % 3]) for k in range(3))
assert max(edges.values()) == 1 and abs(area - 2.0 * faces) < 1e-6, area
rim = sum((b, a) not in edges for a, b in edges)
print(vertices, faces, rim)
assert rim == 2 * (149 + 89) + 2 * (19 + 19), rim
PY
    for how in "--threads 1" "--threads 3 --memory 16M"; do
        # shellcheck disable=SC2086 # split on purpose
        exits "with $how" 0 "$leafcast" export "$tmp/wide.leaf" $how -o "$tmp/again.ply" --force -q
        ok "the same bytes" cmp "$tmp/again.ply" "$tmp/wide.ply"
    done
fi

# ---- GeoTIFF ----
if ! "$leafcast" --list-verbs | grep -qx import-images || ! command -v python3 >/dev/null; then
    skip "GeoTIFF" "no OpenImageIO or no python3 here"
else
    mkdir "$tmp/maps"
    python3 tests/support/write_geotiff.py "$tmp/maps"
    imports() { exits "$1" 0 "$leafcast" import-images "$tmp/maps/$1.tif" -o "$tmp/out.nrrd" --force; }
    imports area
    ok "lies where its corner says" header 'space origin: (1015,1985,0)'
    ok "at distances of pixels, southward" header 'space directions: (30,0,0) (0,-30,0) (0,0,1)'
    ok "in metres" header 'space units: "m" "m" "m"'
    ok "is terrain" header 'leafcast terrain:=yes'
    ok "says what has no data" header 'leafcast missing:=-9999'
    for map in area moved copies; do
        exits "convert $map.tif" 0 "$leafcast" convert "$tmp/maps/$map.tif" -o "$tmp/$map.tif.leaf"
        hits "$tmp/$map.tif.leaf" 1090 1940 >"$tmp/got"
        ok "has the surface of the Arc ASCII grid" cmp -s "$tmp/want" "$tmp/got"
        ok "and its hole" misses "$tmp/$map.tif.leaf" 1040 1960
    done
    ok "the Arc ASCII grid has it, too" misses "$tmp/area.leaf" 1040 1960
    exits "a file that the importer wrote" 0 "$leafcast" convert "$tmp/out.nrrd" -o "$tmp/again.leaf"
    "$leafcast" info "$tmp/again.leaf" --json >"$tmp/again.json"
    ok "is terrain without --heights" grep -q '"kind": "heights"' "$tmp/again.json"
    imports points
    ok "pixels that are points" header 'space origin: (10,20,0)'
    ok "in degrees" header 'space units: "degree" "degree" ""'
    exits "degrees are told" 0 "$leafcast" convert "$tmp/maps/points.tif" -o "$tmp/points.leaf"
    ok "with a factor that shows them in proportion" says "points.tif: degrees across .* metres: --exaggerate=9e-06"
    exits "not where one is given" 0 "$leafcast" convert "$tmp/maps/points.tif" --exaggerate 9e-6 -o "$tmp/points.leaf" --force
    ok "says nothing" [ "$(grep -c degrees "$tmp/err")" = 0 ]
    imports matrix
    ok "a matrix" header 'space directions: (2,1,0) (1,-2,0) (0,0,1)'
    ok "from the corner of a pixel" header 'space origin: (101.5,199.5,0)'
    ok "a number of no data that was rounded up" header 'leafcast missing:=-3.4028234663852886e+38'
    ok "tells what is not applied" says "GDAL's scale"
    imports bytes
    ok "no data that no byte can be is none" [ "$(grep -ac missing "$tmp/out.nrrd")" = 0 ]
    for map in unplaced flat stack; do
        imports $map
        ok "is on no map" header 'space origin: (0,0,0)'
        ok "nor terrain" [ "$(grep -ac terrain "$tmp/out.nrrd")" = 0 ]
    done
    imports short
    ok "tags that are cut off tell nothing" header 'space origin: (0,0,0)'
fi

# ---- a model of the U.S. Geological Survey ----
data=${LEAFCAST_DATA:-../shared/data}/dem_st_helens
if [ ! -d "$data" ] || ! command -v zstd >/dev/null || ! command -v python3 >/dev/null; then
    skip "Mount St. Helens" "no data, zstd or python3 here"
    finish
fi
exits "convert takes it packed" 0 "$leafcast" convert "$data/SainteHelens.dem.zst" -o "$tmp/helens.leaf"
exits "its samples" 0 "$leafcast" export "$tmp/helens.leaf" -o "$tmp/helens.raw"
zstd -dqc "$data"/st_helens_*.raw.zst >"$tmp/truth.raw"
cat >"$tmp/compare.py" <<'PY'
import math, struct, sys
nx, ny = 327, 466
truth = struct.unpack("<%dh" % (nx * ny), open(sys.argv[1], "rb").read())
got = struct.unpack("<%df" % (2 * nx * ny), open(sys.argv[2], "rb").read())
bad = 0
for j in range(ny):
    for i in range(nx):
        want = truth[(ny - 1 - j) * nx + i]
        for twice in (0, 1):
            one = got[(2 * j + twice) * nx + i]
            bad += not (math.isnan(one) if want == -32768 else one == want)
print("%d of %d differ" % (bad, nx * ny))
sys.exit(bad > 0)
PY
exits "each of its 152382 elevations" 0 python3 "$tmp/compare.py" "$tmp/truth.raw" "$tmp/helens.raw"
exits "info" 0 "$leafcast" info "$tmp/helens.leaf"
ok "where it lies" grep -q '^to world *30  0  0  557820$' "$tmp/out"
finish
