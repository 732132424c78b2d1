#!/bin/sh
# choices.sh - what an input has of several: `info' lists it, `convert' says what it takes unasked, a line each.
# marks: long
. tests/support/tap.sh

PYTHONDONTWRITEBYTECODE=1 python3 tests/support/choices.py "$leafcast" "$tmp" >"$tmp/results" 2>"$tmp/said"
rc=$?
[ $rc != 77 ] || { skip "choices" "no numpy here"; finish; }
results
finish
