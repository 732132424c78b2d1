#include "tests/support/mesh_pictures.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "tests/support/fixture.h"

int mesh_pictures_of_all(mesh_opener open, int cubes, int every, uint64_t seed) {
    field_random r = {seed};
    int hits = 0;
    for (int i = 0; i < lab_mesh_count(); i++) {
        lab_mesh lab;
        assert_true(lab_mesh_make(&lab, lab_mesh_name(i), cubes, 7));
        picture_volumes v = open(lab_leaf_make(&lab, 300, false), 1);
        const leafcast_surface s = leafcast_surface_default(lab.iso);
        const leafcast_scene scene = leafcast_scene_default();
        pictures_select(&v, &s, 1);
        for (int kind = i % every; kind < PICTURE_VIEWS; kind += every) {
            const leafcast_camera c = pictures_view(v.of[0], kind, &r);
            hits += pictures_alike(&v, &scene, &c, lab.name);
        }
        pictures_close(&v);
        lab_mesh_release(&lab);
    }
    print_message("%d surfaces\n", hits);
    return hits;
}

int mesh_pictures_of_scenes(mesh_opener open, const char *mesh, int cubes, int scenes,
                            field_random *r) {
    int hits = 0;
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, mesh, cubes, 7));
    picture_volumes v = open(lab_leaf_make(&lab, 700, false), 2);
    const leafcast_info info = leafcast_describe(v.of[0]);
    for (int kind = 0; kind < scenes; kind++) {
        leafcast_surface s[3];
        for (int k = 0; k < 3; k++) {
            s[k] = leafcast_surface_default(lab.iso + 0.1 * k);
            s[k].rgb[k] = 0.1f;
            s[k].opacity = kind % 4 == 3 ? 0.4f : 1.0f;
        }
        pictures_select(&v, s, 1 + kind % 3);
        leafcast_scene scene = pictures_scene(kind, &info);
        scene.lod = LEAFCAST_LOD_EXACT;
        const leafcast_camera c = pictures_view(v.of[0], kind % PICTURE_VIEWS, r);
        hits += pictures_alike(&v, &scene, &c, mesh);
    }
    pictures_close(&v);
    lab_mesh_release(&lab);
    print_message("%d surfaces\n", hits);
    return hits;
}

void mesh_pictures_draw(const char *path, double isovalue, const leafcast_options *o, picture *p) {
    leafcast *v = fixture_open(path, o);
    const leafcast_surface s = leafcast_surface_default(isovalue);
    const leafcast_scene scene = leafcast_scene_default();
    leafcast_stats stats = {.size = sizeof stats};
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
    pictures_draw(v, &scene, &c, p, &stats);
    leafcast_close(v);
}
