/* The streams:
 *
 *   0      u8: the first byte; the cells' codes, of places
 *   1 - 4  u8 plane[4][axes][nodes]   floats, predicted in their lattice (float_lattice.h), axis
 * after axis
 */
#include "formats/leaf/curvilinear_coder.h"

#include "formats/leaf/coded_payload.h"
#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/float_lattice.h"
#include "formats/leaf/float_planes.h"

/* A payload's floats, then the cells' codes, if any, then zeros. */
typedef struct parts {
    uint32_t nodes[3], axes;
    size_t each; /* nodes */
    size_t codes_at, codes_bytes, bytes;
} parts;

static parts parts_of(leaf_block block, const uint32_t counts[4]) {
    const bool values = block == LEAF_BLOCK_VALUES;
    parts p = {.axes = values ? 1 : 3, .each = curvilinear_nodes(counts)};
    for (int a = 0; a < 3; a++)
        p.nodes[a] = counts[a] + 1;
    p.codes_at = p.axes * p.each * sizeof(float);
    p.codes_bytes = values ? 0 : (curvilinear_cells(counts) + 3) / 4;
    p.bytes = values ? curvilinear_value_bytes(counts) : curvilinear_place_bytes(counts);
    return p;
}

static size_t bytes_of(leaf_block block, const uint32_t counts[4]) {
    return parts_of(block, counts).bytes;
}

static size_t room_of(leaf_block block, const uint32_t counts[4]) {
    return 1 + parts_of(block, counts).bytes;
}

static size_t no_scratch(const uint32_t counts[4]) {
    (void)counts;
    return 0;
}

static void encode(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const void *payload, void *scratch, coded_streams *out) {
    const parts p = parts_of(block, counts);
    (void)bounds;
    (void)scratch;
    if (!coded_payload_is_zero(payload, p.codes_at + p.codes_bytes, p.bytes)) {
        coded_payload_store(payload, p.bytes, out);
        return;
    }
    coded_payload_begin(CODED_STREAMS, out);
    memcpy(coded_streams_take(out, p.codes_bytes), (const char *)payload + p.codes_at,
           p.codes_bytes);
    coded_streams_end(out);
    uint8_t *planes = coded_streams_take(out, p.codes_at);
    for (uint32_t a = 0; a < p.axes; a++)
        float_lattice_encode((const float *)payload + a * p.each, p.nodes, p.axes * p.each,
                             planes + a * p.each);
    coded_payload_end_planes(out, FLOAT_PLANES, p.axes * p.each);
}

static bool decode_streams(const parts *p, coded_input *in, void *payload) {
    const uint8_t *codes = coded_input_take(in, p->codes_bytes);
    const uint8_t *planes = codes ? coded_input_take(in, p->codes_at) : NULL;
    if (!planes || in->left)
        return false;
    for (uint32_t a = 0; a < p->axes; a++)
        float_lattice_decode(planes + a * p->each, p->nodes, p->axes * p->each,
                             (float *)payload + a * p->each);
    char *rest = (char *)payload + p->codes_at;
    memcpy(rest, codes, p->codes_bytes);
    memset(rest + p->codes_bytes, 0, p->bytes - p->codes_at - p->codes_bytes);
    return true;
}

static bool decode(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const uint8_t *in, size_t bytes, void *payload) {
    const parts p = parts_of(block, counts);
    coded_input rest = {in, bytes};
    const uint8_t *first = coded_input_take(&rest, 1);
    (void)bounds;
    if (first && *first == CODED_STORED)
        return coded_payload_stored(&rest, payload, p.bytes);
    return first && *first == CODED_STREAMS && decode_streams(&p, &rest, payload);
}

const leaf_coder curvilinear_coder = {
    .bytes = bytes_of, .room = room_of, .scratch = no_scratch, .encode = encode, .decode = decode};
