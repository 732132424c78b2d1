/* test_surface_leaf.c - files of surfaces as a second reader written from TRIANGLES.md alone sees
 * them; files that lie: told by verify with the place, refused by the second reader, and drawn only
 * where no ray can go astray.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_verify.h"
#include "formats/leaf/triangle_geometry.h"
#include "render/leafcast.h"
#include "tests/support/leaf_image.h"
#include "tests/support/naive_surface.h"
#include "tests/support/scratch.h"
#include "tests/support/surface_movie.h"
#include "tests/support/triangle_lab.h"

enum { SIDE = 16, TREELET = 100, STEPS = 3, FIELDS = 2 };

/* ---- sound files ---- */

static int by_corners(const void *a, const void *b) {
    return memcmp(a, b, sizeof(float[3][4]));
}

/* The triangles of a lab that are in its file, each corner with its value; returns how many. */
static uint32_t list_lab(const triangle_lab *s, float (*to)[3][4]) {
    for (uint32_t i = 0; i < s->triangles; i++)
        for (int k = 0; k < 3; k++) {
            const uint32_t v = s->corner[i][k];
            memcpy(to[i][k], s->xyz[v], sizeof s->xyz[v]);
            to[i][k][3] = s->value[v];
        }
    return s->triangles;
}

static uint32_t list_file(const naive_surface *n, float (*to)[3][4]) {
    uint32_t count = 0;
    for (long t = 0; t < n->treelets; t++)
        for (long i = 0; i < n->patch[t].triangles; i++, count++)
            for (int k = 0; k < 3; k++) {
                const naive_patch *p = &n->patch[t];
                const long v = p->row[i][k];
                for (int a = 0; a < 3; a++)
                    to[count][k][a] = p->xyz[a * p->vertices + v];
                to[count][k][3] = p->values[v];
            }
    return count;
}

static void check_lab(const triangle_lab *s, const char *path) {
    static float want[TRIANGLE_LAB_MAX][3][4], got[TRIANGLE_LAB_MAX][3][4];
    naive_surface n;
    if (!naive_surface_load(&n, path))
        fail_msg("%s: %s", s->name, n.why);
    const uint32_t count = list_lab(s, want);
    assert_int_equal(n.triangles, count);
    assert_int_equal(list_file(&n, got), count);
    qsort(want, count, sizeof *want, by_corners);
    qsort(got, count, sizeof *got, by_corners);
    assert_memory_equal(want, got, count * sizeof *want);
    naive_surface_release(&n);
}

