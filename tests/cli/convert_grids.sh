#!/bin/sh
# convert_grids.sh - leafcast convert of grids with several steps and fields: each set is what it is alone, whatever the
# codec, the budget and the threads; what cannot be one file.
. tests/support/tap.sh

out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
same() { cmp -s "$tmp/$1" "$tmp/$2"; }
left() { [ "$(find "$tmp" -name '*.leaf*' | wc -l)" = "$1" ]; }
json() { python3 -c "import json, sys; x = json.load(open(sys.argv[1])); assert $1, x" "$tmp/out"; }

# Three steps: fields of other values, one of them a sphere in much empty space.
step=0
for field in gyroid sphere marschner-lobb; do
    run "$leafcast" generate $field --dims 50,45,40 --type f32 --spacing 1,0.5,2 -o "$tmp/s$step.nrrd"
    run "$leafcast" convert "$tmp/s$step.nrrd" -o "$tmp/s$step.leaf" --name x -q
    step=$((step + 1))
done
exits "a series" 0 "$leafcast" convert "$tmp"/s?.nrrd -o "$out" --times 1,2,4.5 --name x
exits "verify" 0 "$leafcast" verify "$out"
exits "info" 0 "$leafcast" info "$out"
ok "steps and times" says '^steps  *3, times 1 .. 4.5$' out
exits "info --json" 0 "$leafcast" info "$out" --json
ok "has the times" json 'x["times"] == [1, 2, 4.5] and x["steps"] == 3 and x["field_count"] == 1'
ok "has a range a step" json 'len(x["fields"][0]["step_ranges"]) == 3'
# The first has values from -1.5 to 1.5, the second from 0.22 to 0.99, the third from 0.02 to 0.98.
for iso in 1.2 -1.2 0.1 0.5 0.985 1e9; do
    exits "which steps have $iso" 0 "$leafcast" info "$out" --json --iso=$iso
    ok "those whose ranges do" json '[k for a, b in x["isovalues"][0]["at_steps"] for k in range(a, b + 1)] == [k for k in range(3) if x["fields"][0]["step_ranges"][k][0] < '$iso' <= x["fields"][0]["step_ranges"][k][1]]'
done
exits "which steps have 0.1, 0.5, -1e9" 0 "$leafcast" info "$out" --iso 0.1 --iso 0.5 --iso=-1e9
ok "two runs" says "^in 2 of the steps 0 to 2: 0, 2; first at time 1\$" out
ok "one" says "^in 3 of the steps 0 to 2: 0 to 2; first at time 1\$" out
ok "none" says "^in none of the steps 0 to 2\$" out
exits "of two steps" 0 "$leafcast" info "$out" --iso 0.1 --iso 0.5 --iso=1.2 --steps 2,1
ok "the last" says "^in 1 of the steps 1 to 2: 2; first at time 4.5\$" out
ok "both" says "^in 2 of the steps 1 to 2: 1 to 2; first at time 2\$" out
ok "none of these" says "^in none of the steps 1 to 2\$" out
ok "cells are those of the first of them" says "^isovalue 0.5 at step 1: [1-9]" out
exits "step 1 alone" 0 "$leafcast" info "$tmp/s1.leaf" --iso 0.5
ok "as many" [ "$(sed -n 's/^isovalue 0.5: \([0-9]* active cells\).*/\1/p' "$tmp/out")" = \
    "$("$leafcast" info "$out" --iso 0.5 --steps 1 | sed -n 's/^isovalue 0.5 at step 1: \([0-9]* active cells\).*/\1/p')" ]
exits "a step that is not there" 2 "$leafcast" info "$out" --iso 0.5 --steps 1:3
ok "is named" says 'there is no step 3' err
for step in 0 1 2; do
    for how in "" "--memory 24M" "--backend=mapped" "--isa scalar"; do
        # shellcheck disable=SC2086 # split on purpose
        run "$leafcast" render "$out" --step $step --iso 0.3 --size 64x48 --depth-f64 "$tmp/of" -o "$tmp/p.ppm" --force -q $how
        run "$leafcast" render "$tmp/s$step.leaf" --iso 0.3 --size 64x48 --depth-f64 "$tmp/alone" -o "$tmp/q.ppm" --force -q
        ok "step $step $how is what it is alone" same of alone
        ok "and looks so" same p.ppm q.ppm
    done
    exits "probe --step $step" 0 "$leafcast" probe "$out" --point 20,10,30 --step $step
    value=$(sed -n 's/^value: //p' "$tmp/out")
    exits "probe of it alone" 0 "$leafcast" probe "$tmp/s$step.leaf" --point 20,10,30
    ok "has the same value" [ "$value" = "$(sed -n 's/^value: //p' "$tmp/out")" ]
