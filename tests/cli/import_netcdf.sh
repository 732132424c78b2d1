#!/bin/sh
# import_netcdf.sh - leafcast import-netcdf: what netCDF4 writes comes in with samples, spacing and transform.
# marks: long
. tests/support/tap.sh
. tests/support/import_options.sh

import_files netcdf netCDF4 libnetcdf
import_options import-netcdf "$tmp/even.nc"
finish
