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
