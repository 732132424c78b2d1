#!/bin/sh
# convert_series.sh - leafcast convert of time series and of several fields: flags, exit codes, what it says, the same
# bytes; the artery of the data folder.
. tests/support/tap.sh

tools=${LEAFCAST_BUILD:-build/release}/tests
out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
same() { cmp -s "$tmp/$1" "$tmp/$2"; }
left() { [ "$(find "$tmp" -name '*.leaf*' | wc -l)" = "$1" ]; }
json() { python3 -c "import json, sys; x = json.load(open(sys.argv[1])); assert $1, x" "$tmp/out"; }

# Points that move: a series of generate's.
run "$leafcast" generate buckyball --tets --dims 24 --deform 0.9 --steps 4 -o "$tmp/b_%04d.mesh" -q
exits "a series" 0 "$leafcast" convert "$tmp"/b_000?.mesh -o "$out"
ok "tells its steps" says '^steps  *4$' out
ok "tells that points move" says '^points  *move from step to step$' out
exits "verify" 0 "$leafcast" verify "$out"
exits "info" 0 "$leafcast" info "$out"
ok "steps and times" says '^steps  *4, times 0 .. 3, vertices move$' out
ok "places by part" says '^later places  *[1-9]' out
ok "stored positions" says '^positions  *[1-9]' out
for how in "--threads 1" "--threads 3 --memory 10M" "--memory 6M --threads 1"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "convert $how" 0 "$leafcast" convert "$tmp"/b_000?.mesh -o "$tmp/b.leaf" --force $how
    ok "gives the same bytes" same a.leaf b.leaf
done
exits "at times of its own" 0 "$leafcast" convert "$tmp"/b_000?.mesh --times=-1,0,0.5,7 -o "$tmp/b.leaf" --force --json
ok "--json tells fields and steps" json 'x["steps"] == 4 and x["fields"] == ["buckyball"] and x["moving"]'
exits "info --json" 0 "$leafcast" info "$tmp/b.leaf" --json
ok "has the times" json 'x["times"] == [-1, 0, 0.5, 7] and x["moving"] and not x["gradients"]'
ok "has a range a step" json 'len(x["fields"][0]["step_ranges"]) == 4'
ok "its positions count" json 'x["parts"]["stored_positions"] > 0 and x["parts"]["moved"] == 3 * x["parts"]["positions"]'
exits "coarse grids, one a step" 0 "$leafcast" convert "$tmp"/b_000?.mesh --coarse=20 -o "$tmp/b.leaf" --force
ok "leave nothing behind" left 2
exits "info" 0 "$leafcast" info "$tmp/b.leaf" --json
ok "tells of four" json 'x["coarse_sets"] == 4'
exits "verify" 0 "$leafcast" verify "$tmp/b.leaf"
exits "--dry-run" 0 "$leafcast" convert "$tmp"/b_000?.mesh --dry-run --json
ok "reads it all" json 'x["steps"] == 4 and x["memory_least"] < x["memory_planned"]'

# Points that stay.
exits "of one file" 0 "$leafcast" convert "$tmp/b_0000.mesh" -o "$tmp/one.leaf"
exits "the same three times" 0 "$leafcast" convert "$tmp/b_0000.mesh" "$tmp/b_0000.mesh" "$tmp/b_0000.mesh" -o "$tmp/b.leaf" --force
ok "nothing moves" says '^points  *stay where they are$' out
exits "verify" 0 "$leafcast" verify "$tmp/b.leaf"
run "$leafcast" info "$tmp/b.leaf" --json
ok "positions are stored once" json 'x["parts"]["stored_positions"] == 0 and not x["moving"]'
ok "and values, too" json 'x["same_payloads"] == 2 * x["treelets"] and x["payload_bytes"] == x["parts"]["stored_topology"] + x["parts"]["stored_values"]'
for how in "--memory 6M --threads 1" "--compress zstd" "--gradients" "--compress zstd --gradients --threads 1"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "stays three times, $how" 0 "$leafcast" convert "$tmp/b_0000.mesh" "$tmp/b_0000.mesh" "$tmp/b_0000.mesh" -o "$tmp/c.leaf" --force $how
    exits "verify" 0 "$leafcast" verify "$tmp/c.leaf"
    exits "info" 0 "$leafcast" info "$tmp/c.leaf" --json
    ok "each block once" json 'x["same_payloads"] == 2 * x["treelets"] * (1 + x["gradients"])'
done
exits "there and back, moving" 0 "$leafcast" convert "$tmp/b_0000.mesh" "$tmp/b_0001.mesh" "$tmp/b_0001.mesh" "$tmp/b_0000.mesh" -o "$tmp/c.leaf" --force
exits "verify" 0 "$leafcast" verify "$tmp/c.leaf"
exits "info" 0 "$leafcast" info "$tmp/c.leaf" --json --iso 0.01
ok "values and places of the third are the second's" json 'x["same_payloads"] == 4 * x["treelets"] and x["moving"]'
ok "a value that is everywhere needs all that is stored, once" json 'x["isovalues"][0]["over_steps"]["treelets"] == x["treelets"] and x["isovalues"][0]["over_steps"]["bytes"] == x["payload_bytes"]'
for step in 1 2; do
    run "$leafcast" render "$tmp/c.leaf" --step $step --iso 0.3 --size 64x48 --depth-f64 "$tmp/d$step" -o "$tmp/p$step.ppm" -q
