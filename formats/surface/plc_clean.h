/* plc_clean.h - welds points, drops useless facets, and refuses what no mesh can be made of. */
#ifndef FORMATS_SURFACE_PLC_CLEAN_H
#define FORMATS_SURFACE_PLC_CLEAN_H

#include "formats/surface/plc.h"

typedef struct plc_report {
    uint64_t welded;   /* points dropped at the place of an earlier one, whose value stays */
    uint64_t flat;     /* facets dropped: fewer than three different corners */
    uint64_t repeated; /* triangles dropped: the same three points as an earlier one */
} plc_report;

/* plc_clean() - clean a complex. Points at exactly the same place become one (-0 is 0), in the
 * order of their first ones. With `floats`, positions are rounded to floats before. Facets of one
 * polygon lose corners that repeat the one before. */
CHECKED status plc_clean(plc *x, bool floats, plc_report *report);

/* plc_check_solid() - ST_CORRUPT, naming the file, unless four points lie in no common plane (to
 * 1e-8 of their extent, which is TetGen's tolerance, too). */
CHECKED status plc_check_solid(const plc *x, const char *file);

/* plc_check_closed() - ST_CORRUPT if a facet has an edge that no other has. Names the file, the
 * first such facet, and the edge. */
CHECKED status plc_check_closed(const plc *x, const char *file);

#endif
