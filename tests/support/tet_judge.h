/* tet_judge.h - what another renderer's answers about a tetrahedral mesh are worth, in terms of
 * ref_judge.h: missed, false and wrong surfaces, outside the grazing band.
 *
 * Lengths are those of the local edge (tet_reference.h) of the surface's tetrahedron; of a ray that
 * hits nothing, of the tetrahedra near it.
 */
#ifndef TESTS_SUPPORT_TET_JUDGE_H
#define TESTS_SUPPORT_TET_JUDGE_H

#include "tests/support/ref_judge.h"
#include "tests/support/tet_reference.h"

#define TET_JUDGE_ERROR \
    1e-5 /* edges by which a distance may be wrong, and four units of its last place */

/* tet_judge_grazing() - whether the answer changes (the number of surfaces, or a distance by more
 * than REF_GRAZING_CHANGE edges) when the ray is moved sideways by REF_GRAZING_SHIFT edges in any
 * of eight directions. Judges the first `depth` <= 64 surfaces; 1: the nearest. */
bool tet_judge_grazing(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                       const ref_clip *clip, size_t depth);

/* tet_judge_excused() - the same, and also in one direction into each of the sectors that the
 * tetrahedra are, seen along a ray through a vertex or along an edge: at the rim of a hole that is
 * narrower than 45 degrees, only those see where the surface ends. Looks at all tetrahedra: for
 * what is wrong otherwise. */
bool tet_judge_excused(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                       const ref_clip *clip, size_t depth);

/* tet_judge_pixel() - compare one distance (+inf: a miss) with the reference and count it. */
ref_verdict tet_judge_pixel(ref_tally *tally, const tet_ref *r, const ref_ray *ray,
                            const double *isos, int iso_count, const ref_clip *clip, double depth);

/* tet_judge_hits() - compare the other's list of distances, ascending, with the reference's, both
 * of one isovalue, and count it: each must be near one of the other list. How often one is told is
 * no matter here. The band is looked at only where something is wrong. */
ref_verdict tet_judge_hits(ref_tally *tally, const tet_ref *r, const ref_ray *ray, double iso,
                           const ref_clip *clip, const ref_hit *hits, size_t hit_count,
                           const double *t, size_t t_count);

#endif
