#!/bin/sh
# annotate.sh - marks in pictures: the box, the axes, the scale, a title.
. tests/support/tap.sh

leaf=$tmp/g.leaf
draw() { "$leafcast" render "$leaf" --size 200x160 -q "$@"; }
differ() { # differ A B LEAST: bytes that differ, at least
    [ "$(cmp -l "$1" "$2" | wc -l)" -ge "$3" ]
}
"$leafcast" generate sphere --dims 24 --type u8 -o "$tmp/g.nrrd" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$leaf" -q
font=$(ls /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf 2>/dev/null)

exits "no such font" 2 draw --title T --font "$tmp/no.ttf" -o "$tmp/x.ppm"
ok "is named" grep -q "no.ttf" "$tmp/err"
exits "a file that is none" 2 draw --title T --font "$tmp/g.nrrd" -o "$tmp/x.ppm"
ok "is named, too" grep -q "g.nrrd: no font" "$tmp/err"
ok "nothing was written" [ ! -e "$tmp/x.ppm" ]
exits "parts that are none" 2 draw --annotate=boxes -o "$tmp/x.ppm"
exits "a unit of nothing" 2 draw --unit mm -o "$tmp/x.ppm"
ok "says whose it is" grep -q -- "--unit is of --annotate" "$tmp/err"
if [ -z "$font" ]; then
    skip "marks: no DejaVu Sans here"
    finish
fi
exits "without" 0 draw -o "$tmp/without.ppm" --rgba-f64 "$tmp/without"
exits "all" 0 draw --annotate --rgba-f64 "$tmp/with" -o "$tmp/all.ppm"
ok "are in the picture" differ "$tmp/all.ppm" "$tmp/without.ppm" 2000
ok "not in raw colours" cmp "$tmp/with" "$tmp/without"
for part in box axes scale; do
    exits "$part" 0 draw --annotate=$part -o "$tmp/$part.ppm"
    ok "$part: is some of it" differ "$tmp/$part.ppm" "$tmp/without.ppm" 100
    ok "$part: not all" differ "$tmp/$part.ppm" "$tmp/all.ppm" 100
done
exits "a unit" 0 draw --annotate=scale --unit km -o "$tmp/unit.ppm"
ok "is written" differ "$tmp/unit.ppm" "$tmp/scale.ppm" 20
exits "a font of the caller's" 0 draw --annotate --font "$font" -o "$tmp/font.ppm"
ok "the same letters" cmp "$tmp/font.ppm" "$tmp/all.ppm"
exits "a legend in the same letters" 0 draw --project max --legend --title T -o "$tmp/legend.ppm"
exits "in dots" 0 draw --project max --legend -o "$tmp/dots.ppm"
ok "they differ" differ "$tmp/legend.ppm" "$tmp/dots.ppm" 300
printf '%s\n' '{"output": "'"$tmp"'/s1.ppm", "annotate": true}' '{"output": "'"$tmp"'/s2.ppm", "annotate": "scale", "unit": "km"}' \
    '{"output": "'"$tmp"'/s3.ppm", "annotate": false}' >"$tmp/script"
exits "a script" 0 draw --script "$tmp/script"
ok "all of it" cmp "$tmp/s1.ppm" "$tmp/all.ppm"
ok "a part" cmp "$tmp/s2.ppm" "$tmp/unit.ppm"
ok "none" cmp "$tmp/s3.ppm" "$tmp/without.ppm"
exits "smaller than its letters" 0 draw --size 9x4 --annotate --title T -o "$tmp/small.ppm"
finish