done
ok "which are drawn alike" same d1 d2
run "$leafcast" convert "$tmp/b_0000.mesh" "$tmp/b_0001.mesh" "$tmp/b_0001.mesh" "$tmp/b_0000.mesh" -o "$tmp/d.leaf" --memory 6M --threads 1
ok "the same bytes with little memory" same c.leaf d.leaf

# What cannot be.
rm "$tmp"/*.leaf
run "$leafcast" generate buckyball --tets --dims 23 -o "$tmp/other.mesh" -q
exits "another mesh" 3 "$leafcast" convert "$tmp/b_0000.mesh" "$tmp/other.mesh" -o "$out"
ok "is named, and the first tet that differs" says 'other.mesh: tet 0 has the vertices 0, .* as in .*b_0000.mesh' err
# The last tet's first vertex, of 4 bytes, becomes another.
size=$(wc -c <"$tmp/b_0001.mesh")
printf '\001' | dd of="$tmp/b_0001.mesh" bs=1 seek=$((size - 16)) conv=notrunc 2>/dev/null
exits "another tet" 3 "$leafcast" convert "$tmp"/b_000?.mesh -o "$out"
ok "is named by number" says 'b_0001.mesh: tet 73001 has the vertices' err
for wrong in "--times 1,2" "--times 1,2,3,4,5" "--times 1,2,2,3" "--times 1,x,3,4" "--field nothing" "--fields some" \
    "--fields all --field buckyball" "--field buckyball --field buckyball" "-"; do
    # shellcheck disable=SC2086
    exits "$wrong" 2 "$leafcast" convert "$tmp"/b_000?.mesh $wrong -o "$out"
done
ok "nothing is left" left 0

# Real: blood in an artery at five times.
series=$data/tet_artery_series
if [ -z "$data" ] || [ ! -d "$series" ] || [ ! -x "$tools/tool_raw_vtu" ]; then
    skip "the artery" "no $series"
    finish
fi
files=
for t in 0200 0400 0600 0800 1000; do
    "$tools/tool_raw_vtu" "$series/points_f64x3.raw.zst" "$series/tets_i32x4.raw.zst" "$tmp/artery_$t.vtu" \
        speed="$series/speed_t${t}_f32.raw.zst" pressure="$series/pressure_t${t}_f32.raw.zst" || files=none
    files="$files $tmp/artery_$t.vtu"
done
# shellcheck disable=SC2086
exits "two fields at five steps" 0 "$leafcast" convert $files --fields all --times 200,400,600,800,1000 -o "$out" --json
ok "all of it came in" json 'x["input_tets"] == 30136 and x["vertices"] == 5508 and x["fields"] == ["speed", "pressure"]'
ok "half of the tets are the other way round" json 'x["inverted"] == 15019'
exits "verify" 0 "$leafcast" verify "$out"
exits "info" 0 "$leafcast" info "$out" --json --iso 0.3
ok "times, and nothing moves" json 'x["times"] == [200, 400, 600, 800, 1000] and not x["moving"]'
ok "the speed at each step" json '[round(r[1], 4) for r in x["fields"][0]["step_ranges"]] == [0.9548, 0.4966, 0.3963, 0.3236, 0.2357]'
ok "the pressure at each step" json '[round(r[0], 3) for r in x["fields"][1]["step_ranges"]] == [0.217, 0.093, -0.01, -0.045, -0.059]'
ok "active tets of the first" json 'x["isovalues"][0]["active_tets"] > 1000'
sets=$(python3 -c 'import json, sys; x = json.load(open(sys.argv[1])); print("%.3f" % (x["parts"]["stored_values"] / 10 / x["tets"]))' "$tmp/out")
echo "# a further field or step takes $sets bytes a tet"
# shellcheck disable=SC2086
exits "as fields by name, the other way round" 0 "$leafcast" convert $files --field pressure --field speed -o "$tmp/b.leaf"
ok "says so" says '^fields  *pressure$' out
run "$leafcast" info "$tmp/b.leaf"
ok "in that order" says '^fields  *pressure: -0.059' out
# shellcheck disable=SC2086
exits "with little memory" 0 "$leafcast" convert $files --fields all --times 200,400,600,800,1000 --memory 6M --threads 1 -o "$tmp/b.leaf" --force
ok "the same bytes" same a.leaf b.leaf
exits "one array for all steps" 2 "$leafcast" convert $files "$tmp/other.mesh" --field speed -o "$tmp/c.leaf"
ok "and where there is none" says 'other.mesh: no array "speed" of the points' err
finish
