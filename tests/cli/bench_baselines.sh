#!/bin/sh
# bench_baselines.sh - what leafcast bench counts (steps, cells, bytes, surfaces missed) is what
# tests/baselines has, within the tolerances written there; and a count that moves is noticed.
#
# After a change that is meant to move them, write them anew, with $how of below and --ray-cells 20000:
#   build/leafcast bench all $how --baselines tests/baselines --force
# marks: plain
. tests/support/tap.sh

how="--form brief --runs 1 --size 96x96 --threads 2"
counts() { # counts SUITE FOLDER
    few=$how
    case $1 in
    intersectors) few="$how --ray-cells 20000" ;;
    update) few=${how%--size*}${how#*96x96} ;; # it draws nothing
    esac
    # shellcheck disable=SC2086 # a list of flags
    "$leafcast" bench "$1" $few --scratch "$tmp/kept" --against "$2"
}
says() { grep -q -- "$1" "$tmp/$2"; }
change() { # change FILE FACTOR: of the first count that has a tolerance
    awk -F, -v OFS=, -v factor="$2" 'NR > 1 && !done && $4 > 0 && $3 > 1 {
        $3 = $3 * factor; done = 1 } { print }' "$1"
}

for baseline in tests/baselines/*.csv; do
    suite=$(basename "$baseline" .csv)
    exits "$suite: counts as before" 0 counts "$suite" tests/baselines
    ok "$suite: none is off" says "$suite: [1-9][0-9]* counts within tolerance, 0 off" err
done

mkdir "$tmp/moved"
change tests/baselines/figure414.csv 1.2 >"$tmp/moved/figure414.csv"
ok "one count altered" [ "$(diff tests/baselines/figure414.csv "$tmp/moved/figure414.csv" | grep -c '^>')" = 1 ]
exits "a count that moved" 1 counts figure414 "$tmp/moved"
ok "is named" says 'nodes/ray is .*expected' err
ok "and alone" says ' 1 off' err
change tests/baselines/figure414.csv 1.01 >"$tmp/moved/figure414.csv"
exits "a count that moved less than its tolerance" 0 counts figure414 "$tmp/moved"
sed 's/^ml-32 /ml-33 /' tests/baselines/figure414.csv >"$tmp/moved/figure414.csv"
exits "a case that is gone" 1 counts figure414 "$tmp/moved"
ok "is said to be" says 'is not there' err
sed '$s/,[^,]*$//' tests/baselines/figure414.csv >"$tmp/moved/figure414.csv"
exits "a line that is none" 3 counts figure414 "$tmp/moved"
rm "$tmp/moved/figure414.csv"
exits "no baseline" 1 counts figure414 "$tmp/moved"
exits "new baselines" 0 "$leafcast" bench figure414 --form brief --runs 1 --size 16x16 --scratch "$tmp/kept" --baselines "$tmp/new"
ok "have a header and counts, no times" [ "$(sed -n '1p;/ms/p;/Mray/p' "$tmp/new/figure414.csv")" = "case,quantity,expected,tolerance" ]
exits "and are not overwritten" 1 "$leafcast" bench figure414 --form brief --runs 1 --size 16x16 --scratch "$tmp/kept" --baselines "$tmp/new"
long=$tmp/$(head -c 4010 /dev/zero | tr '\0' x)
for option in --against --baselines --out; do
    exits "$option of more bytes than a path has" 2 "$leafcast" bench figure414 --form brief $option "$long"
    ok "is refused for that" says "has 4[0-9]* bytes: at most 4000" err
done
finish
