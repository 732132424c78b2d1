#!/bin/sh
# absent_parts.sh - samples that an input should have and does not: refused, or where its format says what they are, counted.
# marks: long
. tests/support/tap.sh

# OpenImageIO leaks where libpng gives up.
export LSAN_OPTIONS=detect_leaks=0
PYTHONDONTWRITEBYTECODE=1 python3 tests/support/absent_parts.py "$leafcast" "$tmp" >"$tmp/results" 2>"$tmp/said"
rc=$?
[ $rc != 77 ] || { skip "absent parts" "no numpy here"; finish; }
results
finish
