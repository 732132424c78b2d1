#include "formats/leaf/implied_payload.h"

#include <math.h>
#include <string.h>

/* The value of all samples. NaN is the one that converters write: payloads with other NaNs, or with
 * infinity, are stored. */
static float value_of(const float own[2]) {
    return own[0] > own[1] ? NAN : own[0];
}

/* Write a sample of this type as it lies in memory. */
static void encode(sample_type type, float value, uint8_t sample[4]) {
    const int whole = type == SAMPLE_F32 ? 0 : (int)value;
    const uint8_t u8 = (uint8_t)whole;
    const uint16_t u16 = (uint16_t)whole;
    switch (type) {
    case SAMPLE_U8:
    case SAMPLE_I8: memcpy(sample, &u8, sizeof u8); break;
    case SAMPLE_U16:
    case SAMPLE_I16: memcpy(sample, &u16, sizeof u16); break;
    default: memcpy(sample, &value, sizeof value);
    }
}

bool implied_payload_may(const float own[2], uint8_t flags) {
    return flags & LEAF_FLAG_NON_FINITE ? own[0] > own[1] : own[0] == own[1];
}

bool implied_payload_is(const leaf_layout *l, uint32_t t, const float own[2], uint8_t flags,
                        const void *payload) {
    const leaf_payload p = leaf_layout_payload(l, t);
    const size_t width = sample_size(l->type);
    const size_t bytes = (size_t)p.samples[0] * p.samples[1] * p.samples[2] * width;
    const char *samples = (const char *)payload + p.samples_at;
    uint8_t first[4];
    if (!implied_payload_may(own, flags))
        return false;
    encode(l->type, value_of(own), first);
    /* Compare each sample with the one before it. */
    return memcmp(samples, first, width) == 0 &&
           memcmp(samples, samples + width, bytes - width) == 0;
}

/* Whether block m lies in the treelet: its first cell does. */
static bool is_inside(const leaf_payload *p, uint32_t m) {
    uint32_t first[3] = {0, 0, 0};
    for (uint32_t bit = 0; bit < p->node_levels; bit++)
        for (uint32_t a = 0; a < 3; a++)
            first[a] |= (m >> (3 * bit + a) & 1) << (bit + LEAF_BLOCK_LOG2);
    return first[0] < p->cells[0] && first[1] < p->cells[1] && first[2] < p->cells[2];
}

/* Fill the codes: 0, 0 for the one value; 255, 0 for a node without a finite sample. */
static void fill_codes(const leaf_payload *p, bool empty, uint8_t *codes) {
    const uint32_t blocks = 1u << (3 * p->node_levels);
    uint8_t *low = codes + leaf_codes_at(p->node_levels);
    memset(codes, 0, p->samples_at);
    for (uint32_t m = 0; m < blocks; m++)
        low[m] = empty || !is_inside(p, m) ? 255 : 0;
    for (uint32_t k = p->node_levels - 1; k >= 1; k--) {
        uint8_t *here = codes + leaf_codes_at(k);
        const uint8_t *below = codes + leaf_codes_at(k + 1);
        for (uint32_t m = 0; m < 1u << (3 * k); m++)
            here[m] = below[8 * m]; /* the child in octant 0 lies inside, if any does */
    }
}

void implied_payload_fill(const leaf_layout *l, uint32_t t, const float own[2], void *payload) {
    const leaf_payload p = leaf_layout_payload(l, t);
    const size_t width = sample_size(l->type);
    const size_t bytes = (size_t)p.samples[0] * p.samples[1] * p.samples[2] * width;
    uint8_t *samples = (uint8_t *)payload + p.samples_at;
    fill_codes(&p, own[0] > own[1], payload);
    encode(l->type, value_of(own), samples);
    for (size_t done = width; done < bytes;) {
        const size_t more = done < bytes - done ? done : bytes - done;
        memcpy(samples + done, samples, more);
        done += more;
    }
    memset(samples + bytes, 0, p.bytes - p.samples_at - bytes);
}
