#!/bin/sh
# compressed.sh - whatever is asked of a compressed file, the answer is the raw file's, and only what is seen is read.
# marks: leaks
. tests/support/tap.sh

size=64x48
[ -z "$watched" ] || size=$picture

# answer NAME VERB OPTION... - what the verb writes of the raw file and of the small one is the same.
answer() {
    what=$1 verb=$2
    shift 2
    for file in raw small; do
        exits "$what, $file" 0 "$leafcast" "$verb" "$tmp/$file.leaf" -o "$tmp/$file.$what" --force -q "$@"
    done
    ok "the same bytes" cmp "$tmp/raw.$what" "$tmp/small.$what"
}
# The mapping and the arena: the same bytes, and as many of them read.
same_from_backends() { # same_from_backends ISO
    for file in raw small; do
        one_in 2 || continue
        for backend in mapped arena; do
            "$leafcast" render "$tmp/$file.leaf" --iso "$1" --size $size --backend $backend --threads 1 \
                --depth-f64 "$tmp/$backend.depth" -o "$tmp/any.pfm" --stats "$tmp/$backend.json" --force -q || return 1
        done
        cmp "$tmp/mapped.depth" "$tmp/arena.depth" || return 1
        python3 -c 'import json, sys
a, b = (json.load(open(name)) for name in sys.argv[1:])
print(a["bytes"], b["bytes"])
sys.exit(any(a[key][of] != b[key][of]
             for key, of in [("bytes", "read"), ("bytes", "visible"), ("treelets", "loaded")]))' \
            "$tmp/mapped.json" "$tmp/arena.json" || return 1
    done
}
reads_what_it_sees() {
    python3 -c 'import json, sys
b = json.load(open(sys.argv[1]))["bytes"]
print(b)
sys.exit(not 0 < b["read"] == b["visible"] <= b["active"])' "$tmp/small.stats" >"$tmp/out"
}

exits "u8" 0 "$leafcast" generate orbital --dims 61,50,43 -o "$tmp/u8.nrrd" -q
exits "u16" 0 "$leafcast" generate noise --dims 49,67,35 --type u16 -o "$tmp/u16.nrrd" -q
exits "f32" 0 "$leafcast" generate marschner-lobb --dims 40,41,42 --type f32 -o "$tmp/f32.nrrd" -q
exits "next" 0 "$leafcast" generate gyroid --dims 40,41,42 --type f32 -o "$tmp/next.nrrd" -q
exits "a mesh" 0 "$leafcast" generate buckyball --tets --dims 14 -o "$tmp/tets.mesh" -q
tail -c $((49 * 67 * 35 * 2)) "$tmp/u16.nrrd" >"$tmp/i16.raw"

# An isovalue, an output of export, and what is converted.
while read -r iso whole inputs; do
    # shellcheck disable=SC2046,SC2086 # options
    for file in raw small; do
        compress=none
        [ $file = raw ] || compress=zstd
        exits "$inputs: $file" 0 "$leafcast" convert $(echo "$inputs" | sed "s|@|$tmp/|g") --compress $compress \
            -o "$tmp/$file.leaf" --force -q
    done
    ok "is smaller" [ "$(wc -c <"$tmp/small.leaf")" -lt "$(wc -c <"$tmp/raw.leaf")" ]
    exits "is whole" 0 "$leafcast" verify "$tmp/small.leaf" -q
    answer "whole.$whole" export
    answer surface.pfm render --iso "$iso" --size $size --stats "$tmp/small.stats"
    ok "reads what it sees" reads_what_it_sees
    ok "from a mapping, too" same_from_backends "$iso"
    answer tight.pfm render --iso "$iso" --size $size --memory 6M --threads 1
    answer medium.pfm render --tf auto --size 32x24
    answer most.pfm render --project max --size 32x24
    answer slice.ppm slice --axis x ${watched:+--size $picture}
done <<ROWS
40    nrrd @u8.nrrd
40    nrrd @u8.nrrd --treelet 16 --halo 0
40    nrrd @u8.nrrd --missing 0
30000 nrrd @u16.nrrd --treelet 16
-300  nrrd @i16.raw --type i16 --dims 49,67,35
0.5   nrrd @f32.nrrd @next.nrrd --treelet 16
0.3   vtu  @tets.mesh --treelet-tets 300
0.3   vtu  @tets.mesh --gradients --coarse=9
ROWS

# What siblings share counts for their level: the root has no more than its own samples.
head -c $((65 * 65 * 65)) /dev/urandom >"$tmp/any.raw"
exits "noise" 0 "$leafcast" convert "$tmp/any.raw" --type u8 --dims 65,65,65 --compress zstd -o "$tmp/any.leaf" -q
exits "its levels" 0 "$leafcast" info "$tmp/any.leaf" --json
ok "have their bytes" python3 -c 'import json, sys
levels = json.load(open(sys.argv[1]))["levels"]
print(levels)
sys.exit(not (len(levels) == 2 and levels[0]["bytes"] > 65**3 and 0 < levels[1]["bytes"] <= 35**3 + 16))' "$tmp/out"
finish
