#!/bin/sh
# kept_files.sh - files that are to be read for ever (FORMAT.md 13): sound, and with the samples that they had.
. tests/support/tap.sh

cp -R tests/references/kept "$tmp/kept"
# What is left in other files must have the time that it had.
find "$tmp/kept/u8.nrrd" "$tmp/kept/in.zarr" -type f -exec touch -d @1795000000 {} +

the_same() { sha256sum "$tmp/out.$2" | grep -q "^$3"; }

while read -r name form step sum; do
    exits "$name is sound" 0 "$leafcast" verify "$tmp/kept/$name.leaf"
    exits "its samples" 0 "$leafcast" export "$tmp/kept/$name.leaf" -o "$tmp/out.$form" --step "$step" --force -q
    ok "are what they were" the_same "$name" "$form" "$sum"
done <<'FILES'
grid_f32_zstd npy 0 d3a5b44c6d79b02a
grid_u16_level_0 npy 0 c13cb262769b6544
grid_u8 npy 0 bfc964f2037232b5
grown npy 5 be4d4b8467faba2c
mesh vtu 0 92dd0653ce96abb9
mesh_series vtu 1 abd8bfbe9c7ef295
mesh_zstd vtu 0 92dd0653ce96abb9
outside npy 0 bfc964f2037232b5
outside_chunks npy 0 bfc964f2037232b5
series npy 10 a5fd8fce4a932955
steps npy 0 648d0f58db567783
FILES
ok "each file has a row" [ "$(find "$tmp/kept" -name '*.leaf' | wc -l)" -eq "$(grep -c '^[a-z0-9_]* \(npy\|vtu\) [0-9]* [0-9a-f]*$' "$0")" ]

finish
