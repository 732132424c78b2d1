/* vtk_legacy.h - one pass over a legacy VTK file (.vtk), versions 1.0 to 5.1: where its arrays lie.
 *
 * Text or big-endian bytes; attributes and field arrays of points and cells are found here, the
 * geometry by the keywords that a data set's reader adds. No array is held.
 */
#ifndef FORMATS_VTK_VTK_LEGACY_H
#define FORMATS_VTK_VTK_LEGACY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/input/byte_stream.h"
#include "formats/vtk/vtk_array.h"
#include "formats/vtk/vtk_fields.h"

enum { VTK_LEGACY_WORDS = 8 };

typedef struct vtk_legacy vtk_legacy;

/* What begins a section; tables of them end with NULLs. */
typedef struct vtk_legacy_keyword {
    const char *keyword;
    status (*handle)(vtk_legacy *v);
} vtk_legacy_keyword;

/* A data set: the word behind DATASET, and the keywords of its geometry. */
typedef struct vtk_legacy_dataset {
    const char *name; /* NULL ends a table of them */
    const vtk_legacy_keyword *keywords;
} vtk_legacy_dataset;

/* The pass. A keyword's handler finds the stream behind its line, and the line in words. */
struct vtk_legacy {
    mem *m;
    const char *path; /* outlives the arrays */
    byte_stream *s;
    vtk_fields *fields;                /* where arrays of points and cells go */
    uint64_t tuples_there[VTK_OWNERS]; /* the handlers' to set: points, and cells */
    void *user;                        /* the handlers' own */
    int major;                         /* of the file's version */
    char *word[VTK_LEGACY_WORDS];
    int words;

    /* The pass' own. */
    const vtk_legacy_dataset *dataset;
    bool text, in_data;
    vtk_owner owner; /* of the data behind POINT_DATA or CELL_DATA */
    uint64_t tuples; /* of that data */
    text_line line;
    uint64_t line_at; /* the byte where it starts */
};

/* vtk_legacy_known() - whether these are the first bytes of such a file. */
bool vtk_legacy_known(const uint8_t *start, size_t size);

/* vtk_legacy_names() - the data set that they name, as they write it; false when they do not. */
enum { VTK_LEGACY_NAME_MAX = 32 };
bool vtk_legacy_names(const uint8_t *start, size_t size, char name[VTK_LEGACY_NAME_MAX]);

/* vtk_legacy_scan() - with m, path, s (at the start of the file), fields and user set, the rest
 * zero; v->dataset is the one that was found. ST_CORRUPT, ST_UNSUPPORTED, ST_IO, ST_NOMEM, naming
 * file and byte. */
CHECKED status vtk_legacy_scan(vtk_legacy *v, const vtk_legacy_dataset *sets);

/* ---- for handlers ---- */

/* vtk_legacy_fault() - describe what is wrong in this line; returns st. */
status vtk_legacy_fault(const vtk_legacy *v, status st, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/* vtk_legacy_next_line() - the next line that is not blank, in words; none at the end. */
CHECKED status vtk_legacy_next_line(vtk_legacy *v);

/* vtk_legacy_says() - whether the line begins with this word, in any case of letters. */
bool vtk_legacy_says(const vtk_legacy *v, const char *keyword);

/* vtk_legacy_need_words() - ST_CORRUPT, naming the form of the line, when it has fewer words. */
CHECKED status vtk_legacy_need_words(const vtk_legacy *v, int count, const char *form);

/* vtk_legacy_once() - ST_CORRUPT when *before is true, which it is from now on. */
CHECKED status vtk_legacy_once(const vtk_legacy *v, bool *before);

/* The line's word of that index as a number of things, below 2^47, or as the name of a type. */
CHECKED status vtk_legacy_count(const vtk_legacy *v, int word, uint64_t *out);
CHECKED status vtk_legacy_type(const vtk_legacy *v, int word, vtk_type *out);

/* vtk_legacy_array() - the array of count numbers that starts here; the pass goes on behind it. */
CHECKED status vtk_legacy_array(vtk_legacy *v, vtk_type type, const char *role, uint64_t count,
                                vtk_array *out);

#endif
