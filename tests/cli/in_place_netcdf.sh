#!/bin/sh
# in_place_netcdf.sh - treelet files that leave the samples of level 0 in a netCDF file: the same samples,
# pictures and values as of a file with all, with scale, offset and fill value; what stays refused, by name.
# marks: long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
python=$(python_with netCDF4)
if [ -z "$python" ] || ! "$leafcast" import-netcdf --help >/dev/null 2>&1; then
    skip "netCDF in place" "no python3-netcdf4, or no leafcast import-netcdf here"
    finish
fi
in=$tmp/in
mkdir "$in"
cat >"$tmp/make.py" <<'PY'
import sys
import netCDF4, numpy as np
folder = sys.argv[1] + "/"
r = np.random.default_rng(8)
CLASSIC, BIG, CDF5 = "NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA"
def numbers(kind, *shape):
    if kind[0] == "f":
        return np.cumsum(r.normal(size=shape), -1).astype(kind)
    low = 0 if kind[0] == "u" else -60
    return np.clip(np.cumsum(r.integers(-3, 4, shape), -1) + 30, low, 120).astype(kind)
def put(name, data, format=CLASSIC, options="", dims=None, grows=False, fill=None, listed=True, other=0, store={}, group="", **attributes):
    dims = dims or ("t", "z", "y", "x")[-data.ndim:]
    with netCDF4.Dataset(folder + name + ".nc", "w", format=format) as f:
        for i, d in enumerate(dims):
            f.createDimension(d, None if grows and i == 0 else data.shape[i])
        for k in range(other): # what lies in front, and in each record
            o = f.createVariable("o%d" % k, "i1", dims[:1] if grows else dims[-1:])
            o[:] = np.arange(data.shape[0 if grows else -1])
        v = f.createVariable(group + "v", data.dtype, dims, fill_value=fill, **store)
        v.set_auto_maskandscale(False)
        v[:] = data
        for key, value in attributes.items():
            v.setncattr(key, value)
    if listed:
        print(name, options)
shape = 34, 37, 41
for kind in "i1 i2 i4 f4 f8".split():
    put("plain_" + kind, numbers(kind, *shape))
    put("wide_" + kind, numbers(kind, *shape), BIG, other=2)
for kind in "u1 u2 u4 i8 u8 i1 f8".split():
    put("five_" + kind, numbers(kind, *shape), CDF5, other=1)
put("steps", numbers("i2", 3, *shape), options="--step 2")
put("records", numbers("i2", 3, *shape), options="--step 2", grows=True)
put("records_among", numbers("i1", 3, 34, 37, 41), BIG, options="--step 1", grows=True, other=3)
put("records_of_slices", numbers("f4", *shape), grows=True)
put("ensemble", numbers("i2", 2, 3, *shape), options="--step 4", dims=("e", "t", "z", "y", "x"))
put("ensemble_grows", numbers("i2", 2, 3, *shape), options="--step 4", dims=("e", "t", "z", "y", "x"), grows=True, other=2)
for kind in "i1 i2 i4 f4 f8".split():
    if kind != "f4":
        put("scaled_" + kind, numbers(kind, *shape), scale_factor=0.37, add_offset=-11.25)
    put("scaled_filled_" + kind, numbers(kind, *shape), fill=np.array(33, kind), scale_factor=np.float32(0.1))
