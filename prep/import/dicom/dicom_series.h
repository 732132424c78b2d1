/* dicom_series.h - the series that files belong to, by their headers alone. */
#ifndef PREP_IMPORT_DICOM_DICOM_SERIES_H
#define PREP_IMPORT_DICOM_DICOM_SERIES_H

#include "prep/import/dicom/dicom_files.h"
#include "prep/import/dicom/dicom_image.h"
#include "prep/import/importer.h"

/* One frame of one file. */
typedef struct dicom_slice {
    uint32_t series, file;
    uint32_t frame;
    dicom_place place;
    double along; /* the normal; see dicom_order.h */
} dicom_slice;

typedef struct dicom_series {
    dicom_image image;      /* of its first file, but for refuse: of any */
    char type[DICOM_WORDS]; /* for people */
    uint32_t file;          /* its first one */
    size_t slices;
} dicom_series;

typedef struct dicom_study {
    mem *m;
    dicom_files files;
    char (*instances)[DICOM_UID]; /* of the files: "" of what was left aside */
    dicom_series *series;         /* in the order of their first files */
    size_t series_count, series_room;
    dicom_slice *slices; /* of all series, in the order of files and frames */
    size_t slice_count, slice_room;
} dicom_study;

/* dicom_study_read() - the headers of all files. In folders what is no DICOM image is left aside;
 * on the command line it is ST_CORRUPT or ST_UNSUPPORTED. Release it in any case. */
CHECKED status dicom_study_read(mem *m, char *const *paths, int count, dicom_study *out);
void dicom_study_release(dicom_study *s);

/* dicom_study_choose() - the series with q's field as its SeriesInstanceUID, or as its description
 * where only one has it; NULL: the first of two slices and more that can be read. ST_USAGE,
 * ST_UNSUPPORTED. */
CHECKED status dicom_study_choose(const dicom_study *s, const import_request *q, uint32_t *out);

#endif
