/* The streams:
 *
 *   0      u8: the first byte; the cells' codes, of a topology and of positions
 *   1 - 4  u8 plane[4][floats]        of positions and values, each float predicted by the one
 * before 1 ..   of a topology: corners and coordinates (mixed_corner_coder.h)
 */
#include "formats/leaf/mixed_coder.h"

#include "formats/leaf/coded_payload.h"
#include "formats/leaf/float_planes.h"
#include "formats/leaf/mixed_corner_coder.h"

/* A payload: floats; the cells' codes, if any; zeros; of a topology corners, and zeros. */
typedef struct parts {
    size_t floats, codes_at, codes_bytes, codes_end, corners_end, bytes;
} parts;

static parts parts_of(leaf_block block, const mixed_shape *s) {
    if (block == LEAF_BLOCK_VALUES)
        return (parts){.floats = s->nodes,
                       .codes_at = s->nodes * sizeof(float),
                       .codes_end = s->value_bytes,
                       .corners_end = s->value_bytes,
                       .bytes = s->value_bytes};
    parts p = {.floats = 3 * (size_t)s->nodes,
               .codes_at = s->codes_at,
               .codes_bytes = (s->cells + 3) / 4,
               .codes_end = s->place_bytes,
               .corners_end = s->place_bytes,
               .bytes = s->place_bytes};
    if (block != LEAF_BLOCK_TOPOLOGY)
        return p;
    p.corners_end = s->rows_at + mixed_rows_bytes(s);
    p.bytes = s->topology_bytes;
    return p;
}

static size_t bytes_of(leaf_block block, const uint32_t counts[4]) {
    const mixed_shape s = mixed_shape_of(counts);
    return parts_of(block, &s).bytes;
}

static size_t room_of(leaf_block block, const uint32_t counts[4]) {
    const mixed_shape s = mixed_shape_of(counts);
    const parts p = parts_of(block, &s);
    const size_t coded =
        block == LEAF_BLOCK_TOPOLOGY ? p.codes_bytes + mixed_corners_room(&s) : p.bytes;
    return 1 + (coded > p.bytes ? coded : p.bytes);
}

/* A word for each corner. */
static size_t scratch_of(const uint32_t counts[4]) {
    const mixed_shape s = mixed_shape_of(counts);
    return mixed_rows_bytes(&s);
}

/* False: the payload could not be made again. */
static bool encode_streams(leaf_block block, const mixed_shape *s, const parts *p,
                           const char *payload, void *scratch, coded_streams *out) {
    if (!coded_payload_is_zero(payload, p->codes_at + p->codes_bytes, p->codes_end) ||
        !coded_payload_is_zero(payload, p->corners_end, p->bytes))
        return false;
    coded_payload_begin(CODED_STREAMS, out);
    memcpy(coded_streams_take(out, p->codes_bytes), payload + p->codes_at, p->codes_bytes);
    coded_streams_end(out);
    if (block == LEAF_BLOCK_TOPOLOGY)
        return mixed_corners_encode(s, payload, scratch, out);
    float_planes_encode(payload, p->floats, 1, coded_streams_take(out, p->floats * sizeof(float)));
    coded_payload_end_planes(out, FLOAT_PLANES, p->floats);
    return true;
}

static void encode(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const void *payload, void *scratch, coded_streams *out) {
    const mixed_shape s = mixed_shape_of(counts);
    const parts p = parts_of(block, &s);
    (void)bounds;
    if (!encode_streams(block, &s, &p, payload, scratch, out))
        coded_payload_store(payload, p.bytes, out);
}

static bool decode_floats(const parts *p, coded_input *in, void *payload) {
    const uint8_t *planes = coded_input_take(in, p->floats * sizeof(float));
    if (!planes || in->left)
        return false;
    float_planes_decode(planes, p->floats, 1, payload);
    return true;
}

static bool decode_streams(leaf_block block, const mixed_shape *s, coded_input *in, char *payload) {
    const parts p = parts_of(block, s);
    const uint8_t *codes = coded_input_take(in, p.codes_bytes);
    if (!codes)
        return false;
    memset(payload + p.codes_at + p.codes_bytes, 0, p.codes_end - p.codes_at - p.codes_bytes);
    memset(payload + p.corners_end, 0, p.bytes - p.corners_end);
    memcpy(payload + p.codes_at, codes, p.codes_bytes);
    return block == LEAF_BLOCK_TOPOLOGY ? mixed_corners_decode(s, in, payload)
                                        : decode_floats(&p, in, payload);
}

static bool decode(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const uint8_t *in, size_t bytes, void *payload) {
    const mixed_shape s = mixed_shape_of(counts);
    coded_input rest = {in, bytes};
    const uint8_t *first = coded_input_take(&rest, 1);
    (void)bounds;
    if (first && *first == CODED_STORED)
        return coded_payload_stored(&rest, payload, parts_of(block, &s).bytes);
    return first && *first == CODED_STREAMS && decode_streams(block, &s, &rest, payload);
}

const leaf_coder mixed_coder = {
    .bytes = bytes_of, .room = room_of, .scratch = scratch_of, .encode = encode, .decode = decode};
