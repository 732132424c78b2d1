#include "tests/support/ray_stage.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "formats/base/cpu.h"
#include "tests/support/grid_extreme_batch_wide.h"
#include "tests/support/grid_pieces_wide.h"
#include "tests/support/interests.h"

void ray_stage_open(ray_stage *s, const char *path, uint64_t seed) {
    *s = (ray_stage){.random = {seed}};
    s->v = fixture_open(path, NULL);
    s->info = leafcast_describe(s->v);
    for (int isa = 0; isa <= (int)cpu_best(); isa++)
        s->with[s->kernel_count++] = ray_kernels_of(s->v->kind, (cpu_isa)isa);
    s->with[s->kernel_count] = s->with[0];
    if (s->info.dims[0] > 0) {
        s->with[s->kernel_count].segment_batch = grid_pieces_wide;
        s->with[s->kernel_count].extreme_batch = grid_extreme_batch_wide;
    }
    s->kernel_count++;
    s->scratch = aligned_alloc(64, (kind_batch_scratch(s->v->kind) + 127) / 64 * 64);
    assert_non_null(s->scratch);
}

void ray_stage_close(ray_stage *s, const char *name) {
    print_message("# %s: %zu rays, %zu found, %zu blocked\n", name, s->rays, s->found, s->blocked);
    free(s->scratch);
    leafcast_close(s->v);
}

double ray_stage_unit(ray_stage *s) {
    return field_random_unit(&s->random);
}

bool ray_stage_one_in(ray_stage *s, long of) {
    return field_random_below(&s->random, of) == 0;
}

/* Ranges of all widths. */
static void take_some_whole(ray_stage *s, interest *in) {
    homogeneous *h = &in->whole;
    const double range = s->info.value_max - s->info.value_min;
    h->bins = 1 + (int)field_random_below(&s->random, HOMOGENEOUS_BINS);
    h->first = s->info.value_min;
    h->width = range > 0.0 ? range / h->bins : 1.0;
    for (int i = 0; i < h->bins; i++)
        h->until[i] = (float)(homogeneous_begin(h, i) + range * pow(ray_stage_unit(s), 4.0));
}

/* All, or a set of values at random. */
static void select_some(ray_stage *s) {
    interests set;
    double values[8];
    const interest all = interest_of_all();
    for (int i = 0; i < 8; i++)
        values[i] = s->info.value_min + ray_stage_unit(s) * (s->info.value_max - s->info.value_min);
    interests_random(&set, &s->random, values, 8);
    interest in = ray_stage_one_in(s, 2) ? all : set.in;
    if (s->homogeneous && ray_stage_one_in(s, 2))
        take_some_whole(s, &in);
    loader_select(s->v->treelets, &in);
}

void ray_stage_show(ray_stage *s, const leafcast_scene *scene) {
    const leafcast_surface surface =
        leafcast_surface_default(0.5 * (s->info.value_min + s->info.value_max));
    const leafcast_camera view = leafcast_standard_view(s->v, 1.5, 40, 40);
    camera c;
    assert_int_equal(leafcast_select(s->v, &surface, 1), LEAFCAST_OK);
    volume_show(s->v, 0, 0, &surface, 1);
    assert_int_equal(camera_init(&c, &view), ST_OK);
    assert_int_equal(volume_tracer(s->v, scene, &c, &s->tr), ST_OK);
    select_some(s);
}

void ray_stage_admit(leafcast *v, field_random *r, long of) {
    const uint32_t treelets = v->file->layout.treelets;
    loader_request *requests = malloc(treelets * sizeof *requests);
    size_t count = 0;
    assert_non_null(requests);
    loader_clear(v->treelets);
    loader_set_capacity(v->treelets, treelets, 0);
    for (uint32_t t = 0; t < treelets; t++)
        if (of == 0 || field_random_below(r, of) > 0)
            requests[count++] = (loader_request){t, t};
    if (count > 0)
        assert_int_equal(loader_admit(v->treelets, requests, count), ST_OK);
    assert_int_equal(loader_settle(v->treelets), ST_OK);
    free(requests);
}

void ray_stage_bring_in(ray_stage *s, long of) {
    ray_stage_admit(s->v, &s->random, of);
}

ref_ray ray_stage_aim(ray_stage *s) {
    field_random *r = &s->random;
    if (s->lab)
        return lab_mesh_ray(s->lab, (lab_ray)field_random_below(r, LAB_RAY_KINDS), r);
    switch (field_random_below(r, 6)) {
    case 0:
    case 1: return field_exact_ray(&s->world, r); /* along axes and planes, through corners */
    case 2: return field_aimed_ray(&s->world, r, 5);
    case 3: return field_random_ray(&s->world, r, 1e6);
    case 4: return field_random_ray(&s->world, r, 20);
    default: return field_random_ray(&s->world, r, -1);
    }
}

void ray_stage_clear_touched(const ray_stage *s) {
    for (uint32_t t = 0; t < s->v->file->layout.treelets; t++)
        atomic_store(&s->tr.touched[t], 0);
}
