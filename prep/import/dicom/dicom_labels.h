/* dicom_labels.h - turns the frames of binary segments (DICOM SEG), one per segment and place, into
 * slices of labels.
 *
 * Frames of one place become one slice. Writers leave out frames without a pixel, so a place may be
 * missing. If the others are whole steps apart, that place becomes a slice of zeros. C++ includes
 * it within extern "C". Pure.
 */
#ifndef PREP_IMPORT_DICOM_DICOM_LABELS_H
#define PREP_IMPORT_DICOM_DICOM_LABELS_H

#include "prep/import/dicom/dicom_image.h"

typedef struct dicom_label {
    uint32_t frame, segment; /* segment: its number */
    uint32_t group;          /* the same for frames of one place; from 0 on, along the normal */
    double along;            /* position along the normal */
    dicom_place place;
} dicom_label;

/* dicom_labels_group() - sort frames by place, then segment, and set group. All places must be
 * known. Returns the number of groups. */
uint32_t dicom_labels_group(dicom_label *labels, uint32_t count);

/* dicom_labels_tell() - report a slice for each group, as its first frame. A place missing between
 * two groups is reported as a frame from `frames` on, which is not in the file. Returns the status
 * of take(). */
CHECKED status dicom_labels_tell(const dicom_label *labels, uint32_t count, uint32_t frames,
                                 const dicom_places *places);

/* dicom_labels_first() - the first label of the group that a frame belongs to; NULL: none. */
const dicom_label *dicom_labels_first(const dicom_label *labels, uint32_t count, uint32_t frame);

/* dicom_labels_put() - write `value` where the frame has a pixel, into numbers of 8 or 16 bits.
 * bits: of all frames; the first is the lowest of its byte. Pixels with a value keep it. Returns
 * how many had one already. */
uint64_t dicom_labels_put(const uint8_t *bits, uint32_t frame, size_t pixels, uint32_t value,
                          uint32_t allocated, void *numbers);

#endif
