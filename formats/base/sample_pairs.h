/* sample_pairs.h - two neighbours in a row of integer samples as one integer of twice their width.
 *
 * A loop over pairs needs no shuffles: compilers make vectors of it whose lanes are as wide as what
 * sums of samples need.
 */
#ifndef FORMATS_BASE_SAMPLE_PAIRS_H
#define FORMATS_BASE_SAMPLE_PAIRS_H

#include <endian.h>
#include <stdint.h>

/* PAIR_FIRST(), PAIR_SECOND() - the samples of a pair. T: their type; A: a signed or unsigned type
 * twice as wide, for the result; pair: an unsigned integer of A's width, read from memory. */
#define PAIR_LOW(T, A, pair)                                                 \
    ((T)-1 < 0 ? (A)((A)((pair) << (8 * sizeof(T))) >> (int)(8 * sizeof(T))) \
               : (A)((pair) & (((uint32_t)1 << (8 * sizeof(T))) - 1)))
#define PAIR_HIGH(T, A, pair) \
    ((T)-1 < 0 ? (A)((A)(pair) >> (int)(8 * sizeof(T))) : (A)((pair) >> (8 * sizeof(T))))

#if __BYTE_ORDER == __BIG_ENDIAN
#define PAIR_FIRST  PAIR_HIGH
#define PAIR_SECOND PAIR_LOW
#else
#define PAIR_FIRST  PAIR_LOW
#define PAIR_SECOND PAIR_HIGH
#endif

#endif
