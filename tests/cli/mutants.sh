#!/bin/sh
# mutants.sh - wrong kernels, walks and shadows fail their tests, the right ones pass: of a third of
# the lists of tests/mutants one each, others with each commit. All of them: make mutants.
# marks: long
case ${LEAFCAST_BUILD:-} in
*/sanitize* | */thread* | */coverage*)
    echo "ok 1 - mutants # SKIP slow, and the release build's say the same"
    echo "1..1"
    exit 0
    ;;
esac
exec scripts/run-mutants --sample 1 --lists 16
