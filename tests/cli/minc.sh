#!/bin/sh
# minc.sh - MINC 1 and MINC 2: values, not stored integers, where the file puts them; beside nibabel, where it is.
# marks: long
. tests/support/tap.sh

for verb in import-netcdf import-hdf5; do
    [ -x "$(dirname "$(readlink -f "$leafcast")")/../libexec/leafcast-$verb" ] || { skip "MINC" "no $verb here"; finish; }
done
PYTHONDONTWRITEBYTECODE=1 python3 tests/support/minc.py "$leafcast" "$tmp" >"$tmp/results" 2>"$tmp/said"
rc=$?
[ $rc != 77 ] || { skip "MINC" "no netCDF4 or h5py here"; finish; }
results
finish
