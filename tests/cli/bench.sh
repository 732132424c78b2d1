#!/bin/sh
# bench.sh - leafcast bench: that its tables hold what is true whatever the machine's speed.
# marks: plain, long
. tests/support/tap.sh

leaf=$tmp/v.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
csv() { # csv FILE EXPRESSION: python, with the rows as dictionaries in t
    python3 -c 'import csv, fractions, sys
t = list(csv.DictReader(open(sys.argv[1])))
sys.exit(not eval(f"({sys.argv[2]})"))' "$@"
}
run "$leafcast" generate noise --dims 40 -o "$tmp/v.nrrd"
run "$leafcast" convert "$tmp/v.nrrd" -o "$leaf" -q

judge() { # judge FILE FIELDS
    ok "six intersectors a field" csv "$1" "len(t) == 6 * $2"
    ok "marmitt misses nothing, makes nothing up, is exact" csv "$1" \
        'all(r["missed"] == r["false"] == "0" and float(r["worst cells"]) < 1e-9 for r in t if r["intersector"] == "marmitt")'
    ok "marmitt-3 misses nothing, but is off" csv "$1" \
        'all(r["missed"] == r["false"] == "0" and 1e-9 < float(r["worst cells"]) < 1 for r in t if r["intersector"] == "marmitt-3")'
    ok "linear and neubauer miss the same, make nothing up" csv "$1" \
        'len({(r["field"], r["missed"], r["false"]) for r in t if r["intersector"] in ("linear", "neubauer")}) == '"$2"' and all(r["false"] == "0" for r in t if r["intersector"] == "linear")'
    ok "SIMD gives the same bits" csv "$1" 'all(r["differ"] == "0" and float(r["16: scalar ns"]) > 0 for r in t if r["intersector"] == "marmitt")'
    ok "times are there, with their spread" csv "$1" 'all(float(r["ns/ray-cell"]) > 0 and float(r["+-"]) >= 0 for r in t)'
}
exits "built-in fields" 0 "$leafcast" bench intersectors --form brief --ray-cells 20000 -o "$tmp/i.csv" --plot "$tmp/i.svg"
ok "a table on standard output" says '^marschner-lobb *neubauer' out
ok "and what it was measured on" says "CPUs, .*; $(date -u +%Y-%m)-[0-9]*; leafcast [0-9.]*" out
numbers=$(awk -F': ' '/^cpu family/ {f = $2} /^model\t/ && f {print "(family " f ", model " $2 ")"; exit}' /proc/cpuinfo)
ok "and the CPU's numbers, if it has any" says "${numbers:-CPUs}" out
judge "$tmp/i.csv" 2
ok "and as bars" python3 -c 'import sys, xml.dom.minidom as x; sys.exit(x.parse(sys.argv[1]).getElementsByTagName("rect").length != 25)' "$tmp/i.svg"
exits "an existing table" 1 "$leafcast" bench intersectors --ray-cells 100 -o "$tmp/i.csv"
exits "a treelet file" 0 "$leafcast" bench intersectors "$leaf" --iso 128 --size 200x200 --ray-cells 20000 --runs 3 -o "$tmp/f.csv"
judge "$tmp/f.csv" 1
exits "E1" 0 "$leafcast" bench walk "$leaf" --iso 128 --size 64x64 --runs 3 -o "$tmp/w.csv"
ok "three ways see the same" csv "$tmp/w.csv" 'len(t) == 3 and len({r["roots/ray"] for r in t}) == 1'
exits "E2" 0 "$leafcast" bench kernel "$leaf" --iso 128 --size 64x64 -o "$tmp/k.csv"
ok "the filter never disagrees" csv "$tmp/k.csv" 't[0]["disagreements"] == "0" and int(t[0]["ray-cells"]) > 1000'
exits "figure 4.9" 0 "$leafcast" bench figure49 -o "$tmp/f.png" --size 100x100
ok "is a picture" [ -s "$tmp/f.png" ]
ok "with a hole on the left" awk '$1 == "neubauer" { exit !($4 > 0 && $3 > 0) }' "$tmp/out"

