/* test_mesh_leaf.c - treelet files of meshes: planes and codes, round trips, damage and malice. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf_verify.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/scratch.h"

static mem m;

static status try_open(const char *path) {
    leaf_file *f = NULL;
    status st = leaf_file_open(&m, path, &f);
    if (st == ST_OK)
        st = leaf_verify(&m, f, 2, NULL);
    leaf_file_close(f);
    if (mem_used(&m))
        fail_msg("%zu bytes left in memory", mem_used(&m));
    return st;
}

static void test_sound(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++)
        for (uint32_t n = 1; n < 6; n++) {
            mesh_case c = mesh_leaves_cube(n, n > 3 ? 2 : 1, n > 2 ? 3 : 1, n, n > 4 ? 20 : 0);
            c.file.codec = (leaf_codec)codec;
            if (try_open(mesh_leaves_make(&c, "sound.leaf")) != ST_OK)
                fail_msg("%u cells, codec %d: %s", n, codec, status_text());
            mesh_leaves_release(&c);
        }
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_sound, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
