#!/bin/sh
# generate.sh - leafcast generate: its flags, exit codes, what it leaves behind.
. tests/support/tap.sh

out=$tmp/a.nrrd
left() { [ "$(find "$tmp" -name '*.nrrd*' | wc -l)" = "$1" ]; }
says() { grep -q -- "$1" "$tmp/$2"; }

exits "a small volume" 0 "$leafcast" generate gyroid --dims 16,17x18 --type u16 --spacing 1,-2,3 -o "$out"
run "$leafcast" generate gyroid --dims 16,17x18 --type u8 --spacing 1,-2,3 -o -
ok "has a byte a sample more than u8, and one in the type's name" \
    [ $(($(wc -c <"$out") - $(wc -c <"$tmp/out"))) = $((16 * 17 * 18 + 1)) ]
ok "has its spacing" grep -aq '^space directions: (1,0,0) (0,-2,0) (0,0,3)$' "$out"
ok "says nothing" [ ! -s "$tmp/err" ]
exits "an existing output" 1 "$leafcast" generate sphere --dims 8 -o "$out"
ok "is kept" grep -aq '^content: gyroid$' "$out"
ok "and the way out is told" says '--force' err
exits "--force" 0 "$leafcast" generate sphere --dims 8 -o "$out" --force
ok "overwrites" grep -aq '^content: sphere$' "$out"
exits "standard output" 0 "$leafcast" generate sphere --dims 8 -o - --threads 3
ok "gets the same bytes" cmp -s "$tmp/out" "$out"
exits "one number for three spacings, negative" 0 "$leafcast" generate sphere --dims 4 --spacing -2 -o - -q
ok "is taken" grep -aq '^space directions: (-2,0,0) (0,-2,0) (0,0,-2)$' "$tmp/out"
rm -f "$out"

# Plants: triangles with colours, upright; the same seed grows the same plant.
for shape in conifer broadleaf bush grass; do
    exits "a plant: $shape" 0 "$leafcast" generate plant --shape $shape --json -o "$tmp/$shape.ply"
    ok "of thousands of triangles" python3 - "$tmp/out" "$tmp/$shape.ply" <<'P'
import json, struct, sys
told, ply = json.load(open(sys.argv[1])), open(sys.argv[2], "rb").read()
head, body = ply.split(b"end_header\n", 1)
counts = [int(l.split()[2]) for l in head.decode().split("\n") if l.startswith("element")]
assert told["kind"] == "triangles" and told["triangles"] == counts[1] > 1000
at = [struct.unpack_from("<3f3B", body, 15 * i) for i in range(counts[0])]
rows = [struct.unpack_from("<B3i", body, 15 * counts[0] + 13 * i) for i in range(counts[1])]
assert len(body) == 15 * counts[0] + 13 * counts[1]
assert all(r[0] == 3 and 0 <= min(r[1:]) and max(r[1:]) < counts[0] for r in rows)
z = [p[2] for p in at]
assert -3 < min(z) < 0 < 0.3 < max(z) < 20
assert max(p[4] for p in at) > 100  # some green
P
    exits "is a surface" 0 "$leafcast" convert "$tmp/$shape.ply" -o "$tmp/$shape.leaf" -q
done
run "$leafcast" generate plant --shape bush -o - -q
ok "the same bytes each time" cmp "$tmp/out" "$tmp/bush.ply"
run "$leafcast" generate plant --shape bush --seed 2 -o "$tmp/other.ply" -q
ok "another seed, another plant" sh -c "! cmp -s '$tmp/other.ply' '$tmp/bush.ply'"
for wrong in "--shape oak" "--dims 9" "--tets" "--steps 3"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "a plant with $wrong" 2 "$leafcast" generate plant $wrong -o "$tmp/x.ply"
done
exits "a shape of no plant" 2 "$leafcast" generate sphere --dims 9 --shape bush -o "$out"
ok "is refused" says '--shape is of a plant' err
ok "nothing was written" [ ! -e "$tmp/x.ply" ]

# Series: every file is that of its time, the same by any threads and memory; convert takes them.
exits "a series" 0 "$leafcast" generate drop --dims 64 --steps 3 -o "$tmp/s.nrrd" --json
ok "of three files" left 3
ok "tells how many" says '"steps": 3' out
exits "named as %04d says, in little memory" 0 "$leafcast" generate drop --dims 64 --steps 3 --threads 3 --memory 400K -o "$tmp/t_%02d.nrrd" -q
for step in 0 1 2; do
    ok "step $step has the same bytes" cmp -s "$tmp/s_000$step.nrrd" "$tmp/t_0$step.nrrd"
