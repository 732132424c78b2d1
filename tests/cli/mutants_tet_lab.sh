#!/bin/sh
# mutants_tet_lab.sh - each wrong kernel of tests/tet_lab.mutants fails on the hostile meshes, the right one passes.
case ${LEAFCAST_BUILD:-} in
*/sanitize* | */thread* | */coverage*)
    echo "ok 1 - mutants # SKIP slow, and the release build's say the same"
    echo "1..1"
    exit 0
    ;;
esac
exec scripts/run-mutants --count 500 --file tests/tet_lab.mutants
