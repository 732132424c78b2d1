/* fuzz_coder.c - hostile streams of payloads. An input is the block and the kind (u8: block + 4
 * kind), four counts (u16), the bounds (float[6]) and the streams. What comes out must come back
 * from its own streams.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/curvilinear_coder.h"
#include "formats/leaf/mixed_coder.h"
#include "formats/leaf/mixed_geometry.h"
#include "formats/leaf/triangle_coder.h"
#include "formats/leaf/triangle_geometry.h"
#include "formats/mesh/mesh_coder.h"
#include "formats/mesh/mesh_leaf.h"
#include "tests/support/leaf_fuzz.h"

enum { HEAD = 1 + 4 * sizeof(uint16_t) + 6 * sizeof(float) };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What coders may assume of counts, which files are refused without. */
static int mesh_can_be(const uint32_t counts[4]) {
    return !mesh_leaf_counts_fault(counts, 1024, 64);
}

static int curvilinear_can_be(const uint32_t counts[4]) {
    int sound = counts[3] == 0;
    for (int a = 0; a < 3; a++)
        sound &= counts[a] > 0 && counts[a] <= 32;
    return sound;
}

static int mixed_can_be(const uint32_t counts[4]) {
    return !mixed_counts_fault(counts, 1024);
}

static int triangles_can_be(const uint32_t counts[4]) {
    return !triangle_counts_fault(counts, 1024);
}

static const struct {
    const leaf_coder *coder;
    int (*can_be)(const uint32_t counts[4]);
} kinds[] = {{&mesh_coder, mesh_can_be},
             {&curvilinear_coder, curvilinear_can_be},
             {&mixed_coder, mixed_can_be},
             {&triangle_coder, triangles_can_be}};

static int bounds_are_sound(const float b[6]) {
    int sound = 1;
    for (int a = 0; a < 3; a++)
        sound &= isfinite(b[a]) && isfinite(b[a + 3]) && b[a] <= b[a + 3];
    return sound;
}

static void check_again(const leaf_coder *coder, leaf_block block, const uint32_t counts[4],
                        const float bounds[6], const char *payload, size_t bytes) {
    coded_streams s = {.room = coder->room(block, counts)};
    char *scratch = leaf_fuzz_alloc(coder->scratch(counts) + 1);
    char *again = leaf_fuzz_alloc(bytes);
    s.bytes = (uint8_t *)leaf_fuzz_alloc(s.room);
    coder->encode(block, counts, bounds, payload, scratch, &s);
    if (!coder->decode(block, counts, bounds, s.bytes, s.used, again) ||
        memcmp(payload, again, bytes) != 0)
        abort();
    free(s.bytes);
    free(scratch);
    free(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint16_t numbers[4];
    uint32_t counts[4];
    float bounds[6];
    if (size < HEAD)
        return 0;
    memcpy(numbers, data + 1, sizeof numbers);
    memcpy(bounds, data + 1 + sizeof numbers, sizeof bounds);
    for (int k = 0; k < 4; k++)
        counts[k] = numbers[k];
    const size_t kind = data[0] / 4 % (sizeof kinds / sizeof kinds[0]);
    if (!kinds[kind].can_be(counts) || !bounds_are_sound(bounds))
        return 0;
    const leaf_coder *coder = kinds[kind].coder;
    const leaf_block block = (leaf_block)(data[0] % 4);
    if (block == LEAF_BLOCK_GRADIENTS && kind > 0)
        return 0;
    const size_t bytes = coder->bytes(block, counts);
    char *in = leaf_fuzz_alloc(size - HEAD), *payload = leaf_fuzz_alloc(bytes);
    memcpy(in, data + HEAD, size - HEAD);
    if (coder->decode(block, counts, bounds, (const uint8_t *)in, size - HEAD, payload))
        check_again(coder, block, counts, bounds, payload, bytes);
    free(in);
    free(payload);
    return 0;
}