done
exits "without steps" 0 "$leafcast" generate drop --dims 64 -o - -q
ok "it is time 0" cmp -s "$tmp/out" "$tmp/s_0000.nrrd"
exits "of a step" 0 "$leafcast" generate drop --dims 64 --steps 1 -o "$tmp/u.nrrd" -q
ok "it is, too" cmp -s "$tmp/u_0000.nrrd" "$tmp/s_0000.nrrd"
rm "$tmp/s_0001.nrrd" "$tmp/s_0000.nrrd"
exits "one of them exists" 1 "$leafcast" generate drop --dims 64 --steps 3 -o "$tmp/s.nrrd"
ok "and is named" says 's_0002.nrrd exists' err
ok "nothing is written before" [ ! -e "$tmp/s_0000.nrrd" ]
exits "a series of a pattern becomes one file" 0 "$leafcast" convert "$tmp/t_*.nrrd" --times 0,0.5,1 -o "$tmp/t.leaf" -q
exits "info" 0 "$leafcast" info "$tmp/t.leaf" --json
ok "with its times" python3 -c 'import json, sys; sys.exit(json.load(open(sys.argv[1]))["times"] != [0, 0.5, 1])' "$tmp/out"
# What changes: of the drop a part, of the others all that is not of one value.
for field in drop jets vortex; do
    run "$leafcast" generate $field --dims 128 --steps 5 -o "$tmp/$field.nrrd" -q
    exits "$field: its steps" 0 "$leafcast" convert "$tmp/${field}_%04d.nrrd" -o "$tmp/$field.leaf" -q
    run "$leafcast" info "$tmp/$field.leaf" --json
    ok "$field: what is the same from step to step" python3 -c 'import json, sys
x = json.load(open(sys.argv[1]))
same, implied, all = x["same_payloads"], x["implied_payloads"], 5 * x["treelets"]
sys.exit(not (same > 0.1 * all and same + implied > 2 / 3 * all if sys.argv[2] == "drop" else same == 0 and implied < 0.01 * all))' "$tmp/out" $field
    rm "$tmp/$field"*.nrrd
done
exits "a field that stays" 2 "$leafcast" generate gyroid --dims 8 --steps 3 -o "$out"
ok "is told, and those that change" says 'gyroid is the same at any time; these change: drop, jets, vortex$' err
exits "a series to a pipe" 2 "$leafcast" generate jets --dims 8 --steps 3 -o -
exits "no steps" 2 "$leafcast" generate jets --dims 8 --steps 0 -o "$out"
exits "a series whose name has no number's form" 2 "$leafcast" generate jets --dims 8 --steps 2 -o "$tmp/%s.nrrd"
rm -f "$tmp"/*.nrrd

exits "help" 0 "$leafcast" generate --help
ok "lists the fields" says '^  marschner-lobb' out
ok "is on standard output" [ ! -s "$tmp/err" ]
exits "version" 0 "$leafcast" generate --version
for wrong in "" "sphere" "sphere --dims 8" "nothing --dims 8 -o $out" "sphere --dims 1 -o $out" \
    "sphere --dims 8,8 -o $out" "sphere --dims 8.5 -o $out" "sphere --dims 9999999 -o $out" \
    "sphere --dims 8 --type i16 -o $out" "sphere --dims 8 --bogus -o $out" "sphere gyroid --dims 8 -o $out" \
    "sphere --dims 8 --threads 0 -o $out" "sphere --dims 8 --memory 12Q -o $out"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "usage: generate $wrong" 2 "$leafcast" generate $wrong
done
exits "a spacing of 0" 3 "$leafcast" generate sphere --dims 8 --spacing 0 -o "$out"
exits "too little memory" 4 "$leafcast" generate sphere --dims 8 --memory 1K -o "$out"
exits "a folder that is not there" 1 "$leafcast" generate sphere --dims 8 -o "$tmp/none/a.nrrd"
if [ -e /dev/full ]; then
    # shellcheck disable=SC2016
    exits "a full disk" 4 sh -c '"$1" generate sphere --dims 64 -o - >/dev/full' sh "$leafcast"
fi
# shellcheck disable=SC2016
exits "a file that may not grow" 4 sh -c 'ulimit -f 10; "$1" generate sphere --dims 128 -o "$2"' sh "$leafcast" "$out"
ok "none of them leaves a file" left 0

"$leafcast" generate attractor --dims 400 --type f32 --memory 40M -o "$out" 2>"$tmp/err" &
child=$!
tries=0
while left 0 && [ $tries -lt 200 ]; do
    sleep 0.05
    tries=$((tries + 1))
done
ok "while it writes, nothing stands under the final name" [ ! -e "$out" ]
kill -TERM $child
rc=0
wait $child || rc=$?
ok "a signal ends it with 128 + its number (got $rc)" [ $rc = 143 ]
ok "and leaves nothing behind" left 0
ok "and is told" says 'signal 15' err
finish