done
view="--eye 120,60,140 --look-at 25,11,40"
# shellcheck disable=SC2086
{
    exits "pictures of all steps" 0 "$leafcast" render "$out" --steps 0:2 --iso 0.3 --size 64x48 $view -o "$tmp/t_%d.ppm" -q
    run "$leafcast" render "$tmp/s2.leaf" --iso 0.3 --size 64x48 $view -o "$tmp/q.ppm" --force -q
}
ok "the last is that of the last" same t_2.ppm q.ppm
for how in "--threads 1" "--threads 3 --memory 10M" "--memory 5M --threads 1"; do
    # shellcheck disable=SC2086
    exits "convert $how" 0 "$leafcast" convert "$tmp"/s?.nrrd -o "$tmp/b.leaf" --force --times 1,2,4.5 --name x $how
    ok "gives the same bytes" same a.leaf b.leaf
done
for how in 's?.nrrd' 's*.nrrd' 's%d.nrrd' 's[0-2].nrrd' 's%01d.nrrd'; do
    exits "convert $how, as it is" 0 "$leafcast" convert "$tmp/$how" -o "$tmp/b.leaf" --force --times 1,2,4.5 --name x
    ok "is the three" same a.leaf b.leaf
done
exits "a pattern that nothing fits" 1 "$leafcast" convert "$tmp/s%02d.nrrd" -o "$tmp/b.leaf" --force
ok "is a file that is not there" says 's%02d.nrrd: cannot open: No such file' err
cp "$tmp/s0.nrrd" "$tmp/s[0-2].nrrd"
exits "a file of such a name" 0 "$leafcast" convert "$tmp/s[0-2].nrrd" -o "$tmp/b.leaf" --force --name x
ok "is that file" same s0.leaf b.leaf
rm "$tmp/s[0-2].nrrd"
exits "compressed" 0 "$leafcast" convert "$tmp"/s?.nrrd -o "$tmp/z.leaf" --compress zstd
exits "verify" 0 "$leafcast" verify "$tmp/z.leaf"
run "$leafcast" render "$tmp/z.leaf" --step 2 --iso 0.3 --size 64x48 --depth-f64 "$tmp/of" -o "$tmp/p.ppm" --force -q
ok "is drawn alike" same of alone
exits "export of a step" 0 "$leafcast" export "$out" --step 2 -o "$tmp/e.nrrd"
ok "is the step's samples" [ "$(tail -c 360000 "$tmp/e.nrrd" | cksum)" = "$(tail -c 360000 "$tmp/s2.nrrd" | cksum)" ]
exits "export of its surface" 0 "$leafcast" export "$out" --step 2 --iso 0.3 -o "$tmp/e.ply" --force
run "$leafcast" export "$tmp/s2.leaf" --iso 0.3 -o "$tmp/f.ply"
ok "is the step's alone" same e.ply f.ply
exits "export of a step that is not there" 2 "$leafcast" export "$out" --step 3 -o "$tmp/x.nrrd"
exits "a step that is not there" 2 "$leafcast" render "$out" --step 3 --iso 0.3 -o "$tmp/x.png"
exits "one volume needs no more" 2 "$leafcast" render "$tmp/s0.leaf" --step 1 --iso 0.3 -o "$tmp/x.png"
size=$(wc -c <"$out")
for at in 8 64 68 1424 4200 $((size / 3)); do
    cp "$out" "$tmp/x.leaf"
    printf '\377' | dd of="$tmp/x.leaf" bs=1 seek="$at" conv=notrunc 2>/dev/null
    exits "byte $at altered" 3 "$leafcast" verify "$tmp/x.leaf"
done

# What cannot be.
rm "$tmp"/*.leaf
run "$leafcast" generate gyroid --dims 50,45,41 --type f32 --spacing 1,0.5,2 -o "$tmp/taller.nrrd"
run "$leafcast" generate gyroid --dims 50,45,40 --type f32 --spacing 1,0.5,3 -o "$tmp/longer.nrrd"
run "$leafcast" generate gyroid --dims 50,45,40 --type u8 --spacing 1,0.5,2 -o "$tmp/bytes.nrrd"
for other in taller:"50 x 45 x 41" longer:elsewhere bytes:"type u8"; do
    exits "${other%%:*}" 3 "$leafcast" convert "$tmp/s0.nrrd" "$tmp/${other%%:*}.nrrd" -o "$out"
    ok "is named, and what is unlike" says "/${other%%:*}.nrrd: .*${other#*:}" err
done
exits "one that is not there" 1 "$leafcast" convert "$tmp/s0.nrrd" "$tmp/none.nrrd" -o "$out"
for wrong in "--times 1,2" "--times 1,2,2" "--times 1,x,3" "--field gyroid" "-"; do
    # shellcheck disable=SC2086
    exits "$wrong" 2 "$leafcast" convert "$tmp"/s?.nrrd $wrong -o "$out"
done
ok "nothing is left" left 0
finish
