#!/bin/sh
# bare_levels.sh - grids whose coarse levels have no samples (convert --levels 1): the same exact pictures, exports and
# probes as of a file with all; what needs the levels is refused, or does without.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
size() { wc -c <"$1"; }
# Made by two ways, a file of the same name in two folders: what is told must be the same, too.
mkdir "$tmp/all" "$tmp/one" "$tmp/place"

# both NAME COMMAND... - run it in all three folders; passes when it ends alike, and tells and leaves the same.
both() {
    title=$1
    shift
    for folder in all one place; do
        [ -e "$tmp/$folder/$name.leaf" ] || continue
        rm -f "$tmp/$folder"/out.*
        (cd "$tmp/$folder" && "$leafcast" "$@" >"$tmp/out" 2>"$tmp/err" </dev/null)
        rc=$?
        grep -v "^time" "$tmp/out" >"$tmp/$folder/out.said"
        ok "$name, $title, $folder: exit 0" [ "$rc" = 0 ]
        for file in "$tmp/$folder"/out.*; do
            case $folder in
            all) cp "$file" "$tmp/want.${file##*/}" ;;
            *) ok "$name, $title: the same ${file##*/}, $folder" cmp "$file" "$tmp/want.${file##*/}" ;;
            esac
        done
    done
}

# pair NAME OPTIONS... - NAME.leaf of the input $tmp/NAME.nrrd, with all levels, without, and in place without.
pair() {
    name=$1
    shift
    run "$leafcast" convert "$@" -o "$tmp/all/$name.leaf"
    ok "$name: with all levels" [ "$rc" = 0 ]
    exits "$name: without" 0 "$leafcast" convert "$@" -o "$tmp/one/$name.leaf" --levels 1 --threads 3
    ok "$name: is smaller" [ "$(size "$tmp/one/$name.leaf")" -lt "$(size "$tmp/all/$name.leaf")" ]
    exits "$name: is sound" 0 "$leafcast" verify "$tmp/one/$name.leaf"
}
in_place() {
    exits "$name: in place" 0 "$leafcast" convert "$@" -o "$tmp/place/$name.leaf" --levels 1 --in-place
    exits "$name: in place, sound" 0 "$leafcast" verify "$tmp/place/$name.leaf"
}

# look NAME COMMAND... - both(); where sanitizers watch each of the ways below for one of the volumes.
look() { ! one_in 3 || both "$@"; }

# pictures ISO EYE... - all ways to look.
pictures() {
    iso=$1
    shift
    leaf=$name.leaf
    look surface render "$leaf" --iso "$iso" "$@" --size 90x80 -o out.ppm --depth-f64 out.depth
    look shadows render "$leaf" --iso "$iso" "$@" --size 70x60 -o out.ppm --light 1,0.3,0.5 --shadows
    look transparent render "$leaf" --iso "$iso" --iso 0.7 --opacity 0.5 --opacity 0.4 "$@" --size 70x60 -o out.ppm
    look clipped render "$leaf" --iso "$iso" "$@" --size 60x50 -o out.ppm --caps --clip-box 5,5,5,40,30,28
    look medium render "$leaf" --tf auto "$@" --size 50x40 -o out.ppm
    look "coarse medium" render "$leaf" --tf auto "$@" --size 50x40 -o out.ppm --error 0.1
    for what in max min mean; do
        look "$what" render "$leaf" --project $what "$@" --size 50x40 -o out.ppm
    done
    look "first above" render "$leaf" --project first="$iso" "$@" --size 50x40 -o out.ppm
    look "a level per pixel" render "$leaf" --iso "$iso" "$@" --size 60x50 --lod exact -o out.ppm
    look slice slice "$leaf" --plane 1,0.5,0.25,-20 --value-f64 out.values -o out.ppm
    look "probed ray" probe "$leaf" --iso "$iso" --at 31,29 --size 60x50 "$@" --segments
    look "probed point" probe "$leaf" --point 12.25,9.5,8.125
    look "samples" export "$leaf" -o out.raw --format raw
    look "a surface" export "$leaf" --iso "$iso" -o out.ply
}

