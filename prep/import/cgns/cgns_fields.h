/* cgns_fields.h - the fields of a CGNS file at their steps, of nodes and of cells.
 *
 * A field is what has one name in the solutions of all zones (SIDS, 7.7). Where a zone's iterative
 * data names its solutions of each step (SIDS, 11.1.2), only these have a step's fields. Solutions
 * of listed points alone are left out.
 */
#ifndef PREP_IMPORT_CGNS_CGNS_FIELDS_H
#define PREP_IMPORT_CGNS_CGNS_FIELDS_H

#include "formats/mesh/mesh_average.h"
#include "prep/import/cgns/cgns_cells.h"
#include "prep/import/import_fields.h"

typedef struct cgns_fields {
    const cgns_file *f;
    import_fields all;
    bool told; /* the file says how many steps there are */
    /* What is read now: */
    uint32_t turned;      /* which taken field, from 1; 0: none yet */
    int *solutions;       /* by zone: of the field at the step, from 1; 0: there is none */
    char name[CGNS_NAME]; /* as the file spells it */
    mesh_average sums;    /* of a field of cells */
    mesh_polyhedron_room room;
} cgns_fields;

CHECKED status cgns_fields_open(const cgns_file *f, cgns_fields *x);
void cgns_fields_release(cgns_fields *x);

/* cgns_fields_read() - values of taken field k at `count` nodes of the mesh from `first` on, in
 * order; NaN in zones without it. Of a field of cells: means of the cells around each node. */
CHECKED status cgns_fields_read(cgns_fields *x, cgns_cells *cells, uint32_t k, uint64_t first,
                                size_t count, float *to);

#endif
