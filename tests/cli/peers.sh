#!/bin/sh
# peers.sh - leafcast bench peers: that the peers draw the same surface, whatever the machine's speed.
# marks: plain, long
. tests/support/tap.sh

leaf=$tmp/v.leaf
csv() { # csv FILE EXPRESSION: python, with the rows as dictionaries in t, by contestant in by
    python3 -c 'import csv, fractions, sys
t = list(csv.DictReader(open(sys.argv[1])))
by = {(r["contestant"], r.get("BVH")): r for r in t}
sys.exit(not eval(f"({sys.argv[2]})"))' "$@"
}
# The peers' own libraries are not built for our sanitizers.
export LSAN_OPTIONS=detect_leaks=0
run "$leafcast" generate marschner-lobb --dims 128 -o "$tmp/v.nrrd"
run "$leafcast" convert "$tmp/v.nrrd" -o "$leaf" -q

exits "without a file" 2 "$leafcast" bench peers --iso 1
exits "without an isovalue: the suggested one" 0 "$leafcast" bench peers "$leaf" --size 16x16 --runs 1
for step in 0 -0 nan inf -inf 1x; do
    exits "--step $step" 2 "$leafcast" bench peers "$leaf" --iso 127.5 --size 16x16 --runs 1 --step=$step
    ok "is named" grep -q -- "--step: .*$step" "$tmp/err"
done
exits "a step downwards" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 16x16 --runs 1 --step=-0.5
exits "shadows without a light" 2 "$leafcast" bench peers "$leaf" --iso 127.5 --shadows
exits "shadows of what is transparent" 2 "$leafcast" bench peers "$leaf" --iso 127.5 --light 0,1,2 --shadows --opacity 0.5
exits "a background without a picture" 2 "$leafcast" bench peers "$leaf" --iso 127.5 --background red
exits "within too little memory" 4 "$leafcast" bench peers "$leaf" --iso 127.5 --size 16x16 --runs 1 --memory 1K
exits "as JSON" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 16x16 --runs 1 --json --verbose --output "$tmp/q.csv"
ok "with a row for us" python3 -c 'import json, sys; sys.exit(json.load(open(sys.argv[1]))["rows"][0]["contestant"] != "leafcast")' "$tmp/out"
ok "and what it took" grep -q 'of CPU' "$tmp/err"
exits "--force" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 16x16 --runs 1 --force --quiet --output "$tmp/q.csv"
ok "--quiet says nothing more" [ ! -s "$tmp/err" ]
exits "two surfaces" 2 "$leafcast" bench peers "$leaf" --iso 127.5 --iso 100
exits "a race" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 203x190 --runs 3 --threads 2 -o "$tmp/p.csv" --plot "$tmp/p.svg"
cp "$tmp/err" "$tmp/said"
ok "ours, and with a new isovalue" csv "$tmp/p.csv" \
    'float(by["leafcast", "-"]["ms"]) > 0 and float(by["leafcast; new isovalue", "-"]["ms"]) > 0 and int(by["leafcast", "-"]["hits"]) > 5000'
ok "as bars" python3 -c 'import sys, xml.dom.minidom as x; x.parse(sys.argv[1])' "$tmp/p.svg"
exits "an existing table" 1 "$leafcast" bench peers "$leaf" --iso 127.5 -o "$tmp/p.csv"

if grep -q 'no Embree' "$tmp/said"; then
    ok "says what to install" grep -q libembree-dev "$tmp/said"
    skip "Embree" "not built with Embree (libembree-dev)"