"$leafcast" generate noise --dims 75,67,50 --type f32 -o "$tmp/n.nrrd" -q
"$leafcast" generate gyroid --dims 80,40,44 --type u8 -o "$tmp/g.nrrd" -q
python3 - "$tmp" <<'PY'
import random, struct, sys
folder = sys.argv[1] + "/"
random.seed(5)
dims = 70, 41, 37
n = dims[0] * dims[1] * dims[2]
with open(folder + "holes.nrrd", "wb") as f:
    f.write(b"NRRD0004\ntype: float\ndimension: 3\nsizes: 70 41 37\nencoding: raw\nendian: little\n\n")
    f.write(struct.pack(f"<{n}f", *[float("nan") if i // 70 % 41 < 9 or random.random() < 0.02 else i % 70 / 70 +
                                    random.random() / 5 for i in range(n)]))
for k in range(3):
    with open(folder + f"step{k}.nrrd", "wb") as f:
        f.write(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 70 41 37\nencoding: raw\n\n")
        f.write(bytes((i % 70 * (k + 1) + i // 70 * 3 + i // 2870 * 2) % 256 for i in range(n)))
for a in "xyz":
    at, where = 0.0, []
    for i in range({"x": 75, "y": 67, "z": 50}[a]):
        where.append(at)
        at += 0.5 + random.random()
    open(folder + a + ".txt", "w").write("\n".join(map(str, where)))
PY

pair n "$tmp/n.nrrd" --treelet 16
in_place "$tmp/n.nrrd" --treelet 16
pictures 0.5 --eye 200,120,150
pair g "$tmp/g.nrrd" --compress zstd --treelet 16
in_place "$tmp/g.nrrd" --treelet 16
pictures 128 --eye 200,120,150
pair holes "$tmp/holes.nrrd" --treelet 16 --halo 0
in_place "$tmp/holes.nrrd" --treelet 16 --halo 0
pictures 0.55 --eye 200,120,150
pair uneven "$tmp/n.nrrd" --treelet 16 --axis-x "$tmp/x.txt" --axis-y "$tmp/y.txt" --axis-z "$tmp/z.txt"
pictures 0.5 --eye 200,120,150
pair steps "$tmp/step0.nrrd" "$tmp/step1.nrrd" "$tmp/step2.nrrd" --treelet 16 --compress zstd
for step in 0 1 2; do
    both "step $step" render steps.leaf --iso 100 --step $step --size 60x50 -o out.ppm
    both "samples of step $step" export steps.leaf --step $step --format raw -o out.raw
done

# ---- the same bytes, however it is made ----

for how in "--threads 1" "--threads 3 --memory 12M" "--checkpoint 0 --threads 2"; do
    # shellcheck disable=SC2086
    run "$leafcast" convert "$tmp/n.nrrd" -o "$tmp/again.leaf" --levels 1 --treelet 16 --force $how
    ok "the same bytes with $how" cmp "$tmp/again.leaf" "$tmp/one/n.leaf"
done
run "$leafcast" convert "$tmp/n.nrrd" -o "$tmp/again.leaf" --levels all --treelet 16 --force
ok "--levels all is what there is without it" cmp "$tmp/again.leaf" "$tmp/all/n.leaf"
run sh -c 'cat "$2" | "$1" convert - -o "$3" --levels 1 --treelet 16 --force' sh "$leafcast" "$tmp/n.nrrd" "$tmp/again.leaf"
ok "the same bytes from standard input" cmp "$tmp/again.leaf" "$tmp/one/n.leaf"

# ---- what is told ----

exits "a plan" 0 "$leafcast" convert "$tmp/n.nrrd" --dry-run --levels 1 --treelet 16 --json
cp "$tmp/out" "$tmp/plan"
run "$leafcast" convert "$tmp/n.nrrd" --dry-run --treelet 16 --json
ok "says the size, and that less memory is needed" python3 -c '
import json, os, sys
one, all = (json.load(open(name)) for name in sys.argv[1:3])
sys.exit(not (one["file_bytes"] == os.path.getsize(sys.argv[3]) and one["memory_least"] < all["memory_least"] and
              [l["sampled"] for l in one["levels"]] == [True] + [False] * (len(one["levels"]) - 1) and
              all["levels"][-1]["sampled"] and one["treelets"] == all["treelets"]))' "$tmp/plan" "$tmp/out" "$tmp/one/n.leaf"
exits "a plan in words" 0 "$leafcast" convert "$tmp/n.nrrd" --dry-run --levels 1 --treelet 16
ok "says that level 0 is alone" grep -q "^levels  *4 (0 alone with samples)" "$tmp/out"
exits "info" 0 "$leafcast" info "$tmp/one/n.leaf" --iso 0.5
ok "says so of each level" grep -q "^    1  *none  *[1-9][0-9]*  *0" "$tmp/out"
ok "and how it was made" grep -q "made by.* level 0 alone" "$tmp/out"
exits "info as JSON" 0 "$leafcast" info "$tmp/place/n.leaf" --iso 0.5 --json
ok "says which levels have samples, and divides by no payloads" python3 -c '
import json, sys
f = json.load(open(sys.argv[1]))
sys.exit(not ([l["sampled"] for l in f["levels"]] == [True, False, False, False] and f["payload_bytes"] == 0 and
              "deviation" not in f["levels"][1] and f["isovalues"][0]["active_share"] == 0))' "$tmp/out"

# ---- what needs the levels ----

refused() {
    title=$1
    shift
    exits "$title" 2 "$leafcast" "$@"
    ok "$title: says why" says "level of detail [0-9]*: .*n.leaf has samples of level 0 alone, as .leafcast convert --levels 1. made it"
    ok "$title: leaves nothing" [ ! -e "$tmp/no.ppm" ]
}
refused "a picture of level 1" render "$tmp/one/n.leaf" --iso 0.5 --lod 1 --size 20x20 -o "$tmp/no.ppm"
refused "a preview of level 1" render "$tmp/one/n.leaf" --iso 0.5 --lod 1 --preview --size 20x20 -o "$tmp/no.ppm"
refused "a medium of level 1" render "$tmp/one/n.leaf" --tf auto --lod 1 --size 20x20 -o "$tmp/no.ppm"
refused "a projection of level 2" render "$tmp/one/n.leaf" --project max --lod 2 --size 20x20 -o "$tmp/no.ppm"
refused "a ray through level 1" probe "$tmp/one/n.leaf" --iso 0.5 --lod 1 --at 3,3
refused "samples of level 1" export "$tmp/one/n.leaf" --level 1 -o "$tmp/no.raw"
refused "a surface of level 1" export "$tmp/one/n.leaf" --level 1 --iso 0.5 -o "$tmp/no.ply"
exits "level 0 by name" 0 "$leafcast" render "$tmp/one/n.leaf" --iso 0.5 --lod 0 --size 20x20 -o "$tmp/zero.ppm"
name=n
both "as coarse as pixels" render n.leaf --iso 0.5 --size 900x800 --lod pixel -o out.ppm
exits "no level is coarse enough" 0 "$leafcast" render "$tmp/one/n.leaf" --iso 0.5 --size 16x16 --lod pixel -o "$tmp/p.ppm"
exits "exactly" 0 "$leafcast" render "$tmp/one/n.leaf" --iso 0.5 --size 16x16 -o "$tmp/q.ppm"
ok "then it is the exact picture" cmp "$tmp/p.ppm" "$tmp/q.ppm"
for way in "--iso 0.5" "--tf auto" "--project max"; do
    # shellcheck disable=SC2086
    exits "a preview, $way" 0 "$leafcast" render "$tmp/one/n.leaf" $way --preview --size 30x20 -o "$tmp/p.ppm" --force
done
exits "in little memory" 0 "$leafcast" render "$tmp/one/n.leaf" --iso 0.5 --memory 4M --size 90x80 --eye 200,120,150 -o "$tmp/p.ppm" --force
exits "and in much" 0 "$leafcast" render "$tmp/all/n.leaf" --iso 0.5 --size 90x80 --eye 200,120,150 -o "$tmp/q.ppm" --force
ok "it is the same picture" cmp "$tmp/p.ppm" "$tmp/q.ppm"

for word in 0 2 3 -1 1.5 none ALL ""; do
    exits "--levels \"$word\"" 2 "$leafcast" convert "$tmp/n.nrrd" -o "$tmp/no.leaf" --levels="$word"
    ok "is neither" says "convert: --levels: \"$word\" is neither 1 nor all"
done
run "$leafcast" generate buckyball --tets --dims 7 -o "$tmp/m.mesh"
exits "--levels of a mesh" 2 "$leafcast" convert "$tmp/m.mesh" -o "$tmp/no.leaf" --levels 1
ok "is told" says "--levels"
for no in leaf raw ply ppm; do ok "nothing is left of these: $no" [ ! -e "$tmp/no.$no" ]; done

# ---- damage ----

cp "$tmp/one/g.leaf" "$tmp/bad.leaf"
at=$(($(size "$tmp/bad.leaf") - 3000))
printf 'XXXXXXXXXXXXXXXX' | dd of="$tmp/bad.leaf" bs=1 seek=$at conv=notrunc 2>/dev/null
exits "a damaged one" 3 "$leafcast" verify "$tmp/bad.leaf"
exits "is an error" 3 "$leafcast" render "$tmp/bad.leaf" --iso 128 --size 60x50 -o "$tmp/no.ppm"
exits "or has a hole" 1 "$leafcast" render "$tmp/bad.leaf" --iso 128 --size 60x50 --allow-missing -o "$tmp/hole.ppm" --stats "$tmp/stats"
ok "which is counted" python3 -c '
import json, sys
s = json.load(open(sys.argv[1]))
sys.exit(not (s["treelets"]["lost"] > 0 and s["provisional_pixels"] > 0))' "$tmp/stats"
exits "repaired from a copy" 0 "$leafcast" verify "$tmp/bad.leaf" --repair "$tmp/one/g.leaf"
ok "it is whole again" cmp "$tmp/bad.leaf" "$tmp/one/g.leaf"

# ---- of real scans, an index in place is at most 0.02 of the samples ----

for scan in bonsai_256x256x256_uint8 engine_256x256x128_uint8 tooth_103x94x161_uint8 walnut_128x96x114_uint16 \
    ct_head_128_128x128x112_uint16 embryo_256x256x256_uint8 cranium_ct_256x256x108_int16 lobster_12bit_120x120x34_uint16; do
    packed=$data/${scan%_*_*}/$scan.raw.zst
    if [ -z "$data" ] || [ ! -e "$packed" ] || ! command -v zstd >/dev/null; then
        skip "$scan" "the data folder or zstd is not here"
        continue
    fi
    one_in 4 || continue
    zstd -dqf "$packed" -o "$tmp/$scan.raw"
    name=scan
    run "$leafcast" convert "$tmp/$scan.raw" -o "$tmp/all/scan.leaf" --force
    exits "$scan: in place" 0 "$leafcast" convert "$tmp/$scan.raw" -o "$tmp/place/scan.leaf" --levels 1 --in-place --force
    index=$(size "$tmp/place/scan.leaf") raw=$(size "$tmp/$scan.raw")
    ok "$scan: $index bytes are at most 0.02 of $raw" [ $((50 * index)) -le "$raw" ]
    both surface render scan.leaf --size 120x100 -o out.ppm --depth-f64 out.depth
    both samples export scan.leaf -o out.raw
    rm "$tmp/$scan.raw"
done
finish
