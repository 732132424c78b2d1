#!/bin/sh
# import_hdf5.sh - leafcast import-hdf5: what h5py writes comes in with samples, spacing and transform.
. tests/support/tap.sh

verb=$(dirname "$(readlink -f "$leafcast")")/../libexec/leafcast-import-hdf5
[ -x "$verb" ] || { skip "import-hdf5" "no libhdf5 here"; finish; }
PYTHONDONTWRITEBYTECODE=1 python3 tests/support/import_hdf5.py "$leafcast" "$tmp" "$data" >"$tmp/results" 2>"$tmp/said"
rc=$?
[ $rc != 77 ] || { skip "import-hdf5" "no h5py here"; finish; }
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
