#!/bin/sh
# verify_repair.sh - a damaged treelet file is named part by part, and made whole from another copy: leafcast verify --repair.
# marks: plain
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
tells() { grep -q -- "$1" "$tmp/out"; }
# damage FILE BYTE... - other bytes there
damage() {
    file=$1
    shift
    for at; do printf '\377\001\376' | dd of="$file" bs=1 seek="$at" conv=notrunc 2>/dev/null; done
}
copies() { # copies SOUND: into bad.leaf and from.leaf
    cp "$1" bad.leaf
    cp "$1" from.leaf
}
# whole NAME SOUND OPTION... - mended with these options; what is made is as the sound file
whole() {
    name=$1
    sound=$2
    shift 2
    exits "$name" 0 "$leafcast" verify bad.leaf --repair from.leaf "$@"
    ok "$name: as it was" cmp "$sound" "${made:-bad.leaf}"
    ok "$name: nothing else is there" [ -z "$(find . -name "*partial*")" ]
}

cd "$tmp" || exit 1
"$leafcast" generate gyroid --dims 70 -o g.nrrd -q
"$leafcast" convert g.nrrd -o g.leaf --treelet 16 -q
"$leafcast" convert g.nrrd -o z.leaf --treelet 16 --compress zstd -q
"$leafcast" generate buckyball --tets --dims 14 --steps 2 --deform 0.3 -o m.mesh -q
"$leafcast" convert m_0000.mesh m_0001.mesh -o m.leaf --coarse=20 --compress zstd -q
ok "inputs are there" [ -s g.leaf -a -s z.leaf -a -s m.leaf ]

# ---- verify names all that is damaged ----
cp g.leaf bad.leaf
damage bad.leaf 30000
exits "one damaged payload" 3 "$leafcast" verify bad.leaf
ok "is named, with its place" says "bad.leaf: byte .* treelet [0-9]*'s payload of [0-9]* bytes has the checksum"
damage bad.leaf 60000 200000
exits "several" 3 "$leafcast" verify bad.leaf
ok "are all named" says "bad.leaf: 3 parts are damaged: treelet [0-9]*'s payload, treelet [0-9]*'s payload, treelet"
run "$leafcast" verify bad.leaf --json
ok "likewise as JSON" tells '"message": "bad.leaf: 3 parts are damaged:'
size=$(wc -c <g.leaf)
# shellcheck disable=SC2046 # numbers
damage bad.leaf $(seq 40000 9000 "$((size - 100))")
exits "very many" 3 "$leafcast" verify bad.leaf
ok "are counted" says "and [0-9]* more$"

# ---- repair ----
for sound in g.leaf z.leaf m.leaf; do
    size=$(wc -c <$sound)
    copies $sound
    damage bad.leaf 30 4100 5000 $((size / 2)) $((size * 3 / 4))
    damage from.leaf $((size / 3))
    cp bad.leaf kept.leaf
    made=made.leaf
    whole "$sound, to another file" $sound -o made.leaf
    ok "$sound: the damaged file is as before" cmp bad.leaf kept.leaf
    ok "$sound: says it is sound" tells '^made.leaf: sound: [0-9]* treelets'
    ok "$sound: says what was taken" tells "^from from.leaf: [0-9]* of [0-9]* payloads, [0-9]* of [0-9]* parts"
    exits "$sound: the output is there" 1 "$leafcast" verify bad.leaf --repair from.leaf -o made.leaf
    whole "$sound: --force" $sound -o made.leaf --force -q
    ok "-q says nothing" [ ! -s "$tmp/out" ]
    made=
    whole "$sound, in place" $sound
    whole "$sound, once more" $sound
    ok "$sound: nothing was damaged" tells 'nothing was damaged'
    copies $sound
    head -c $((size / 2)) $sound >bad.leaf
    whole "$sound, cut short" $sound
    rm made.leaf
done
copies g.leaf
damage bad.leaf 60000
run "$leafcast" verify bad.leaf --repair from.leaf --json
ok "JSON: one payload was taken" tells '"payloads_taken": 1'
ok "JSON: mended" tells '"mended": true'

# ---- what cannot be ----
copies g.leaf
damage bad.leaf 60000 90000 200000
damage from.leaf 60010 200010
cp bad.leaf kept.leaf
exits "damaged in both" 3 "$leafcast" verify bad.leaf --repair from.leaf
ok "are named" says "2 parts are damaged in both bad.leaf and from.leaf: treelet [0-9]*'s payload, treelet [0-9]*'s payload$"
ok "the file is as before" cmp bad.leaf kept.leaf
exits "likewise for another file" 3 "$leafcast" verify bad.leaf --repair from.leaf -o made.leaf
ok "which is not there" [ ! -e made.leaf ]
exits "another file" 2 "$leafcast" verify bad.leaf --repair z.leaf
ok "is refused by its id" says "z.leaf the id $("$leafcast" info z.leaf --json | sed -n 's/.*"id": "\([0-9a-f]*\)".*/\1/p')"
damage bad.leaf 40
damage from.leaf 50
exits "no sound header" 3 "$leafcast" verify bad.leaf --repair from.leaf
ok "is told" says "the headers of both copies are damaged"
exits "a header that is not the other's" 3 "$leafcast" verify bad.leaf --repair z.leaf
ok "is told" says "nothing else tells that z.leaf is a copy"
exits "no such file" 1 "$leafcast" verify bad.leaf --repair none.leaf
exits "the same file" 2 "$leafcast" verify bad.leaf --repair bad.leaf
ln bad.leaf hard.leaf
exits "by another name" 2 "$leafcast" verify bad.leaf --repair hard.leaf
exits "and to another file" 2 "$leafcast" verify bad.leaf --repair hard.leaf -o made.leaf
exits "over the copy" 2 "$leafcast" verify bad.leaf --repair from.leaf -o from.leaf --force
exits "over the damaged file" 2 "$leafcast" verify bad.leaf --repair from.leaf -o bad.leaf --force
exits "to standard output" 2 "$leafcast" verify bad.leaf --repair g.leaf -o -
exits "-o without --repair" 2 "$leafcast" verify bad.leaf -o made.leaf
exits "--force without --repair" 2 "$leafcast" verify bad.leaf --force
exits "too little memory" 4 "$leafcast" verify bad.leaf --repair g.leaf --memory 1K
copies g.leaf
damage bad.leaf 60000
cp bad.leaf kept.leaf
(ulimit -f 100 && exec "$leafcast" verify bad.leaf --repair from.leaf) 2>&1 | cat >"$tmp/err"
ok "a limit on the size of files is told" says 'File too large'
ok "the file is as before" cmp bad.leaf kept.leaf
ok "and nothing is left" [ -z "$(find . -name "*partial*")" ]
finish
