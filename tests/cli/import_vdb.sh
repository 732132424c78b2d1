#!/bin/sh
# import_vdb.sh - OpenVDB files through the importer: the samples and the map that OpenVDB itself reads
# back, of every kind of grid and compression; what is refused, with its words; broken files; budgets.
# marks: long
. tests/support/tap.sh

tool=${LEAFCAST_BUILD:-build/release}/tests/tool_vdb
if ! "$leafcast" --list-verbs | grep -qx import-vdb; then
    skip "leafcast import-vdb" "no OpenVDB here"
    finish
fi
says() { grep -q -- "$1" "$tmp/err"; }
prints() { grep -qE -- "$1" "$tmp/out"; }
absent() { [ -z "$(find "$tmp" -name "$1*")" ]; }

cat >"$tmp/compare.py" <<'PY'
"""compare.py F.nrrd DUMP: an NRRD holds what tool_vdb read: sizes, map, every byte of the samples."""
import sys
def fail(what):
    sys.exit(what)
head, data = open(sys.argv[1], "rb").read().split(b"\n\n", 1)
field = dict(l.split(": ", 1) for l in head.decode().split("\n") if ": " in l)
box, points, samples = open(sys.argv[2], "rb").read().split(b"\n", 2)
box = [int(x) for x in box.split()]
points = [float(x) for x in points.split()]
vector = lambda text: [float(x) for x in text.strip("()").split(",")]
origin = vector(field["space origin"])
axes = [vector(a) for a in field["space directions"].split()]
if [int(n) for n in field["sizes"].split()] != box[3:]:
    fail("sizes %s, not %s" % (field["sizes"], box[3:]))
scale = max(abs(x) for x in points)
for i in range(4):
    for r in range(3):
        mine = origin[r] + (axes[i - 1][r] if i else 0)
        if abs(mine - points[3 * i + r]) > 1e-15 * 4 * scale:
            fail("map: node %d, row %d: %r, not %r" % (i, r, mine, points[3 * i + r]))
if data != samples:
    fail("samples differ: %d bytes, %d" % (len(data), len(samples)))
PY

# same FILE GRID COMPONENT [--box BOX]: what the importer writes is what the library reads.
same() {
    same_file=$1
    same_grid=$2
    same_component=$3
    shift 3
    set -- "$@"
    box=$(echo "${2-}" | tr , ' ')
    # shellcheck disable=SC2086 # numbers
    "$tool" dump "$same_file" "$same_grid" "$same_component" $box >"$tmp/dump" || return 1
    [ "$same_component" = 0 ] || set -- "$@" --component "$same_component"
    run "$leafcast" import-vdb "$same_file" --field "$same_grid" "$@" -o "$tmp/same.nrrd" --force
    [ "$rc" = 0 ] && python3 "$tmp/compare.py" "$tmp/same.nrrd" "$tmp/dump"
}

