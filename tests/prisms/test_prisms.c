/* test_prisms.c - a kind that shares nothing with grids, tets and balls but the walks: its cells
 * have two kinds of faces, adjoin, and have one value each.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/prisms/prisms.h"
#include "tests/prisms/prisms_truth.h"
#include "tests/support/cells_file.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/third_kind.h"

THIRD_KIND(PRISMS_KIND, prisms_geometry, prisms_kind)

/* A slab of squares, each of two triangles whose corners are moved at random, in layers. A treelet
 * is a block of squares of one layer. */
enum { SIDE = 8, LAYERS = 3, BLOCK = 4, STEPS = 2 };
enum { TREELETS = SIDE / BLOCK * (SIDE / BLOCK) * LAYERS, MOST = 2 * BLOCK * BLOCK };

typedef struct slab {
    prism prisms[STEPS][TREELETS * MOST];
    uint32_t counts[TREELETS], count; /* a step */
    float corner[SIDE + 1][SIDE + 1][2], height[LAYERS + 1];
} slab;

static void make_places(slab *s, field_random *r) {
    for (int y = 0; y <= SIDE; y++)
        for (int x = 0; x <= SIDE; x++) {
            s->corner[y][x][0] = (float)(x + 0.6 * field_random_unit(r));
            s->corner[y][x][1] = (float)(y + 0.6 * field_random_unit(r));
        }
    for (int z = 0; z <= LAYERS; z++)
        s->height[z] = (float)(1.5 * z + field_random_unit(r));
}

/* One half of a square. Every sixth is left out. */
static void add_half(slab *s, uint32_t t, int x, int y, int z, int half, field_random *r) {
    const int to[2][3][2] = {{{0, 0}, {1, 0}, {0, 1}}, {{1, 1}, {0, 1}, {1, 0}}};
    prism one = {.z = {s->height[z], s->height[z + 1]}};
    for (int k = 0; k < 3; k++)
        memcpy(one.base[k], s->corner[y + to[half][k][1]][x + to[half][k][0]], sizeof one.base[k]);
    const bool hole = field_random_unit(r) < 1.0 / 6.0;
    for (int step = 0; step < STEPS; step++) {
        one.value = (float)(0.1 + field_random_unit(r));
        if (!hole)
            s->prisms[step][s->count] = one;
    }
    s->counts[t] += !hole;
    s->count += !hole;
}

static void make_slab(slab *s) {
    field_random r = {FIELD_SEED};
    *s = (slab){.count = 0};
    make_places(s, &r);
    for (uint32_t t = 0; t < TREELETS; t++) {
        const int bx = (int)t % 2 * BLOCK, by = (int)t / 2 % 2 * BLOCK, z = (int)t / 4;
        for (int i = 0; i < MOST; i++)
            add_half(s, t, bx + i / 2 % BLOCK, by + i / 2 / BLOCK, z, i % 2, &r);
    }
    for (int step = 1; step < STEPS; step++) /* as a file has them */
        memmove(&s->prisms[0][0] + (size_t)step * s->count, s->prisms[step],
                s->count * sizeof(prism));
}

static const prism *step_of(const slab *s, uint32_t step) {
    return &s->prisms[0][0] + (size_t)step * s->count;
}

static leaf_image image_of(const slab *s) {
    return cells_file(&(cells_input){.kind = PRISMS_KIND,
                                     .name = "prisms",
                                     .records = s->prisms,
                                     .counts = s->counts,
                                     .treelets = TREELETS,
                                     .steps = STEPS});
}

static int chords_of(const void *ctx, uint32_t step, const double origin[3],
                     const double direction[3], cell_chord out[CELL_CHORDS_MAX], bool *grazing) {
    const slab *s = ctx;
    return prisms_truth_chords(&(prisms_truth){step_of(s, step), s->count}, origin, direction, out,
                               grazing);
}

static bool value_at(const void *ctx, uint32_t step, const double point[3], long double *value,
                     bool *grazing) {
    const slab *s = ctx;
    return prisms_truth_at(&(prisms_truth){step_of(s, step), s->count}, point, value, grazing);
}

