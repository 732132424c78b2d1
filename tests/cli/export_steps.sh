#!/bin/sh
# export_steps.sh - all steps of a grid as one NIfTI of four axes, and as OME-Zarr: what nibabel and Python's
# zarr read of them, and what comes back; folders that are there, or half written.
. tests/support/tap.sh

left() { [ -z "$(find "$tmp" -maxdepth 1 -name 'x.zarr*')" ]; }

# Steps at times of their own, of a generator's grids.
for i in 0 1 2 3; do
    "$leafcast" generate gyroid --dims 70,41,33 --type u16 --spacing 0.5,0.75,2 -o "$tmp/s$i.nrrd" -q
done
"$leafcast" generate orbital --dims 70,41,33 --type u16 --spacing 0.5,0.75,2 -o "$tmp/s2.nrrd" --force -q
"$leafcast" convert "$tmp"/s?.nrrd --times 1,3.5,6,8.5 --unit mm -o "$tmp/even.leaf" -q
"$leafcast" convert "$tmp"/s?.nrrd --times 1,3,6,7 -o "$tmp/uneven.leaf" -q
"$leafcast" convert "$tmp/s2.nrrd" -o "$tmp/one.leaf" -q

# NIfTI.
exits "all steps as .nii" 0 "$leafcast" export "$tmp/even.leaf" --step all -o "$tmp/a.nii"
ok "says how many" grep -q '^steps  *4$' "$tmp/out"
ok "loses nothing" [ ! -s "$tmp/err" ]
exits "packed, by a pipe, little memory" 0 "$leafcast" export "$tmp/even.leaf" --step all -o - --format nifti --memory 2M
ok "the same bytes" cmp "$tmp/out" "$tmp/a.nii"
exits "as .nii.gz" 0 "$leafcast" export "$tmp/even.leaf" --step all -o "$tmp/a.nii.gz"
# shellcheck disable=SC2016
ok "and what the other is" sh -c 'gzip -dc "$1" | cmp - "$2"' sh "$tmp/a.nii.gz" "$tmp/a.nii"
exits "NIfTI-2 by name" 0 "$leafcast" export "$tmp/even.leaf" --step all -o "$tmp/2.nii" --format nifti2 --json
ok "tells the steps" grep -q '"steps": 4' "$tmp/out"
exits "uneven times" 0 "$leafcast" export "$tmp/uneven.leaf" --step all -o "$tmp/u.nii"
ok "are told" grep -q "at uneven times, which NIfTI cannot say" "$tmp/err"
exits "one step, all of it" 0 "$leafcast" export "$tmp/one.leaf" --step all -o "$tmp/1.nii"
ok "is what it is without" sh -c '"$1" export "$2" -o - --format nifti | cmp - "$3"' sh "$leafcast" "$tmp/one.leaf" "$tmp/1.nii"
for file in a.nii a.nii.gz 2.nii; do
    exits "$file comes back" 0 "$leafcast" convert "$tmp/$file" --steps all -o "$tmp/back.leaf" --force
    run "$leafcast" info "$tmp/back.leaf"
    ok "with its times" grep -q 'steps  *4.*1 \.\. 8\.5' "$tmp/out"
    for i in 0 2 3; do
        "$leafcast" export "$tmp/back.leaf" --step $i -o "$tmp/raw.raw" -q --force
        ok "and samples of step $i" sh -c 'tail -c 189420 "$1" | cmp - "$2"' sh "$tmp/s$i.nrrd" "$tmp/raw.raw"
    done
done
for format in nrrd raw metaimage npy vti tiff vdb; do
    exits "all steps as $format" 2 "$leafcast" export "$tmp/even.leaf" --step all --format $format -o "$tmp/no"
    ok "says what has them" grep -q '.nii and .zarr have all' "$tmp/err"
done
exits "all steps of a surface" 2 "$leafcast" export "$tmp/even.leaf" --step all --iso 120 -o "$tmp/no.ply"
exits "no number" 2 "$leafcast" export "$tmp/even.leaf" --step 1:2 -o "$tmp/no.nii"

# Zarr.
exits "all steps as .zarr" 0 "$leafcast" export "$tmp/even.leaf" --step all -o "$tmp/a.zarr"
ok "loses nothing" [ ! -s "$tmp/err" ]
exits "with other threads and memory" 0 "$leafcast" export "$tmp/even.leaf" --step all -o "$tmp/b.zarr/" --threads 3 --memory 6M
ok "the same files" diff -r "$tmp/a.zarr" "$tmp/b.zarr"
exits "too little memory" 4 "$leafcast" export "$tmp/even.leaf" -o "$tmp/x.zarr" --memory 1M
ok "says how much it needs" grep -q 'a chunk of this grid needs' "$tmp/err"
ok "leaves nothing" left
exits "a step" 0 "$leafcast" export "$tmp/even.leaf" --step 2 -o "$tmp/2.zarr"
exits "a box of a level" 0 "$leafcast" export "$tmp/one.leaf" --level 1 --box 3,2,1,33,18,16 -o "$tmp/box.zarr"
exits "comes back" 0 "$leafcast" convert "$tmp/a.zarr" --steps all -o "$tmp/back.leaf" --force
exits "is the same again" 0 "$leafcast" export "$tmp/back.leaf" --step all -o "$tmp/c.zarr"
ok "but for its name" sh -c 'diff -r "$1" "$2" | grep -v name | grep -q . && exit 1; exit 0' sh "$tmp/a.zarr/0" "$tmp/c.zarr/0"
run "$leafcast" info "$tmp/back.leaf"
ok "with times" grep -q 'steps  *4.*1 \.\. 8\.5' "$tmp/out"
run "$leafcast" info "$tmp/a.zarr"
ok "with units" grep -q '^axes  *mm$' "$tmp/out"
exits "uneven times" 0 "$leafcast" export "$tmp/uneven.leaf" --step all -o "$tmp/u.zarr"
ok "are told" grep -q "at uneven times, which OME-Zarr cannot say" "$tmp/err"

