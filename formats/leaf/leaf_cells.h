/* leaf_cells.h - treelet files of kinds whose cells are records that share nothing: balls, prisms,
 * whatever has a box and a range of values.
 *
 * A kind says what a record is (leaf_cells), and gets its row of leaf_geometry.h. The file has:
 *
 *   BOUNDS   float[6] a treelet at a step, steps one after another: holds its cells
 *   COUNTS   uint32_t[4] a treelet: cells; 0, 0, 0. The same at all steps
 *   payload  a set's records of a treelet, all sets of treelets one after another
 *
 * Of the header it uses what all kinds do, and bounds, over all steps.
 */
#ifndef FORMATS_LEAF_LEAF_CELLS_H
#define FORMATS_LEAF_LEAF_CELLS_H

#include "formats/leaf/leaf_geometry.h"

typedef struct leaf_cells {
    const char *name; /* of a cell, for messages: "sphere" */
    uint32_t bytes;   /* of a record, a multiple of LEAF_ALIGN */
    uint32_t most;    /* cells in a treelet */
    /* Set the box (lo x y z, hi x y z) and the least and greatest value of a cell, rounded
     * outwards. A cell is asked for the surface of v only if range[0] < v <= range[1]; so the value
     * outside of all cells belongs to the range where the step at the cell's face is a surface.
     * Returns NULL, or what is wrong with the record. The record is hostile. */
    const char *(*measure)(const void *record, float box[6], float range[2]);
} leaf_cells;

/* What the directory has besides: leaf_file.besides. */
typedef struct leaf_cells_directory {
    float (*bounds)[6];
    uint32_t (*counts)[4];
    uint64_t *first; /* treelets + 1: number of a treelet's first cell in the whole file */
} leaf_cells_directory;

static inline const leaf_cells_directory *leaf_cells_directory_of(const leaf_file *f) {
    return f->besides;
}

/* leaf_cells_treelet() - the treelet of a cell, by the number in the whole file: first[t] is that
 * of a treelet's first cell. Of any kind whose cells are counted treelet after treelet. */
uint32_t leaf_cells_treelet(const uint64_t *first, uint32_t treelets, uint64_t number);

/* leaf_cells_of() - what a record of the file is. */
const leaf_cells *leaf_cells_of(const leaf_file *f);

/* LEAF_CELLS_GEOMETRY() - the row of a kind. c: its leaf_cells. */
status leaf_cells_check_parameters(const char *path, const leaf_header *h);
status leaf_cells_check_values(const char *path, const leaf_header *h);
status leaf_cells_check_rest(const char *path, const leaf_header *h);
status leaf_cells_check_layout(const char *path, const leaf_header *h, leaf_layout *l);
uint64_t leaf_cells_sets(const leaf_header *h);
uint64_t leaf_cells_payloads(const leaf_header *h);
bool leaf_cells_labels(const leaf_header *h);
uint64_t leaf_cells_section_bytes(const leaf_header *h, uint32_t kind);
status leaf_cells_allocate(leaf_file *f);
void *leaf_cells_section(const leaf_file *f, uint32_t kind);
void leaf_cells_release(leaf_file *f);
status leaf_cells_lay_out(leaf_file *f, leaf_directory *d);
status leaf_cells_check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                                  const leaf_directory *d);
uint32_t leaf_cells_payload_bytes(const leaf_layout *l, uint32_t p);
bool leaf_cells_begins_run(const leaf_layout *l, uint32_t p);
leaf_series leaf_cells_series(const leaf_layout *l, uint32_t p);
const char *leaf_cells_payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]);
int leaf_cells_parts(const leaf_layout *l, uint32_t set, uint32_t treelet,
                     uint32_t payloads[LEAF_PARTS_MAX]);

#define LEAF_CELLS_GEOMETRY(c)                                                          \
    {                                                                                   \
        .cells = (c), .check_parameters = leaf_cells_check_parameters,                  \
        .check_values = leaf_cells_check_values, .check_rest = leaf_cells_check_rest,   \
        .check_layout = leaf_cells_check_layout, .sets = leaf_cells_sets,               \
        .payloads = leaf_cells_payloads, .labels = leaf_cells_labels,                   \
        .section_bytes = leaf_cells_section_bytes, .allocate = leaf_cells_allocate,     \
        .section = leaf_cells_section, .release = leaf_cells_release,                   \
        .lay_out = leaf_cells_lay_out, .check_directory = leaf_cells_check_directory,   \
        .payload_bytes = leaf_cells_payload_bytes, .begins_run = leaf_cells_begins_run, \
        .series = leaf_cells_series, .payload_name = leaf_cells_payload_name,           \
        .parts = leaf_cells_parts                                                       \
    }

#endif
