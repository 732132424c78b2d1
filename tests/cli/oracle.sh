#!/bin/sh
# oracle.sh - convert, render --depth-f64, and the reference: no surface missed, none false, from far, near, inside, along
# grid planes. $LEAFCAST_ORACLE_EVERY: one pixel in so many (default 2 for test fields, 97 for scans).
# marks: long, plain
. tests/support/tap.sh

tools=${LEAFCAST_BUILD:-build/release}/tests
oracle=$tools/tool_oracle
[ -x "$oracle" ] || { skip oracle "no $oracle"; finish; }
table=$tmp/table

# judge NAME EVERY VOLUME_FLAGS VIEW_FLAGS - draw $tmp/v.leaf and compare with $tmp/v.nrrd or $volume.
judge() {
    judge_name=$1 judge_every=$2
    case $4 in *--eye* | *--view*) judge_view=$4 ;; *) judge_view="$4 --view standard" ;; esac
    # shellcheck disable=SC2086 # lists of flags
    run "$leafcast" render "$tmp/v.leaf" $judge_view --depth-f64 "$tmp/d" --force -q
    ok "$judge_name: render" [ "$rc" = 0 ]
    # shellcheck disable=SC2086
    run "$oracle" "$volume" $3 $4 --depth "$tmp/d" --every "$judge_every"
    ok "$judge_name: agrees with the reference" [ "$rc" = 0 ]
    sed 's/^/# /' "$tmp/out"
    printf '%-28s %s\n' "$judge_name" "$(tail -n 1 "$tmp/out" | sed 's/^[^ ]* *//')" >>"$table"
}

# Every test field: standard and close view, from the middle, in the plane through the middle of the grid.
every=${LEAFCAST_ORACLE_EVERY:-2}
for name in $("$tools/tool_field"); do
    volume=$tmp/v.nrrd
    run "$tools/tool_field" "$name" 20 1 "$volume"
    read -r iso kind <"$tmp/out"
    axes=
    [ "$kind" = regular ] || axes="--axis-x=$volume.x --axis-y=$volume.y --axis-z=$volume.z"
    # shellcheck disable=SC2086
    run "$leafcast" convert "$volume" $axes --treelet 16 -o "$tmp/v.leaf" --force -q
    ok "$name: convert" [ "$rc" = 0 ]
    view=
    case $name in
    flat-cells) view="--eye 90,10300,60 --look-at 10,10000,10" ;; # cells of 1 x 1000 x 1
    thin-cells) view="--eye 0.09,10.3,0.06 --look-at 0.01,10,0.01" ;; # of 0.001 x 1 x 0.001
    esac
    judge "$name" "$every" "$axes" "--iso $iso --size 72x72 $view"
    case $name in
    flat-cells | thin-cells | far | mirrored | rectilinear) continue ;;
    wild) continue ;; # filaments about grid edges, thinner than rounding: no band covers a ray along one
    esac
    judge "$name, close" "$every" "$axes" "--iso $iso --size 64x64 --view close"
    judge "$name, inside" "$every" "$axes" "--iso $iso --size 63x63 --eye 10,9.5,10 --look-at 12,9.5,10 --fov 100"
    judge "$name, in a plane" "$every" "$axes" "--iso $iso --size 65x65 --eye 10,-20,10 --look-at 10,10,10"
done

# Scans: NAME FILE TYPE DIMS ISO SPACING
every=${LEAFCAST_ORACLE_EVERY:-97}
while read -r name file type dims iso spacing; do
    [ -n "$data" ] && [ -f "$data/$name/$file.zst" ] || { skip "$name" "no data"; continue; }
    volume=$tmp/$file
    zstd -qdf "$data/$name/$file.zst" -o "$volume"
    run "$leafcast" convert "$volume" --spacing "$spacing" -o "$tmp/v.leaf" --force -q
    ok "$name: convert" [ "$rc" = 0 ]
    flags="--dims $dims --type $type --spacing $spacing"
    judge "$name" "$every" "$flags" "--iso $iso --size 320x320"
    judge "$name, close" "$every" "$flags" "--iso $iso --size 320x320 --view close"
    rm -f "$volume"
done <<SCANS
neghip neghip_64x64x64_uint8.raw u8 64,64,64 64 1,1,1
fuel fuel_64x64x64_uint8.raw u8 64,64,64 10 1,1,1
tooth tooth_103x94x161_uint8.raw u8 103,94,161 110 1,1,1
stent stent_128x128x256_float32.raw f32 128,128,256 0.15 1,1,1
engine engine_256x256x128_uint8.raw u8 256,256,128 80 1,1,1
bonsai bonsai_256x256x256_uint8.raw u8 256,256,256 37 1,1,1
headsq headsq_64x64x93_uint16.raw u16 64,64,93 500 3.2,3.2,1.5
cranium_ct cranium_ct_256x256x108_int16.raw i16 256,256,108 226 0.957,0.957,1.5
carotid carotid_76x49x45_float32.raw f32 76,49,45 190 1,1,1
SCANS
echo "# view                              rays      hits  missed   false too_far      worst        rms   grazing of_them"
sed 's/^/# /' "$table"
finish
