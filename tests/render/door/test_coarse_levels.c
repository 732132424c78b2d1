/* test_coarse_levels.c - which levels of detail previews have, and which of these are of the
 * volume's kind of cells; the grid inside a thinned one where memory has no room for that.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "tests/support/coarse_subjects.h"
#include "tests/support/curvilinear_steps.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

static void convert(const curvilinear_zone *zone, const char *name) {
    curvilinear_steps s;
    curvilinear_result r;
    const curvilinear_options o = {.file = leaf_parameters_default(),
                                   .memory = UINT64_C(1) << 30,
                                   .threads = 2,
                                   .force = true,
                                   .coarse = true};
    curvilinear_steps_init(&s, zone, 1, 1, 1);
    if (curvilinear_convert(&m, &s.series, "g", scratch_path(name), &o, NULL, &r) != ST_OK)
        fail_msg("%s", status_text());
}

/* ---- What is told ---- */

static void check_info(const char *path, uint32_t preview_levels, uint32_t cell_levels) {
    leafcast *v = fixture_open(path, NULL);
    const leafcast_info info = leafcast_describe(v);
    assert_int_equal(info.preview_levels, preview_levels);
    assert_int_equal(info.cell_levels, cell_levels);
    leafcast_close(v);
}

/* A ring whose nodes that are left lie in a plane: no regular grid is made of it. */
static void make_ring(const char *name) {
    static const float around[5][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
    float p[5 * 3 * 3][3], values[5 * 3 * 3];
    const curvilinear_zone zone = {.nodes = {5, 3, 3}, .p = (const float(*)[3])p, .values = values};
    for (int n = 0; n < 5 * 3 * 3; n++) {
        const float radius = 1.0F + (float)(n / 5 % 3);
        p[n][0] = radius * around[n % 5][0];
        p[n][1] = radius * around[n % 5][1];
        p[n][2] = (float)(n / 15);
        values[n] = radius;
    }
    convert(&zone, name);
}

static void test_told(void **state) {
    (void)state;
    for (subject of = TETS; of < SUBJECTS; of++) {
        coarse_subjects_make(&m, of, "plain.leaf", NULL, false);
        coarse_subjects_make(&m, of, "coarse.leaf", NULL, true);
        check_info(scratch_path("plain.leaf"), 1, 1);
        check_info(scratch_path("coarse.leaf"), of == THINNED ? 4 : 3, of == THINNED ? 2 : 1);
    }
    make_ring("ring.leaf");
    check_info(scratch_path("ring.leaf"), 2, 2);
    field f;
    assert_true(field_make(&f, "waves", 40, FIELD_SEED));
    check_info(fixture_leaf(&f, 4, 1, false), 3, 3); /* coarse grids are of its own kind */
    field_release(&f);
    assert_int_equal(leafcast_describe(NULL).cell_levels, 0);
}

/* ---- No room ---- */

/* A slab that sways. Every second of its nodes along each axis makes four treelets. */
enum { SIDE = 129, HIGH = 65, NODES = SIDE * SIDE * HIGH };
/* An eighth of this has no room for those four, but for some of the grid inside; from 5 MiB on the
 * exact picture has room, from 20 MiB on all four have. */
enum { SCANT = 12 << 20 };
enum { MARGIN = 2, PICTURES = 20, LEVELS_INSIDE = 3 };
#define ISO 0.5

static void make_slab(const char *name) {
    float(*p)[3] = malloc(NODES * sizeof *p), *values = malloc(NODES * sizeof *values);
    const curvilinear_zone zone = {
        .nodes = {SIDE, SIDE, HIGH}, .p = (const float(*)[3])p, .values = values};
    assert_true(p && values);
    for (uint32_t n = 0; n < NODES; n++) {
        const uint32_t i = n % SIDE, j = n / SIDE % SIDE, k = n / (SIDE * SIDE);
        p[n][0] = (float)i;
        p[n][1] = (float)j;
        p[n][2] = (float)(k + 10.0 * sin(0.03 * i));
        values[n] = (float)k / (HIGH - 1);
    }
    convert(&zone, name);
    free(p);
    free(values);
}

static leafcast_camera view;

static leafcast *open_within(const char *name, uint64_t memory) {
    const leafcast_surface s = leafcast_surface_default(ISO);
    leafcast *v = fixture_open(
        scratch_path(name),
        &(leafcast_options){.size = sizeof(leafcast_options), .threads = 2, .memory = memory});
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    return v;
}

/* Returns the pixels that are marked. level 0: the exact picture. */
static uint64_t draw(leafcast *v, uint32_t level, bool preview, picture *p) {
    leafcast_scene scene = leafcast_scene_default();
    leafcast_stats stats = {.size = sizeof stats};
    scene.preview = preview;
    scene.lod = level ? LEAFCAST_LOD_LEVEL : LEAFCAST_LOD_EXACT;
    scene.lod_level = level;
    pictures_draw(v, &scene, &view, p, &stats);
    return stats.provisional_pixels;
}

/* Whether there is a surface at all pixels at most MARGIN from pixel i. */
static bool is_well_inside(const picture *p, int i) {
    const int x = i % PICTURE_WIDTH, y = i / PICTURE_WIDTH;
    bool inside =
        x >= MARGIN && y >= MARGIN && x + MARGIN < PICTURE_WIDTH && y + MARGIN < PICTURE_HEIGHT;
    for (int dy = -MARGIN; inside && dy <= MARGIN; dy++)
        for (int dx = -MARGIN; dx <= MARGIN; dx++)
            inside &= isfinite(p->z[i + dy * PICTURE_WIDTH + dx]) != 0;
    return inside;
}

typedef struct pictures_of_all {
    picture exact, thinned, inside[LEVELS_INSIDE];
} pictures_of_all;

static void draw_all(pictures_of_all *all) {
    leafcast *v = open_within("slab.leaf", 0), *alone = open_within("inside.leaf", 0);
    view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    assert_int_equal(leafcast_describe(alone).levels, LEVELS_INSIDE);
    assert_int_equal(draw(v, 0, false, &all->exact), 0);
    assert_int_equal(draw(v, 1, true, &all->thinned), PICTURE_PIXELS);
    for (uint32_t n = 0; n < LEVELS_INSIDE; n++)
        (void)draw(alone, n, false, &all->inside[n]);
    leafcast_close(alone);
    leafcast_close(v);
}

static bool is_of_inside(const pictures_of_all *all, const picture *got, int i) {
    for (int n = 0; n < LEVELS_INSIDE; n++)
        if (pictures_same_pixel(got, &all->inside[n], i))
            return true;
    return false;
}

/* Away from the rim there are no holes, and what is there is a level of the grid inside. A ray may
 * go through two of them. */
static void check_inside(const pictures_of_all *all, const picture *got) {
    int inside = 0, of_inside = 0, of_thinned = 0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        if (!is_well_inside(&all->exact, i))
            continue;
        if (!(fabs(got->z[i] - all->exact.z[i]) < 1.0))
            fail_msg("pixel %d: at %g, truly %g", i, got->z[i], all->exact.z[i]);
        inside++;
        of_inside += is_of_inside(all, got, i);
        of_thinned += pictures_same_pixel(got, &all->thinned, i);
    }
    assert_true(inside > PICTURE_PIXELS / 8);
    assert_true(of_inside > inside * 9 / 10);
    assert_true(of_thinned < inside / 10);
}

/* Where the thinned grid has no room, level 1 is the grid inside it, from the first picture on. */
static void test_no_room(void **state) {
    (void)state;
    skip_under_thread();
    static pictures_of_all all;
    static picture got;
    make_slab("slab.leaf");
    coarse_subjects_take_part(&m, "slab.leaf", 0, "thinned.leaf");
    coarse_subjects_take_part(&m, "thinned.leaf", 0, "inside.leaf");
    draw_all(&all);
    leafcast *v = open_within("slab.leaf", SCANT);
    assert_int_equal(leafcast_describe(v).cell_levels, 2);
    for (int n = 0; n < PICTURES; n++) {
        assert_int_equal(draw(v, 1, true, &got), PICTURE_PIXELS);
        check_inside(&all, &got);
    }
    assert_int_equal(draw(v, 0, false, &got), 0);
    for (int i = 0; i < PICTURE_PIXELS; i++)
        assert_true(pictures_same_pixel(&got, &all.exact, i));
    leafcast_close(v);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_told), cmocka_unit_test(test_no_room)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
