#!/bin/sh
# convert.sh - leafcast convert, verify, info: flags, exit codes, what they say and leave behind.
. tests/support/tap.sh

in=$tmp/gyroid.nrrd
out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
left() { [ "$(find "$tmp" -name '*.leaf*' | wc -l)" = "$1" ]; }
run "$leafcast" generate gyroid --dims 70,60,50 --type u16 -o "$in"

exits "a small volume" 0 "$leafcast" convert "$in" -o "$out"
ok "tells the file's size" says '^file .* of raw$' out
ok "tells grid and levels" says '^grid  *70 x 60 x 50 u16, 3 levels, 15 treelets$' out
ok "tells values, time, memory" [ "$(grep -c '^values\|^time\|^memory' "$tmp/out")" = 3 ]
ok "says nothing else" [ ! -s "$tmp/err" ]
ok "leaves one file" left 1
exits "verify" 0 "$leafcast" verify "$out"
ok "says it is sound" says ': sound: 15 treelets' out
exits "verify --json" 0 "$leafcast" verify "$out" --json
ok "is JSON" says '"sound": true' out

exits "an existing output" 1 "$leafcast" convert "$in" -o "$out"
ok "and the way out is told" says '--force' err
exits "--force -q" 0 "$leafcast" convert "$in" -o "$out" --force -q
ok "is quiet" [ ! -s "$tmp/out" -a ! -s "$tmp/err" ]
exits "--force" 0 "$leafcast" convert "$in" -o "$out" --force --json
ok "with --json" says '"treelets": 15' out
for how in "--threads 1" "--threads 3 --memory 6M" "--memory 40M"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "convert $how" 0 "$leafcast" convert "$in" -o "$tmp/b.leaf" --force $how
    ok "gives the same bytes" cmp -s "$out" "$tmp/b.leaf"
