/* test_leaf_memory.c - treelet files opened from memory: the pictures and answers of the file, in
 * place where that can be; the caller's bytes are never touched; damage is found as in a file.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "stream/source.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

/* A file's bytes twice: at a multiple of 64, and 8 behind one. */
typedef struct image {
    const char *path;
    char *file; /* as read */
    char *bytes[2];
    void *block[2];
    size_t size;
} image;

static image image_of(const char *path) {
    image i = {.path = path};
    i.file = scratch_read(path, &i.size);
    for (size_t k = 0; k < 2; k++) {
        assert_int_equal(posix_memalign(&i.block[k], 64, i.size + 8), 0);
        i.bytes[k] = (char *)i.block[k] + 8 * k;
        memcpy(i.bytes[k], i.file, i.size);
    }
    return i;
}

static void release(image *i) {
    free(i->file);
    free(i->block[0]);
    free(i->block[1]);
}

static const char *grid_leaf(bool compressed) {
    field f;
    assert_true(field_make(&f, "noise-u8", 40, FIELD_SEED));
    const char *path = fixture_leaf(&f, 4, 1, compressed);
    field_release(&f);
    return path;
}

static const char *mesh_leaf(bool coarse) {
    mem m;
    mesh_result r;
    mesh_case c = mesh_cases_kuhn(9, 8, 7);
    mem_init(&m, 0);
    c.options.treelet_tets = 300;
    c.options.coarse = coarse;
    c.options.coarse_dims = 20;
    if (mesh_cases_convert(&m, &c, "mesh.leaf", 0, &r) != ST_OK)
        fail_msg("%s", status_text());
    mesh_cases_free(&c);
    return scratch_path("mesh.leaf");
}

static leafcast *open_bytes(const image *i, int k, const leafcast_options *o) {
    leafcast *v = NULL;
    if (leafcast_open_memory(i->bytes[k], i->size, o, &v) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    return v;
}

/* Two isosurfaces; a second picture with others, so that treelets come and go. */
static void draw(leafcast *v, picture *p) {
    const leafcast_info info = leafcast_describe(v);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    for (int round = 0; round < 3; round++) {
        leafcast_surface surfaces[2];
        for (int s = 0; s < 2; s++) {
            const double share = round == 1 ? 0.2 : 0.4 + 0.2 * s;
            surfaces[s] = leafcast_surface_default(info.value_min +
                                                   share * (info.value_max - info.value_min));
        }
        assert_int_equal(leafcast_select(v, surfaces, round == 1 ? 1 : 2), LEAFCAST_OK);
        pictures_draw(v, &scene, &view, p, NULL);
    }
}

static int hits(const picture *p) {
    int n = 0;
    for (int i = 0; i < PICTURE_PIXELS; i++)
        n += p->id[i] >= 0;
    return n;
}

static void check_pictures(const char *path) {
    static picture want, got;
    image i = image_of(path);
    leafcast_options o = {
        .size = sizeof o, .threads = 2, .experiments = EXPERIMENTS(.treelet_limit = 3)};
    leafcast *from_file = fixture_open(path, &o);
    draw(from_file, &want);
    assert_in_range(hits(&want), 200, PICTURE_PIXELS);
    for (int k = 0; k < 2; k++)
        for (int backend = 0; backend <= LEAFCAST_BACKEND_ARENA; backend++) {
            leafcast *v = NULL;
            o.backend = (leafcast_backend)backend;
            assert_int_equal(leafcast_open_memory(i.bytes[k], i.size, &o, &v), LEAFCAST_OK);
            draw(v, &got);
            assert_memory_equal(&want, &got, sizeof got);
            leafcast_close(v);
            assert_memory_equal(i.bytes[k], i.file, i.size);
        }
    leafcast_close(from_file);
    release(&i);
}

static void test_grid(void **state) {
    (void)state;
    check_pictures(grid_leaf(false));
    check_pictures(grid_leaf(true));
}

static void test_mesh(void **state) {
    (void)state;
    check_pictures(mesh_leaf(false));
}

/* A preview opens the grid inside the mesh's bytes. */
static void test_preview(void **state) {
    (void)state;
    static picture p;
    leafcast_scene scene = leafcast_scene_default();
    image i = image_of(mesh_leaf(true));
    leafcast *v = open_bytes(&i, 0, NULL);
    const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_surface s = leafcast_surface_default(0.4);
    scene.preview = true;
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    pictures_draw(v, &scene, &view, &p, NULL);
    assert_in_range(hits(&p), 1, PICTURE_PIXELS);
    leafcast_close(v);
    release(&i);
}

/* Whether treelet 0 is used where the bytes are. */
static bool used_in_place(const char *bytes, size_t size, source_kind kind) {
    mem m;
    leaf_file *f = NULL;
    source *s = NULL;
    leaf_unpacker *u = NULL;
    const void *payload = NULL;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open_memory(&m, "name", bytes, size, &f), ST_OK);
    assert_int_equal(source_open(&m, f, kind, &s), ST_OK);
    assert_int_equal(leaf_unpacker_create(&m, f, &u), ST_OK);
    assert_int_equal(source_load(s, 0, u, &payload), ST_OK);
    const bool inside = (const char *)payload >= bytes && (const char *)payload < bytes + size;
    assert_int_equal((uintptr_t)payload % 64, 0);
    source_evict(s, 0, payload);
    leaf_unpacker_destroy(u);
    source_close(s);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return inside;
}

