#!/bin/sh
# import_dicom.sh - leafcast import-dicom: what pydicom writes comes in with samples, spacing and transform.
# marks: long
. tests/support/tap.sh
. tests/support/import_options.sh

import_files dicom pydicom dcmtk
import_options import-dicom "$tmp/mixed"
finish
