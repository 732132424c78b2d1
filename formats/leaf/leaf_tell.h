/* leaf_tell.h - what a treelet file tells of itself: a row for each kind of geometry, and the facts
 * that all kinds have.
 *
 * leafcast info walks the row of a file's kind, and knows no kind. A new kind adds its row, and a
 * line in leaf_tellers.c.
 */
#ifndef FORMATS_LEAF_LEAF_TELL_H
#define FORMATS_LEAF_LEAF_TELL_H

#include "formats/base/fact_sheet.h"
#include "formats/leaf/leaf_file.h"

typedef struct leaf_teller {
    const char *name;  /* "grid" */
    const char *cells; /* what its cells are called: "cells" */
    const char *drawn; /* what its histograms count: "samples"; NULL: it has none */
    bool is_surface;   /* it is a surface by itself: it has no isosurfaces */
    bool has_levels;   /* it has levels of detail, and tells what an isovalue needs of each */
    /* The number of cells of the whole volume, if shares of it are told. NULL: they are not. */
    uint64_t (*cell_count)(const leaf_header *h);
    /* tell(): what the file is, in lines and values: facts of its own, between those below.
     * tell_parts(): tables of what it is made of; NULL: there are none. */
    void (*tell)(const leaf_file *f, const fact_sheet *to);
    void (*tell_parts)(const leaf_file *f, const fact_sheet *to);
} leaf_teller;

/* leaf_teller_of() - the row of a file's kind; leaf_tell_other if it has none: that row tells what
 * all kinds have. */
const leaf_teller *leaf_teller_of(const leaf_file *f);
extern const leaf_teller leaf_tell_other;

/* leaf_tell_begin() - tell the name, the program that made the file, and its id. */
void leaf_tell_begin(const leaf_file *f, const fact_sheet *to);

/* leaf_tell_values() - tell the range of all values, and how many are not finite. counted: what
 * these are called; copies: how often the file has each. */
void leaf_tell_values(const leaf_file *f, const fact_sheet *to, const char *counted,
                      unsigned copies);

/* leaf_tell_print_fields(), leaf_tell_print_steps() - the lines about fields and steps.
 * leaf_tell_set_fields() - the values about both. */
void leaf_tell_print_fields(const leaf_file *f, const fact_sheet *to);
void leaf_tell_print_steps(const leaf_file *f, const fact_sheet *to);
void leaf_tell_set_fields(const leaf_file *f, const fact_sheet *to);

/* leaf_tell_coarse() - tell how many sets have coarse grids, and their bytes. */
void leaf_tell_coarse(const leaf_file *f, const fact_sheet *to);

/* leaf_tell_bounds() - tell the box about all cells, at all steps. */
void leaf_tell_bounds(const leaf_file *f, const fact_sheet *to);

/* leaf_tell_codec() - returns the name of the file's codec. */
const char *leaf_tell_codec(const leaf_file *f);

/* leaf_tell_bytes() - tell the sizes of the file and its parts. raw: bytes of the data before
 * compression. */
void leaf_tell_bytes(const leaf_file *f, const fact_sheet *to, double raw);

/* leaf_tell_implied() - returns the number of payloads without bytes. */
uint32_t leaf_tell_implied(const leaf_file *f);

#endif
