/* coder_lab.h - a payload, coded and decoded by its kind's coder (leaf_coder.h), with guards around
 * all buffers. Trouble fails the running test.
 */
#ifndef TESTS_SUPPORT_CODER_LAB_H
#define TESTS_SUPPORT_CODER_LAB_H

#include "formats/leaf/leaf_coder.h"

typedef struct coder_subject {
    const leaf_coder *coder;
    leaf_block block;
    uint32_t counts[4];
    float bounds[6];
    size_t bytes;
    uint8_t *payload;
    coded_streams streams; /* of coder_lab_encode() */
} coder_subject;

/* coder_lab_guarded() - so many bytes, 64-byte aligned, with a guard behind them; free() them.
 * coder_lab_check_guard() - the guard is as it was. */
uint8_t *coder_lab_guarded(size_t bytes);
void coder_lab_check_guard(const uint8_t *at, size_t bytes);

/* coder_lab_subject() - a payload of zeros. bounds: NULL for zeros.
 * coder_lab_release() - free what a subject has. */
coder_subject coder_lab_subject(const leaf_coder *coder, leaf_block block, const uint32_t counts[4],
                                const float bounds[6]);
void coder_lab_release(coder_subject *x);

/* coder_lab_encode() - set the streams.
 * coder_lab_decode() - decode a copy of the bytes that has nothing behind it, into zeros. NULL:
 * they are refused. */
void coder_lab_encode(coder_subject *x);
uint8_t *coder_lab_decode(const coder_subject *x, const uint8_t *bytes, size_t size);

#endif
