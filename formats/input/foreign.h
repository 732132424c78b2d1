/* foreign.h - formats that are known by sight but not read: which one it is, and what to do.
 */
#ifndef FORMATS_INPUT_FOREIGN_H
#define FORMATS_INPUT_FOREIGN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

typedef struct foreign_format {
    const char *name;     /* "NIfTI-1" */
    const char *advice;   /* what to do, as the end of a sentence */
    const char *importer; /* "vdb": leafcast-import-vdb reads it, and convert by that; or NULL */
} foreign_format;

/* foreign_find() - by the first bytes (FOREIGN_PEEK, or all there are); else by the end of the path
 * ("-": none). bytes: of the whole file; UINT64_MAX: not known. NULL: an unknown format. */
enum { FOREIGN_PEEK = 4096 };
const foreign_format *foreign_find(const char *path, const uint8_t *start, size_t size,
                                   uint64_t bytes);

/* foreign_refuse() - ST_UNSUPPORTED for an input that nobody reads: what it is, where that is
 * known, and what to do; else `expected`, as the end of a sentence. Of the stream nothing was
 * taken. */
CHECKED status foreign_refuse(byte_stream *s, const char *expected);

/* foreign_check_folder() - ST_UNSUPPORTED for a folder that is a file of a format that nobody
 * reads, as a case of OpenFOAM is. */
CHECKED status foreign_check_folder(mem *m, const char *folder);

#endif
