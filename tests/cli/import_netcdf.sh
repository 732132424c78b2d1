#!/bin/sh
# import_netcdf.sh - leafcast import-netcdf: what netCDF4 writes comes in with samples, spacing and transform.
. tests/support/tap.sh

verb=$(dirname "$(readlink -f "$leafcast")")/../libexec/leafcast-import-netcdf
[ -x "$verb" ] || { skip "import-netcdf" "no libnetcdf here"; finish; }
PYTHONDONTWRITEBYTECODE=1 python3 tests/support/import_netcdf.py "$leafcast" "$tmp" "$data" >"$tmp/results" 2>"$tmp/said"
rc=$?
[ $rc != 77 ] || { skip "import-netcdf" "no netCDF4 here"; finish; }
while IFS='	' read -r name result; do
    case $result in
    skip*) skip "$name" "${result#skip }" ;;
    *)
        echo "$result" >"$tmp/err"
        ok "$name" [ "$result" = right ]
        ;;
    esac
done <"$tmp/results"
cp "$tmp/said" "$tmp/err"
ok "all of them were run (exit $rc)" [ $rc = 0 ]
finish