# Broken copies: each is refused, or gives samples where a value alone was hit.
cat >"$tmp/break.py" <<'PY'
import random, subprocess, sys
leafcast, path, broken, count, seed = sys.argv[1:4] + [int(a) for a in sys.argv[4:6]]
random.seed(seed)
whole = open(path, "rb").read()
bad = errors = 0
for k in range(2 * count):
    data = bytearray(whole[: len(whole) * k // count] if k < count else whole)
    for i in range(0 if k < count else random.choice((1, 4, 16))):
        data[random.randrange(min(len(data), random.choice((100, 1000, 1 << 60))))] = random.randrange(256)
    with open(broken, "wb") as f:
        f.write(data)
    try:
        r = subprocess.run([leafcast, "import-vdb", broken, "--memory", "256M"], timeout=60,
                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        code, words = r.returncode, r.stderr
    except subprocess.TimeoutExpired:
        code, words = "a hang", b""
    errors += code != 0
    if code not in ((3, 4) if k < count else (0, 3, 4)) or (code and b"leafcast import-vdb: " not in words):
        bad += 1
        print("seed %d, copy %d: exit %s: %s" % (seed, k, code, words.decode(errors="replace")))
print("%d of %d refused" % (errors, 2 * count))
sys.exit(bad > 0 or errors < count)
PY

if [ ! -x "$tool" ]; then
    skip "import-vdb against OpenVDB" "tool_vdb is not built"
else
    mkdir "$tmp/v"
    exits "files of OpenVDB" 0 "$tool" make "$tmp/v"
    for grid in float double int32 int64 bool mask vec3s vec3d vec3i; do
        ok "$grid: samples and map" same "$tmp/v/blosc.vdb" $grid 0
    done
    part=-24,-12,-44,40,60,20 # all leaves, and the small tiles
    for grid in vec3s vec3d vec3i; do
        ok "$grid: a component" same "$tmp/v/blosc.vdb" $grid 2 --box $part
    done
    for file in zip none half stream; do
        for grid in float vec3d bool; do
            ok "$file: $grid" same "$tmp/v/$file.vdb" $grid 0 --box $part
        done
    done
    ok "a box that cuts leaves" same "$tmp/v/blosc.vdb" float 0 --box -13,-3,-33,11,29,-2
    ok "a box outside of all" same "$tmp/v/blosc.vdb" float 0 --box 5000,0,-9000,5006,7,-8990
    ok "a box around all" same "$tmp/v/zip.vdb" double 0 --box -60,-30,-70,270,150,140
    exits "a pad" 0 "$leafcast" import-vdb "$tmp/v/blosc.vdb" --pad 3 -o "$tmp/pad.nrrd"
    "$tool" dump "$tmp/v/blosc.vdb" float 0 -23 -12 -43 258 130 130 >"$tmp/dump"
    ok "is a box three wider" python3 "$tmp/compare.py" "$tmp/pad.nrrd" "$tmp/dump"
    for grid in first second "twin[0]" "twin[1]"; do
        ok "of a shared tree and a shared name: $grid" same "$tmp/v/shared.vdb" "$grid" 0 --box $part
    done
    exits "a level set" 0 "$leafcast" import-vdb "$tmp/v/sphere.vdb" -o "$tmp/sphere.nrrd"
    ok "has the outside and the inside" same "$tmp/v/sphere.vdb" sphere 0 --box -40,-30,-20,60,70,80

    exits "--list" 0 "$leafcast" import-vdb "$tmp/v/half.vdb" --list
    ok "names grids, sizes and types" prints '^vec3d +276 x 137 x 168 +vec3d, half$'
    ok "all of them" [ "$(wc -l <"$tmp/out")" = 9 ]
    exits "--list --json" 0 "$leafcast" import-vdb "$tmp/v/points.vdb" --list --json
    ok "and what is no volume" prints '"why": "points'
    refused() { # refused NAME WORDS ARGUMENT...
        refused_words=$2
        exits "$1" "${refused_code:-3}" "$leafcast" import-vdb "$tmp/v/$3" -o "$tmp/refused.nrrd" ${4+"$4" "$5"}
        ok "says so" says "$refused_words"
        ok "leaves nothing" absent refused
    }
    refused "points" "points, which are no samples" points.vdb
    refused "a frustum" "frustum" frustum.vdb
    refused "no active voxel" "no active voxel" empty.vdb
    refused "no grid at all" "no grid in it" nothing.vdb
    refused "no such grid" 'no grid "heat"; `leafcast import-vdb .* --list' blosc.vdb --field heat
    refused "a number that no sample holds" "beyond 2^53" huge.vdb
    refused_code=2
    refused "no such component" "has 1" blosc.vdb --component 2
    exits "the empty grid in a box" 0 "$leafcast" import-vdb "$tmp/v/empty.vdb" --box 0,0,0,3,3,3 -o "$tmp/e.nrrd"
    refused_code=4
    refused "a tree beyond --memory" "no room\|--memory leaves" none.vdb --memory 300K
    exits "a budget below the tree's size" 0 "$leafcast" import-vdb "$tmp/v/none.vdb" --field vec3d --memory 10M \
        -o "$tmp/small.nrrd"
    ok "gives the same" same "$tmp/v/none.vdb" vec3d 0
    ok "byte by byte" cmp -s "$tmp/small.nrrd" "$tmp/same.nrrd"
    for file in sphere shared; do
        exits "broken copies of $file.vdb" 0 python3 "$tmp/break.py" "$leafcast" "$tmp/v/$file.vdb" \
            "$tmp/broken.vdb" 50 "${SEED:-14}"
    done

    exits "convert takes one" 0 "$leafcast" convert "$tmp/v/sphere.vdb" -o "$tmp/sphere.leaf"
    # A sphere of radius 3 at (1, 2, 3): where rays along the axes through its centre meet it.
    for axis in 1,0,0 0,1,0 0,0,1 -1,0,0; do
        eye=$(echo $axis | awk -F, '{ print 1 + 9 * $1 "," 2 + 9 * $2 "," 3 + 9 * $3 }')
        up=$(echo $axis | awk -F, '{ print $2 "," $3 "," $1 }')
        run "$leafcast" probe "$tmp/sphere.leaf" --iso 0 --size 101x101 --fov 20 --eye="$eye" \
            --look-at 1,2,3 --up="$up" --at 50,50 --json
        distance=$(grep -o '"t": [0-9.]*' "$tmp/out" | head -n 1 | grep -o '[0-9.]*$')
        ok "a sphere of radius 3 along $axis (${distance:-no hit})" \
            awk -v d="$distance" 'BEGIN { exit !(d > 5.999 && d < 6.001) }'
    done
fi

if [ -z "$data" ] || [ ! -d "$data/vdb_sphere_ls" ]; then
    skip "real OpenVDB files" "no data folder"
    finish
fi
# FILE GRID SIZES ISO VALUE: the grid of the file, and that something is seen of it.
while read -r file grid sizes iso; do
    exits "$file: $grid" 0 "$leafcast" import-vdb "$data/$file.vdb" --field "$grid" -o "$tmp/real.nrrd" --force
    ok "has sizes $sizes" grep -aqx "sizes: $(echo "$sizes" | tr x ' ')" "$tmp/real.nrrd"
    [ ! -x "$tool" ] || ok "has OpenVDB's samples and map" same "$data/$file.vdb" "$grid" 0
    exits "becomes a treelet file" 0 "$leafcast" convert "$tmp/real.nrrd" -o "$tmp/real.leaf" --force
    exits "of which something is seen" 0 "$leafcast" render "$tmp/real.leaf" --iso "$iso" --size 64x64 \
        --fail-empty -o "$tmp/real.png" --force
done <<LIST
vdb_smoke/smoke density 111x222x112 0.1
vdb_sphere_ls/sphere ls_sphere 125x125x125 0
vdb_dragon_xform/dragon density 70x49x31 0.5
vdb_dragon_xform/dragon_with_xform density 141x99x63 0.5
vdb_pig/pig density 201x197x197 0.5
vdb_pyro/pyro density 59x93x59 2
vdb_sequence/fluid_data_0150 density 29x29x32 0.1
vdb_sequence/fluid_data_0200 velocity 29x29x32 0.5
vdb_sequence/fluid_data_0250 temperature 29x29x32 0.1
LIST
exits "the real points" 3 "$leafcast" import-vdb "$data/vdb_points_reject/sphere_points.vdb"
ok "are refused by name" says 'points'
# The real level set: |p| - 3 in its band, as exact as half precision; and beyond it the background.
exits "the sphere of radius 3" 0 "$leafcast" import-vdb "$data/vdb_sphere_ls/sphere.vdb" -o "$tmp/ls.nrrd"
cat >"$tmp/ball.py" <<'PY'
import array, math, sys
head, raw = open(sys.argv[1], "rb").read().split(b"\n\n", 1)
f = dict(l.split(": ", 1) for l in head.decode().split("\n") if ": " in l)
nx, ny, nz = (int(n) for n in f["sizes"].split())
o = [float(x) for x in f["space origin"].strip("()").split(",")]
h = float(f["space directions"].split(",")[0].strip("( "))
v = array.array("f", raw)
worst, band = 0, 3 * 0.05
for k in range(nz):
    for j in range(ny):
        for i in range(nx):
            d = math.dist((o[0] + i * h, o[1] + j * h, o[2] + k * h), (0, 0, 0)) - 3
            want = max(-band, min(band, d))
            worst = max(worst, abs(v[(k * ny + j) * nx + i] - want))
print("worst", worst)
sys.exit(worst > 2e-3 * h + 1e-4)
PY
exits "is |p| - 3 within its band" 0 python3 "$tmp/ball.py" "$tmp/ls.nrrd"
finish
