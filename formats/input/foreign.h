/* foreign.h - recognises formats that are not read here, and says which one it is and what to do.
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
    const char *advice;   /* advice to the user, as the end of a sentence */
    const char *importer; /* "vdb" if leafcast-import-vdb, and so convert, reads it; or NULL */
    bool mesh;            /* which gives a mesh; else a grid */
} foreign_format;

/* foreign_find() - find the format by the first bytes (FOREIGN_PEEK, or all there are), else by the
 * end of the path ("-": none). bytes: size of the whole file; UINT64_MAX: unknown. Returns NULL for
 * an unknown format. */
enum { FOREIGN_PEEK = 4096 };
const foreign_format *foreign_find(const char *path, const uint8_t *start, size_t size,
                                   uint64_t bytes);

/* foreign_refuse() - return ST_UNSUPPORTED for an input that nothing here reads. Describes its
 * format, if known, and what to do; else `expected`, as the end of a sentence. Call before anything
 * is taken from the stream. */
CHECKED status foreign_refuse(byte_stream *s, const char *expected);

/* foreign_check_folder() - return ST_UNSUPPORTED if a folder is a file of a format that nothing
 * here reads, such as a case of OpenFOAM. */
CHECKED status foreign_check_folder(mem *m, const char *folder);

#endif
