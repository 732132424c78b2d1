#!/bin/sh
# mutants.sh - each wrong kernel, walk and shadow of these lists fails its stress test, the right ones pass.
case ${LEAFCAST_BUILD:-} in
*/sanitize* | */thread* | */coverage*)
    echo "ok 1 - mutants # SKIP slow, and the release build's say the same"
    echo "1..1"
    exit 0
    ;;
esac
exec scripts/run-mutants --file tests/cell_kernel.mutants --file tests/watertight.mutants
