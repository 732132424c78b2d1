/* test_first_preview.c - the first picture of a volume of which nothing has been read: it has no
 * holes, it is soon there, and those that follow get finer until they are exact.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <string.h>

#include "render/leafcast.h"
#include "stream/loader.h"
#include "tests/support/fixture.h"
#include "tests/support/watched.h"

/* The finest level has more than LOADER_PREVIEW_BYTES. */
enum { CELLS = WATCHED ? 130 : 160, SIDE = 64, PIXELS = SIDE * SIDE, LEVELS_MAX = 8 };

typedef struct shot {
    float rgba[4][PIXELS];
    double z[PIXELS];
    uint8_t provisional[PIXELS];
    leafcast_stats stats;
} shot;

static leafcast *open_at(const char *path, double iso, uint32_t slots) {
    const leafcast_surface s = leafcast_surface_default(iso);
    leafcast *v =
        fixture_open(path, &(leafcast_options){.size = sizeof(leafcast_options),
                                               .threads = 2,
                                               .experiments = EXPERIMENTS(.treelet_limit = slots)});
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    return v;
}

static void draw(leafcast *v, const leafcast_scene *scene, shot *p) {
    const leafcast_camera view = leafcast_standard_view(v, 1.6, SIDE, SIDE);
    const leafcast_image image = {.size = sizeof image,
                                  .r = p->rgba[0],
                                  .g = p->rgba[1],
                                  .b = p->rgba[2],
                                  .a = p->rgba[3],
                                  .z = p->z,
                                  .provisional = p->provisional};
    memset(p, 0, sizeof *p);
    p->stats.size = sizeof p->stats;
    assert_int_equal(leafcast_trace(v, scene, &view, &image, &p->stats, NULL, NULL), LEAFCAST_OK);
}

static bool same(const shot *a, const shot *b) {
    return !memcmp(a->rgba, b->rgba, sizeof a->rgba) && !memcmp(a->z, b->z, sizeof a->z);
}

typedef struct subject {
    const char *path;
    double iso;
    shot levels[LEVELS_MAX]; /* the picture of each level, by a volume that waits for all of it */
    uint32_t count;
} subject;

static void make(subject *s, bool compressed) {
    field f;
    assert_true(field_make(&f, "waves", CELLS, FIELD_SEED));
    s->path = fixture_leaf(&f, 4, 1, compressed);
    s->iso = f.iso;
    field_release(&f);
    leafcast *v = open_at(s->path, s->iso, 0);
    leafcast_scene scene = leafcast_scene_default();
    s->count = leafcast_describe(v).levels;
    assert_in_range(s->count, 3, LEVELS_MAX);
    scene.lod = LEAFCAST_LOD_LEVEL;
    for (uint32_t i = 0; i < s->count; i++) {
        scene.lod_level = i;
        draw(v, &scene, &s->levels[i]);
    }
    leafcast_close(v);
}

/* The level of which this is the picture. */
static uint32_t level_of(const subject *s, const shot *p) {
    uint32_t level = 0;
    while (level < s->count && !same(p, &s->levels[level]))
        level++;
    return level;
}

/* All pixels are those of one level, and marked unless it is the finest. Returns the level. */
static uint32_t check(const subject *s, const shot *p) {
    const uint32_t level = level_of(s, p);
    assert_true(level < s->count);
    assert_int_equal(p->stats.provisional_pixels, level > 0 ? PIXELS : 0);
    for (int i = 0; i < PIXELS; i++)
        assert_int_equal(p->provisional[i], level > 0);
    return level;
}

static void preview(const subject *s, uint32_t slots) {
    static shot p;
    leafcast *v = open_at(s->path, s->iso, slots);
    leafcast_scene scene = leafcast_scene_default();
    scene.preview = true;
    draw(v, &scene, &p);
    uint32_t level = check(s, &p);
    const bool coarser = p.stats.bytes_active > LOADER_PREVIEW_BYTES;
    assert_int_equal(level > 0, coarser);
    assert_true(level < 3); /* not the coarsest: there is something to see */
    if (slots == 0)         /* each treelet once, and no others, where there is room */
        assert_int_equal(p.stats.bytes_read, p.stats.bytes_visible);
    for (int n = 0; level > 0 && slots == 0 && n < 10000; n++) {
        draw(v, &scene, &p);
        const uint32_t next = check(s, &p);
        assert_true(next <= level);
        level = next;
    }
    assert_true(slots > 0 || level == 0);
    leafcast_close(v);
}

static void test_raw(void **state) {
    static subject s;
    (void)state;
    make(&s, false);
    assert_true(s.levels[0].stats.bytes_active > LOADER_PREVIEW_BYTES);
    preview(&s, 0);
    preview(&s, 7);
}

static void test_compressed(void **state) {
    static subject s;
    (void)state;
    make(&s, true);
    preview(&s, 0);
    preview(&s, 7);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_raw),
        cmocka_unit_test(test_compressed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