put("offset", numbers("i2", *shape), add_offset=1000.5)
put("negative", numbers("i2", *shape), scale_factor=-2.0, missing_value=np.int16(7))
put("filled_i1", numbers("i1", *shape), fill=np.int8(31))
put("filled_i2", numbers("i2", *shape), missing_value=np.int16(31))
put("filled_beyond", numbers("i1", *shape), missing_value=np.int16(999))
put("same_twice", numbers("i2", *shape), fill=np.int16(31), missing_value=np.int16(31))
f = numbers("f4", *shape)
f[r.random(shape) < 0.01] = np.float32(-999.9)
f[r.random(shape) < 0.01] = np.nan
f[r.random(shape) < 0.01] = np.float32(9.969209968386869e36)
put("filled_f4", f, fill=np.float32(-999.9))
put("filled_f8", f.astype("f8"), fill=np.float64(np.float32(-999.9)))
put("own_fill", f)
put("unsigned", numbers("i1", *shape), _Unsigned="true", fill=np.int8(31))
put("unsigned_scaled", numbers("i2", *shape), _Unsigned="true", scale_factor=0.01, add_offset=2.0)
put("filled_i8", numbers("i8", *shape), CDF5, fill=np.int64(31))
put("missing", numbers("i2", *shape), options="--missing 31")
put("all", numbers("i2", *shape), CDF5, fill=np.int16(32000), scale_factor=1e-3, add_offset=273.15)
# netCDF-4: HDF5, in one piece or in chunks.
FOUR = "NETCDF4"
packed = dict(zlib=True, complevel=4, chunksizes=(10, 12, 13))
for i, kind in enumerate("i1 u1 i2 u2 i4 u4 i8 u8 f4 f8".split()):
    put("four_" + kind, numbers(kind, *shape), FOUR)
    put("four_packed_" + kind, numbers(kind, *shape), FOUR, store=dict(packed, shuffle=bool(i & 1), endian=("little", "big")[i & 1]))
put("four_scaled", numbers("i2", *shape), FOUR, store=packed, fill=np.int16(31), scale_factor=0.01, add_offset=273.15)
put("four_scaled_piece", numbers("i2", *shape), FOUR, fill=np.int16(31), scale_factor=0.01, add_offset=273.15)
put("four_filled", f, FOUR, store=packed, fill=np.float32(-999.9))
put("four_steps", numbers("i2", 3, *shape), FOUR, options="--step 2", grows=True, store=dict(chunksizes=(2, 10, 12, 13)))
put("four_steps_piece", numbers("i2", 3, *shape), FOUR, options="--step 1")
put("four_ensemble", numbers("i2", 2, 3, *shape), FOUR, options="--step 2", dims=("e", "t", "z", "y", "x"), store=dict(zlib=True, chunksizes=(1, 2, 10, 12, 13)))
put("four_ensemble_piece", numbers("i2", 2, 3, *shape), FOUR, options="--step 4", dims=("e", "t", "z", "y", "x"))
put("four_group", numbers("f4", *shape), FOUR, options="--field a/v", group="a/", store=packed)
put("four_classic", numbers("f4", *shape), "NETCDF4_CLASSIC", store=packed)
# What stays refused: also floats' own fill value, which has neighbours that become the same here, and one beside it.
put("scaled_f4", numbers("f4", *shape), listed=False, scale_factor=0.37, add_offset=-11.25)
put("another_f4", f, listed=False, missing_value=-999.9)
put("ranged", numbers("i2", *shape), listed=False, valid_min=np.int16(0))
put("two_fills", numbers("i2", *shape), listed=False, fill=np.int16(31), missing_value=np.int16(32))
put("filled_i4", numbers("i4", *shape), listed=False, fill=np.int32(31))
put("flat", numbers("i2", *shape), listed=False, fill=np.int16(31), scale_factor=1e-30, add_offset=1.0)
put("scale_0", numbers("i2", *shape), listed=False, scale_factor=0.0)
put("slices_apart", numbers("i2", *shape), listed=False, grows=True, other=2)
put("four_steps_of_both", numbers("i2", 2, 3, *shape), FOUR, dims=("e", "t", "z", "y", "x"), store=dict(zlib=True, chunksizes=(1, 1, 10, 12, 13)), listed=False)
put("four_summed", numbers("i2", *shape), FOUR, listed=False, store=dict(packed, fletcher32=True)) # by netCDF in front of the codec
put("four_ranged", numbers("i2", *shape), FOUR, listed=False, valid_max=np.int16(90))
PY
"$python" -W ignore "$tmp/make.py" "$in" >"$tmp/list" || ok "files to read" false

