/* dicom_j2k.h - a frame that JPEG 2000 packed, in front of OpenJPEG; DCMTK has no decoder for it.
 *
 * C++ includes it within extern "C".
 */
#ifndef PREP_IMPORT_DICOM_DICOM_J2K_H
#define PREP_IMPORT_DICOM_DICOM_J2K_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"

/* What the DICOM header says of the frame. */
typedef struct dicom_j2k_form {
    uint32_t columns, rows, samples; /* numbers a pixel */
    uint32_t allocated, stored;      /* bits of a number: 8, 16 or 32; those that count */
    bool is_signed;
} dicom_j2k_form;

/* dicom_j2k_is_there() - whether this program was built with OpenJPEG. */
bool dicom_j2k_is_there(void);

/* dicom_j2k_decode() - a codestream as columns * rows * samples numbers, in native byte order, the
 * samples of a pixel side by side. What its header says is held against the form before any of it
 * is decoded. ST_CORRUPT, ST_UNSUPPORTED, ST_NOMEM, naming `path`. */
CHECKED status dicom_j2k_decode(const char *path, const void *stream, size_t size,
                                const dicom_j2k_form *form, void *out);

#endif
