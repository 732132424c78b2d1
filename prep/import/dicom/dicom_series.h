/* dicom_series.h - groups files into series, by their headers alone. */
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
    double along; /* position along the normal; see dicom_order.h */
} dicom_slice;

typedef struct dicom_series {
    dicom_image image;      /* of its first file; refuse: of any of its files */
    char type[DICOM_WORDS]; /* a description for people */
    uint32_t file;          /* its first file */
    size_t slices;
} dicom_series;

typedef struct dicom_study {
    mem *m;
    dicom_files files;
    char (*instances)[DICOM_UID]; /* per file; "": the file was skipped */
    dicom_series *series;         /* in the order of their first files */
    size_t series_count, series_room;
    dicom_slice *slices; /* of all series, in the order of files and frames */
    size_t slice_count, slice_room;
} dicom_study;

/* dicom_study_read() - read the headers of all files. In folders, files that are no DICOM images
 * are skipped. On the command line they are ST_CORRUPT or ST_UNSUPPORTED. Release it in any
 * case. */
CHECKED status dicom_study_read(mem *m, char *const *paths, int count, dicom_study *out);
void dicom_study_release(dicom_study *s);

/* dicom_study_choose() - the series whose SeriesInstanceUID is q's field, or whose description is,
 * if only one has it. NULL: the first readable series of at least two slices. ST_USAGE,
 * ST_UNSUPPORTED. */
CHECKED status dicom_study_choose(const dicom_study *s, const import_request *q, uint32_t *out);

#endif
