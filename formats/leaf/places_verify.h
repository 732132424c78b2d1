/* places_verify.h - checks of a treelet's payloads whose nodes have places and values one after
 * another: of curvilinear grids and mixed meshes.
 */
#ifndef FORMATS_LEAF_PLACES_VERIFY_H
#define FORMATS_LEAF_PLACES_VERIFY_H

#include "formats/curved/curved_cell.h"
#include "formats/leaf/leaf_geometry.h"

/* A treelet while it is checked. */
typedef struct places_subject {
    const leaf_file *f;
    uint32_t t, payload; /* the one that is looked at */
    uint32_t nodes;
    const float *places, *values; /* as loaded: x, y, z of all nodes; a value of each */
    /* NULL, or widens the limits of what all nodes have to those of all cells. The subject is the
     * first member of what it needs. */
    void (*widen)(const struct places_subject *s, const float *of_nodes, float *least,
                  float *greatest);
} places_subject;

/* places_wrong() - ST_CORRUPT at a byte of the payload. */
status places_wrong(const places_subject *s, uint64_t at, const char *what);

/* places_check_zeros() - bytes from `from` to before `end` are 0.
 * places_check_box() - all nodes are somewhere, and the box of all is this one.
 * places_check_values() - the values of a set are as the directory says; value_bytes: of the
 * payload. Add those that are not finite to *non_finite. */
CHECKED status places_check_zeros(const places_subject *s, const void *bytes, uint32_t from,
                                  uint32_t end);
CHECKED status places_check_box(const places_subject *s, const float bounds[6]);
CHECKED status places_check_values(places_subject *s, uint32_t set, uint32_t value_bytes,
                                   uint64_t *non_finite);

/* places_code() - the code of the cell with these nodes. */
hex_code places_code(const places_subject *s, const uint32_t row[CELL_ROW]);

#endif
