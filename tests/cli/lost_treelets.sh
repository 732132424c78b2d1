#!/bin/sh
# lost_treelets.sh - pictures of files with damaged treelets: refused, or drawn without them (--allow-missing), the same
# way whatever the threads, memory and backend.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
run "$leafcast" generate gyroid --dims 120,110,100 --type u8 -o "$tmp/g.nrrd"
run "$leafcast" generate noise --dims 24 --tets -o "$tmp/m.mesh"
run "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/raw.leaf"
run "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/zstd.leaf" --compress zstd
run "$leafcast" convert "$tmp/m.mesh" -o "$tmp/mesh.leaf" --treelet-tets 1000
printf '0 0 0 0 0\n0.5 1 0 0 0\n0.6 1 1 0 90\n1 0 0 1 90\n' >"$tmp/thin.tf"
printf '0 0 0 0 0\n100 1 0 0 0\n110 1 1 0 9\n255 0 0 1 9\n' >"$tmp/opaque.tf"
# damage FILE SHARES... - a copy, with bytes that differ at these tenths.
damage() {
    cp "$tmp/$1.leaf" "$tmp/bad_$1.leaf"
    name=$1
    size=$(wc -c <"$tmp/$1.leaf")
    shift
    for tenths in "$@"; do
        printf 'damage damage damage damage damage damage damage damage' |
            dd of="$tmp/bad_$name.leaf" bs=1 seek=$((size * tenths / 10)) conv=notrunc 2>/dev/null
    done
}
damage raw 3 5 6
damage zstd 3 5 6
damage mesh 4 6
pixels=90x80
[ -z "$watched" ] || pixels=45x40
marked() { sed -n 's/.*; \([0-9]*\) pixels, marked.*/\1/p' "$tmp/err"; }

# lacking NAME FILE ARGUMENTS... - strict pictures are refused by name; lenient ones are all the same.
lacking() {
    name=$1
    file=$2
    shift 2
    exits "$name: refused" 3 "$leafcast" render "$tmp/bad_$file.leaf" "$@" --size $pixels -o "$tmp/p.ppm"
    ok "by name" says "treelet [0-9]*'s .* has the checksum"
    ok "without a picture" [ ! -e "$tmp/p.ppm" ]
    exits "$name: drawn without them" 1 "$leafcast" render "$tmp/bad_$file.leaf" "$@" --size $pixels -o "$tmp/p.ppm" --allow-missing --stats "$tmp/stats" --threads 1 --force
    ok "says which" says "treelets are lost, the first as .*treelet [0-9]*'s .* has the checksum"
    ok "pixels are marked: $(marked)" [ "$(marked)" -gt 0 ]
    ok "and counted" grep -q '"lost": [1-9]' "$tmp/stats"
    cp "$tmp/p.ppm" "$tmp/first.ppm"
    for how in "--threads 3" "--memory 12M" "--isa scalar" "--sweep"; do
        one_in 3 || continue # each of them for other pictures
        # shellcheck disable=SC2086 # split on purpose
        exits "$name, $how" 1 "$leafcast" render "$tmp/bad_$file.leaf" "$@" --size $pixels -o "$tmp/p.ppm" --force --allow-missing $how
        ok "the same picture" cmp "$tmp/first.ppm" "$tmp/p.ppm"
    done
    run "$leafcast" render "$tmp/$file.leaf" "$@" --size $pixels -o "$tmp/whole.ppm" --force
    ok "another one than of the whole file" sh -c '! cmp -s "$1" "$2"' sh "$tmp/whole.ppm" "$tmp/first.ppm"
    exits "$name, of the whole file" 0 "$leafcast" render "$tmp/$file.leaf" "$@" --size $pixels -o "$tmp/p.ppm" --force --allow-missing
    ok "the same as ever" cmp "$tmp/whole.ppm" "$tmp/p.ppm"
    rm -f "$tmp/p.ppm"
}
for file in raw zstd; do
    lacking "$file, a surface" $file --iso 128
    lacking "$file, shadows" $file --iso 128 --shadows --light 1,2,3 --shading phong
    lacking "$file, transparent" $file --iso 100 --opacity 0.5 --iso 150 --opacity 0.5
    lacking "$file, a medium" $file --tf auto
    lacking "$file, a mean" $file --project mean
    lacking "$file, the first" $file --project first=140
    lacking "$file, an opaque medium" $file --tf "$tmp/opaque.tf"
    lacking "$file, clipped, four rays a pixel" $file --iso 128 --clip-plane 1,0,0,-40 --samples 4
done
lacking "a mesh" mesh --iso 0.5
lacking "a mesh's medium" mesh --tf auto
lacking "an opaque medium" mesh --tf "$tmp/thin.tf"
lacking "the first in a mesh" mesh --project first=0.5
for how in "--clip-plane 1,0,0,-30 --caps" "--project max" "--project min" "--preview" "--progressive" "--tf auto --certify"; do
    iso="--iso 128"
    case $how in --project* | --tf*) iso= ;; esac
    # shellcheck disable=SC2086
    exits "--allow-missing $how" 2 "$leafcast" render "$tmp/bad_raw.leaf" $iso $how -o "$tmp/p.ppm" --allow-missing
done
exits "a sequence" 1 "$leafcast" render "$tmp/bad_raw.leaf" --iso-list 100,128,150 --size 60x50 -o "$tmp/p_%d.ppm" --allow-missing
ok "all pictures are there" [ -s "$tmp/p_0.ppm" ] && [ -s "$tmp/p_1.ppm" ] && [ -s "$tmp/p_2.ppm" ]
ok "says of how many" says 'of 3 pictures lack treelets that are damaged'
exits "the file is made whole" 0 "$leafcast" verify "$tmp/bad_raw.leaf" --repair "$tmp/raw.leaf"
exits "and drawn as ever" 0 "$leafcast" render "$tmp/bad_raw.leaf" --iso 128 --size 60x50 -o "$tmp/p.ppm" --allow-missing
finish
