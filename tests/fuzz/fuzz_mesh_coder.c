/* fuzz_mesh_coder.c - hostile streams of meshes' payloads. An input is the block (u8), four counts
 * (u16), the bounds (float[6]) and the streams. What comes out must come back from its own streams.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "formats/mesh/mesh_coder.h"
#include "formats/mesh/mesh_leaf.h"
#include "tests/support/leaf_fuzz.h"

enum { HEAD = 1 + 4 * sizeof(uint16_t) + 6 * sizeof(float) };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int bounds_are_sound(const float b[6]) {
    int sound = 1;
    for (int a = 0; a < 3; a++)
        sound &= isfinite(b[a]) && isfinite(b[a + 3]) && b[a] <= b[a + 3];
    return sound;
}

static void check_again(mesh_block block, const uint32_t counts[4], const float bounds[6],
                        const char *payload, size_t bytes) {
    coded_streams s = {.room = mesh_coder_room(block, counts)};
    char *scratch = leaf_fuzz_alloc(mesh_coder_scratch(block, counts) + 1);
    char *again = leaf_fuzz_alloc(bytes);
    s.bytes = (uint8_t *)leaf_fuzz_alloc(s.room);
    mesh_coder_encode(block, counts, bounds, payload, scratch, &s);
    if (!mesh_coder_decode(block, counts, bounds, s.bytes, s.used, again) ||
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
    if (mesh_leaf_counts_fault(counts, 1024, 64) || !bounds_are_sound(bounds))
        return 0;
    const mesh_block block = (mesh_block)(data[0] % 4);
    const size_t bytes = mesh_coder_bytes(block, counts);
    char *in = leaf_fuzz_alloc(size - HEAD), *payload = leaf_fuzz_alloc(bytes);
    memcpy(in, data + HEAD, size - HEAD);
    if (mesh_coder_decode(block, counts, bounds, (const uint8_t *)in, size - HEAD, payload))
        check_again(block, counts, bounds, payload, bytes);
    free(in);
    free(payload);
    return 0;
}
