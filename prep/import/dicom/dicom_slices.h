/* dicom_slices.h - lists the series of DICOM files, or reads one as slices: headers first, then the
 * pixels of one slice at a time. */
#ifndef PREP_IMPORT_DICOM_DICOM_SLICES_H
#define PREP_IMPORT_DICOM_DICOM_SLICES_H

#include "prep/import/importer.h"

/* dicom_slices_open() - open q's series, as importer.open(). gaps: accept missing slices. */
CHECKED status dicom_slices_open(mem *m, const import_request *q, bool gaps, slice_source *out);

/* dicom_slices_list() - as importer.list(). */
CHECKED status dicom_slices_list(mem *m, const import_request *q, const import_list *to);

#endif
