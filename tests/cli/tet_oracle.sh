#!/bin/sh
# tet_oracle.sh - meshes: convert, render --depth-f64, and the reference: no surface missed, none false, distances within
# 1e-5 of the local edge. $LEAFCAST_ORACLE_EVERY: one pixel in so many (default 8 for test meshes, 97 for the others).
# marks: plain, long
. tests/support/tap.sh

tools=${LEAFCAST_BUILD:-build/release}/tests
oracle=$tools/tool_tet_oracle
[ -x "$oracle" ] || { skip tet_oracle "no $oracle"; finish; }
table=$tmp/table

# judge NAME EVERY MESH_FLAGS VIEW_FLAGS - draw $tmp/v.leaf and compare.
judge() {
    case $4 in *--eye* | *--view*) judge_view=$4 ;; *) judge_view="$4 --view standard" ;; esac
    # shellcheck disable=SC2086 # lists of flags
    run "$leafcast" render "$tmp/v.leaf" $judge_view --depth-f64 "$tmp/d" --force -q
    ok "$1: render" [ "$rc" = 0 ]
    # shellcheck disable=SC2086
    run "$oracle" $3 $4 --depth "$tmp/d" --every "$2"
    ok "$1: agrees with the reference" [ "$rc" = 0 ]
    sed 's/^/# /' "$tmp/out"
    printf '%-28s %s\n' "$1" "$(tail -n 1 "$tmp/out" | sed 's/^[^ ]* *//')" >>"$table"
}

# convert NAME INPUT FLAGS - to $tmp/v.leaf.
convert() {
    # shellcheck disable=SC2086
    run "$leafcast" convert "$2" $3 -o "$tmp/v.leaf" --force -q
    ok "$1: convert" [ "$rc" = 0 ]
}

# Every test mesh, in the standard and the close view.
every=${LEAFCAST_ORACLE_EVERY:-8}
for name in $("$tools/tool_tet_mesh"); do
    run "$tools/tool_tet_mesh" "$name" 7 1 "$tmp/v.mesh"
    read -r iso <"$tmp/out"
    convert "$name" "$tmp/v.mesh" ""
    view=
    case $name in
    needle*) view="--eye 3500,-9,6 --look-at 3500,3.5,3.5" ;; # cubes of 1000 x 1 x 1
    esac
    judge "$name" "$every" "$tmp/v.mesh" "--iso $iso --size 72x72 $view"
    judge "$name, close" "$every" "$tmp/v.mesh" "--iso $iso --size 64x64 --view close"
done

# Along edges, in faces: eyes on vertices' planes, looking along them; from inside; several isovalues.
"$tools/tool_tet_mesh" noise 8 2 "$tmp/v.mesh" >/dev/null
convert noise "$tmp/v.mesh" ""
judge "noise, in a plane" 1 "$tmp/v.mesh" "--iso 0.6 --size 65x65 --eye 4,-12,4 --look-at 4,4,4"
judge "noise, along a diagonal" 1 "$tmp/v.mesh" "--iso 0.6 --size 65x65 --eye 20,20,20 --look-at 4,4,4"
judge "noise, inside" 1 "$tmp/v.mesh" "--iso 0.6 --size 63x63 --eye 4,3.5,4 --look-at 6,3.5,4 --fov 100"
judge "noise, four isovalues" 1 "$tmp/v.mesh" \
    "--iso 0.9 --iso 0.3 --iso 0.5 --iso 0.7 --size 64x64 --clip-box 1,1,1,8,8,7.5"
"$tools/tool_tet_mesh" vertex-values 8 2 "$tmp/v.mesh" >/dev/null
convert vertex-values "$tmp/v.mesh" ""
judge "vertex-values, in a plane" 1 "$tmp/v.mesh" "--iso 2 --size 65x65 --eye 4,-12,4 --look-at 4,4,4"

# The blunt fin.
every=${LEAFCAST_ORACLE_EVERY:-97}
if [ -n "$data" ] && [ -f "$data/bluntfin/bluntfinxyz.bin" ]; then
    "$tools/tool_split_plot3d" "$data/bluntfin/bluntfinxyz.bin" "$data/bluntfin/bluntfinq.bin" "$tmp/v.mesh"
    convert "blunt fin" "$tmp/v.mesh" ""
    for iso in 1 2 4; do
        judge "blunt fin, $iso" "$every" "$tmp/v.mesh" "--iso $iso --size 320x320"
        judge "blunt fin, $iso, at the fin" "$every" "$tmp/v.mesh" \
            "--iso $iso --size 320x320 --eye -5,5,4 --look-at 0.7,0.7,2.7"
    done
else
    skip "blunt fin" "no data"
fi

# Meshes of simulations: FOLDER FILE FIELD ARRAY ISO
while read -r folder file field array iso; do
    [ -n "$data" ] && [ -f "$data/$folder/$file" ] || { skip "$folder" "no data"; continue; }
    convert "$folder" "$data/$folder/$file" "--field $field"
    mesh="--points $data/$folder/points_f32x3.raw.zst --tets $data/$folder/tets_i32x4.raw.zst"
    mesh="$mesh --values $data/$folder/$array"
    judge "$folder" "$every" "$mesh" "--iso $iso --size 320x320"
    judge "$folder, close" "$every" "$mesh" "--iso $iso --size 320x320 --view close"
done <<END
tet_pipe_flow rigid_wall_flow.vtu Pressure pressure_f32.raw.zst 1300
tet_heart_lv result_200.vtu VonMises_stress vonmises_f32.raw.zst 38000
tet_beam result_100.vtu VonMises_stress vonmises_f32.raw.zst 1e9
tet_turb_degenerate xsmall_turb.vtu tur_mu tur_mu_f32.raw.zst 3e-5
END

echo "# view                              rays      hits  missed   false too_far      worst        rms   grazing of_them"
sed 's/^/# /' "$table"
finish
