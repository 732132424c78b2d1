#!/bin/sh
# uneven_axes.sh - a spacing beside an uneven axis: every sample keeps its place through every format that holds it.
. tests/support/tap.sh

PYTHONDONTWRITEBYTECODE=1 python3 tests/support/uneven_axes.py "$leafcast" "$tmp" >"$tmp/results" 2>"$tmp/said"
rc=$?
[ $rc != 77 ] || { skip "uneven axes" "no numpy here"; finish; }
results
finish
