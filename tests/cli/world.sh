#!/bin/sh
# world.sh - left and right: one body in the worlds of all formats that say which way their axes point is one picture,
# one value at a point, and one export.
# marks: long
. tests/support/tap.sh

export PYTHONDONTWRITEBYTECODE=1
for module in nibabel pydicom; do
    python=$(python_with $module)
    [ -n "$python" ] || { skip "files of $module" "no python3-$module here"; finish; }
done
"$python" tests/support/world.py "$leafcast" "$tmp" >"$tmp/results" 2>"$tmp/said"
rc=$?
results

# What a file does not say, the command line does, and what it says wrong.
"$leafcast" generate sphere --dims 8 -o "$tmp/s.nrrd" -q
says() { "$leafcast" info "$1" | sed -n 's/^axes *//p'; }
ok "axes that nobody tells" [ -z "$(says "$tmp/s.nrrd")" ]
exits "--axes and --unit" 0 "$leafcast" convert "$tmp/s.nrrd" --axes RAS --unit mm -o "$tmp/s.leaf" -q
ok "are in the file" [ "$(says "$tmp/s.leaf")" = "RAS (x to the right, y to the front, z to the head), mm" ]
exits "the file is sound" 0 "$leafcast" verify "$tmp/s.leaf" -q
"$leafcast" export "$tmp/s.leaf" -o "$tmp/r.nrrd" -q
exits "--axes none" 0 "$leafcast" convert "$tmp/r.nrrd" --axes none -o "$tmp/n.leaf" -q
ok "leaves the unit" [ "$(says "$tmp/n.leaf")" = mm ]
exits "--axes XYZ" 2 "$leafcast" convert "$tmp/s.nrrd" --axes XYZ -o "$tmp/x.leaf"
exits "render --axes XYZ" 2 "$leafcast" render "$tmp/s.leaf" --axes XYZ -o "$tmp/x.png"
exits "slice --axes" 0 "$leafcast" slice "$tmp/s.leaf" --axes LPS -o "$tmp/l.png" -q
sed 's/^space: .*/space: upside-down/' "$tmp/r.nrrd" >"$tmp/u.nrrd"
exits "a space that NRRD does not know" 3 "$leafcast" info "$tmp/u.nrrd"
ok "is named with its line" grep -q 'u.nrrd: line [0-9]*: .*upside-down' "$tmp/err"

# Steps of a series lie in one world.
sed 's/right-anterior-superior/left-posterior-superior/' "$tmp/r.nrrd" >"$tmp/l.nrrd"
exits "a series in two worlds" 3 "$leafcast" convert "$tmp/r.nrrd" "$tmp/l.nrrd" -o "$tmp/x.leaf"
ok "is told which" grep -q 'l.nrrd: its axes are LPS, expected RAS' "$tmp/err"

# Pictures name the ends of the axes.
exits "an annotated picture" 0 "$leafcast" render "$tmp/s.leaf" --annotate --size 300x300 -o "$tmp/a.png" -q
"$leafcast" render "$tmp/n.leaf" --annotate --size 300x300 -o "$tmp/b.png" -q
ok "differs from one of axes without names" [ "$(cksum <"$tmp/a.png")" != "$(cksum <"$tmp/b.png")" ]
finish
