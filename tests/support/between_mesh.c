#include "tests/support/between_mesh.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/leaf/leaf_grow.h"
#include "tests/support/scratch.h"
#include "tests/support/tet_judge.h"

/* Step 3 is step 2. */
void between_mesh_points(bool moves, int step, float (*to)[3]) {
    const int moved = !moves ? 0 : step == 3 ? 2 : step;
    for (int i = 0; i < BETWEEN_MESH_POINTS; i++) {
        const int n = BETWEEN_MESH_NODES, node[3] = {i % n, i / n % n, i / n / n};
        for (int a = 0; a < 3; a++) {
            const double at = node[a], other = node[(a + 1) % 3];
            to[i][a] = (float)(BETWEEN_MESH_STRIDE * at + 0.3 * sin(7 * i + a) +
                               0.2 * moved * sin(0.5 * other + moved + a) +
                               (moved ? 0.3 * sin(11 * i + 5 * moved + a) : 0));
        }
    }
}

mesh_movie between_mesh_movie(const between_kind *of, const float *const *steps, uint32_t first,
                              uint32_t count) {
    mesh_case c = mesh_cases_kuhn(BETWEEN_MESH_CELLS, BETWEEN_MESH_CELLS, BETWEEN_MESH_CELLS);
    c.options.treelet_tets = 300;
    c.options.file.codec = of->codec;
    c.options.file.zstd_level = 1;
    c.options.file.histograms = true;
    c.options.grows = of->grown;
    mesh_movie v = mesh_movies_make(c, 1, count, count, 0);
    for (uint32_t s = 0; s < count; s++) {
        memcpy(v.values[s][0], steps[first + s], BETWEEN_MESH_POINTS * sizeof(float));
        memcpy(v.points[s], steps[first + s] + BETWEEN_MESH_POINTS,
               3 * BETWEEN_MESH_POINTS * sizeof(float));
        v.times[s] = between_times[first + s];
    }
    return v;
}

void between_mesh_convert(const between_kind *of, const float *const *steps, uint32_t first,
                          uint32_t count, const char *path) {
    mesh_movie v = between_mesh_movie(of, steps, first, count);
    mesh_result r;
    mem m;
    mem_init(&m, 0);
    mesh_movies_write(&v);
    if (first > 0)
        assert_int_equal(leaf_grow_open(&m, path, &v.c.options.grow), ST_OK);
    if (mesh_movies_convert(&m, &v, path, &r, false) != ST_OK)
        fail_msg("%s", status_text());
    leaf_grow_close(v.c.options.grow);
    assert_int_equal(mem_used(&m), 0);
    mesh_movies_release(&v);
}

ref_tally between_mesh_judge(const float *of, const ref_camera *look, double iso,
                             const double *depth, int every) {
    mesh_case c = mesh_cases_kuhn(BETWEEN_MESH_CELLS, BETWEEN_MESH_CELLS, BETWEEN_MESH_CELLS);
    const tet_ref_mesh mesh = {.point_count = c.point_count,
                               .tet_count = c.tet_count,
                               .points =
                                   (const float(*)[3])(const void *)(of + BETWEEN_MESH_POINTS),
                               .values = of,
                               .tets = (const uint32_t(*)[4])c.tets};
    tet_ref *truth = tet_ref_create(&mesh);
    ref_tally tally = {0};
    for (int i = 0; i < look->width * look->height; i += every) {
        const ref_ray ray = ref_primary_ray(look, i % look->width, i / look->width);
        (void)tet_judge_pixel(&tally, truth, &ray, &iso, 1, NULL, depth[i]);
    }
    tet_ref_destroy(truth);
    mesh_cases_free(&c);
    return tally;
}
