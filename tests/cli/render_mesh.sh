#!/bin/sh
# render_mesh.sh - pictures and probes of meshes: from every kernel, budget and compression the same
# distances; what a mesh does not have is refused.
# marks: threads, long, leaks
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/$2"; }
json() { # json EXPRESSION: python, with what was printed as j
    python3 -c 'import json, sys
j = json.load(open(sys.argv[1]))
sys.exit(not eval(f"({sys.argv[2]})"))' "$tmp/out" "$1"
}
draw() { # draw NAME FILE OPTION...
    name=$1
    shift
    exits "drawn: $name" 0 "$leafcast" render "$@" --iso 0.3 --size 160x120 -o "$tmp/p.pfm" --force \
        --depth-f64 "$tmp/$name.depth" --stats "$tmp/$name.json"
}
alike() { cmp -s "$tmp/$1.depth" "$tmp/$2.depth"; }

"$leafcast" generate buckyball --tets --dims 24 -o "$tmp/b.mesh" -q
exits "a mesh" 0 "$leafcast" convert "$tmp/b.mesh" -o "$tmp/b.leaf" -q
exits "cut finer, compressed" 0 "$leafcast" convert "$tmp/b.mesh" --treelet-tets 400 --compress zstd:3 -o "$tmp/z.leaf" -q

draw one "$tmp/b.leaf" --isa scalar --threads 1
draw tiles "$tmp/b.leaf" --threads 2
ok "tiles see what single rays see" alike one tiles
draw mapped "$tmp/b.leaf" --backend mapped
ok "mapped, too" alike one mapped
draw finer "$tmp/z.leaf"
ok "in smaller treelets, too" alike one finer
draw tight "$tmp/z.leaf" --memory 4M --threads 1
ok "with little memory, too" alike one tight
ok "which then holds" python3 -c 'import json, sys
sys.exit(json.load(open(sys.argv[1]))["peak_budget_bytes"] > 4 << 20)' "$tmp/tight.json"
draw limited "$tmp/z.leaf" --treelet-limit 1
ok "and with one treelet at a time" alike one limited
draw swept "$tmp/z.leaf" --sweep
ok "and with all of them" alike one swept
exits "too little memory" 4 "$leafcast" render "$tmp/z.leaf" --iso 0.3 --memory 140K -o "$tmp/p.pfm" --force
ok "is told with what would do" says "bytes would do" err

exits "no intersector to choose" 2 "$leafcast" render "$tmp/b.leaf" --iso 0.3 --intersector linear -o "$tmp/p.pfm" --force
ok "is said" says "intersectors are for grids" err
exits "no coarse level" 2 "$leafcast" render "$tmp/b.leaf" --iso 0.3 --lod 1 -o "$tmp/p.pfm" --force
ok "is said, too" says "no coarse levels" err
exits "nor in a preview, without a coarse grid" 2 "$leafcast" render "$tmp/b.leaf" --iso 0.3 --lod 1 --preview -o "$tmp/p.pfm" --force
ok "which is said" says "coarse grid" err
exits "with one" 0 "$leafcast" convert "$tmp/b.mesh" --coarse -o "$tmp/c.leaf" -q
exits "there is one" 0 "$leafcast" render "$tmp/c.leaf" --iso 0.3 --lod 1 --preview -o "$tmp/p.pfm" --size 32x32 --force
ok "all of it provisional" says "1024 pixels are provisional" err