static void test_in_place(void **state) {
    (void)state;
    image raw = image_of(grid_leaf(false)), packed = image_of(grid_leaf(true)),
          tets = image_of(mesh_leaf(false));
    assert_true(used_in_place(raw.bytes[0], raw.size, SOURCE_AUTO));
    assert_true(used_in_place(raw.bytes[0], raw.size, SOURCE_MAPPED));
    assert_false(used_in_place(raw.bytes[0], raw.size, SOURCE_ARENA));
    assert_false(used_in_place(raw.bytes[1], raw.size, SOURCE_AUTO));
    assert_false(used_in_place(raw.bytes[1], raw.size, SOURCE_MAPPED));
    assert_false(used_in_place(packed.bytes[0], packed.size, SOURCE_AUTO));
    assert_false(used_in_place(tets.bytes[0], tets.size, SOURCE_AUTO));
    assert_false(used_in_place(tets.bytes[0], tets.size, SOURCE_MAPPED));
    release(&raw);
    release(&packed);
    release(&tets);
}

/* Payloads that are not what their checksums say: found when they are used, in place or not. */
static void test_damaged(void **state) {
    (void)state;
    static picture p;
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_image plane = {.size = sizeof plane, .z = p.z};
    image i = image_of(grid_leaf(false));
    for (int k = 0; k < 2; k++) {
        for (size_t at = i.size / 2; at < i.size; at += 512)
            i.bytes[k][at] ^= 1;
        leafcast *v = open_bytes(&i, k, NULL);
        const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
        const leafcast_info info = leafcast_describe(v);
        const leafcast_surface s = leafcast_surface_default((info.value_min + info.value_max) / 2);
        leafcast_scene all = scene;
        all.sweep = true;
        assert_string_equal(info.name, "memory"); /* the file has none */
        assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
        assert_int_equal(leafcast_trace(v, &all, &view, &plane, NULL, NULL, NULL),
                         LEAFCAST_CORRUPT);
        assert_non_null(strstr(leafcast_error_text(), "memory: byte "));
        leafcast_close(v);
    }
    release(&i);
}

static void test_refused(void **state) {
    (void)state;
    leafcast *v = NULL;
    image i = image_of(grid_leaf(true));
    leafcast_options o = {.size = sizeof o, .memory = 1};
    assert_int_equal(leafcast_open_memory(i.bytes[0], i.size, &o, &v), LEAFCAST_NOMEM);
    o.size = 1;
    assert_int_equal(leafcast_open_memory(i.bytes[0], i.size, &o, &v), LEAFCAST_USAGE);
    assert_int_equal(leafcast_open_memory(NULL, 0, NULL, &v), LEAFCAST_CORRUPT);
    assert_int_equal(leafcast_open_memory(i.bytes[0], i.size - 1, NULL, &v), LEAFCAST_CORRUPT);
    assert_non_null(strstr(leafcast_error_text(), "memory"));
    assert_null(v);
    release(&i);
}

/* Each allocation of opening fails in turn. */
static void test_faults(void **state) {
    (void)state;
    image i = image_of(mesh_leaf(true));
    leafcast_status st = LEAFCAST_NOMEM;
    long k = 1;
    for (; st != LEAFCAST_OK; k++) {
        leafcast *v = NULL;
        fault_arm(FAULT_ALLOC, k);
        st = leafcast_open_memory(i.bytes[0], i.size, NULL, &v);
        fault_arm(FAULT_ALLOC, 0);
        assert_true(st == LEAFCAST_OK || (st == LEAFCAST_NOMEM && *leafcast_error_text()));
        leafcast_close(v);
    }
    assert_in_range(k, 10, 1000);
    release(&i);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),    cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_preview), cmocka_unit_test(test_in_place),
        cmocka_unit_test(test_damaged), cmocka_unit_test(test_refused),
        cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
