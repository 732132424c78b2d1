/* float_steps.h - floats that are multiples of a step: whole numbers, decimals of a text, halves.
 *
 * Step 0 is none. Steps 1 .. FLOAT_DECIMALS are 1, 10^-1, 10^-2, ..; those behind them 2^-1, 2^-2,
 * .. A float is the multiple k of a step if (float)((double)k step) has its bits.
 */
#ifndef FORMATS_LEAF_FLOAT_STEPS_H
#define FORMATS_LEAF_FLOAT_STEPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { FLOAT_DECIMALS = 7, FLOAT_BINARIES = 24, FLOAT_STEPS = 1 + FLOAT_DECIMALS + FLOAT_BINARIES };

/* The NaN that stands for missing data: a multiple of every step. */
#define FLOAT_MISSING 0x7FC00000U

/* Multiples lie between minus this and this, both excluded. */
#define FLOAT_MULTIPLES 0x40000000

/* float_step_size() - a step; of step 0 it is 0. float_steps_in_one() - how many are 1, exactly. */
double float_step_size(unsigned step);
double float_steps_in_one(unsigned step);

/* float_step_bits() - the bits of the multiple of a step of this size.
 * float_step_multiple() - which multiple a float is, which is not FLOAT_MISSING. False: none. */
static inline uint32_t float_step_bits(int32_t multiple, double size) {
    const float value = (float)((double)multiple * size);
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}
bool float_step_multiple(uint32_t bits, double size, double in_one, int32_t *multiple);

/* float_step_join() - the first step from `step` to `last` of which this float is a multiple; 0: of
 * none. */
unsigned float_step_join(unsigned step, unsigned last, uint32_t bits);

/* float_step_find() - guess the step of n floats in one pass: of the decimals, else of the
 * binaries. It takes each float in turn and moves on to the first step that suits it; it does not
 * go back to those before. So the step may not suit all: check each by float_step_multiple(). 0:
 * none found. */
unsigned float_step_find(const uint32_t *bits, size_t n);

#endif
