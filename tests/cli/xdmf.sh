#!/bin/sh
# xdmf.sh - grids of XDMF: values, places and times; what is refused.
. tests/support/tap.sh

PYTHONDONTWRITEBYTECODE=1 python3 tests/support/xdmf.py "$leafcast" "$tmp" >"$tmp/results" 2>"$tmp/said"
rc=$?
[ $rc != 77 ] || { skip "XDMF" "no numpy here"; finish; }
results
finish
