#include "tests/support/coder_lab.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

enum { GUARD = 64, GUARD_BYTE = 0xa7 };

uint8_t *coder_lab_guarded(size_t bytes) {
    uint8_t *at = aligned_alloc(64, (bytes + GUARD + 63) / 64 * 64);
    assert_non_null(at);
    memset(at, GUARD_BYTE, bytes + GUARD);
    return at;
}

void coder_lab_check_guard(const uint8_t *at, size_t bytes) {
    for (size_t i = 0; i < GUARD; i++)
        assert_int_equal(at[bytes + i], GUARD_BYTE);
}

coder_subject coder_lab_subject(const leaf_coder *coder, leaf_block block, const uint32_t counts[4],
                                const float bounds[6]) {
    coder_subject x = {.coder = coder, .block = block};
    memcpy(x.counts, counts, sizeof x.counts);
    if (bounds)
        memcpy(x.bounds, bounds, sizeof x.bounds);
    x.bytes = coder->bytes(block, counts);
    x.payload = coder_lab_guarded(x.bytes);
    memset(x.payload, 0, x.bytes);
    return x;
}

void coder_lab_release(coder_subject *x) {
    free(x->payload);
    free(x->streams.bytes);
}

void coder_lab_encode(coder_subject *x) {
    const size_t room = x->coder->room(x->block, x->counts);
    const size_t scratch_bytes = x->coder->scratch(x->counts);
    uint8_t *scratch = coder_lab_guarded(scratch_bytes);
    free(x->streams.bytes);
    x->streams =
        (coded_streams){.bytes = coder_lab_guarded(room), .room = room, .used = 7, .count = 7};
    x->coder->encode(x->block, x->counts, x->bounds, x->payload, scratch, &x->streams);
    coder_lab_check_guard(scratch, scratch_bytes);
    coder_lab_check_guard(x->streams.bytes, room);
    coder_lab_check_guard(x->payload, x->bytes);
    free(scratch);
    const coded_streams *s = &x->streams;
    assert_true(s->used <= room && s->count >= 1 && s->count <= CODED_STREAMS_MAX);
    assert_int_equal(s->end[s->count - 1], s->used);
    for (uint32_t i = 1; i < s->count; i++)
        assert_true(s->end[i - 1] <= s->end[i]);
}

uint8_t *coder_lab_decode(const coder_subject *x, const uint8_t *bytes, size_t size) {
    uint8_t *in = malloc(size ? size : 1), *out = coder_lab_guarded(x->bytes);
    assert_non_null(in);
    memcpy(in, bytes, size);
    memset(out, 0, x->bytes);
    const bool good = x->coder->decode(x->block, x->counts, x->bounds, in, size, out);
    coder_lab_check_guard(out, x->bytes);
    free(in);
    if (good)
        return out;
    free(out);
    return NULL;
}
