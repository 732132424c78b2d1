#!/bin/sh
# named_files.sh - files that files name: they lie in the folder of the one that names them, and are regular.
# marks: long
. tests/support/tap.sh

PYTHONDONTWRITEBYTECODE=1 python3 tests/support/named_files.py "$leafcast" "$tmp" >"$tmp/results" 2>"$tmp/said"
rc=$?
[ $rc != 77 ] || { skip "named files" "no numpy here"; finish; }
results
finish
