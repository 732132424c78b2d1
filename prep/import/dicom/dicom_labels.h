/* dicom_labels.h - the frames of binary segments (DICOM SEG), one a segment and place, as slices of
 * labels.
 *
 * Frames of one place become one slice. Writers leave out frames without a pixel, so that a place
 * may be absent: it becomes a slice of zeros where the others are whole steps apart. C++ includes
 * it within extern "C". Pure.
 */
#ifndef PREP_IMPORT_DICOM_DICOM_LABELS_H
#define PREP_IMPORT_DICOM_DICOM_LABELS_H

#include "prep/import/dicom/dicom_image.h"

typedef struct dicom_label {
    uint32_t frame, segment; /* segment: its number */
    uint32_t group;          /* frames of one place have the same, from 0 on, along the normal */
    double along;            /* where that is */
    dicom_place place;
} dicom_label;

/* dicom_labels_group() - sorts frames by place, then segment, and sets group; all are of known
 * place. Returns how many groups there are. */
uint32_t dicom_labels_group(dicom_label *labels, uint32_t count);

/* dicom_labels_tell() - a slice for each group, of its first frame, and for each place that is
 * absent between two, of a frame from `frames` on, which no file has. What take() returns. */
CHECKED status dicom_labels_tell(const dicom_label *labels, uint32_t count, uint32_t frames,
                                 const dicom_places *places);

/* dicom_labels_first() - the first label of the group that a frame is in; NULL: it has none. */
const dicom_label *dicom_labels_first(const dicom_label *labels, uint32_t count, uint32_t frame);

/* dicom_labels_put() - where the frame has a pixel, its value: in numbers of 8 or 16 bits. bits: of
 * all frames, the first the lowest of its byte. Returns how many pixels had a value already, which
 * they keep. */
uint64_t dicom_labels_put(const uint8_t *bits, uint32_t frame, size_t pixels, uint32_t value,
                          uint32_t allocated, void *numbers);

#endif
