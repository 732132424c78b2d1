#!/bin/sh
# foreign.sh - what is known by sight and read by nothing here is refused by name, with what to do: a sample of each.
. tests/support/tap.sh

python3 tests/support/foreign_samples.py "$tmp/samples" formats/input/foreign.c >"$tmp/list" 2>"$tmp/said" || cp "$tmp/said" "$tmp/err"
ok "each row of the table has a sample" [ ! -s "$tmp/said" ]
refused() { # refused NAME PATH: by that name, and with words behind it
    grep -qF "$2: this is $1, which is not read here: " "$tmp/err" &&
        sed -n 's/.*which is not read here: //p' "$tmp/err" | grep -q '....'
}
while IFS='	' read -r name path; do
    for verb in convert info; do
        set -- "$leafcast" $verb "$path"
        [ $verb = info ] || set -- "$@" -o "$tmp/x.leaf"
        run "$@"
        ok "$verb of ${path##*/}: $name" refused "$name" "$path"
        ok "exit 3 (got $rc)" [ "$rc" = 3 ]
    done
done <"$tmp/list"

# A row that has none is found out.
{ cat formats/input/foreign.c && echo '    REFUSED("a format of tomorrow", PARAVIEW, 0, BYTES("x"), ""),'; } >"$tmp/table.c"
exits "a row without a sample" 1 python3 tests/support/foreign_samples.py "$tmp/samples" "$tmp/table.c"
ok "is told" grep -q "no sample of: a format of tomorrow" "$tmp/err"

# What looks like one of them and is not.
printf '*KEYWORD\n*NODE\n1,0,0,0\n' >"$tmp/dyna.k"
exits "LS-DYNA" 3 "$leafcast" info "$tmp/dyna.k"
ok "is not Abaqus" grep -q "no known format" "$tmp/err"
printf '4 1 1 0 0\n' >"$tmp/five.txt"
exits "five numbers" 3 "$leafcast" info "$tmp/five.txt"
ok "are not AVS UCD" grep -q "no known format" "$tmp/err"
exits "raw samples, as the user says" 0 "$leafcast" info "$tmp/samples/a.plt" --dims 4,4,4 --type u8 --quick
finish
