/* naive_box.h - codes of boxes of samples, from section 10 of formats/FORMAT.md alone. */
#ifndef TESTS_SUPPORT_NAIVE_BOX_H
#define TESTS_SUPPORT_NAIVE_BOX_H

#include <stdint.h>

/* naive_sample_bytes() - bytes of a sample of a type: 1 u8 2 i8 3 u16 4 i16 5 f32. */
int naive_sample_bytes(int type);

/* naive_boxes_decode() - the samples of `count` boxes, one box after the other, each in its order.
 * sizes: of the boxes, in that order; in: the code, all of it. earlier: samples that it has the
 * differences to, like `out`; NULL: to none. Returns NULL, or what is wrong with the code. */
const char *naive_boxes_decode(int type, const long (*sizes)[3], int count, const unsigned char *in,
                               uint64_t bytes, const unsigned char *earlier, unsigned char *out);

#endif