# Suites of whole frames: what every kernel must agree on.
judge_frames() { # judge_frames FILE ROWS-AT-LEAST
    ok "every kernel draws the same, and finds the same" csv "$1" \
        "len(t) >= $2"' and all(r["differ"] == "0" for r in t) and len({(r["volume"], r["view"], r["zoom"], r["size"], r["roots/ray"]) for r in t}) == sum(r["isa"] == "scalar" for r in t)'
    ok "time, bytes and memory are there" csv "$1" \
        'all(float(r[c]) > 0 for r in t for c in ("ms", "Mray/s", "active MB", "read MB", "peak MB")) and all(float(r["read MB"]) <= float(r["active MB"]) for r in t)'
}
exits "all suites, in brief" 0 "$leafcast" bench all --out "$tmp/all" --runs 1 --ray-cells 2000 --size 48x48
for suite in $("$leafcast" bench --help-all | sed -nE '/^Suites/,$s/^  ([a-z][a-z0-9]*).*/\1/p' | grep -v -e all -e figure49 -e peers); do
    ok "$suite: CSV and SVG" [ -s "$tmp/all/$suite.csv" -a -s "$tmp/all/$suite.svg" ]
    ok "$suite: sound SVG" python3 -c 'import sys, xml.dom.minidom as x; x.parse(sys.argv[1])' "$tmp/all/$suite.svg"
done
judge_frames "$tmp/all/steps.csv" 12
ok "by faces the same, in two to three tests a tet" csv "$tmp/all/plucker.csv" \
    'len(t) == 6 and all(r["differ"] == "0" for r in t) and all(2 <= float(r["tests/tet"]) <= 3 and float(r["tets/ray"]) > 1 for r in t if r["way"] == "faces") and all(r["tests/tet"] == "-" for r in t if r["way"] == "tree")'
ok "hexes: every way, of both grids, and what none of it may lose" csv "$tmp/all/hexes.csv" \
    'len(t) == 24 and all(float(r["fps"]) > 0 for r in t) and all(int(r["lost"]) <= 40 for r in t if r["lost"] != "-")'
ok "hexes: two tests a cell at least, and by patches fewer tests and less error" csv "$tmp/all/hexes.csv" \
    'all(float(r["tests/hex"]) >= 2 for r in t if r["tests/hex"] != "-") and all(float(b["tests/hex"]) < float(a["tests/hex"]) and (a["draws"] != "iso" or float(b["t mean"]) < float(a["t mean"]) < 0.1) for a, b in zip(t, t[1:]) if (a["way"], b["way"]) == ("pluecker", "hybrid"))'
ok "hexes: nearly all exact hits, and none made up by patches" csv "$tmp/all/hexes.csv" \
    'all(int(r["missed"]) + int(r["false"]) < 0.03 * int(r["hits"]) for r in t if r["t mean"] != "-") and all(r["false"] == "0" for r in t if r["draws"] == "iso" and r["way"] == "hybrid")'
judge_frames "$tmp/all/frames.csv" 16
judge_frames "$tmp/all/figure414.csv" 4
judge_frames "$tmp/all/zoom.csv" 42
ok "figure 4.14 begins at itself" csv "$tmp/all/figure414.csv" 't[0]["x smallest"] == "1.000" and int(t[-1]["samples"]) == 64'
ok "the exact picture has no error, and is on the front" csv "$tmp/all/pareto.csv" \
    'float(t[0]["rms cells"]) == float(t[0]["worst cells"]) == 0 == int(t[0]["wrong px"]) and t[0]["front"] == "front" and t[0]["intersector"] == "marmitt"'
ok "nobody on the front is beaten" csv "$tmp/all/pareto.csv" \
    'all(not (float(a["ms"]) < float(b["ms"]) and float(a["rms cells"]) < float(b["rms cells"]) and int(a["wrong px"]) < int(b["wrong px"])) for b in t if b["front"] == "front" for a in t)'
ok "threads draw the same" csv "$tmp/all/threads.csv" 'all(r["differ"] == "0" for r in t) and t[0]["frame/loop"] == "1.000"'
ok "behind: the same pixels as one by one" csv "$tmp/all/behind.csv" \
    'len(t) == 8 and t[0]["x opaque"] == t[4]["x opaque"] == "1.000" and all(r["differ"] == r["colours differ"] == "0" for r in t)'
