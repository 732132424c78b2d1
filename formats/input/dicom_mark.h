/* dicom_mark.h - what a file of DICOM is told by: DICM behind a preamble of 128 bytes.
 *
 * The preamble is the application's own, and may be the head of another format (PS3.10, 7.1: so
 * that readers of TIFF find the same pixels). Whoever tells a format by its first bytes asks here
 * before.
 */
#ifndef FORMATS_INPUT_DICOM_MARK_H
#define FORMATS_INPUT_DICOM_MARK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { DICOM_PREAMBLE = 128, DICOM_MARK_END = DICOM_PREAMBLE + 4 };

/* dicom_mark_is_at() - of a file's first bytes. */
static inline bool dicom_mark_is_at(const uint8_t *start, size_t size) {
    return size >= DICOM_MARK_END && memcmp(start + DICOM_PREAMBLE, "DICM", 4) == 0;
}

#endif
