#!/bin/sh
# ci.sh - what .ci/run, run-fuzz and bare-root say and how they exit, with stand-ins for all that takes time.
. tests/support/tap.sh

tree=$tmp/tree
mkdir -p "$tree/.ci" "$tree/scripts" "$tree/tests/cli" "$tree/tests/support" "$tree/bin"
cp .ci/run "$tree/.ci"
cp scripts/run-fuzz "$tree/scripts"
# stand_in NAME LINE...: a script of these lines.
stand_in() {
    name=$1
    shift
    printf '#!/bin/sh\n' >"$tree/$name"
    printf '%s\n' "$@" >>"$tree/$name"
    chmod 755 "$tree/$name"
}
for f in check_layers check_headers check_size check_format check_man check_isa setup-debian; do
    stand_in scripts/$f "echo $f \"\$@\" >>$tree/ran"
done
stand_in scripts/bare-root 'echo in the root: "$@"' 'echo "7 passed, 0 failed, 1 skipped"'
for f in cppcheck shellcheck; do stand_in bin/$f "echo $f >>$tree/ran"; done
stand_in bin/make "echo make \"\$@\" >>$tree/ran"
ci() { PATH=$tree/bin:$PATH bash "$tree/.ci/run" "$@"; }
last() { [ "$(tail -n 1 "$tmp/out")" = "$1" ]; }

exits "all steps" 0 ci
ok "end with the summary of the tests in the bare root" last "7 passed, 0 failed, 1 skipped"
ok "set up for CI first" sh -c 'head -n 1 "$1" | grep -qx "setup-debian --ci"' - "$tree/ran"
for f in CONFIG=sanitize CONFIG=thread CC=clang fuzz cppcheck shellcheck check_layers check_headers \
    check_size check_format check_man; do
    ok "ran: $f" grep -q -- "$f" "$tree/ran"
done
ok "the root is told to make demo and test" grep -q 'make demo' "$tmp/out"

stand_in bin/make 'case $* in *thread*) seq 3000; echo a race; exit 7 ;; esac'
exits "a step that fails" 1 ci
ok "is named" last "failed: thread"
ok "shown whole" sh -c '[ "$(grep -c "^[0-9]*$" "$1")" = 3000 ]' - "$tmp/out"
ok "with the reason" grep -qx 'a race' "$tmp/out"
ok "beside the others, which end" grep -q '==== rules done' "$tmp/out"

stand_in bin/make true
stand_in scripts/bare-root 'echo "7 passed, 1 failed, 1 skipped"' 'exit 1'
exits "tests that fail in the bare root" 1 ci
ok "are told" last "failed: bare"
stand_in scripts/setup-debian 'exit 1'
exits "nothing runs without the set-up" 1 ci
ok "nothing" sh -c '! grep -q ==== "$1"' - "$tmp/out"

mkdir -p "$tree/tests/corpus/fuzz_good" "$tree/tests/corpus/fuzz_bad"
stand_in fuzz_good 'echo "stat::number_of_executed_units: 12"'
stand_in fuzz_bad 'echo overflow; echo bytes >build/fuzz/found/fuzz_bad.bad-1; exit 77'
fuzz() { (cd "$tree" && scripts/run-fuzz 1 "$@"); }
exits "targets that find nothing" 0 fuzz ./fuzz_good
ok "say how often they ran" grep -q 'fuzz_good: 12 runs' "$tmp/out"
exits "one that does" 1 fuzz ./fuzz_bad ./fuzz_good
ok "shows what it said" grep -qx overflow "$tmp/out"
ok "and its input" [ "$(sed -n '/base64 -d <<X/,/^X$/p' "$tmp/out" | sed '1d;$d' | base64 -d | gzip -d)" = bytes ]
ok "the other one ends" grep -q 'fuzz_good: 12 runs' "$tmp/out"

exits "bare-root without a command" 2 scripts/bare-root
exits "with an option that is none" 2 scripts/bare-root --none true
exits "with a data folder that is none" 2 scripts/bare-root --data "$tmp/none" true
exits "its help" 0 scripts/bare-root --help
finish
