/* surface_units.h - the treelets with an isosurface, for each isovalue: pieces in the order of the
 * output.
 */
#ifndef PREP_EXPORT_SURFACE_UNITS_H
#define PREP_EXPORT_SURFACE_UNITS_H

#include "formats/leaf/leaf_file.h"

typedef struct surface_unit {
    uint32_t treelet, isovalue; /* its number */
} surface_unit;

/* Start with {.m = budget}. */
typedef struct surface_units {
    mem *m;
    surface_unit *list;
    size_t count, room;
} surface_units;

/* surface_units_find() - of a set of values, by the treelets' own ranges. Release in any case. */
CHECKED status surface_units_find(surface_units *u, const leaf_file *f, uint32_t set,
                                  const double *isovalues, uint32_t count);
void surface_units_release(surface_units *u);

#endif
