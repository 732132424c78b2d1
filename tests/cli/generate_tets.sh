#!/bin/sh
# generate_tets.sh - leafcast generate --tets: its flags, the stream it writes, its exit codes.
# marks: long
. tests/support/tap.sh

out=$tmp/a.mesh
left() { [ "$(find "$tmp" -name '*.mesh*' | wc -l)" = "$1" ]; }
# size FILE POINTS TETS - a stream of a bucky ball of so many
size() {
    printf 'LEAFCAST MESH 1\nname: buckyball\nfield: buckyball\npoints: %d\ntets: %d\n\n' "$2" "$3" >"$tmp/head"
    head -c "$(wc -c <"$tmp/head")" "$1" | cmp -s - "$tmp/head" &&
        [ "$(wc -c <"$1")" = $(($(wc -c <"$tmp/head") + 16 * $2 + 16 * $3)) ]
}

exits "the bucky ball" 0 "$leafcast" generate buckyball --tets --dims 32 -o "$out"
ok "has 178746 tets" size "$out" 32768 178746
ok "says nothing" [ ! -s "$tmp/err" ]
exits "an existing output" 1 "$leafcast" generate sphere --tets --dims 8 -o "$out"
ok "is kept" size "$out" 32768 178746
exits "standard output, one thread, little memory" 0 \
    "$leafcast" generate buckyball --tets --dims 32 --type f32 --threads 1 --memory 256K -o -
ok "gets the same bytes" cmp -s "$tmp/out" "$out"
mv "$tmp/out" "$tmp/still"
exits "deformed" 0 "$leafcast" generate buckyball --tets --dims 32 --deform 0.5 -o "$out" --force
ok "has as many bytes" size "$out" 32768 178746
ok "but others" [ "$(cmp "$tmp/still" "$out" | wc -l)" = 1 ]
exits "copies" 0 "$leafcast" generate buckyball --tets --dims 5,4x3 --replicate 2,3,4 -o "$out" --force
ok "are each there" size "$out" $((24 * 60)) $((24 * 144))
rm -f "$out"

exits "a time series" 0 "$leafcast" generate buckyball --tets --dims 9 --deform 0.9 --steps 4 -o "$tmp/s_%04d.mesh"
ok "is a file a step" left 4
ok "each whole" size "$tmp/s_0003.mesh" 729 3072
"$leafcast" generate buckyball --tets --dims 9 --deform 0.9 -o "$out"
ok "a quarter of the way it is where --deform says" cmp -s "$tmp/s_0001.mesh" "$out"
"$leafcast" generate buckyball --tets --dims 9 -o "$out" --force
ok "it begins undeformed" cmp -s "$tmp/s_0000.mesh" "$out"
rm -f "$tmp"/*.mesh
exits "of a field that changes with time" 0 "$leafcast" generate vortex --tets --dims 9 --steps 3 -o "$out"
ok "is a file a step" left 3
"$leafcast" generate vortex --tets --dims 9 -o "$out"
ok "it begins at time 0" cmp -s "$tmp/a_0000.mesh" "$out"
ok "points and tets are the same, values are not" python3 -c 'import sys
a, b = (open(f, "rb").read() for f in sys.argv[1:])
head = len(a) - 729 * 16 - 3072 * 16
points, values = head + 729 * 12, head + 729 * 16
sys.exit(a[:points] != b[:points] or a[values:] != b[values:] or a == b)' "$tmp/a_0000.mesh" "$tmp/a_0002.mesh"
exits "of one that does not" 2 "$leafcast" generate sphere --tets --dims 8 --steps 3 -o "$out"
ok "both ways out are told" grep -q 'these change: drop, jets, vortex; or --deform' "$tmp/err"
rm -f "$tmp"/*.mesh

for wrong in "--dims 8 --replicate 2" "--dims 8 --deform 0.5" "--dims 8 --deform 0.5 --steps 3" \
    "--tets" "--tets --dims 1" "--tets --dims 8 --type u8" "--tets --dims 8 --deform 0" \
    "--tets --dims 8 --deform 0.95" "--tets --dims 8 --deform nan" "--tets --dims 8 --replicate 0" \
    "--tets --dims 8 --replicate 1.5" "--tets --dims 8 --replicate 2,2" "--tets --dims 8 --steps 3" \
    "--tets --dims 8 --deform 0.1 --steps 0" "--tets --dims 8 --replicate 40000" \
    "--tets --dims 2 --replicate 1024" "--tets --dims 8 --spacing 0" "--tets --dims 8 --spacing 1e31"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "usage: generate sphere $wrong" 2 "$leafcast" generate sphere $wrong -o "$out"
done
exits "a series to a pipe" 2 "$leafcast" generate sphere --tets --dims 8 --deform 0.5 --steps 2 -o -
exits "too little memory" 4 "$leafcast" generate sphere --tets --dims 8 --memory 1K -o "$out"
exits "a folder that is not there" 1 "$leafcast" generate sphere --tets --dims 8 -o "$tmp/none/a.mesh"
if [ -e /dev/full ]; then
    # shellcheck disable=SC2016
    exits "a full disk" 4 sh -c '"$1" generate sphere --tets --dims 32 -o - >/dev/full' sh "$leafcast"
fi
# shellcheck disable=SC2016
exits "a file that may not grow" 4 sh -c 'ulimit -f 10; "$1" generate sphere --tets --dims 64 -o "$2"' sh "$leafcast" "$out"
ok "none of them leaves a file" left 0

# 8^3 bucky balls through a pipe.
# shellcheck disable=SC2016
run sh -c '"$1" generate buckyball --tets --dims 32 --replicate 8 --memory 16M -o - | wc -c' sh "$leafcast"
ok "90 million tets, 1.7 GB, in 16 MiB" [ "$(cat "$tmp/out")" = $((82 + 16 * 16777216 + 16 * 91517952)) ]
finish
