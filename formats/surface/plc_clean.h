/* plc_clean.h - points welded, useless facets dropped, and what no mesh can be made of refused. */
#ifndef FORMATS_SURFACE_PLC_CLEAN_H
#define FORMATS_SURFACE_PLC_CLEAN_H

#include "formats/surface/plc.h"

typedef struct plc_report {
    uint64_t welded;   /* points at the place of an earlier one, whose value stays */
    uint64_t flat;     /* facets dropped: fewer than three different corners */
    uint64_t repeated; /* triangles dropped: the same three points as an earlier one */
} plc_report;

/* plc_clean() - points at exactly the same place become one (-0 is 0), in the order of the first of
 * each; with `floats` positions are rounded to floats before. Facets of one polygon lose corners
 * that repeat the one before. */
CHECKED status plc_clean(plc *x, bool floats, plc_report *report);

/* plc_check_solid() - ST_CORRUPT, naming the file, unless there are four points that are in no
 * plane (to 1e-8 of their extent, which is TetGen's tolerance, too). */
CHECKED status plc_check_solid(const plc *x, const char *file);

/* plc_check_closed() - ST_CORRUPT, naming the file, the first facet that has an edge of its own,
 * and that edge. */
CHECKED status plc_check_closed(const plc *x, const char *file);

#endif