run "$leafcast" generate sphere --dims 32 --type f32 -o "$tmp/s.nrrd"
run "$leafcast" convert "$tmp/s.nrrd" -o "$tmp/s.leaf" -q
exits "behind a sphere's front" 0 "$leafcast" bench behind "$tmp/s.leaf" --iso 0.6 --size 64x64 --runs 1 -o "$tmp/b.csv"
ok "is its back" csv "$tmp/b.csv" '[r["surfaces/hit"] for r in t] == ["1.0000", "1.0000", "2.0000", "2.0000"]'
ok "rays go to the light where it shines" csv "$tmp/b.csv" \
    '[r["rays/px"] == "1.0000" for r in t] == [True, False, True, True] and 1 < float(t[1]["rays/px"]) < 1 + float(t[1]["hit px"]) / 64 ** 2'
exits "with lights of one's own" 0 "$leafcast" bench behind "$tmp/s.leaf" --iso 0.6 --size 64x64 --runs 1 --light 0,1,2 --light 0,1,2 --force -o "$tmp/c.csv"
ok "twice the rays" python3 -c 'import csv, sys
one, two = (float(list(csv.DictReader(open(f)))[1]["rays/px"]) - 1 for f in sys.argv[1:])
sys.exit(abs(two - 2 * one) > 2e-4)' "$tmp/b.csv" "$tmp/c.csv"
exits "lanes" 0 "$leafcast" bench lanes "$leaf" --iso 128 --size 48x48 --threads 1 -o "$tmp/n.csv"
exits "frames" 0 "$leafcast" bench frames "$leaf" --iso 128 --size 48x48 --runs 3 --threads 1 -o "$tmp/m.csv"
ok "count each cell that frames count, and each surface" python3 -c 'import csv, sys
lanes, frames = (list(csv.DictReader(open(f))) for f in sys.argv[1:])
def count(isa, *stages): return sum(int(r["lanes"]) for r in lanes if r["isa"] == isa and r["stage"] in stages)
def near(a, b): return abs(a - 48 ** 2 * float(b)) < 2
here = [r for r in frames if r["view"] == "standard" and r["isa"] in ("sse42", "avx2", "avx512")]
sys.exit(not all(near(count(r["isa"], "visitors", "groups"), r["cells/ray"]) and near(count(r["isa"], "roots"), r["roots/ray"]) for r in here))' "$tmp/n.csv" "$tmp/m.csv"
ok "fewer from stage to stage, in lanes that there are" csv "$tmp/n.csv" \
    'all(0 <= float(r["filled %"]) <= 100 and int(r["lanes"]) > 0 for r in t) and all(a["isa"] != b["isa"] or int(b["lanes"]) <= int(a["lanes"]) for a, b in zip(t, t[1:]) if b["stage"] in ("visitors", "survivors", "queue", "queue_survivors", "roots"))'
"$leafcast" generate buckyball --tets --dims 12 --replicate 4 -o - | "$leafcast" convert - -o "$tmp/balls.leaf" -q
exits "lanes of small tets" 0 "$leafcast" bench lanes "$tmp/balls.leaf" --iso 0.3 --size 100x100 --threads 1 -o "$tmp/t.csv"
ok "fewer tets from stage to stage, and polygons by the vector" python3 -c 'import csv, sys
t = list(csv.DictReader(open(sys.argv[1])))
for isa in {r["isa"] for r in t}:
    n = {r["stage"]: int(r["lanes"]) for r in t if r["isa"] == isa}
    full = {r["stage"]: float(r["filled %"]) for r in t if r["isa"] == isa}
    assert n["covers"] < 0.5 * n["tets"] and n["covering"] < 0.55 * n["covers"] and n["looked_at"] < 0.7 * n["covering"]
    assert n["polygons"] == n["looked_at"] and full["polygons"] > 85 and full["rays"] > 80
    assert n["polygons_hit"] > 0.85 * n["polygons"] and n["rays"] < 1.2 * n["polygons"]' "$tmp/t.csv"
