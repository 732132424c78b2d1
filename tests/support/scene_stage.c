#include "tests/support/scene_stage.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/leaf_files.h"

enum { NODES = 36, CUBES = 6 };

const leafcast_surface scene_stage_grid[] = {{0.5, {0.9f, 0.2f, 0.1f}, 0.4f, 0, 0},
                                             {1.1, {0.1f, 0.8f, 0.3f}, 0.6f, 0, 0}};
leafcast_surface scene_stage_mesh = {0, {0.2f, 0.3f, 0.9f}, 0.5f, 0, 0};
const double scene_stage_isos[] = {0.5, 1.1};

int scene_stage_set(void **state) {
    static scene_stage s;
    const long dims[3] = {NODES, NODES, NODES};
    leaf_case c = leaf_files_case(NODES, NODES, NODES, SAMPLE_F32);
    s.samples = leaf_files_random(&c, 11, 0);
    c.samples = s.samples;
    strcpy(s.grid_path, leaf_files_make(&c, "grid.leaf"));
    s.grid = ref_volume_regular(dims, s.samples, NULL, NULL);
    assert_true(lab_mesh_make(&s.lab, "noise", CUBES, 7));
    for (size_t i = 0; i < s.lab.point_count; i++)
        for (int a = 0; a < 3; a++) {
            const double share =
                ((double)s.lab.points[i][a] - s.lab.lo[a]) / (s.lab.hi[a] - s.lab.lo[a]);
            s.lab.points[i][a] = (float)(4.0 + 27.0 * share);
        }
    strcpy(s.mesh_path, lab_leaf_make(&s.lab, 200, false));
    s.raw = lab_mesh_reference(&s.lab);
    s.mesh = tet_ref_create(&s.raw);
    assert_non_null(s.mesh);
    scene_stage_mesh.isovalue = s.lab.iso;
    *state = &s;
    return 0;
}

int scene_stage_clear(void **state) {
    scene_stage *s = *state;
    tet_ref_destroy(s->mesh);
    lab_mesh_release(&s->lab);
    free(s->samples);
    return 0;
}

void scene_stage_open(scene_pair *p, const scene_stage *s, const leafcast_options *device,
                      uint32_t treelets) {
    assert_int_equal(leafcast_device_create(device, &p->device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o,
                                .device = p->device,
                                .experiments = EXPERIMENTS(.treelet_limit = treelets)};
    assert_int_equal(leafcast_open(s->grid_path, &o, &p->volume[0]), LEAFCAST_OK);
    assert_int_equal(leafcast_open(s->mesh_path, &o, &p->volume[1]), LEAFCAST_OK);
    p->shown[0] =
        (leafcast_shown){.volume = p->volume[0], .surfaces = scene_stage_grid, .count = 2};
    p->shown[1] =
        (leafcast_shown){.volume = p->volume[1], .surfaces = &scene_stage_mesh, .count = 1};
    p->scene = leafcast_scene_default();
    p->scene.volumes = p->shown;
    p->scene.volume_count = 2;
}

void scene_stage_close(scene_pair *p) {
    leafcast_close(p->volume[0]);
    leafcast_device_destroy(p->device); /* ends with the last volume */
    leafcast_close(p->volume[1]);
}

leafcast_camera scene_stage_view(double from) {
    return (leafcast_camera){.size = sizeof(leafcast_camera),
                             .eye = {from, 0.6 * from + 3.1, 0.8 * from},
                             .look_at = {17.3, 17.1, 17.7},
                             .up = {0, 0, 1},
                             .fov = 40,
                             .width = PICTURE_WIDTH,
                             .height = PICTURE_HEIGHT};
}

void scene_stage_same(const picture *a, const picture *b) {
    assert_memory_equal(a->z, b->z, sizeof a->z);
    assert_memory_equal(a->id, b->id, sizeof a->id);
    assert_memory_equal(a->normal, b->normal, sizeof a->normal);
    assert_memory_equal(a->rgba, b->rgba, sizeof a->rgba);
}

leafcast_scene scene_stage_lit(const scene_pair *v) {
    leafcast_scene scene = v->scene;
    scene.light_count = 2;
    scene.lights[0] = (leafcast_light){false, {1, 0.4, 2}, {0.8f, 0.7f, 0.6f}, 0};
    scene.lights[1] = (leafcast_light){true, {60, -20, 50}, {0.3f, 0.4f, 0.5f}, 0};
    scene.shadows = true;
    return scene;
}
