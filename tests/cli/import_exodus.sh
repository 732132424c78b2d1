#!/bin/sh
# import_exodus.sh - leafcast import-exodus: the nodes, elements and variables that netCDF4 wrote; convert takes them as it takes a .vtu.
# marks: long
. tests/support/tap.sh
. tests/support/import_options.sh

import_files exodus netCDF4 libnetcdf
import_options import-exodus "$tmp/classic" mesh
finish