else
    ok "Embree draws the same pixels" csv "$tmp/p.csv" \
        'abs(int(by["leafcast", "-"]["hits"]) - int(by["rtcIntersect16", "medium"]["hits"])) < 30 and int(by["rtcIntersect16", "medium"]["only peer"]) < 30 and int(by["rtcIntersect16", "medium"]["only ours"]) < 30'
    ok "where we do, but for the triangles' flatness" csv "$tmp/p.csv" \
        '0 < float(by["rtcIntersect16", "medium"]["median cells"]) < 0.03 and float(by["rtcIntersect16", "medium"]["p99 cells"]) < 1'
    ok "and as we do" csv "$tmp/p.csv" 'float(by["rtcIntersect16", "medium"]["colour rms"]) < 0.1'
    ok "by packets and single rays, both BVHs" csv "$tmp/p.csv" \
        '{("rtcIntersect16", "high"), ("rtcIntersect8", "medium"), ("rtcIntersect1", "medium")} <= by.keys()'
    ok "the yardstick is Embree's fastest" csv "$tmp/p.csv" \
        'all(max(float(r[x]) for k, r in by.items() if k[0][:3] == "rtc" and ";" not in k[0]) == 1 for x in ("x Embree", "x by CPU"))'
    ok "nobody goes behind an opaque surface" csv "$tmp/p.csv" \
        'by.keys().isdisjoint({("rtcIntersect16; incoherent", "medium"), ("rtcIntersect16; one pass", "medium")}) and all(r["hits"] in (r["surfaces"], "-") and r["rays"] in ("38570", "-") for r in t)'
    if [ "$(uname -m)" = x86_64 ]; then
        exits "older instructions" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 203x190 --runs 1 --isa sse42 -o "$tmp/isa.csv"
        ok "are told" grep -q ', sse42; ' "$tmp/out"
        ok "and draw the same" csv "$tmp/isa.csv" 'int(by["leafcast", "-"]["hits"]) > 5000 and int(by["rtcIntersect16", "medium"]["only ours"]) < 30 and int(by["rtcIntersect16", "medium"]["only peer"]) < 30'
        exits "but not of media" 2 "$leafcast" bench peers "$leaf" --media --runs 1 --isa sse42
    fi
    # Behind the first surface.
    exits "a light from aside" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 203x190 --runs 1 --light 0,1,2 -o "$tmp/l.csv"
    ok "shines alike" csv "$tmp/l.csv" 'float(by["rtcIntersect16", "medium"]["colour rms"]) < 0.1 and by["leafcast", "-"]["rays"] == "38570"'
    for light in "--light 0,1,2" "--point-light 60,90,200"; do
        exits "shadows, $light" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 203x190 --runs 1 $light --shadows --force -o "$tmp/l.csv"
        ok "fall alike: as many rays, as many colours" csv "$tmp/l.csv" \
            'len({k[0] for k in by} & {"rtcIntersect16; incoherent", "rtcIntersect16; one pass"}) == 1 and all(abs(int(r["rays"]) / int(by["leafcast", "-"]["rays"]) - 1) < 0.005 and int(r["rays"]) > 39000 for r in t if r["rays"] != "-") and 20 * int(by["rtcIntersect16", "medium"]["far px"]) < int(by["leafcast", "-"]["hits"])'
    done
    exits "all layers" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 203x190 --runs 1 --opacity 0.3 -o "$tmp/a.csv"
    ok "are as many, however they are found" csv "$tmp/a.csv" \
        '("rtcIntersect16; one pass", "medium") in by and all(abs(int(r["surfaces"]) / int(by["leafcast", "-"]["surfaces"]) - 1) < 0.02 and int(r["surfaces"]) > 3 * int(by["leafcast", "-"]["hits"]) for r in t if r["surfaces"] != "-")'
    ok "and as bright" csv "$tmp/a.csv" 'float(by["rtcIntersect16", "medium"]["colour rms"]) < 0.04'
    exits "two layers" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 203x190 --runs 1 --opacity 0.3 --layers 2 -o "$tmp/b.csv"
    ok "are two at most" csv "$tmp/b.csv" \
        'all(1.5 * int(by["leafcast", "-"]["hits"]) < int(r["surfaces"]) <= 2 * int(by["rtcIntersect16", "medium"]["hits"]) for r in t if r["surfaces"] != "-")'
    exits "thin layers" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 16x16 --runs 1 --opacity 0.1 -o "$tmp/c.csv"
    ok "are too many for one pass" csv "$tmp/c.csv" '("rtcIntersect16; one pass", "medium") not in by'
    # A mesh's triangles are its surface: the same picture but for floats.
    run "$leafcast" generate buckyball --tets --dims 16 -o "$tmp/m.mesh"
    run "$leafcast" convert "$tmp/m.mesh" -o "$tmp/m.leaf" -q
    for what in "--light 0,1,2 --shadows" "--opacity 0.3"; do
        exits "a mesh, $what" 0 "$leafcast" bench peers "$tmp/m.leaf" --iso 0.3 --size 203x190 --runs 1 $what --force -o "$tmp/m.csv"
        ok "as many surfaces and rays" csv "$tmp/m.csv" \
            'all(abs(int(r[c]) - int(by["leafcast", "-"][c])) < 5 for c in ("surfaces", "rays") for r in t if r[c] != "-" and "alone" not in r["contestant"])'
        ok "and the same colours" csv "$tmp/m.csv" \
            'int(by["rtcIntersect16", "medium"]["far px"]) < 5 and float(by["rtcIntersect16", "medium"]["colour rms"]) < 0.005'
    done
    # A surface itself: the file's triangles are Embree's. Layers begin a little behind the last one there.
    run "$leafcast" export "$leaf" --iso 127.5 -o "$tmp/s.ply" -q
    run "$leafcast" convert "$tmp/s.ply" --normals flat -o "$tmp/given.leaf" -q
    exits "of a surface an isovalue" 2 "$leafcast" bench peers "$tmp/given.leaf" --iso 1 --size 16x16 --runs 1
    for what in "--light 0,1,2 --shadows" "--opacity 0.3"; do
        exits "a surface, $what" 0 "$leafcast" bench peers "$tmp/given.leaf" --size 203x190 --runs 1 $what --force -o "$tmp/g.csv"
        ok "the same surfaces" csv "$tmp/g.csv" \
            'all(abs(int(r["surfaces"]) / int(by["leafcast", "-"]["surfaces"]) - 1) < 0.001 for r in t if r["surfaces"] != "-" and "alone" not in r["contestant"]) and int(by["leafcast", "-"]["hits"]) > 5000'
        ok "in the same pixels and colours" csv "$tmp/g.csv" \
            'int(by["rtcIntersect16", "medium"]["only peer"]) + int(by["rtcIntersect16", "medium"]["only ours"]) < 5 and float(by["rtcIntersect16", "medium"]["p99 cells"]) < 0.01 and float(by["rtcIntersect16", "medium"]["colour rms"]) < 0.01'
        ok "nothing is extracted" csv "$tmp/g.csv" 'all("new isovalue" not in r["contestant"] for r in t)'
    done
    # Seen from inside, turned, mirrored, sheared and far from the origin.
    exits "from inside" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 64x64 --runs 1 --eye 62,62,120 --look-at 80,40,20 -o "$tmp/i.csv"
    ok "sees the same" csv "$tmp/i.csv" \
        'int(by["leafcast", "-"]["hits"]) > 1000 and int(by["rtcIntersect16", "medium"]["only peer"]) + int(by["rtcIntersect16", "medium"]["only ours"]) < 10 and float(by["rtcIntersect16", "medium"]["median cells"]) < 0.03'
    run "$leafcast" generate sphere --dims 64 -o "$tmp/s.nrrd"
    sed 's/^space directions:.*/space directions: (0,0,1.5) (-2,0,0) (0,1,0.25)/; s/^space origin:.*/space origin: (100000,5,7)/' "$tmp/s.nrrd" >"$tmp/t.nrrd"
    run "$leafcast" convert "$tmp/t.nrrd" -o "$tmp/t.leaf" -q
    exits "in a space of its own" 0 "$leafcast" bench peers "$tmp/t.leaf" --iso 127.5 --size 203x190 --runs 1 -o "$tmp/t.csv"
    ok "sees the same there" csv "$tmp/t.csv" \
        'int(by["leafcast", "-"]["hits"]) > 3000 and int(by["rtcIntersect16", "medium"]["only peer"]) + int(by["rtcIntersect16", "medium"]["only ours"]) < 5 and float(by["rtcIntersect16", "medium"]["p99 cells"]) < 0.3 and float(by["rtcIntersect16", "medium"]["colour rms"]) < 0.02'
    exits "side by side" 0 "$leafcast" bench peers "$leaf" --iso 127.5 --size 64x48 --runs 1 --picture "$tmp/p.png"
    ok "three pictures wide" [ "$(od -An -tx1 -j16 -N8 "$tmp/p.png" | tr -d ' ')" = 000000c000000030 ]
