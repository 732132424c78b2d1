/* output_name.h - whether an output's name agrees with what is written into it.
 *
 * The format of an output is the one that its name says, or the name is refused: a mesh stream
 * called x.vtu would be found out by the next program only, or by none. Names that say no format
 * (x, x.out) are anyone's.
 */
#ifndef FORMATS_BASE_OUTPUT_NAME_H
#define FORMATS_BASE_OUTPUT_NAME_H

#include <stdbool.h>

#include "formats/base/status.h"

/* What a verb writes. */
typedef struct output_kind {
    const char *what;     /* "a mesh stream" */
    const char *suffixes; /* of its names, each with a blank behind: ".mesh " */
    const char *instead;  /* how to come by another format, as a sentence's end; NULL: untold */
    bool sequence;        /* a %04d in its name is replaced: a file each */
} output_kind;

/* The way from NRRD or a mesh stream to the rest. */
#define OUTPUT_BY_EXPORT \
    "`leafcast convert' makes a treelet file of that, `leafcast export' others of this"

/* output_name_check() - ST_USAGE for a name that ends as those of another format do, or has a %d
 * where one file is written; it says what would do. path: "-" is fine, and so is NULL. */
CHECKED status output_name_check(const char *path, const output_kind *kind);

/* output_name_is_known() - whether a path ends as files of some format do. */
bool output_name_is_known(const char *path);

#endif
