/* dicom_image.h - one DICOM file: what its header says, and its frames. In front of DCMTK.
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

/* Of a file; all frames have it in common. */
typedef struct dicom_image {
    char series[DICOM_UID], instance[DICOM_UID];
    char description[DICOM_TEXT], modality[20], syntax[DICOM_TEXT];
    uint32_t columns, rows, frames;
    uint32_t samples;                 /* 1, or 3 of colours */
    uint32_t allocated, stored, high; /* bits of a stored number; its highest bit */
    bool is_signed;
    uint32_t segments;        /* binary ones, as labels of 8 or 16 bits; 0: it has none */
    bool dicom, storage;      /* it says of what class it is; and that this is one of images */
    char refuse[DICOM_WORDS]; /* why it cannot be read; "": it can */
} dicom_image;

/* Of a frame. Patient's coordinates, in mm: x to the left, y to the back, z to the head. */
typedef struct dicom_place {
    bool known;         /* it has a position and an orientation; else what follows does not count */
    double position[3]; /* middle of the first pixel */
    double across[3];   /* direction of a row, along which columns count */
    double down[3];     /* of a column */
    double between[2];  /* distance of columns, of rows; 1 where it is not told */
    double apart;       /* distance of slices, as the header has it; 0: not told */
    double slope, intercept;
    int number; /* of the instance, or where it has several frames of the frame */
} dicom_place;

typedef struct dicom_places {
    status (*take)(void *ctx, uint32_t frame, const dicom_place *place);
    void *ctx;
} dicom_places;

/* dicom_image_begin() - once, before all others: decoders, and no words of the library's own. */
void dicom_image_begin(void);

/* dicom_image_read() - the header of a file of `bytes`, up to its pixels; then, where refuse is "",
 * places are told, frame by frame. ST_CORRUPT; what take() returns. */
status dicom_image_read(const char *path, uint64_t bytes, dicom_image *out,
                        const dicom_places *places);

typedef struct dicom_reader dicom_reader;

/* dicom_reader_open() - for the frames of a file that dicom_image_read() took. */
status dicom_reader_open(const char *path, dicom_reader **out);
void dicom_reader_close(dicom_reader *r); /* NULL is fine */

/* dicom_reader_overlaps() - of labels: how many pixels more than one segment has, over all frames.
 * ST_CORRUPT. */
status dicom_reader_overlaps(dicom_reader *r, uint64_t *pixels);

/* dicom_reader_frame() - decoded, in native byte order: columns * rows * samples numbers of so many
 * allocated bits, the samples of a pixel side by side. size: of that, in bytes; buffer has room for
 * twice that. Of labels, those of all segments at the frame's place: their numbers, or 1 where
 * there is one alone. ST_CORRUPT, ST_UNSUPPORTED, ST_NOMEM. */
status dicom_reader_frame(dicom_reader *r, uint32_t frame, void *buffer, size_t size);

#endif
