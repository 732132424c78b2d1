/* fuzz_leaf.c - hostile treelet files, checksums made right. Seeds: files that `leafcast convert`
 * made of small meshes and grids.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/leaf_fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    char *bytes = malloc(size + 1);
    if (!bytes)
        abort();
    memcpy(bytes, data, size);
    leaf_fuzz_seal(bytes, size);
    snprintf(path, sizeof path, "/dev/shm/leafcast-fuzz-%d.leaf", (int)getpid());
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(bytes, 1, size, f) != size)
        abort();
    fclose(f);
    free(bytes);
    leaf_fuzz_result r;
    const char *wrong = leaf_fuzz_try(path, &r);
    if (wrong) {
        fprintf(stderr, "fuzz_leaf: %s\n", wrong);
        abort();
    }
    remove(path);
    return 0;
}
