#!/bin/sh
# import_hdf5.sh - leafcast import-hdf5: what h5py writes comes in with samples, spacing and transform.
# marks: leaks, long
. tests/support/tap.sh
. tests/support/import_options.sh

import_files hdf5 h5py libhdf5
import_options import-hdf5 "$tmp/places.h5"
finish
