/* dicom_j2k.h - decodes a frame packed by JPEG 2000. Wraps OpenJPEG, as DCMTK has no decoder for
 * it.
 *
 * C++ includes it within extern "C".
 */
#ifndef PREP_IMPORT_DICOM_DICOM_J2K_H
#define PREP_IMPORT_DICOM_DICOM_J2K_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"

/* Facts about the frame from the DICOM header. */
typedef struct dicom_j2k_form {
    uint32_t columns, rows, samples; /* samples: numbers per pixel */
    uint32_t allocated, stored;      /* bits of a number: 8, 16 or 32; how many of them count */
    bool is_signed;
} dicom_j2k_form;

/* dicom_j2k_is_there() - returns whether this program was built with OpenJPEG. */
bool dicom_j2k_is_there(void);

/* dicom_j2k_decode() - decode a codestream to columns * rows * samples numbers, in native byte
 * order, a pixel's samples side by side. Its header is compared with the form before anything is
 * decoded. ST_CORRUPT, ST_UNSUPPORTED, ST_NOMEM, naming `path`. */
CHECKED status dicom_j2k_decode(const char *path, const void *stream, size_t size,
                                const dicom_j2k_form *form, void *out);

#endif
