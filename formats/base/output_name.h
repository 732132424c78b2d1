/* output_name.h - whether an output's name agrees with what is written into it.
 *
 * An output has the format that its name says; other names are refused. Otherwise only the next
 * program would notice that x.vtu is a mesh stream, or none would. A name that says no format (x,
 * x.out) suits any output.
 */
#ifndef FORMATS_BASE_OUTPUT_NAME_H
#define FORMATS_BASE_OUTPUT_NAME_H

#include <stdbool.h>

#include "formats/base/status.h"

/* What a verb writes. */
typedef struct output_kind {
    const char *what;     /* what it is called: "a mesh stream" */
    const char *suffixes; /* suffixes of its names, each followed by a blank: ".mesh " */
    const char *instead;  /* how to get another format, as the end of a sentence; NULL: not said */
    bool sequence;        /* the name may have a %04d: one file per number */
} output_kind;

/* How to get from NRRD or a mesh stream to other formats. */
#define OUTPUT_BY_EXPORT \
    "`leafcast convert' makes a treelet file of that, `leafcast export' others of this"

/* output_name_check() - returns ST_USAGE for a name with the suffix of another format, or with a %d
 * where only one file is written. The message says which names are allowed. Accepts the paths "-"
 * and NULL. */
CHECKED status output_name_check(const char *path, const output_kind *kind);

/* output_name_is_stdout() - whether a path is "-"; NULL is not. */
bool output_name_is_stdout(const char *path);

/* output_name_is_known() - whether a path has the suffix of a known format. */
bool output_name_is_known(const char *path);

#endif
