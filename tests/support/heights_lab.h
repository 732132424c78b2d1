/* heights_lab.h - terrains that are traps, as treelet files, and rays over them judged beside brute
 * force (heights_truth.h).
 */
#ifndef TESTS_SUPPORT_HEIGHTS_LAB_H
#define TESTS_SUPPORT_HEIGHTS_LAB_H

#include <stdint.h>

#include "render/leafcast.h"
#include "tests/support/fields.h"
#include "tests/support/heights_truth.h"

/* Hills, noise, plateaus, needles, holes, far from the origin, tiny, huge, flat, saddles. */
enum { HEIGHTS_SHAPES = 11 };
const char *heights_lab_name(int shape);

typedef struct heights_terrain {
    heights_truth truth;
    float *heights;
    const char *type;
    bool holes;
    const char *field; /* its name; NULL: it has none */
} heights_terrain;

/* heights_lab_make() - about n nodes an axis. Release it. */
void heights_lab_make(heights_terrain *t, int shape, long n, uint64_t seed);
void heights_lab_release(heights_terrain *t);

/* heights_lab_leaf() - its file in the scratch folder, by treelets of 2^cells_log2 cells; the path
 * stays valid. */
const char *heights_lab_leaf(const heights_terrain *t, uint32_t cells_log2, uint32_t halo,
                             bool compressed);

/* What was seen. Rays whose answer changes when they are moved by 1e-6 of a cell graze, and count
 * as nothing else; but leaks are counted among all rays. */
typedef struct heights_tally {
    uint64_t rays, hits, grazing, missed, false_hits, wrong_t, wrong_side, wrong_order, leaks;
    double worst; /* distance from the true hit, cells */
} heights_tally;

/* heights_lab_ray() - a random ray of one of several sorts, its direction of unit length. *through:
 * whether it goes from above all heights to below them without leaving the lattice. */
enum { HEIGHTS_RAYS = 8 };
leafcast_ray heights_lab_ray(const heights_terrain *t, int sort, field_random *r, bool *through);

/* heights_lab_judge() - all hits of a ray. heights_lab_judge_first() - an answer of
 * leafcast_trace_rays(). False: it is wrong. */
bool heights_lab_judge(const heights_terrain *t, leafcast *v, const leafcast_ray *r, bool through,
                       heights_tally *tally);
bool heights_lab_judge_first(const heights_terrain *t, const leafcast_ray *r,
                             const leafcast_ray_hit *hit, heights_tally *tally);

/* heights_lab_faults() - how many rays were wrong. */
uint64_t heights_lab_faults(const heights_tally *t);

#endif