fi
if grep -q 'no VTK' "$tmp/said"; then
    ok "says what to install" grep -q python3-vtk9 "$tmp/said"
    skip "VTK" "no VTK here (python3-vtk9)"
elif ! grep -q 'no Embree' "$tmp/said"; then
    ok "VTK finds as many triangles" csv "$tmp/p.csv" \
        'by["VTK flying edges", "-"]["triangles"] == by["rtcIntersect16", "medium"]["triangles"]'
fi

# ---- media ----
exits "media with an isovalue" 2 "$leafcast" bench peers "$leaf" --media --iso 127.5
exits "a transfer function of nothing" 2 "$leafcast" bench peers "$leaf" --iso 127.5 --tf auto
exits "steps of media" 2 "$leafcast" bench peers "$leaf" --media --step 1
exits "no such transfer function" 2 "$leafcast" bench peers "$leaf" --media --tf nothing
sed 's/^space directions:.*/space directions: (0,1.5,0) (-1.5,0,0) (0,0,1.5)/; s/^space origin:.*/space origin: (1000,5,7)/' "$tmp/v.nrrd" >"$tmp/turned.nrrd"
run "$leafcast" convert "$tmp/turned.nrrd" -o "$tmp/turned.leaf" -q
for file in v turned; do
    exits "$file: media" 0 "$leafcast" bench peers "$tmp/$file.leaf" --media --tf positive --tf auto --size 61x53 --runs 1 --threads 2 --force -o "$tmp/m.csv" --plot "$tmp/m.svg"
    ok "ours are within what was asked for" csv "$tmp/m.csv" \
        'len({r["setting"] for r in t if r["contestant"] == "leafcast"}) == 7 and all(float(r["worst"]) <= float(fractions.Fraction(r["setting"])) for r in t if r["contestant"] == "leafcast")'
    if grep -q 'no VTK' "$tmp/err"; then
        ok "says what to install" grep -q python3-vtk9 "$tmp/err"
        skip "$file: VTK's ray caster" "no VTK here (python3-vtk9)"
    else
        ok "VTK sees about the same, in two types and three distances" csv "$tmp/m.csv" \
            'len({(r["contestant"], r["setting"]) for r in t if r["contestant"][:3] == "VTK"}) == 6 and all(float(r["rms"]) < 0.04 and float(r["99 %"]) < 0.12 and (r["opacity off"] == "-") == (r["contestant"] == "leafcast") and (r["opacity off"] == "-" or float(r["opacity off"]) < 1e-4) for r in t)'
        ok "ratios are of times" csv "$tmp/m.csv" \
            'all(abs(float(r["ms"]) / float(r["x ours"]) / min(float(o["ms"]) for o in t if o["transfer"] == r["transfer"] and o["contestant"] == "leafcast" and float(o["worst"]) <= float(r["worst"])) - 1) < 0.01 for r in t if r["x ours"] != "-")'
    fi
done
finish
