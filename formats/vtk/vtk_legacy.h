/* vtk_legacy.h - one pass over a legacy VTK file (.vtk), versions 1.0 to 5.1, to find its arrays.
 *
 * Text or big-endian bytes. This pass finds attributes and field arrays of points and cells. A data
 * set's reader adds the keywords of its geometry. No array is held.
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

/* A keyword that begins a section. Tables of keywords end with NULLs. */
typedef struct vtk_legacy_keyword {
    const char *keyword;
    status (*handle)(vtk_legacy *v);
} vtk_legacy_keyword;

/* A data set: the word behind DATASET, and the keywords of its geometry. */
typedef struct vtk_legacy_dataset {
    const char *name; /* NULL ends a table of them */
    const vtk_legacy_keyword *keywords;
} vtk_legacy_dataset;

/* The pass. A keyword's handler finds the stream behind the keyword's line, and the line split into
 * words. */
struct vtk_legacy {
    mem *m;
    const char *path; /* outlives the arrays */
    byte_stream *s;
    vtk_fields *fields;                /* receives arrays of points and cells */
    uint64_t tuples_there[VTK_OWNERS]; /* set by the handlers: numbers of points and cells */
    void *user;                        /* for the handlers */
    int major;                         /* major number of the file's version */
    char *word[VTK_LEGACY_WORDS];
    int words;

    /* Private to the pass. */
    const vtk_legacy_dataset *dataset;
    bool text, in_data;
    vtk_owner owner; /* owner of the data behind POINT_DATA or CELL_DATA */
    uint64_t tuples; /* tuples of that data */
    text_line line;
    uint64_t line_at; /* the byte where the line starts */
};

/* vtk_legacy_known() - returns whether these are the first bytes of such a file. */
bool vtk_legacy_known(const uint8_t *start, size_t size);

/* vtk_legacy_names() - find the data set that the first bytes name, as it is spelled there. Returns
 * false when they name none. */
enum { VTK_LEGACY_NAME_MAX = 32 };
bool vtk_legacy_names(const uint8_t *start, size_t size, char name[VTK_LEGACY_NAME_MAX]);

/* vtk_legacy_scan() - scan the file. Set m, path, s (at the start of the file), fields and user;
 * the rest must be zero. Afterwards v->dataset is the one found. ST_CORRUPT, ST_UNSUPPORTED, ST_IO,
 * ST_NOMEM, naming file and byte. */
CHECKED status vtk_legacy_scan(vtk_legacy *v, const vtk_legacy_dataset *sets);

/* ---- for handlers ---- */

/* vtk_legacy_fault() - describe what is wrong in this line; returns st. */
status vtk_legacy_fault(const vtk_legacy *v, status st, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/* vtk_legacy_next_line() - read the next line that is not blank, and split it into words. No words
 * at the end. */
CHECKED status vtk_legacy_next_line(vtk_legacy *v);

/* vtk_legacy_says() - returns whether the line begins with this word, in any case of letters. */
bool vtk_legacy_says(const vtk_legacy *v, const char *keyword);

/* vtk_legacy_need_words() - ST_CORRUPT if the line has fewer words, naming the line's form. */
CHECKED status vtk_legacy_need_words(const vtk_legacy *v, int count, const char *form);

/* vtk_legacy_once() - ST_CORRUPT if *before is true; then sets it to true. */
CHECKED status vtk_legacy_once(const vtk_legacy *v, bool *before);

/* Read the line's word of that index as a count, below 2^47, or as the name of a type. */
CHECKED status vtk_legacy_count(const vtk_legacy *v, int word, uint64_t *out);
CHECKED status vtk_legacy_type(const vtk_legacy *v, int word, vtk_type *out);

/* vtk_legacy_points() - "POINTS n type" and the array behind it. vtk_legacy_lists() - "KEYWORD n
 * size", and the ids behind it in either form; the lists add to those that cell data are of.
 * *before: vtk_legacy_once(). */
CHECKED status vtk_legacy_points(vtk_legacy *v, bool *before, uint64_t *points, vtk_array *out);
CHECKED status vtk_legacy_lists(vtk_legacy *v, const char *keyword, bool *before, vtk_lists *out);

/* vtk_legacy_array() - make the array of count numbers that starts here, and skip it. */
CHECKED status vtk_legacy_array(vtk_legacy *v, vtk_type type, const char *role, uint64_t count,
                                vtk_array *out);

#endif