judge_time() { # judge_time FILE ROWS
    ok "time: pictures are those of the step alone, and show something" csv "$1" \
        "len(t) == $2"' and all(r["differ"] == "0" and int(r["hits"]) > 100 for r in t)'
    ok "time: every way finds the same" csv "$1" \
        'len({(r["series"], r["size"], r["hits"]) for r in t}) == len(t) // 2'
    ok "time: what it takes" csv "$1" 'all(float(r[c]) > 0 for r in t for c in ("fps", "first fps", "same fps", "cpu ms", "first MB", "resident MB", "peak MB"))'
}
judge_time "$tmp/all/time.csv" 16
ok "time: of the drop, a part is read; of jets and vortex all of every step" csv "$tmp/all/time.csv" \
    'all(int(r["loads"]) == 40 for r in t if r["series"] in ("jets-64", "vortex-64")) and all(int(r["loads"]) < 36 for r in t if r["series"] == "drop-64")'
"$leafcast" generate jets --dims 40 --steps 4 --type f32 -o "$tmp/j.nrrd" -q
for codec in none zstd; do
    run "$leafcast" convert "$tmp/j_%04d.nrrd" --compress $codec -o "$tmp/j_$codec.leaf" -q
    exits "time of a grid's steps, $codec" 0 "$leafcast" bench time "$tmp/j_$codec.leaf" --iso 0.6 --size 64x64 --runs 2 -o "$tmp/j_$codec.csv"
    judge_time "$tmp/j_$codec.csv" 4
done
# A step alone that is another one is found out.
exits "time, files kept" 0 "$leafcast" bench time --form brief --runs 1 --size 48x48 --scratch "$tmp/series" -o "$tmp/one.csv"
cp "$tmp/series"/vortex-64-vortex-steps.leaf.0001 "$tmp/series"/vortex-64-vortex-steps.leaf.0003
exits "time, with a wrong step alone" 0 "$leafcast" bench time --form brief --runs 1 --size 48x48 --scratch "$tmp/series" -o "$tmp/two.csv"
ok "which is seen" csv "$tmp/two.csv" 'all((int(r["differ"]) > 200) == (r["series"] == "vortex-64") for r in t)'
# What a change of steps costs: no more than is new, and its masks are those of the step alone.
judge_update() { # judge_update FILE SERIES
    ok "update: masks are those of the step alone" csv "$1" "len(t) >= 2 * $2"' and all(r["differ"] == "0" for r in t)'
    ok "update: no more is new than is held, and that is loaded" csv "$1" \
        'all(0 < float(r["new"]) <= float(r["treelets"]) and float(r["MB"]) > 0 and float(r["ms"]) >= 0 for r in t)'
    ok "update: the surface is in fewer cells" csv "$1" \
        'all(int(a["cells"]) < int(b["cells"]) for a in t for b in t if a["series"] == b["series"] and (a["asked"], b["asked"]) == ("surface", "all values"))'
}
judge_update "$tmp/all/update.csv" 3
ok "update: of all values, every cell of every step" csv "$tmp/all/update.csv" 'all(r["cells"] == str(5 * 63 ** 3) for r in t if r["asked"] == "all values")'
ok "update: jets and vortex are new at every step, of the drop a part" csv "$tmp/all/update.csv" \
    'all((r["new"] == r["treelets"] == "8.0") == (r["series"] != "drop-64") for r in t if r["asked"] == "all values")'
exits "update, with a wrong step alone" 0 "$leafcast" bench update --form brief --runs 1 --scratch "$tmp/series" -o "$tmp/up.csv"
ok "which is seen" csv "$tmp/up.csv" 'all((r["differ"] == "8") == (r["series"] == "vortex-64" and r["asked"] == "surface") for r in t)'
for codec in none zstd; do
    exits "update of a file, $codec" 0 "$leafcast" bench update "$tmp/j_$codec.leaf" --iso 0.6 --runs 2 --threads 1 --force -o "$tmp/up.csv"
    judge_update "$tmp/up.csv" 1
