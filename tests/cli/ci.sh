#!/bin/sh
# ci.sh - what .ci/run, run-fuzz, bare-root and demo say and how they exit, with stand-ins for all that takes time.
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
for f in check_layers check_kinds check_headers check_size check_format check_man check_isa setup-debian; do
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
for f in CONFIG=sanitize CONFIG=thread CC=clang CROSS=aarch64 fuzz cppcheck shellcheck check_layers check_kinds check_headers \
    check_size check_format check_man check_isa; do
    ok "ran: $f" grep -q -- "$f" "$tree/ran"
done
ok "the root is told to make demo and test" grep -q 'make demo' "$tmp/out"

exits "a step that is none" 2 ci rules ls
ok "is named, and nothing runs" sh -c 'grep -q "no step .ls." "$1" && [ ! -s "$2" ]' - "$tmp/err" "$tmp/out"
exits "one step" 0 ci rules
ok "runs alone" [ "$(grep -c begins "$tmp/out")" = 1 ]

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

exits "mutants with a compiler that fails" 1 env LEAFCAST_COMPILE=false \
    scripts/run-mutants --file tests/mutants/watertight.mutants --sample 1 --seed 1
ok "are faults of the tests" grep -q '^not ok 1 - .* passes$' "$tmp/out"
ok "for that reason" grep -qx '# does not compile or link' "$tmp/out"

# The demo's program notes its words, a line each, and makes its output; what is printed does so again.
cp scripts/demo "$tree/scripts"
# shellcheck disable=SC2016 # its own
stand_in bin/leafcast 'printf "%s\n" "$@" >>noted' 'while [ "$1" != -o ]; do shift; done' 'echo bytes >"$2"'
exits "the demo" 0 env LEAFCAST="$tree/bin/leafcast" "$tree/scripts/demo"
mv "$tree/noted" "$tmp/once"
sed -n 's/^\$ //p' "$tmp/out" >"$tmp/printed"
run sh -c 'cd "$1" && PATH=$1/bin:$PATH sh "$2"' - "$tree" "$tmp/printed"
ok "prints commands that can be pasted" cmp "$tmp/once" "$tree/noted"

# bare-root with stand-ins for what makes the base and the namespaces, in another user's checkout.
if [ "$(id -u)" = 0 ] && command -v flock apt-config >/dev/null; then
    root=$tree/build/bare-root/root
    cp scripts/bare-root "$tree/scripts"
    # shellcheck disable=SC2016 # their own
    {
        stand_in bin/mmdebstrap 'cd "$(mktemp -d)" && mkdir -p etc var/lib/dpkg/info && echo 99 >etc/debian_version' \
            'touch var/lib/dpkg/info/a.list && tar -c . && head -c 9000000 /dev/zero' # bytes behind the end, as it may have
        stand_in bin/zstd 'exec cat'
        stand_in bin/unshare 'while [ "$1" != --within ]; do shift; done' 'shift 3' 'exec "$@"'
    }
    bare() {
        (cd "$tree" && PATH=$tree/bin:$PATH HOME=/none GIT_CONFIG_SYSTEM=/dev/null exec scripts/bare-root "$@")
    }
    echo build >"$tree/.gitignore"
    # A mirror that is down once, or for good.
    mv "$tree/bin/mmdebstrap" "$tree/bin/makes_base"
    stand_in bin/sleep true
    stand_in bin/mmdebstrap '[ -e build/once ] || { touch build/once; echo E: no mirror >&2; exit 1; }' 'exec makes_base'
    (cd "$tree" && git init -q && git add . && git -c user.name=a -c user.email=a commit -qm a) >/dev/null 2>&1
    mkdir -p "$tree/build"
    exits "a base that cannot be made at once" 0 bare true
    ok "is told" grep -q '2 more tries' "$tmp/err"
    ok "with the reason" grep -qx 'E: no mirror' "$tmp/err"
    stand_in bin/mmdebstrap 'echo E: no mirror >&2' 'exit 1'
    rm "$tree"/build/bare-root/base-*
    exits "nor ever" 1 bare true
    ok "after three tries" [ "$(grep -c 'E: no mirror' "$tmp/err")" = 3 ]
    mv "$tree/bin/makes_base" "$tree/bin/mmdebstrap"
    rm "$tree/bin/sleep"
    chown -R 64321 "$tree"
    exits "a command in a bare root" 0 bare test -e "$root/src/leafcast/scripts/bare-root"
    ok "of which it is said what it is" grep -q "Debian 99, 1 packages; commit $(git -C "$tree" -c safe.directory='*' rev-parse HEAD)" "$tmp/err"
    ok "the root goes with it" [ ! -e "$root" ]
    exits "its exit status is the command's" 7 bare sh -c 'exit 7'
    exits "--keep" 0 bare --keep true
    ok "leaves the root" [ -e "$root/etc/debian_version" ]
    stand_in bin/git 'case $* in *clone*) exit 128 ;; esac' "exec $(command -v git) \"\$@\""
    exits "a clone that fails" 128 bare true
    ok "says where" grep -q '^bare-root: line [0-9]*: exit status 128$' "$tmp/err"
    rm "$tree/bin/git"
    # The command notes its number.
    ended() { [ ! -e "$root" ] && ! kill -0 "$(cat "$tree/build/pid")" 2>/dev/null; }
    # ends_by_signal SIGNAL SCRIPT: it takes the command and the root with it.
    ends_by_signal() {
        rm -f "$tree/build/pid"
        # shellcheck disable=SC2016 # the command's
        (cd "$tree" && PATH=$tree/bin:$PATH exec env --default-signal=INT "scripts/$2" \
            sh -c 'echo $$ >build/pid; exec sleep 1000') >/dev/null 2>"$tmp/err" &
        child=$!
        until [ -s "$tree/build/pid" ] || ! kill -0 $child 2>/dev/null; do sleep 0.1; done
        kill -s "$1" $child
        wait $child 2>/dev/null
        ended
    }
    # One that is slow to give the command's number a name.
    sed 's/^child=\$!$/sleep 1; &/' "$tree/scripts/bare-root" >"$tree/scripts/slow-root"
    chmod 755 "$tree/scripts/slow-root"
    ok "a slower one" sh -c '! cmp -s "$1/bare-root" "$1/slow-root"' - "$tree/scripts"
    for signal in TERM INT; do
        ok "SIG$signal ends the command and its root with it" ends_by_signal $signal bare-root
        ok "SIG$signal that comes early, too" ends_by_signal $signal slow-root
    done
else
    skip "bare-root with stand-ins" "as root of a Debian only"
fi
# tests_of WHAT...: which tests make would run.
tests_of() {
    env -u MAKEFLAGS -u MAKELEVEL -u T make -n run-tests CONFIG=sanitize "$@" 2>/dev/null | grep 'scripts/run-tests' | tr ' ' '\n' |
        grep -E '\.sh$|/tests/test_' | sort
}
tests_of SHARE=1 >"$tmp/every"
for drawn in 0 1 2; do tests_of SHARE=3 DRAWN=$drawn; done >"$tmp/thirds"
ok "three shares" [ "$(wc -l <"$tmp/thirds")" -gt 300 ]
ok "are all tests, each once" sh -c 'sort "$1" | cmp - "$2"' - "$tmp/thirds" "$tmp/every"

exits "bare-root without a command" 2 scripts/bare-root
exits "with an option that is none" 2 scripts/bare-root --none true
exits "with a data folder that is none" 2 scripts/bare-root --data "$tmp/none" true
exits "its help" 0 scripts/bare-root --help
finish
