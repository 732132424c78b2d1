#!/bin/sh
# stress.sh - the stress lab's tool: tables, CSV, and the lines that rerun a fault.
# marks: plain
. tests/support/tap.sh

tool=${LEAFCAST_BUILD:-build/release}/tests/tool_stress
[ -x "$tool" ] || { skip stress "no $tool"; finish; }

exits "a few cases" 0 "$tool" cells --count 500 --case random --case two-surfaces --csv "$tmp/t.csv"
ok "a line a case and intersector" [ "$(grep -cE '^(random|two-surfaces) ' "$tmp/out")" = 12 ]
ok "no faults" grep -q '^0 faults' "$tmp/out"
ok "as CSV" [ "$(grep -cE '^(random|two-surfaces),[a-z0-9-]+,500,' "$tmp/t.csv")" = 12 ]
cp "$tmp/t.csv" "$tmp/first.csv"
exits "with other threads" 0 "$tool" cells --count 500 --case random --case two-surfaces --threads 3 --csv "$tmp/t.csv"
ok "the same numbers" cmp -s "$tmp/first.csv" "$tmp/t.csv"
exits "with another seed" 0 "$tool" cells --count 500 --case random --seed 21 --csv "$tmp/t.csv"
ok "other numbers" sh -c "! grep -qxF -f '$tmp/t.csv' '$tmp/first.csv' || [ \$(grep -cxF -f '$tmp/t.csv' '$tmp/first.csv') = 1 ]"

# An approximate intersector, held to what marmitt is held to, fails: its faults come with lines that
# rerun them, and each of them finds the same fault again.
exits "linear is not exact" 1 "$tool" cells --count 500 --case two-surfaces --exact linear
sed -n 's/^\([a-z ]*\): .*; rerun: /\1|/p' "$tmp/out" >"$tmp/lines"
ok "three lines to rerun" [ "$(wc -l <"$tmp/lines")" = 3 ]
number=0
while IFS='|' read -r fault line; do
    number=$((number + 1))
    # shellcheck disable=SC2086 # a command line
    exits "line $number" 1 $line
    ok "line $number: $fault, again" grep -q "^$fault: linear" "$tmp/out"
    # shellcheck disable=SC2086
    exits "line $number, by marmitt" 0 ${line% linear}
done <"$tmp/lines"

exits "missing data" 0 "$tool" cell nan-inf 20 5
exits "a block" 0 "$tool" block plateau 20 7
exits "a ray" 0 "$tool" leak noise far 20 3
ok "its surfaces" grep -q '^hit ' "$tmp/out"
exits "pictures" 0 "$tool" leak crate unit 20 picture 12
exits "shadows" 0 "$tool" shadow bowl small-far 20 2 24 scalar
exits "an unknown case" 2 "$tool" --case nothing
exits "an unknown section" 2 "$tool" nothing
exits "a cell of no case" 2 "$tool" cell nothing 1 2
exits "a solid of no form" 2 "$tool" leak nothing unit 1 2
finish
