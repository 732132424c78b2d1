/* box_coder.h - boxes of samples as few bytes, without loss (FORMAT.md 10).
 *
 * Samples become unsigned integers in the order of their values, each is predicted from those
 * before it, and what is left over goes to zstd, a stream for each of its bytes. Where one value
 * takes up much of the boxes, a map says where, and only the other samples are coded. A prediction
 * looks at rows that are known already, and otherwise only adds along its own row: so rows are
 * decoded as a whole, by vectors.
 *
 * Boxes of a later step may be coded by their differences to an earlier one's, which are coded like
 * samples.
 *
 * A coder belongs to one thread.
 */
#ifndef FORMATS_LEAF_BOX_CODER_H
#define FORMATS_LEAF_BOX_CODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/cpu.h"
#include "formats/base/mem.h"
#include "formats/base/sample.h"
#include "formats/base/status.h"

/* A box of samples somewhere in memory. */
enum { BOX_ROW_MAX = 256 };
typedef struct coded_box {
    uint32_t size[3];   /* 1 or more; x up to BOX_ROW_MAX */
    uint32_t stride[3]; /* samples from one to the next on each axis */
    void *at;           /* its first sample; encoding only reads */
} coded_box;

typedef struct box_coder box_coder;

/* box_coder_create() - a coder of boxes with up to `samples` samples together. level: of zstd, for
 * encoding; 0: the coder only decodes. */
CHECKED status box_coder_create(mem *m, sample_type type, size_t samples, int level,
                                box_coder **out);
void box_coder_destroy(box_coder *c); /* NULL is fine */

/* box_coder_use() - run the loops of another ISA than cpu_best(), one that the CPU has. */
void box_coder_use(box_coder *c, cpu_isa isa);

/* box_coder_memory() - bytes that box_coder_create() takes from m. box_coder_outside() - and those
 * that zstd takes elsewhere once it has been used. */
size_t box_coder_memory(sample_type type, size_t samples);
size_t box_coder_outside(const box_coder *c);

/* box_coder_room() - the most bytes that so many samples can take. */
size_t box_coder_room(sample_type type, size_t samples);

/* box_coder_encode() - code the samples of the boxes into out, of box_coder_room() bytes. Returns
 * how many bytes they take. The same samples give the same bytes on any machine, by the same
 * version of zstd. */
size_t box_coder_encode(box_coder *c, const coded_box *boxes, uint32_t count, void *out);

/* box_coder_encode_from() - the same, with boxes of the same sizes that hold earlier samples: where
 * it is clearly smaller, a code of the differences to them. Returns 0 if all samples are the same.
 * box_coder_is_difference() - whether a code is one of differences. */
size_t box_coder_encode_from(box_coder *c, const coded_box *boxes, const coded_box *earlier,
                             uint32_t count, void *out);
bool box_coder_is_difference(const void *code);

/* box_coder_hash() - XXH3-64 of the samples of the boxes, in the order of their rows. */
uint64_t box_coder_hash(box_coder *c, const coded_box *boxes, uint32_t count);

/* box_coder_decode() - write the samples. difference: the code must be one of differences, and the
 * boxes hold the earlier samples; else it must be none. Returns false if the bytes are no code of
 * boxes of these sizes (FORMAT.md 10): some samples may have been written then. Safe for any bytes.
 */
CHECKED bool box_coder_decode(box_coder *c, const void *in, size_t bytes, const coded_box *boxes,
                              uint32_t count, bool difference);

/* The parts of a code, for those who count. */
typedef struct box_code {
    uint8_t method;     /* 0: plain samples; 1: coded */
    uint8_t map;        /* of floats: 0: their bits in order; else multiples of a step */
    uint8_t prediction; /* box_prediction */
    uint8_t width;      /* bytes of a residual, 0 to the size of a sample */
    uint32_t base;      /* with a step: the multiple that 0 stands for */
    uint32_t background;
    uint32_t coded; /* samples that are not the background */
} box_code;

/* How a sample is predicted: from the row above (y) and the row behind (z), ... */
typedef enum box_prediction {
    BOX_NONE = 0,   /* 0 */
    BOX_ROW = 1,    /* the sample above */
    BOX_PLANE = 2,  /* above + behind - behind and above */
    BOX_MEDIAN = 3, /* the median of above, behind, and BOX_PLANE */
    BOX_ALONG = 4,  /* and by the error of the sample before it in its row */
    BOX_BACKGROUND = 8,
    BOX_DIFFERENCE = 16 /* of differences to earlier samples, plus half the range of values */
} box_prediction;

#endif
