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

# python_with MODULE - the Python that has it: the system's own, where another goes before it; else nothing.
python_with() {
    for python in python3 /usr/bin/python3; do
        if "$python" -c "import $1" 2>/dev/null; then
            echo "$python"
            return
        fi
    done
}

# finish - the last line of every script.
finish() {
    echo "1..$tap_count"
    exit "$tap_failed"
}
