# tap.sh - what the script tests in tests/cli share. Sourced:  . tests/support/tap.sh
#
# Gives $leafcast (the front door under test), $data (the data folder; empty when there is none) and
# $tmp (a folder of the test's own, removed at the end). Scripts start at the checkout's root.
# shellcheck shell=sh
set -u
# shellcheck disable=SC2034 # for those that source this
leafcast=${LEAFCAST:-$PWD/build/leafcast}
data=${LEAFCAST_DATA:-$PWD/../shared/data}
[ -d "$data" ] || data=
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
trap 'exit 130' INT TERM HUP
tap_count=0
tap_failed=0

# run COMMAND... - run it; what it says is in $tmp/out and $tmp/err, its exit status in $rc.
run() {
    rc=0
    "$@" >"$tmp/out" 2>"$tmp/err" </dev/null || rc=$?
}

# ok NAME COMMAND... - passes when the command succeeds; a failure shows what the last run said.
ok() {
    tap_count=$((tap_count + 1))
    tap_name=$1
    shift
    if "$@"; then
        echo "ok $tap_count - $tap_name"
    else
        tap_failed=1
        echo "not ok $tap_count - $tap_name"
        echo "# not so: $*"
        for f in out err; do
            [ ! -s "$tmp/$f" ] || tail -n 20 "$tmp/$f" | sed "s/^/# $f: /"
        done
    fi
}

# exits NAME STATUS COMMAND... - run it; passes when it exits with this status.
exits() {
    tap_title=$1
    tap_want=$2
    shift 2
    run "$@"
    ok "$tap_title: exit $tap_want (got $rc)" [ "$rc" = "$tap_want" ]
}

# skip NAME WHY - a test that cannot be made here.
skip() {
    tap_count=$((tap_count + 1))
    echo "ok $tap_count - $1 # SKIP $2"
}

# results - what a script in Python has written to $tmp/results, a line a test: its name, a tab, "right", "skip WHY" or
# what was wrong; it ended with $rc and said $tmp/said.
results() {
    while IFS='	' read -r name result; do
        case $result in
        skip*) skip "$name" "${result#skip }" ;;
        *)
            echo "$result" >"$tmp/err"
            ok "$name" [ "$result" = right ]
            ;;
        esac
    done <"$tmp/results"
    cp "$tmp/said" "$tmp/err"
    ok "all of them were run (exit $rc)" [ "$rc" = 0 ]
}

# $watched - what a sanitizer watches, `memory` or `threads`; empty: there is none. $picture - the size of pictures that
# are held against each other: to find a wrong access it takes fewer pixels.
# shellcheck disable=SC2034 # for those that source this
case ${LEAFCAST_BUILD-} in
*/sanitize*) watched=memory picture=24x20 ;;
*/thread*) watched=threads picture=24x20 ;;
*) watched='' picture=80x70 ;;
esac

# one_in N [NAME NAMES] - true at every Nth call with this N, the first one included, and if NAME is among NAMES; at each
# but where sanitizers watch: what has been compared there in the same way, on other input, need not be again.
tap_turn=0
one_in() {
    [ -n "$watched" ] || return 0
    case " ${3-} " in *" ${2--} "*) return 0 ;; esac
    eval "tap_turn=\$((\${tap_turn_$1:-0} + 1)) tap_turn_$1=\$tap_turn"
    [ $((tap_turn % $1)) = 1 ]
}

# python_with MODULE - the Python that has it: the system's own, where another goes before it; else nothing.
python_with() {
    for python in python3 /usr/bin/python3; do
        if "$python" -c "import $1" 2>/dev/null; then
            echo "$python"
            return
        fi
    done
}

# client NAME COMMAND... - run a program that tells what it has looked at, a line a test: "ok NAME" or "not NAME", with
# "end" behind the last.
client() {
    tap_client=$1
    shift
    run "$@"
    ok "$tap_client: it ends well" [ "$rc" = 0 ]
    while read -r result name; do ok "$tap_client: $name" [ "$result" = ok ]; done <<LINES
$(sed -n 's/^\(ok\|not\) /\1 /p' "$tmp/out")
LINES
    ok "$tap_client: it has told of all" grep -qx "end" "$tmp/out"
}

# need_view - the viewer; or skip the whole script.
need_view() {
    "$leafcast" --list-verbs own | grep -qx view && return
    skip "the viewer" "it is not built here: no libwebsockets or libturbojpeg"
    finish
}

# need_browser - a browser that Python drives, as $python; or skip the whole script.
need_browser() {
    python=$(python_with selenium)
    [ -z "$python" ] || ! command -v chromium >/dev/null || ! command -v chromedriver >/dev/null || return 0
    skip "the viewer's page" "chromium, chromium-driver or python3-selenium is not here"
    finish
}

# finish - the last line of every script.
finish() {
    echo "1..$tap_count"
    exit "$tap_failed"
}
