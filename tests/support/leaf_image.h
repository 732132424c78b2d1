/* leaf_image.h - a treelet file in memory, to be changed and made to look sound: not damage, but
 * malice. */
#ifndef TESTS_SUPPORT_LEAF_IMAGE_H
#define TESTS_SUPPORT_LEAF_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/leaf/leaf_file.h"

typedef struct leaf_image {
    char *bytes; /* malloc'ed; free() it */
    size_t size;
    leaf_header *header; /* in place, like all that follows */
    leaf_section *table;
    uint64_t sections_end; /* of the directory */
} leaf_image;

/* leaf_image_of() - of a sound file's bytes, which it takes over. Compressed sections become plain
 * ones: such a file has no coarse grids.
 * leaf_image_as_is() - the same, as it is. */
leaf_image leaf_image_of(char *bytes, size_t size);
leaf_image leaf_image_as_is(char *bytes, size_t size);

/* leaf_image_is_directory() - whether byte `at` is of the header or the directory. */
bool leaf_image_is_directory(const leaf_image *i, uint64_t at);

/* leaf_image_section() - where a section begins; NULL: there is none. */
void *leaf_image_section(const leaf_image *i, uint32_t kind);

/* leaf_image_seal() - make the sections' checksums and the header's, and the id, right again.
 * leaf_image_seal_payloads() - those of the payloads in the directory, before that. Whatever else
 * is wrong stays, and nothing outside the image is looked at, whatever header and table say. */
void leaf_image_seal(const leaf_image *i);
void leaf_image_seal_payloads(const leaf_image *i);

#endif