done
ok "from standard input" sh -c '"$1" convert - -o "$2" --force <"$3" >"$4"' - "$leafcast" "$tmp/b.leaf" "$in" "$tmp/out"
ok "the same bytes" cmp -s "$out" "$tmp/b.leaf"
exits "zstd" 0 "$leafcast" convert "$in" -o "$tmp/z.leaf" --compress zstd:5
exits "verify it" 0 "$leafcast" verify "$tmp/z.leaf"
ok "it is smaller" [ "$(wc -c <"$tmp/z.leaf")" -lt "$(wc -c <"$out")" ]
exits "treelets of 16, no halo" 0 "$leafcast" convert "$in" -o "$tmp/c.leaf" --treelet 16 --halo 0
exits "verify them" 0 "$leafcast" verify "$tmp/c.leaf"
exits "info" 0 "$leafcast" info "$tmp/c.leaf" --iso 30000 --iso 70000
ok "knows the treelets" says '^treelets  *16^3 cells, halo 0' out
ok "counts active cells" says '^isovalue 30000: [1-9][0-9]* active cells' out
ok "finds none outside the range" says '^isovalue 70000: 0 active cells, 0 active treelets' out
exits "info --json" 0 "$leafcast" info "$tmp/c.leaf" --iso -5 --json
ok "is JSON" says '"treelet_cells": 16' out
ok "with isovalues" says '"active_cells": 0' out
rm -f "$tmp"/*.leaf

exits "--dry-run" 0 "$leafcast" convert "$in" --dry-run
ok "tells levels, file, memory, spilling" [ "$(grep -c '^levels\|^file\|^memory\|^spilled  *nothing' "$tmp/out")" = 4 ]
run "$leafcast" generate gyroid --dims 140,120,80 --type u16 -o "$tmp/wide.nrrd"
exits "--dry-run with little memory" 0 "$leafcast" convert "$tmp/wide.nrrd" --dry-run --memory 4M --threads 1
ok "says what is spilled" says '^spilled  *[1-9] levels through a temporary file' out
exits "--dry-run --json" 0 "$leafcast" convert "$in" --dry-run --json -o "$out"
ok "is JSON" says '"memory_least": ' out
ok "writes nothing" left 0

exits "too little memory" 4 "$leafcast" convert "$in" -o "$out" --memory 300K
ok "says how much would do" says 'this input needs [0-9]* MiB' err
ok "leaves nothing" left 0
head -c 20000 "$in" >"$tmp/short.nrrd"
exits "an input cut short" 3 "$leafcast" convert "$tmp/short.nrrd" -o "$out"
ok "names the file" says 'short.nrrd' err
printf 'not a volume, whatever it is\n' >"$tmp/text.nrrd"
exits "an input that is none" 3 "$leafcast" convert "$tmp/text.nrrd" -o "$out"
exits "an input that is not there" 1 "$leafcast" convert "$tmp/none.nrrd" -o "$out"
exits "a folder that is not there" 1 "$leafcast" convert "$in" -o "$tmp/none/a.leaf"
ok "all leave nothing" left 0
if [ "$(df --output=fstype "$tmp" 2>/dev/null | tail -n 1)" ]; then
    (ulimit -f 100 && exec "$leafcast" convert "$in" -o "$out") >"$tmp/out" 2>"$tmp/err"
    rc=$?
    ok "no room on the disk: exit 4 (got $rc)" [ "$rc" = 4 ]
    ok "leaves nothing" left 0
fi

head -c 8000 /dev/zero >"$tmp/raw.bin"
exits "raw samples with hints" 0 "$leafcast" convert "$tmp/raw.bin" --dims 10,20,20 --type u16 --spacing 1,-2,0.5 \
    --origin -1,0,1 -o "$out"
exits "info" 0 "$leafcast" info "$out"
ok "has spacing and origin" says '^  *0  -2  0  0$' out
rm -f "$out"
printf '0 1 2 4 8 16 32 64 128 256' >"$tmp/x.txt"
exits "an axis file" 0 "$leafcast" convert "$tmp/raw.bin" --dims 10,20,20 --type u16 --axis-x "$tmp/x.txt" -o "$out"
exits "info" 0 "$leafcast" info "$out"
ok "is rectilinear" says '^space  *rectilinear' out
exits "an axis scaled" 0 "$leafcast" convert "$tmp/raw.bin" --dims 10,20,20 --type u16 --axis-x "$tmp/x.txt" --spacing -0.5,1,1 -o "$out" --force
exits "info" 0 "$leafcast" info "$out" --json
ok "the coordinates are scaled" says '^ *-0.5,$' out
printf '\0\0\200\077\0\0\0\100\0\0\200\277\0\0\0\100\0\0\200\077\0\0\0\100\0\0\200\077\0\0\0\100' >"$tmp/f.bin"
exits "missing data" 0 "$leafcast" convert "$tmp/f.bin" --dims 2,2,2 --type f32 --missing=-1 -o "$tmp/m.leaf"
ok "is counted" says '^no data  *1 samples' out
ok "and is not the minimum" says '^values  *1 .. 2$' out
exits "missing data among integers" 0 "$leafcast" convert "$tmp/raw.bin" --dims 10,20,20 --type u16 --missing 3 -o "$tmp/i.leaf"
exits "a one-sample axis" 3 "$leafcast" convert "$tmp/raw.bin" --dims 10,400,1 --type u16 -o "$tmp/flat.leaf"

printf 'x' | dd of="$out" bs=1 seek=9000 conv=notrunc 2>/dev/null
exits "verify a damaged file" 3 "$leafcast" verify "$out"
ok "names file and byte" says 'a.leaf: byte ' err
printf 'x' | dd of="$out" bs=1 seek=100 conv=notrunc 2>/dev/null
exits "info on a damaged header" 3 "$leafcast" info "$out"
exits "info on what is no treelet file" 3 "$leafcast" info "$tmp/raw.bin"

for verb in convert verify info; do
    exits "help of $verb" 0 "$leafcast" $verb --help
    ok "is on standard output" [ ! -s "$tmp/err" ]
    exits "$verb without a file" 2 "$leafcast" $verb
done
for wrong in "$in" "$in $in --times 1 -o $out" "$in -o $out --compress lzma" "$in -o $out --compress zstd:99" \
    "$in -o $out --treelet 48" "$in -o $out --treelet 128" "$in -o $out --halo 2" "$in -o $out --dims 3,4" \
    "$in -o $out --type u7" "$in -o $out --spacing 0,1,1" "$in -o $out --threads 0" "$in -o $out --memory x"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "usage: convert $wrong" 2 "$leafcast" convert $wrong
done
exits "verify two files" 2 "$leafcast" verify "$in" "$in"
exits "info without an isovalue" 2 "$leafcast" info "$in" --iso x
finish