done
exits "update of a mesh" 3 "$leafcast" bench update "$tmp/balls.leaf" --iso 0.3
ok "is refused for that" says 'no time series of a grid' err
exits "of a single step" 3 "$leafcast" bench update "$leaf" --iso 128
exits "update draws nothing" 2 "$leafcast" bench update --size 9x9
# One tree over treelets and steps: whatever its order, it finds what a look at all ranges does.
# Triangles that move: no tree finds anything else than boxes built anew do, wherever it was built.
ok "dynamic: every tree, every state, and the same hits" csv "$tmp/all/dynamic.csv" \
    'len(t) == 36 and all(r["differ"] == "0" and int(r["hits"]) > 50 for r in t) and
     len({(r["scene"], r["state"], r["hits"]) for r in t}) == 12'
ok "dynamic: a walk keeps neighbours together, an explosion does not" csv "$tmp/all/dynamic.csv" \
    'all(float(a["nodes/ray"]) < 1.5 * float(b["nodes/ray"]) for a in t for b in t
         if a["scene"] == b["scene"] == "walker" and a["tree"] == b["tree"] == "boxes/rays" and (a["state"], b["state"]) == ("moved", "anew")) and
     all(float(a["nodes/ray"]) > 2 * float(b["nodes/ray"]) for a in t for b in t
         if a["scene"] == b["scene"] == "explosion" and a["tree"] == b["tree"] != "boxes/tiles" and (a["state"], b["state"]) == ("moved", "anew"))'
ok "terrain: a wood that grows, whose rays ask few objects, and the same hits" csv "$tmp/all/terrain.csv" \
    'len(t) == 4 and all(r["differ"] == "0" and int(r["hits"]) > 500 and float(r["asked/ray"]) < 40 for r in t) and
     [int(r["objects"]) > 1000 * 4 * 16 ** 0 * 4 ** i for i, r in enumerate(t)] == [True] * 4'
exits "terrain takes no file" 2 "$leafcast" bench terrain "$leaf"
exits "dynamic takes no file" 2 "$leafcast" bench dynamic "$leaf" --iso 128
judge_time4d() { # judge_time4d FILE SERIES
    ok "time4d: every order finds the same, and something" csv "$1" \
        "len(t) == 5 * $2"' and all(r["differ"] == "0" and int(r["met"]) > 10 for r in t) and
         len({(r["series"], r["met"]) for r in t}) == len(t) // 5'
    ok "time4d: M08's order costs no more than a tree a step, but for the way to it" csv "$1" \
        'all(float(a["step nodes"]) <= float(b["step nodes"]) + 2 * int(a["steps"]).bit_length() for a in t for b in t
         if a["series"] == b["series"] and (a["order"], b["order"]) == ("most overlap (M08)", "a tree a step"))'
}
judge_time4d "$tmp/all/time4d.csv" 4
"$leafcast" generate drop --dims 97 --steps 12 -o "$tmp/fall.nrrd" -q
run "$leafcast" convert "$tmp/fall_%04d.nrrd" --treelet 16 -o "$tmp/fall.leaf" -q
exits "time4d of a file" 0 "$leafcast" bench time4d "$tmp/fall.leaf" --iso 127.5 --size 32x32 --runs 2 -o "$tmp/fall.csv"
judge_time4d "$tmp/fall.csv" 1
ok "time4d: ranges are passed over" csv "$tmp/fall.csv" \
    'all(float(a[c]) < 0.7 * float(b[c]) for a in t for b in t for c in ("step nodes", "series nodes", "sweep nodes")
     if (a["order"], b["order"]) == ("most overlap (M08)", "all ranges"))'
