/* scene_stage.h - a grid and a mesh in the same place, to be shown together: what the tests of
 * scenes share. Trouble fails the running test.
 */
#ifndef TESTS_SUPPORT_SCENE_STAGE_H
#define TESTS_SUPPORT_SCENE_STAGE_H

#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"
#include "tests/support/reference.h"
#include "tests/support/tet_reference.h"

/* A grid and a mesh in the same place, and what is true of them. */
typedef struct scene_stage {
    char grid_path[512], mesh_path[512];
    float *samples;
    ref_volume grid;
    lab_mesh lab;
    tet_ref_mesh raw;
    tet_ref *mesh;
} scene_stage;

/* Both files on one device, and a scene of them. */
typedef struct scene_pair {
    leafcast_device *device;
    leafcast *volume[2];
    leafcast_shown shown[2];
    leafcast_scene scene;
} scene_pair;

/* The surfaces of the grid, with their isovalues, and of the mesh. */
extern const leafcast_surface scene_stage_grid[2];
extern const double scene_stage_isos[2];
extern leafcast_surface scene_stage_mesh;

/* scene_stage_set(), scene_stage_clear() - for cmocka_run_group_tests(). */
int scene_stage_set(void **state);
int scene_stage_clear(void **state);

/* scene_stage_open() - open both on a new device; treelets: leafcast_experiments.treelet_limit. */
void scene_stage_open(scene_pair *p, const scene_stage *s, const leafcast_options *device,
                      uint32_t treelets);
void scene_stage_close(scene_pair *p);

/* scene_stage_view() - a camera from that far. scene_stage_lit() - the scene, lit, with shadows. */
leafcast_camera scene_stage_view(double from);
leafcast_scene scene_stage_lit(const scene_pair *v);

void scene_stage_same(const picture *a, const picture *b);

#endif