# pair NAME OPTIONS... - NAME.nc as $tmp/NAME.leaf, in place, and $tmp/all.leaf: what they draw and tell.
pair() {
    name=$1
    shift
    exits "$name: in place" 0 "$leafcast" convert "$in/$name.nc" -o "$tmp/$name.leaf" --in-place --force "$@"
    exits "$name: sound" 0 "$leafcast" verify "$tmp/$name.leaf"
    run "$leafcast" convert "$in/$name.nc" -o "$tmp/whole.leaf" --compress zstd --force "$@"
    [ "$rc" = 0 ] || ok "$name: with all samples" false
    for file in "$name" whole; do
        run "$leafcast" export "$tmp/$file.leaf" -o "$tmp/$file.raw" --format raw --force
        [ "$rc" = 0 ] || ok "$name: export of $file" false
        run "$leafcast" render "$tmp/$file.leaf" -o "$tmp/$file.ppm" --size $picture --tf auto --force --threads 2
        [ "$rc" = 0 ] || ok "$name: render of $file" false
    done
    for what in raw ppm; do
        ok "$name, $what: the same" cmp "$tmp/$name.$what" "$tmp/whole.$what"
    done
}
while read -r name options; do
    one_in 4 "$name" "four_scaled four_scaled_piece" || continue # all kinds of numbers: test_stored_samples.c
    # shellcheck disable=SC2086
    pair "$name" $options
done <"$tmp/list"
ok "these were $(wc -l <"$tmp/list") variables" [ "$(wc -l <"$tmp/list")" -gt 70 ]

refused() {
    exits "$1: refused" 3 "$leafcast" convert "$in/$1.nc" -o "$tmp/r.leaf" --in-place
    ok "$1: told" says "$1.nc: --in-place$2"
    ok "$1: nothing is left" [ ! -e "$tmp/r.leaf" ]
    exits "$1: converted otherwise" 0 "$leafcast" convert "$in/$1.nc" -o "$tmp/r.leaf"
    rm -f "$tmp/r.leaf"
}
stays=": it cannot stay as it is stored"
refused ranged "$stays: a valid range"
refused two_fills "$stays: several fill values"
refused filled_i4 "$stays: a fill value among integers of 32 bits"
refused flat "$stays: a fill value that others become, too"
refused scaled_f4 "$stays: a fill value that others become, too"
refused another_f4 "$stays: several fill values"
refused scale_0 "$stays: a scale that is 0 or not finite"
refused slices_apart "$stays: slices lie a record apart"
refused four_ranged "$stays: a valid range"
refused four_summed "$stays: a filter behind a checksum"
exits "several axes of steps" 3 "$leafcast" convert "$in/four_steps_of_both.nc" -o "$tmp/r.leaf" --in-place --step 4
ok "are told" says "four_steps_of_both.nc: --in-place$stays: several axes of steps"
ok "chunks: a table of them" [ "$(od -An -tu4 -j 1500 -N4 "$tmp/four_scaled.leaf" | tr -d ' ')" = 64 ]
ok "one piece: none" [ "$(od -An -tu4 -j 1500 -N4 "$tmp/four_scaled_piece.leaf" | tr -d ' ')" = 0 ]
exits "two values for missing data" 3 "$leafcast" convert "$in/filled_i2.nc" -o "$tmp/r.leaf" --in-place --missing 5
ok "are told" says "a value for missing data of its own"

# ---- a file that changes, or is cut ----

cp "$in/all.nc" "$tmp/c.nc"
run "$leafcast" convert "$tmp/c.nc" -o "$tmp/c.leaf" --in-place
touch -r "$tmp/c.nc" "$tmp/time"
printf 'XXXX' | dd of="$tmp/c.nc" bs=1 seek=60000 conv=notrunc 2>/dev/null
touch -r "$tmp/time" "$tmp/c.nc"
exits "other samples: refused" 3 "$leafcast" verify "$tmp/c.leaf"
ok "by name" says "c.nc: .*the samples of treelet"
head -c 90000 "$in/all.nc" >"$tmp/short.nc"
exits "a short file" 3 "$leafcast" convert "$tmp/short.nc" -o "$tmp/r.leaf" --in-place
ok "is told" says "short.nc: "
finish