exits "time4d of a single step" 3 "$leafcast" bench time4d "$leaf" --iso 128
ok "is refused for that" says 'no time series' err
judge_media() { # judge_media FILE PICTURES
    ok "media: what is certified is within its claim, and that within what was asked for" csv "$1" \
        'all(float(r["worst"]) <= float(r["claimed"]) + float(r["ref bound"]) and float(r["claimed"]) <= float(fractions.Fraction(r["setting"])) for r in t if r["way"] == "certified")'
    ok "media: what is not claims nothing" csv "$1" 'all((r["claimed"] == "-") == (r["way"] not in ("certified", "threshold")) for r in t)'
    ok "media: a threshold says what comes of it" csv "$1" 'all(float(r["worst"]) <= float(r["claimed"]) + float(r["ref bound"]) for r in t if r["way"] == "threshold")'
    ok "media: errors are in order, time is there" csv "$1" \
        'all(0 <= float(r["99 %"]) <= float(r["worst"]) and 0 < float(r["rms"]) <= float(r["worst"]) and float(r["ms"]) > 0 and (float(r["> 1/510 %"]) > 0) == (float(r["worst"]) > 1 / 510) for r in t)'
    ok "media: small steps are nearer than large ones" csv "$1" \
        "len(t) == $2"' * len([r for r in t if r["transfer"] == t[0]["transfer"]]) and all(30 * float(b["rms"]) < float(a["rms"]) for a in t if (a["way"], a["setting"]) == ("steps", "1") for b in t if (b["transfer"], b["way"], b["setting"]) == (a["transfer"], "steps", "1/16"))'
    # Times are rounded to a hundredth of a millisecond.
    ok "media: the ratio is that of times" csv "$1" \
        'all(r["steps/this"] in ("-", "not reached") or min(float(o["ms"]) for o in t if o["transfer"] == r["transfer"] and o["way"] == "steps") - 0.006 < 1.01 * float(r["steps/this"]) * (float(r["ms"]) + 0.006) and 0.99 * float(r["steps/this"]) * (float(r["ms"]) - 0.006) < 0.006 + min(float(o["ms"]) for o in t if o["transfer"] == r["transfer"] and o["way"] == "steps" and float(o["worst"]) <= float(r["worst"]) * 1.001) for r in t)'
}
judge_media "$tmp/all/media.csv" 3
exits "media of a file" 0 "$leafcast" bench media "$leaf" --tf ct --tf thin --size 24x24 --runs 1 --clip-box 0,0,0,20,40,40 -o "$tmp/media.csv"
judge_media "$tmp/media.csv" 2
exits "projections" 0 "$leafcast" bench projections "$leaf" --iso 128 --size 40x30 --runs 1 -o "$tmp/x.csv"
for file in "$tmp/all/projections.csv" "$tmp/x.csv"; do
    ok "projections: values are those of single rays" csv "$file" 'len(t) == 5 and all(r["differ"] == "0" for r in t)'
    ok "projections: no more is read than may be needed" csv "$file" \
        'all(0 < int(r["read"]) <= int(r["active"]) and float(r["ms"]) > 0 for r in t) and t[0]["draws"] == "surface" and t[0]["x surface"] == "1.000"'
    ok "projections: each sees the volume" csv "$file" \
        'len({r["px"] for r in t if r["draws"] in ("max", "min", "mean")}) == 1 and all(0 < int(r["px"]) <= int(t[1]["px"]) for r in t)'
done
exits "no such transfer function" 2 "$leafcast" bench media "$leaf" --tf nothing --size 24x24 --runs 1
exits "all, once more" 1 "$leafcast" bench all --out "$tmp/all"
exits "all of a file" 2 "$leafcast" bench all "$leaf" --iso 128 --out "$tmp/all2"
exits "a suite of a file" 0 "$leafcast" bench zoom "$leaf" --iso 128 --size 32x32 --runs 1
ok "names it" says '^v.leaf  *inside' out
exits "volumes kept" 0 env LEAFCAST_DATA= TMPDIR="$tmp/nowhere" "$leafcast" bench walk --form brief --runs 1 --size 16x16 --scratch "$tmp/kept"
ok "in the scratch folder" [ -s "$tmp/kept/marschner-lobb-u8-32.leaf" ]
exits "a data folder that is not there" 1 "$leafcast" bench walk --form brief --runs 1 --size 16x16 --data "$tmp/no"
ok "is named" says 'no: cannot read the data folder' err
mkdir "$tmp/empty"
exits "volumes not kept" 0 env TMPDIR="$tmp/empty" "$leafcast" bench walk --form brief --runs 1 --size 16x16
ok "leave nothing" rmdir "$tmp/empty"

exits "no such suite" 2 "$leafcast" bench nonsense
exits "no such field" 2 "$leafcast" bench intersectors plaid
exits "no such form" 2 "$leafcast" bench intersectors --form long
exits "a file without an isovalue" 2 "$leafcast" bench kernel "$leaf"
exits "an isovalue that meets nothing" 2 "$leafcast" bench kernel "$leaf" --iso 1000
finish
