/* image_names.h - the files of a stack, in order: those of a folder, or those that were named.
 *
 * Names are compared as people count: runs of digits by their value, so that img2 comes before
 * img10; all else byte by byte.
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

/* image_names_compare() - below, above or 0, as strcmp(). */
int image_names_compare(const char *a, const char *b);

/* image_names_find() - of a folder its files, but for hidden ones, whose names `known` takes; else
 * the paths themselves. Sorted unless as_given. ST_UNSUPPORTED for a folder without any. */
CHECKED status image_names_find(mem *m, char *const *paths, size_t count, bool as_given,
                                bool (*known)(const char *path), image_names *out);
void image_names_release(image_names *n);

#endif
