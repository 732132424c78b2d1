/* dicom_mark.h - the mark that tells a DICOM file: DICM behind a preamble of 128 bytes.
 *
 * The preamble belongs to the application, and may be the head of another format (PS3.10, 7.1: so
 * that readers of TIFF find the same pixels). So ask here before recognising any other format by
 * its first bytes.
 */
#ifndef FORMATS_INPUT_DICOM_MARK_H
#define FORMATS_INPUT_DICOM_MARK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { DICOM_PREAMBLE = 128, DICOM_MARK_END = DICOM_PREAMBLE + 4 };

/* dicom_mark_is_at() - returns whether a file's first bytes have the mark. */
static inline bool dicom_mark_is_at(const uint8_t *start, size_t size) {
    return size >= DICOM_MARK_END && memcmp(start + DICOM_PREAMBLE, "DICM", 4) == 0;
}

#endif
