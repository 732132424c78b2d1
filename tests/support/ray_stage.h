/* ray_stage.h - a volume whose treelets are there or not, all kernels that this CPU has, and random
 * rays: for tests of many rays against rays one by one.
 */
#ifndef TESTS_SUPPORT_RAY_STAGE_H
#define TESTS_SUPPORT_RAY_STAGE_H

#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"

typedef struct ray_stage {
    leafcast *v;
    tracer tr;
    leafcast_info info;
    ref_volume world;    /* a grid; */
    const lab_mesh *lab; /* or a mesh */
    ray_kernels with[8];
    int kernel_count;
    void *scratch;
    field_random random;
    bool homogeneous;            /* nodes may be taken whole: before it is shown */
    size_t rays, found, blocked; /* what a test has counted */
} ray_stage;

/* ray_stage_open(), ray_stage_close() - the file at `path`; what is random comes from the seed. The
 * last of the kernels are those for vectors of AVX-512 in plain C. */
void ray_stage_open(ray_stage *s, const char *path, uint64_t seed);
void ray_stage_close(ray_stage *s, const char *name);

/* ray_stage_unit(), ray_stage_one_in() - a random number in [0, 1); true once in so many. */
double ray_stage_unit(ray_stage *s);
bool ray_stage_one_in(ray_stage *s, long of);

/* ray_stage_show() - a scene: s->tr. All values are of interest, or some. */
void ray_stage_show(ray_stage *s, const leafcast_scene *scene);

/* ray_stage_bring_in() - all treelets, but one in `of` stays absent, at random; 0: none.
 * ray_stage_admit() - the same for any volume. */
void ray_stage_bring_in(ray_stage *s, long of);
void ray_stage_admit(leafcast *v, field_random *r, long of);

/* ray_stage_aim() - a ray in world space, of any kind. */
ref_ray ray_stage_aim(ray_stage *s);

/* ray_stage_clear_touched() - no treelet has been walked. */
void ray_stage_clear_touched(const ray_stage *s);

#endif