static void test_labs(void **state) {
    static const uint32_t sizes[] = {1, 7, 64, TRIANGLES_MAX};
    static triangle_lab lab;
    (void)state;
    for (int n = 0; n < triangle_lab_count(); n++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
            for (int zstd = 0; zstd < 2; zstd++) {
                mesh_result r;
                triangle_lab_make(&lab, n, FIELD_SEED);
                triangle_lab_convert(&lab, scratch_path("lab.leaf"), sizes[i], "f", zstd, &r);
                check_lab(&lab, scratch_path("lab.leaf"));
            }
}

static surface_movie movie_of(leaf_codec codec) {
    surface_movie v = surface_movie_make(SIDE, FIELDS, STEPS, true, "sheet");
    v.options.treelet_tets = TREELET;
    v.options.file.codec = codec;
    v.options.normals = NORMALS_SMOOTH;
    v.options.file.zstd_level = 1;
    v.options.file.run_align_log2 = 9;
    return v;
}

static status verify(const char *path) {
    mem m;
    leaf_file *f = NULL;
    mem_init(&m, 0);
    status st = leaf_file_open(&m, path, &f);
    if (st == ST_OK)
        st = leaf_verify(&m, f, 1, NULL);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static void test_movies(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        mem m;
        mesh_result r;
        surface_movie v = movie_of((leaf_codec)codec);
        assert_int_equal(surface_movie_convert(&m, &v, scratch_path("sheet.leaf"), NULL, false, &r),
                         ST_OK);
        assert_int_equal(r.header.flat, 1);
        assert_int_equal(r.header.repeated, 1);
        assert_int_equal(r.header.bad, 1);
        surface_movie_check(&v, scratch_path("sheet.leaf"));
        assert_int_equal(verify(scratch_path("sheet.leaf")), ST_OK);
        surface_movie_release(&v);
    }
}

/* ---- files that lie ---- */

/* What is changed in the payloads of the first treelet. */
typedef struct lied {
    leaf_image image;
    triangle_shape shape;
    char *topology, *values, *moved; /* values of the first set; places of the last step */
    uint16_t *corner;
} lied;

typedef void lie(const lied *x);

/* A half alone says that there is none. */
static void spoil_normal(const lied *x) {
    uint32_t *normals = (uint32_t *)(void *)x->topology + 3 * (size_t)x->shape.vertices;
    normals[5] = 0x80000000;
}

static void lose_corner(const lied *x) {
    x->corner[4] = (uint16_t)x->shape.vertices;
}

/* The one before takes the last vertex's place. */
static void leave_vertex(const lied *x) {
    for (uint32_t i = 0; i < TRIANGLE_CORNERS * x->shape.triangles; i++)
        x->corner[i] = (uint16_t)(x->corner[i] - (x->corner[i] + 1U == x->shape.vertices));
}

static void swap_vertices(const lied *x) {
    x->corner[0] = 1;
    x->corner[1] = 0;
}

static void swap_last(const lied *x) {
    const uint32_t last = x->shape.vertices - 1;
    for (uint32_t i = 0; i < TRIANGLE_CORNERS * x->shape.triangles; i++)
        if (x->corner[i] + 1U >= last)
            x->corner[i] = (uint16_t)(2 * last - 1 - x->corner[i]);
}

static void add_corner(const lied *x) {
    x->topology[x->shape.topology_bytes - 1] = 1;
}

static void add_place(const lied *x) {
    x->topology[x->shape.place_bytes - 1] = 1;
}

static void add_value(const lied *x) {
    x->values[x->shape.value_bytes - 1] = 1;
}

static void add_moved(const lied *x) {
    x->moved[x->shape.place_bytes - 1] = 1;
}

static void shift_vertex(const lied *x) {
    ((float *)(void *)x->topology)[0] -= 100.0F;
}

static void lose_vertex(const lied *x) {
    ((float *)(void *)x->topology)[1] = NAN;
}

static void shift_moved(const lied *x) {
    ((float *)(void *)x->moved)[0] -= 100.0F;
}

/* All vertices of the treelet come together: its box is wider than it says. */
static void shrink(const lied *x) {
    float *at = (float *)(void *)x->topology;
    for (uint32_t n = 1; n < x->shape.vertices; n++)
        at[n] = at[0];
}

static void change_value(const lied *x) {
    ((float *)(void *)x->values)[3] = 1e9F;
}

static void even_values(const lied *x) {
    float *at = (float *)(void *)x->values;
    for (uint32_t n = 0; n < x->shape.vertices; n++)
        at[n] = isfinite(at[n]) ? at[0] : at[n];
}

static void flip_flag(const lied *x) {
    ((uint8_t *)leaf_image_section(&x->image, LEAF_SECTION_FLAGS))[0] ^= LEAF_FLAG_NON_FINITE;
}

static uint32_t (*counts_of(const lied *x))[4] {
    return leaf_image_section(&x->image, LEAF_SECTION_COUNTS);
}

static void count_triangles(const lied *x) {
    counts_of(x)[0][0] = TREELET + 1;
}

static void count_none(const lied *x) {
    counts_of(x)[0][0] = 0;
}

static void count_vertices(const lied *x) {
    counts_of(x)[0][1] = 2;
}

static void count_many(const lied *x) {
    counts_of(x)[0][1] = TRIANGLE_CORNERS * counts_of(x)[0][0] + 1;
}

static void count_more(const lied *x) {
    counts_of(x)[0][2] = 1;
}

static void count_last(const lied *x) {
    counts_of(x)[0][3] = 1;
}

static void claim_triangles(const lied *x) {
    x->image.header->tets++;
}

static void claim_flat(const lied *x) {
    x->image.header->flat = x->image.header->tets + 1;
}

static void claim_inverted(const lied *x) {
    x->image.header->inverted = 1;
}

static void claim_vertices(const lied *x) {
    x->image.header->vertices =
        TRIANGLE_CORNERS * x->image.header->treelets * x->image.header->treelet_tets + 1;
}

static void claim_few(const lied *x) {
    x->image.header->vertices = 2;
}

static void claim_leaves(const lied *x) {
    x->image.header->leaf_tets = 4;
}

static void claim_gradients(const lied *x) {
    x->image.header->gradients = 1;
}

static void claim_large(const lied *x) {
    x->image.header->treelet_tets = TRIANGLES_MAX + 1;
}

static void claim_codec(const lied *x) {
    x->image.header->codec = LEAF_CODEC_ZSTD + 1;
}

static void claim_zones(const lied *x) {
    x->image.header->zones = 1;
}

static void claim_bounds(const lied *x) {
    x->image.header->bounds[3] += 1.0F;
}

static void claim_treelets(const lied *x) {
    x->image.header->treelets = 1 << 20;
}

/* What verify says; where: of a payload, with its byte; and whether a file is drawn all the same:
 * what rays would go astray by is found when a treelet is loaded. The picture is of the first step.
 */
static const struct {
    lie *tell;
    const char *told;
    bool drawn;
} lies[] = {
    {lose_corner, "a triangle is at no vertex", false},
    {leave_vertex, "a vertex is at no triangle", true},
    {swap_vertices, "vertices are not in the order of their first use", true},
    {swap_last, "vertices are not in the order of their first use", true},
    {add_corner, "expected 0 as padding", true},
    {add_place, "expected 0 as padding", true},
    {add_value, "expected 0 as padding", true},
    {add_moved, "expected 0 as padding", true},
    {shift_vertex, "its box is not that of its nodes", false},
    {lose_vertex, "a node is nowhere", false},
    {shift_moved, "its box is not that of its nodes", true},
    {shrink, "its box is not that of its nodes", true},
    {change_value, "its range is not that of its values", false},
    {even_values, "its range is not that of its values", true},
    {flip_flag, "about what is not finite", false},
    {count_triangles, "cannot have so many triangles", false},
    {count_none, "cannot have so many triangles", false},
    {count_vertices, "cannot have so many vertices", false},
    {count_many, "cannot have so many vertices", false},
    {count_more, "cannot have so many normals", false},
    {count_last, "cannot have more than triangles, vertices and normals", false},
    {spoil_normal, "a normal is none", true},
    {claim_triangles, "expected the treelets'", false},
    {claim_flat, "of them folded", false},
    {claim_inverted, "of them folded", false},
    {claim_vertices, "nodes", false},
    {claim_few, "nodes", false},
    {claim_leaves, "leaf_tets", false},
    {claim_gradients, "gradients", false},
    {claim_large, "treelet_tets", false},
    {claim_codec, "codec", false},
    {claim_zones, "expected 0 in a reserved place", false},
    {claim_bounds, "bounds", false},
    {claim_treelets, "treelets", false},
};

static lied lie_about(const char *path, lie *tell) {
    size_t size;
    char *bytes = scratch_read(path, &size);
    lied x = {.image = leaf_image_of(bytes, size)};
    const uint64_t *offsets = leaf_image_section(&x.image, LEAF_SECTION_OFFSETS);
    const uint64_t n = x.image.header->treelets;
    x.shape = triangle_shape_of(counts_of(&x)[0]);
    x.topology = x.image.bytes + offsets[0];
    x.values = x.image.bytes + offsets[n];
    x.moved = x.image.bytes + offsets[n * (1 + FIELDS * STEPS + STEPS - 2)];
    x.corner = (uint16_t *)(void *)(x.topology + x.shape.place_bytes);
    tell(&x);
    if (tell != claim_treelets)
        leaf_image_seal_payloads(&x.image);
    leaf_image_seal(&x.image);
    return x;
}

static bool is_drawn(const char *path) {
    enum { WIDTH = 32, HEIGHT = 24 };
    static double rgba[4 * WIDTH * HEIGHT];
    leafcast *v = NULL;
    if (leafcast_open(path, NULL, &v) != LEAFCAST_OK)
        return false;
    const leafcast_surface surface = leafcast_surface_default(0.0);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof image, .rgba = rgba};
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    const leafcast_camera c = leafcast_standard_view(v, 1.1, WIDTH, HEIGHT);
    const leafcast_status st = leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL);
    leafcast_close(v);
    assert_true(st == LEAFCAST_OK || st == LEAFCAST_CORRUPT);
    return st == LEAFCAST_OK;
}

