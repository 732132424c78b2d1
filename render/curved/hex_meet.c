#include "render/curved/hex_meet.h"

#include "formats/base/simd_one.h"
#include "render/curved/hex_meet_template.h"

/* The number of roots, 0 or 1; -1: not known. */
static int single_root(const hexahedron *cell, int sense, const sheared_ray *r, double isovalue,
                       path_root *out) {
    const hex_rays rays = {{r->axis[0], r->axis[1], r->axis[2]}, {r->slope[0], r->slope[1]}, r->d};
    hex_sight sight;
    hex_forms forms;
    hex_met met;
    hex_sight_of(cell, r->o, &sight);
    if (!hex_may_meet(&sight, &rays, isovalue))
        return 0;
    hex_forms_of(&sight, &rays, isovalue, &forms);
    hex_meet_lanes(&sight, &rays, &forms, true, &met);
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

int hex_meet_roots(const hexahedron *cell, int sense, const sheared_ray *r, double isovalue,
                   path_root out[PATH_ROOTS], path_counts *counts) {
    const int single = sense != 0 ? single_root(cell, sense, r, isovalue, out) : -1;
    return single >= 0 ? single : hex_meet_crossed(cell, sense, r, isovalue, out, counts);
}

int hex_meet_crossed(const hexahedron *cell, int sense, const sheared_ray *r, double isovalue,
                     path_root out[PATH_ROOTS], path_counts *counts) {
    hex_path path;
    if (hex_path_of(cell, sense, r, &path) == 0)
        return 0;
    return hex_roots(cell, sense, &path, isovalue, out, counts);
}
