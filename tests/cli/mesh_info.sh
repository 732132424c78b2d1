#!/bin/sh
# mesh_info.sh - leafcast info and verify on treelet files of meshes: what they say, and of bad ones.
. tests/support/tap.sh

out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
run "$leafcast" generate sphere --tets --dims 13 -o "$tmp/a.mesh"
for how in none zstd:3; do
    exits "convert, $how" 0 "$leafcast" convert "$tmp/a.mesh" -o "$out" --force --compress "$how"
    exits "info" 0 "$leafcast" info "$out" --iso 0.5 --iso 99
    ok "tets and vertices" says '^mesh  *10368 tets, 2197 vertices$' out
    ok "the field" says '^field  *sphere$' out
    ok "bounds of three axes" [ "$(grep -c ' 0 .. 12$' "$tmp/out")" = 3 ]
    ok "bytes of the file" says "^file  *$(wc -c <"$out") bytes, [0-9.]* a tet" out
    ok "tets take 8 bytes" says '^tets  *10368  *82944  *8.000$' out
    for part in positions nodes values 'value codes' padding topology; do
        ok "$part" says "^$part  *[0-9]" out
    done
    ok "active tets" says '^isovalue 0.5: [1-9][0-9]* active tets, 0.[0-9]* of all, [1-9]' out
    ok "or none" says '^isovalue 99: 0 active tets, 0.000 of all, 0 active treelets' out
    exits "info --json" 0 "$leafcast" info "$out" --json --iso 0.5
    ok "is JSON" python3 -c '
import json, os, sys
x = json.load(open(sys.argv[1]))
parts = x["parts"]
sizes = ["tets", "positions", "nodes", "values", "value_codes", "padding"]
raw = x["codec"] == "raw"
assert x["tets"] == 10368 and x["vertices"] == 2197 and x["bounds"] == [0, 0, 0, 12, 12, 12]
assert x["file_bytes"] == os.path.getsize(sys.argv[2])
assert parts["stored_topology"] + parts["stored_values"] == x["payload_bytes"]
assert not raw or sum(parts[s] for s in sizes) == x["payload_bytes"]
assert sum(row["payloads"] for row in x["payload_sizes"]) == 2 * x["treelets"]
assert 0 < x["isovalues"][0]["active_tets"] < x["tets"]
' "$tmp/out" "$out"
    exits "verify" 0 "$leafcast" verify "$out"
    ok "it is sound" says ': sound: [1-9][0-9]* treelets, ' out
done

size=$(wc -c <"$out")
head -c $((size - 1)) "$out" >"$tmp/short.leaf"
exits "cut short" 3 "$leafcast" info "$tmp/short.leaf"
ok "names the file" says 'short.leaf' err
cp "$out" "$tmp/bad.leaf"
printf '\377\377\377' | dd of="$tmp/bad.leaf" bs=1 seek=16384 conv=notrunc 2>/dev/null
exits "a payload changed" 3 "$leafcast" verify "$tmp/bad.leaf"
ok "names payload and byte" says "bad.leaf: byte [0-9]*: treelet [0-9]*'s topology" err
"$leafcast" generate sphere --dims 5 -o "$tmp/one.nrrd" -q
exits "a field of what has one" 2 "$leafcast" info "$tmp/one.nrrd" --field f
ok "says what it is for" grep -q -- '--field is for treelet files, and formats that have several, and .* is NRRD' "$tmp/err"
finish