static void test_lies(void **state) {
    (void)state;
    mem m;
    mesh_result r;
    surface_movie v = movie_of(LEAF_CODEC_RAW);
    const char *sound = scratch_path("sound.leaf");
    assert_int_equal(surface_movie_convert(&m, &v, sound, NULL, false, &r), ST_OK);
    surface_movie_release(&v);
    assert_true(is_drawn(sound));
    for (size_t n = 0; n < sizeof lies / sizeof *lies; n++) {
        naive_surface naive;
        lied x = lie_about(sound, lies[n].tell);
        const char *path = scratch_write("lie.leaf", x.image.bytes, x.image.size);
        const status st = verify(path);
        if ((st != ST_CORRUPT && st != ST_UNSUPPORTED) || !strstr(status_text(), lies[n].told) ||
            !strstr(status_text(), path))
            fail_msg("%zu: status %d: %s", n, st, status_text());
        if (naive_surface_load(&naive, path))
            fail_msg("%zu: the second reader sees nothing of \"%s\"", n, lies[n].told);
        naive_surface_release(&naive);
        free(x.image.bytes);
        if (is_drawn(path) != lies[n].drawn)
            fail_msg("%zu: %s", n, lies[n].drawn ? "is not drawn" : "is drawn");
    }
}

/* One bit of each of many bytes changed: refused, or the byte is of no meaning. */
static void test_flipped(void **state) {
    enum { STRIDE = 97 };
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        mem m;
        mesh_result r;
        size_t size;
        surface_movie v = movie_of((leaf_codec)codec);
        const char *sound = scratch_path("sound.leaf");
        assert_int_equal(surface_movie_convert(&m, &v, sound, NULL, false, &r), ST_OK);
        surface_movie_release(&v);
        char *bytes = scratch_read(sound, &size);
        for (size_t at = 0; at < size; at += STRIDE) {
            bytes[at] = (char)(bytes[at] ^ 1 << at % 8);
            const char *path = scratch_write("flip.leaf", bytes, size);
            const status st = verify(path);
            if (st != ST_CORRUPT && st != ST_UNSUPPORTED)
                fail_msg("byte %zu: status %d", at, st);
            assert_non_null(strstr(status_text(), path));
            bytes[at] = (char)(bytes[at] ^ 1 << at % 8);
        }
        free(bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_labs),
        cmocka_unit_test(test_movies),
        cmocka_unit_test(test_lies),
        cmocka_unit_test(test_flipped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
