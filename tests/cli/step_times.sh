#!/bin/sh
# step_times.sh - convert --steps takes the times that an input has, and their unit.
# marks: long
. tests/support/tap.sh

PYTHONDONTWRITEBYTECODE=1 python3 tests/support/step_times.py "$leafcast" "$tmp" >"$tmp/results" 2>"$tmp/said"
rc=$?
[ $rc != 77 ] || { skip "times of steps" "no numpy here"; finish; }
results
finish
