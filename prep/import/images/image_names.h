/* image_names.h - the files of a stack, in order: those in a folder, or the files named.
 *
 * Runs of digits in names are compared by value, so that img2 comes before img10. The rest is
 * compared byte by byte.
 */
#ifndef PREP_IMPORT_IMAGES_IMAGE_NAMES_H
#define PREP_IMPORT_IMAGES_IMAGE_NAMES_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct image_names {
    mem *m;
    char **paths;
    size_t count, room;
} image_names;

/* image_names_compare() - returns < 0, 0 or > 0, as strcmp() does. */
int image_names_compare(const char *a, const char *b);

/* image_names_find() - list the files of a folder that `known` accepts, except hidden ones; else
 * the paths themselves. Sorted unless as_given. ST_UNSUPPORTED: the folder has no such file. */
CHECKED status image_names_find(mem *m, char *const *paths, size_t count, bool as_given,
                                bool (*known)(const char *path), image_names *out);
void image_names_release(image_names *n);

#endif