static void test_values(void **state) {
    (void)state;
    static slab s;
    make_slab(&s);
    const leaf_image image = image_of(&s);
    cell_judge(&image, &(cell_truth){&s, STEPS, 1.1, chords_of, value_at});
    free(image.bytes);
}

static const double iso = 0.6, to_light[3] = {0.64, -0.6, 0.48};

/* t where a ray first enters a prism of the isovalue or more, ahead or around its start. INFINITY:
 * nowhere. */
static long double first_of(const slab *s, uint32_t step, const double origin[3],
                            const double direction[3], bool *grazing) {
    cell_chord chords[CELL_CHORDS_MAX];
    const int count = chords_of(s, step, origin, direction, chords, grazing);
    long double first = INFINITY;
    for (int i = 0; i < count; i++) {
        *grazing |= chords[i].t0 < -1e-9L && chords[i].t1 > 1e-9L && (double)chords[i].most >= iso;
        if ((double)chords[i].most >= iso && chords[i].t1 > 1e-9L)
            first = fminl(first, chords[i].t0);
    }
    return first;
}

/* Whether the light reaches a place on the outside of all prisms of the isovalue or more. */
static bool is_lit(const slab *s, uint32_t step, const double at[3], const double normal[3],
                   bool *grazing) {
    double slope = 0.0;
    for (int a = 0; a < 3; a++)
        slope += to_light[a] * normal[a];
    *grazing |= fabs(slope) < 1e-3;
    return slope > 0.0 && isinf(first_of(s, step, at, to_light, grazing));
}

static void test_first_surfaces(void **state) {
    (void)state;
    static slab s;
    static picture p;
    make_slab(&s);
    const leaf_image image = image_of(&s);
    leafcast *v = fixture_open(scratch_write("prisms.leaf", image.bytes, image.size), NULL);
    const leafcast_surface surface = leafcast_surface_default(iso);
    leafcast_scene scene = leafcast_scene_default();
    scene.ambient = 0.0f;
    scene.shadows = true;
    scene.light_count = 1;
    scene.lights[0] = (leafcast_light){.rgb = {1, 1, 1}};
    memcpy(scene.lights[0].vector, to_light, sizeof to_light);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    const leafcast_camera c = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    int seen = 0, dark = 0, wrong = 0, grazes = 0;
    assert_int_equal(leafcast_select_between(v, 0, 0, 0.5), LEAFCAST_UNSUPPORTED);
    assert_non_null(strstr(leafcast_error_text(), "prisms.leaf: times between steps are of grids"));
    for (uint32_t step = 0; step < STEPS; step++) {
        assert_int_equal(leafcast_select_set(v, 0, step), LEAFCAST_OK);
        pictures_draw(v, &scene, &c, &p, NULL);
        for (uint32_t i = 0; i < PICTURE_PIXELS; i++) {
            double origin[3], direction[3], at[3], normal[3], facing = 0.0;
            bool grazing = false;
            leafcast_pixel_ray(&c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, origin,
                               direction);
            const long double first = first_of(&s, step, origin, direction, &grazing);
            const bool any = !isinf(first);
            for (int a = 0; a < 3; a++) {
                normal[a] = (double)p.normal[a][i];
                facing += direction[a] * normal[a];
                at[a] = any ? (double)(origin[a] + first * direction[a]) : 0.0;
            }
            const bool lit = any && is_lit(&s, step, at, normal, &grazing);
            grazes += grazing;
            if (grazing)
                continue;
            seen += any;
            dark += any && !lit;
            wrong += any ? p.id[i] != 0 || !(facing < 0.0) || (p.rgba[0][i] > 0.0f) != lit ||
                               !(fabs((double)(p.z[i] / first - 1.0L)) < 1e-12)
                         : p.id[i] >= 0;
        }
    }
    print_message("# %d pixels, %d dark, %d wrong, %d grazing\n", seen, dark, wrong, grazes);
    assert_true(seen > PICTURE_PIXELS / 4 && dark > seen / 30 && seen > 2 * dark &&
                grazes < PICTURE_PIXELS / 20);
    assert_int_equal(wrong, 0);
    leafcast_close(v);
    free(image.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),
        cmocka_unit_test(test_first_surfaces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
