#!/bin/sh
# list_hint.sh - the command that a message names to list what a file has works as it is printed.
# marks: plain
. tests/support/tap.sh

# No message names the option alone.
grep -rn --include='*.c' --include='*.cpp' -e '--list' prep/import formats/grid render | grep -v 'import_hint\.c\|list-verbs\|list-options' |
    grep 'tells what\|prints those' >"$tmp/err"
ok "messages name it by import_hint_list()" [ ! -s "$tmp/err" ]

# named NAME WORDS COMMAND... - it fails, saying WORDS, and what is named in `...' lists WANTED.
named() {
    name=$1
    wanted=$2
    shift 2
    run "$@"
    ok "$name: is refused" [ "$rc" = 2 -o "$rc" = 3 ]
    sed -n "s/.*\`leafcast \\(import-[a-z0-9]* .* --list\\)' tells what there is.*/\\1/p" "$tmp/err" >"$tmp/command"
    ok "$name: a command is named" [ -s "$tmp/command" ]
    run sh -c "\"\$1\" $(cat "$tmp/command")" sh "$leafcast"
    ok "$name: it works" [ "$rc" = 0 ]
    ok "$name: it lists $wanted" grep -q -- "$wanted" "$tmp/out"
}
has() { "$leafcast" --list-verbs own | grep -qx "$1"; }

# A name with what a shell would take for its own.
odd="$tmp/it's \$HOME"
mkdir "$odd"
"$leafcast" generate sphere --dims 6 -o "$tmp/g.nrrd"
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
if has import-vdb; then
    "$leafcast" export "$tmp/g.leaf" -o "$odd/g.vdb"
    for verb in import-vdb convert info; do
        case $verb in convert) set -- -o "$tmp/x.leaf" ;; *) set -- ;; esac
        named "OpenVDB, $verb" value "$leafcast" $verb "$odd/g.vdb" --field none "$@"
    done
else
    skip "OpenVDB" "no import-vdb here"
fi
python=$(python_with h5py)
if has import-hdf5 && [ -n "$python" ]; then
    "$python" -c '
import h5py, numpy, sys
with h5py.File(sys.argv[1] + "/line.h5", "w") as f: f["line"] = numpy.zeros(5)
with h5py.File(sys.argv[1] + "/cube.h5", "w") as f: f["cube"] = numpy.zeros((3, 3, 3))' "$odd"
    named "HDF5 without a grid" line "$leafcast" convert "$odd/line.h5" -o "$tmp/x.leaf"
    named "HDF5, no such data set" cube "$leafcast" info "$odd/cube.h5" --field none
else
    skip "HDF5" "no import-hdf5 or h5py here"
fi
python=$(python_with netCDF4)
if has import-netcdf && [ -n "$python" ]; then
    "$python" -c '
import netCDF4, sys
for name, axes in ("line", "x"), ("cube", "zyx"):
    d = netCDF4.Dataset(sys.argv[1] + "/" + name + ".nc", "w")
    for a in axes: d.createDimension(a, 4)
    d.createVariable(name, "f4", tuple(axes))[:] = 1
    d.close()' "$odd"
    named "NetCDF without a grid" line "$leafcast" convert "$odd/line.nc" -o "$tmp/x.leaf"
    named "NetCDF, no such variable" cube "$leafcast" info "$odd/cube.nc" --field none
else
    skip "NetCDF" "no import-netcdf or netCDF4 here"
fi
python=$(python_with pydicom)
if has import-dicom && [ -n "$python" ]; then
    mkdir "$odd/series"
    "$python" - "$odd/series" <<'PY'
import sys
import numpy, pydicom
from pydicom.dataset import FileDataset, FileMetaDataset
for i in range(2):
    meta = FileMetaDataset()
    meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
    meta.MediaStorageSOPInstanceUID = pydicom.uid.generate_uid()
    f = FileDataset(None, {}, file_meta=meta, preamble=bytes(128))
    f.is_little_endian, f.is_implicit_VR = True, False
    f.SOPClassUID, f.SOPInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID
    f.SeriesInstanceUID, f.Modality, f.Rows, f.Columns = "1.2.%d" % i, "CT", 4, 4
    f.SamplesPerPixel, f.PhotometricInterpretation = 1, "MONOCHROME2"
    f.BitsAllocated, f.BitsStored, f.HighBit, f.PixelRepresentation = 16, 16, 15, 0
    f.PixelData = numpy.zeros(16, "u2").tobytes()
    f["PixelData"].VR = "OW"
    f.save_as("%s/%d.dcm" % (sys.argv[1], i), write_like_original=False)
PY
    named "DICOM without a series" 1.2.0 "$leafcast" convert "$odd/series" -o "$tmp/x.leaf"
    named "DICOM, no such series" 1.2.1 "$leafcast" info "$odd/series" --field none
else
    skip "DICOM" "no import-dicom or pydicom here"
fi

# Verbs without a list say what has one, and show no table of their own.
for verb in convert info render export; do
    exits "$verb --list" 2 "$leafcast" $verb "$tmp/g.nrrd" --list
    ok "is told the way" grep -q "no option --list; .leafcast info INPUT. tells" "$tmp/err"
    ok "prints no table" [ ! -s "$tmp/out" ]
    exits "$verb --list-options" 0 "$leafcast" $verb --list-options
done
exits "leafcast info" 0 "$leafcast" info "$tmp/g.nrrd"
finish
