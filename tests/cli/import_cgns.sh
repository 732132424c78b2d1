#!/bin/sh
# import_cgns.sh - leafcast import-cgns: zones, elements, solutions and steps that h5py wrote come in as a mesh; ADF as HDF5.
# marks: long
. tests/support/tap.sh
. tests/support/import_options.sh

import_files cgns h5py libcgns
import_options import-cgns "$tmp/steps.cgns" mesh
finish
