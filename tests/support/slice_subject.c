#include "tests/support/slice_subject.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "prep/grid/convert.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/scratch.h"

static slice_subject *load(const char *path, bool mesh) {
    slice_subject *s = calloc(1, sizeof *s);
    snprintf(s->path, sizeof s->path, "%s", path);
    s->mesh = mesh;
    if (mesh ? !naive_mesh_load(&s->tets, path) : !naive_leaf_load(&s->grid, path))
        fail_msg("%s", mesh ? s->tets.why : s->grid.why);
    return s;
}

void slice_subject_free(slice_subject *s) {
    if (s->mesh)
        naive_mesh_release(&s->tets);
    else
        naive_leaf_release(&s->grid);
    free(s);
}

naive_point slice_subject_truth(const slice_subject *s, int level, const double point[3]) {
    return s->mesh ? naive_points_mesh(&s->tets, 0, point)
                   : naive_points_grid(&s->grid, level, point);
}

slice_subject *slice_subject_of_field(const char *name, const char *type, long n, bool compressed) {
    field f;
    assert_true(field_make(&f, name, n, FIELD_SEED));
    if (type)
        f.type = type;
    slice_subject *s = load(fixture_leaf(&f, 4, 1, compressed), false);
    field_release(&f);
    return s;
}

slice_subject *slice_subject_of_mesh(const char *name, int cubes, uint32_t treelet_tets) {
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, name, cubes, 5));
    slice_subject *s = load(lab_leaf_make(&lab, treelet_tets, false), true);
    lab_mesh_release(&lab);
    return s;
}

/* A volume that is turned, sheared a bit, and far away. */
static const char TURNED[] = "space directions: (0.8,0.6,0.05) (-0.9,1.2,0) (0.1,0.2,-0.7)\n"
                             "space origin: (1003.25,-77.5,12.125)\n";
float slice_subject_turned_value(long i, long j, long k) {
    return (float)(sin(0.3 * (double)i) + cos(0.21 * (double)(j * k)) + 0.01 * (double)k);
}

slice_subject *slice_subject_turned(void) {
    const char *path = scratch_path("turned.nrrd"), *leaf = scratch_path("turned.leaf");
    FILE *out = fopen(path, "wb");
    fprintf(out,
            "NRRD0004\ntype: float\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n"
            "space dimension: 3\n%s\n",
            SLICE_TURNED_X, SLICE_TURNED_Y, SLICE_TURNED_Z, TURNED);
    for (long k = 0; k < SLICE_TURNED_Z; k++)
        for (long j = 0; j < SLICE_TURNED_Y; j++)
            for (long i = 0; i < SLICE_TURNED_X; i++) {
                const float f = slice_subject_turned_value(i, j, k);
                fwrite(&f, sizeof f, 1, out);
            }
    fclose(out);
    mem m;
    volume *v;
    const volume_hints hints = {0};
    convert_options o = {.file = leaf_parameters_default(), .memory = 1 << 30, .threads = 2};
    convert_plan plan;
    convert_result result;
    o.file.cells_log2 = 4;
    o.force = true;
    mem_init(&m, (size_t)o.memory);
    assert_int_equal(volume_open(&m, path, &hints, &v), ST_OK);
    assert_int_equal(convert_plan_make(&m, volume_grid(v), &o, &plan), ST_OK);
    assert_int_equal(convert_run(&m, v, leaf, &o, &plan, NULL, &result), ST_OK);
    volume_close(v);
    return load(leaf, false);
}

leafcast_slice_pixels slice_subject_sized(uint32_t width, uint32_t height) {
    return (leafcast_slice_pixels){
        .size = sizeof(leafcast_slice_pixels), .width = width, .height = height};
}

leafcast_slice_pixels slice_subject_slice(const leafcast *v, field_random *r) {
    const leafcast_info info = leafcast_describe(v);
    leafcast_slice_pixels s = slice_subject_sized(SLICE_WIDTH, SLICE_HEIGHT);
    for (int a = 0; a < 3; a++) {
        const double edge = info.bounds[1][a] - info.bounds[0][a];
        s.u[a] = 1.4 * edge * field_random_in(r, -1.0, 1.0);
        s.v[a] = 1.4 * edge * field_random_in(r, -1.0, 1.0);
        s.origin[a] =
            info.bounds[0][a] + edge * field_random_in(r, 0.3, 0.7) - 0.5 * (s.u[a] + s.v[a]);
    }
    return s;
}

void slice_subject_pixel(const leafcast_slice_pixels *s, int i, double point[3]) {
    const double right = (i % s->width + 0.5) / s->width, down = (i / s->width + 0.5) / s->height;
    for (int a = 0; a < 3; a++)
        point[a] = s->origin[a] + right * s->u[a] + down * s->v[a];
}

leafcast_stats slice_subject_sample(leafcast *v, const leafcast_slice_pixels *s, double *value) {
    leafcast_stats stats = {.size = sizeof stats};
    if (leafcast_sample_slice(v, s, value, &stats, NULL, NULL) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    return stats;
}

slice_subject *slice_subject_one(int which) {
    return which == 0   ? slice_subject_of_field("noise-u8", NULL, 50, true)
           : which == 1 ? slice_subject_turned()
                        : slice_subject_of_mesh("noise", 6, 60);
}
