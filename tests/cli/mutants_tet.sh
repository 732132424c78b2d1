#!/bin/sh
# mutants_tet.sh - each wrong kernel of tets of tests/tet_kernel.mutants fails its test, the right ones pass.
case ${LEAFCAST_BUILD:-} in
*/sanitize* | */thread* | */coverage*)
    echo "ok 1 - mutants # SKIP slow, and the release build's say the same"
    echo "1..1"
    exit 0
    ;;
esac
exec scripts/run-mutants --file tests/tet_kernel.mutants
