#include "render/curved/curved_meet.h"

#include "formats/base/simd_one.h"
#include "formats/curved/quadratic_path.h"
#include "render/curved/curved_meet_template.h"
#include "render/curved/hex_roots.h"

/* The number of roots, 0 or 1; -1: not known. terms: of the cell's forms. */
static inline int find_single(const curved_sight *sight, int terms, int sense, const sheared_ray *r,
                              double isovalue, path_root *out) {
    const curved_rays rays = {
        {r->axis[0], r->axis[1], r->axis[2]}, {r->slope[0], r->slope[1]}, r->d};
    curved_forms forms;
    curved_met met;
    if (!curved_may_meet(sight, terms, &rays, isovalue))
        return 0;
    curved_forms_of(sight, terms, &rays, isovalue, &forms);
    curved_meet_lanes(sight, terms, &rays, &forms, true, &met);
    if (met.unknown)
        return -1;
    if (!met.once)
        return 0;
    out->t = met.t;
    for (int a = 0; a < 3; a++)
        out->at[a] = met.at[a];
    out->entering = met.enters == (sense > 0);
    return 1;
}

static int meet_hexahedron(const hexahedron *cell, int sense, const sheared_ray *r, double isovalue,
                           path_root *out) {
    curved_sight sight;
    curved_sight_of_hexahedron(cell, r->o, &sight);
    return find_single(&sight, TRILINEAR, sense, r, isovalue, out);
}

static int meet_tet(const quadratic_tet *cell, int sense, const sheared_ray *r, double isovalue,
                    path_root *out) {
    curved_sight sight;
    curved_sight_of_tet(cell, r->o, &sight);
    return find_single(&sight, FORM_TERMS, sense, r, isovalue, out);
}

int curved_meet_roots(const curved_cell *cell, const sheared_ray *r, double isovalue,
                      path_root out[PATH_ROOTS], path_counts *counts) {
    int single = -1;
    quadratic_path path;
    if (cell->quadratic && !quadratic_path_place(&cell->tet, r, &path)) /* most that are near */
        return 0;
    if (cell->sense != 0)
        single = cell->quadratic
                     ? meet_tet(&cell->tet, cell->sense, r, isovalue, out)
                     : meet_hexahedron(&cell->hexahedron, cell->sense, r, isovalue, out);
    return single >= 0 ? single : curved_meet_crossed(cell, r, isovalue, out, counts);
}

int curved_meet_crossed(const curved_cell *cell, const sheared_ray *r, double isovalue,
                        path_root out[PATH_ROOTS], path_counts *counts) {
    if (cell->quadratic) {
        quadratic_path path;
        return quadratic_path_of(&cell->tet, cell->sense, r, &path) == 0
                   ? 0
                   : path_roots(&path.map, path.part, path.count, cell->sense == 0, isovalue, out,
                                counts);
    }
    hex_path path;
    return hex_path_of(&cell->hexahedron, cell->sense, r, &path) == 0
               ? 0
               : hex_roots(&cell->hexahedron, cell->sense, &path, isovalue, out, counts);
}
