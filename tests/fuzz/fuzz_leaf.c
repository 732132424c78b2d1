/* fuzz_leaf.c - hostile treelet files, checksums made right. Seeds: files that `leafcast convert`
 * made of small meshes and grids.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/leaf_fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    leaf_fuzz_result r;
    char *bytes = leaf_fuzz_alloc(size);
    memcpy(bytes, data, size);
    leaf_fuzz_seal(bytes, size);
    const char *wrong = leaf_fuzz_try(bytes, size, size && data[size / 2] & 1, &r);
    if (wrong) {
        fprintf(stderr, "fuzz_leaf: %s\n", wrong);
        abort();
    }
    free(bytes);
    return 0;
}
