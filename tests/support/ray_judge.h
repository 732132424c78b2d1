/* ray_judge.h - all surfaces along one ray, as leafcast_probe_ray() finds them, against the
 * reference: their number, places, order and sides, outside the grazing band. */
#ifndef TESTS_SUPPORT_RAY_JUDGE_H
#define TESTS_SUPPORT_RAY_JUDGE_H

#include "render/leafcast.h"
#include "tests/support/ref_judge.h"

typedef struct ray_tally {
    int rays, hits, grazing, faults; /* hits: that the reference sees */
    double worst;                    /* cells */
} ray_tally;

/* ray_judge() - count one ray; its direction is made a unit vector first. The first faults are
 * lines on stderr that start with the name. Trouble fails the running test. */
void ray_judge(ray_tally *sum, leafcast *volume, const char *name, const ref_volume *v, ref_ray ray,
               const double *isos, int iso_count);

#endif
