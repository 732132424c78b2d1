#!/bin/sh
# reads_ahead.sh - leafcast render: while a picture of a series is written, what the next one needs is read, whatever says
# which one that is.
. tests/support/tap.sh

command -v python3 >/dev/null || { skip "reading ahead" "no python3 here"; finish; }
[ -r /proc/self/io ] || { skip "reading ahead" "the system does not count what is read"; finish; }
run "$leafcast" generate jets --dims 65 --type f32 --steps 4 -o "$tmp/s.nrrd" -q
exits "a series" 0 "$leafcast" convert "$tmp/s_0000.nrrd" "$tmp/s_0001.nrrd" "$tmp/s_0002.nrrd" "$tmp/s_0003.nrrd" --treelet 16 -o "$tmp/s.leaf" -q
client "read" python3 tests/support/reads_ahead.py "$leafcast" "$tmp"
finish
