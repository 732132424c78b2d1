/* leaf_geometry.h - what a kind of geometry decides about a treelet file: a row of a table each.
 *
 * Header, section table, directory and payloads are the container; what is in them beside what all
 * files have, a row says. Adding a kind adds a file with its row and a line of leaf_geometries.c.
 */
#ifndef FORMATS_LEAF_LEAF_GEOMETRY_H
#define FORMATS_LEAF_LEAF_GEOMETRY_H

#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_file.h"

typedef struct leaf_geometry {
    bool holds_indices; /* leaf_file_holds_indices() */
    bool has_map;       /* to_world is its own, so that section WORLD may say which way it leads */

    /* ---- The header, as leaf_check_header() and leaf_check_layout() ---- */

    /* Fields that say how the file is made; those that say what is in it, and to_world; the rest of
     * the page, from header.tets on. */
    status (*check_parameters)(const char *path, const leaf_header *h);
    status (*check_values)(const char *path, const leaf_header *h);
    status (*check_rest)(const char *path, const leaf_header *h);
    status (*check_layout)(const char *path, const leaf_header *h, leaf_layout *l);

    /* ---- The directory ---- */

    /* Elements a treelet of RANGES, OWN, FLAGS; elements of OFFSETS, SIZES, CHECKSUMS; bytes of the
     * sections of its own, 0: it has none of that kind. */
    uint64_t (*sets)(const leaf_header *h);
    uint64_t (*payloads)(const leaf_header *h);
    /* Whether there can be sections FIELDS and TIMES. */
    bool (*labels)(const leaf_header *h);
    uint64_t (*section_bytes)(const leaf_header *h, uint32_t kind);
    /* Room for what the directory has besides, to which section() points: where one of its own is
     * read to. release() gives back what there is of it. NULL: nothing. */
    status (*allocate)(leaf_file *f);
    void *(*section)(const leaf_file *f, uint32_t kind);
    void (*release)(leaf_file *f);
    /* Sections have been read: check its own, and make f->layout. d: what leaf_check_directory()
     * is to look at besides is to be added; at and end are there. */
    status (*lay_out)(leaf_file *f, leaf_directory *d);
    /* The part of leaf_check_directory() behind payloads: ranges, flags, what is its own. */
    status (*check_directory)(const char *path, const leaf_header *h, const leaf_layout *l,
                              const leaf_directory *d);

    /* ---- Payloads, as leaf_layout.h has them ---- */

    uint32_t (*payload_bytes)(const leaf_layout *l, uint32_t p);
    bool (*begins_run)(const leaf_layout *l, uint32_t p);
    const char *(*payload_name)(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]);

    /* Payloads that the directory tells, and which have no bytes: whether one of this own range and
     * these flags can be; whether this one is; and its bytes. NULL, all three: there are none. */
    bool (*may_imply)(const float own[2], uint8_t flags);
    bool (*implies)(const leaf_layout *l, uint32_t p, const float own[2], uint8_t flags,
                    const void *payload);
    void (*imply)(const leaf_layout *l, uint32_t p, const float own[2], void *payload);
} leaf_geometry;

/* leaf_geometry_of() - the row of a leaf_kind; NULL: this program knows none. */
const leaf_geometry *leaf_geometry_of(uint32_t kind);

#endif