exits "gradients, too" 0 "$leafcast" convert "$tmp/b.mesh" --gradients -o "$tmp/g.leaf" -q
exits "which are sound" 0 "$leafcast" verify "$tmp/g.leaf"
draw smooth "$tmp/g.leaf" --normals smooth
ok "change no distance" alike one smooth
exits "a smooth normal" 0 "$leafcast" probe "$tmp/g.leaf" --iso 0.3 --size 160x120 --at 70,60 --normals smooth --json
cp "$tmp/out" "$tmp/smooth.out"
exits "and a faceted one" 0 "$leafcast" probe "$tmp/g.leaf" --iso 0.3 --size 160x120 --at 70,60 --normals faceted --json
ok "differ, and little else" python3 -c 'import json, sys
a, b = (json.load(open(f))["hits"] for f in sys.argv[1:])
sys.exit(not (a and all(x["t"] == y["t"] and x["normal"] != y["normal"] and
    sum(p * q for p, q in zip(x["normal"], y["normal"])) > 0.5 for x, y in zip(a, b))))' "$tmp/smooth.out" "$tmp/out"
exits "smooth without gradients" 2 "$leafcast" render "$tmp/b.leaf" --iso 0.3 --normals smooth -o "$tmp/p.pfm" --force
ok "is said, with what to do" says "convert --gradients" err
exits "gradients of a volume" 2 "$leafcast" convert tests/cli/convert.sh --dims 2,2,2 --type u8 --gradients -o "$tmp/v.leaf"
ok "are refused" says "gradients is for meshes" err

exits "a pixel's ray" 0 "$leafcast" probe "$tmp/b.leaf" --iso 0.3 --size 160x120 --at 80,60 --json
ok "hits an even number of times" json 'j["count"] % 2 == 0'
ok "as the picture says" python3 -c 'import json, struct, sys
j = json.load(open(sys.argv[1]))
z = struct.unpack_from("<d", open(sys.argv[2], "rb").read(), 8 * (60 * 160 + 80))[0]
sys.exit(not (j["hits"][0]["t"] == z if j["count"] else z == float("inf")))' "$tmp/out" "$tmp/one.depth"
exits "the same from behind" 0 "$leafcast" probe "$tmp/b.leaf" --iso 0.3 --ray -5,11.4,11.3,1,0,0 --json
ok "hits in order, entering and leaving by turns" json '[h["side"] for h in j["hits"]] == ["entering", "leaving"] * (j["count"] // 2) and j["count"] > 0 and [h["t"] for h in j["hits"]] == sorted(h["t"] for h in j["hits"])'
ok "in tets whose values hold the isovalue" json 'all(min(h["values"]) < 0.3 <= max(h["values"]) for h in j["hits"])'
ok "with small bounds of their errors" json 'all(0 < h["error_bound"] < 1e-9 for h in j["hits"])'
exits "a point" 0 "$leafcast" probe "$tmp/b.leaf" --point 3.3,4.1,5.7 --json
ok "has a value between its tet's" json 'j["inside"] and min(j["values"]) <= j["value"] <= max(j["values"])'
exits "a point outside" 0 "$leafcast" probe "$tmp/b.leaf" --point -3,4,5 --json
ok "is told" json 'not j["inside"]'

# A square without volume, and a tet beside it.
printf '8 3 1\n0 0 0 1 -1\n1 1 0 1 1\n2 1 1 1 -1\n3 0 1 1 1\n4 3 0 0 -1\n5 4 0 0 1\n6 3 1 0 1\n7 3 0 1 1\n' >"$tmp/flat.node"
printf '2 4\n0 0 1 2 3\n1 4 5 6 7\n' >"$tmp/flat.ele"
run "$leafcast" convert "$tmp/flat.node" -o "$tmp/flat.leaf" -q
exits "a ray through a flat tet" 0 "$leafcast" probe "$tmp/flat.leaf" --iso 0 --ray 0.4,0.55,3,0,0,-1 --json
ok "hits it" json '[h["t"] for h in j["hits"]] == [2]'
ok "on no side" json 'j["hits"][0]["side"] == "flat tet"'
exits "one through a sound tet" 0 "$leafcast" probe "$tmp/flat.leaf" --iso 0 --ray 3.1,0.1,-3,0,0,1 --json
ok "enters" json '[h["side"] for h in j["hits"]] == ["entering"]'
finish