# Nothing is replaced, and nothing half-written has the name.
exits "a folder that is there" 1 "$leafcast" export "$tmp/one.leaf" -o "$tmp/a.zarr"
exits "with --force" 1 "$leafcast" export "$tmp/one.leaf" -o "$tmp/a.zarr" --force
ok "says what to do" grep -q 'remove it first' "$tmp/err"
ok "stays" diff -r "$tmp/a.zarr" "$tmp/b.zarr"
exits "to standard output" 2 "$leafcast" export "$tmp/one.leaf" -o - --format zarr
exits "a folder that is not there" 1 "$leafcast" export "$tmp/one.leaf" -o "$tmp/none/x.zarr"
exits "packed" 2 "$leafcast" export "$tmp/one.leaf" -o "$tmp/x.zarr.gz"
mkdir -p "$tmp/x.zarr.partial-1/0/0"
echo left >"$tmp/x.zarr.partial-1/0/0/0"
ln -s "$tmp/a.zarr" "$tmp/x.zarr.partial-1/link"
exits "beside what a killed run left" 0 "$leafcast" export "$tmp/one.leaf" -o "$tmp/x.zarr"
ok "which is removed, and told" grep -q 'removed .*x.zarr.partial-1, which a killed run left' "$tmp/err"
ok "is gone" [ ! -e "$tmp/x.zarr.partial-1" ]
ok "links were not followed" diff -r "$tmp/a.zarr" "$tmp/b.zarr"
rm -r "$tmp/x.zarr"
head -c 60000 "$tmp/even.leaf" >"$tmp/cut.leaf"
exits "a file that is cut off" 3 "$leafcast" export "$tmp/cut.leaf" --step all -o "$tmp/x.zarr"
cp "$tmp/even.leaf" "$tmp/bad.leaf"
size=$(wc -c <"$tmp/bad.leaf")
printf 'damage damage damage' | dd of="$tmp/bad.leaf" bs=1 seek=$((size * 5 / 8)) conv=notrunc 2>/dev/null
exits "a damaged one" 3 "$leafcast" export "$tmp/bad.leaf" --step all -o "$tmp/x.zarr"
ok "nothing is left" left
exits "a damaged one as .nii" 3 "$leafcast" export "$tmp/bad.leaf" --step all -o "$tmp/x.nii"
ok "nothing is left of it" [ -z "$(find "$tmp" -name 'x.nii*')" ]

# What it cannot say.
sed 's/^space directions: .*/space directions: (0.5,0.1,0) (0,0.75,0) (0,0,2)/' "$tmp/s2.nrrd" >"$tmp/turned.nrrd"
"$leafcast" convert "$tmp/turned.nrrd" -o "$tmp/turned.leaf" -q
exits "a sheared grid" 3 "$leafcast" export "$tmp/turned.leaf" -o "$tmp/x.zarr"
ok "says what can hold it" grep -q 'turned, sheared or reversed.*.nrrd can hold' "$tmp/err"
sed 's/^space directions: .*/space directions: (-0.5,0,0) (0,0.75,0) (0,0,2)/' "$tmp/s2.nrrd" >"$tmp/turned.nrrd"
"$leafcast" convert "$tmp/turned.nrrd" -o "$tmp/turned.leaf" -q --force
exits "a reversed grid" 3 "$leafcast" export "$tmp/turned.leaf" -o "$tmp/x.zarr"
"$leafcast" convert "$tmp/s2.nrrd" --axes RAS -o "$tmp/ras.leaf" -q
exits "a world of RAS" 0 "$leafcast" export "$tmp/ras.leaf" -o "$tmp/ras.zarr"
ok "is told" grep -q "which way the world's axes point" "$tmp/err"

# Other readers.
for module in nibabel zarr; do
    python=$(python_with $module)
    if [ -z "$python" ]; then
        skip "what $module reads" "no python3-$module here"
        continue
    fi
    PYTHONDONTWRITEBYTECODE=1 "$python" tests/support/export_steps.py $module "$tmp" >"$tmp/results" 2>"$tmp/said"
    rc=$?
    results
done
finish
