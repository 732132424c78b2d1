/* dicom_image.h - reads one DICOM file: its header, and its frames. Wraps DCMTK.
 *
 * C++ includes it within extern "C".
 */
#ifndef PREP_IMPORT_DICOM_DICOM_IMAGE_H
#define PREP_IMPORT_DICOM_DICOM_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"

enum { DICOM_UID = 68, DICOM_TEXT = 80, DICOM_WORDS = 200 };

/* Facts of a file that all its frames share. */
typedef struct dicom_image {
    char series[DICOM_UID], instance[DICOM_UID];
    char description[DICOM_TEXT], modality[20], syntax[DICOM_TEXT];
    uint32_t columns, rows, frames;
    uint32_t samples;                 /* per pixel: 1, or 3 for colours */
    uint32_t allocated, stored, high; /* bits of a stored number; its highest bit */
    bool is_signed;
    uint32_t segments;        /* binary segments, read as labels of 8 or 16 bits; 0: none */
    bool dicom, storage;      /* the file tells its class; that is a class of images */
    char refuse[DICOM_WORDS]; /* why it cannot be read; "": it can */
} dicom_image;

/* Place of a frame, in the patient's coordinates in mm: x to the left, y to the back, z to the
 * head. */
typedef struct dicom_place {
    bool known;         /* position and orientation are known; else ignore the fields below */
    double position[3]; /* middle of the first pixel */
    double across[3];   /* direction of a row: where the column number grows */
    double down[3];     /* direction of a column */
    double between[2];  /* distance of columns, and of rows; 1: unknown */
    double apart;       /* distance of slices in the header; 0: unknown */
    double slope, intercept;
    int number; /* of the instance; with several frames: of the frame */
} dicom_place;

typedef struct dicom_places {
    status (*take)(void *ctx, uint32_t frame, const dicom_place *place);
    void *ctx;
} dicom_places;

/* dicom_image_begin() - call it once before all others: registers decoders, and silences the
 * library. */
void dicom_image_begin(void);

/* dicom_image_read() - read the header of a file of `bytes` bytes, up to its pixels. Then, if
 * refuse is "", report the places frame by frame. ST_CORRUPT, or the status of take(). */
status dicom_image_read(const char *path, uint64_t bytes, dicom_image *out,
                        const dicom_places *places);

typedef struct dicom_reader dicom_reader;

/* dicom_reader_open() - open a file that dicom_image_read() accepted, to read its frames. */
status dicom_reader_open(const char *path, dicom_reader **out);
void dicom_reader_close(dicom_reader *r); /* NULL is fine */

/* dicom_reader_overlaps() - for labels: the number of pixels, over all frames, that belong to more
 * than one segment. ST_CORRUPT. */
status dicom_reader_overlaps(dicom_reader *r, uint64_t *pixels);

/* dicom_reader_frame() - decode a frame in native byte order: columns * rows * samples numbers of
 * `allocated` bits, a pixel's samples side by side. size: bytes of that; buffer has room for twice
 * as much. Labels: of all segments at the frame's place, their numbers, or 1 for a single segment.
 * ST_CORRUPT, ST_UNSUPPORTED, ST_NOMEM. */
status dicom_reader_frame(dicom_reader *r, uint32_t frame, void *buffer, size_t size);

#endif
