#include "formats/leaf/deviation_band.h"

#include <assert.h>
#include <string.h>

#include "formats/leaf/deviation_rows.h"

/* The numbers of a row, rounded up to whole vectors. */
static uint32_t row_of(uint32_t nodes) {
    return (nodes / 2 + 1 + 31) / 32 * 32;
}

size_t deviation_band_bytes(uint32_t nodes) {
    return sizeof(deviation_band) + 4 * (size_t)row_of(nodes) * sizeof(double);
}

void deviation_band_begin(deviation_band *band, uint32_t nodes) {
    memset(band, 0, deviation_band_bytes(nodes));
    band->nodes = nodes;
    band->row = row_of(nodes);
}

size_t deviation_scratch_bytes(uint32_t nodes) {
    return (DEVIATION_COARSE_ROWS + 1) * (size_t)row_of(nodes) * sizeof(double);
}

void deviation_compare(const deviation_slice *s, void *scratch, deviation_band *band) {
    assert(s->nodes == band->nodes && s->rows <= 2 * DEVIATION_BRICK + 1);
    band->numbers = deviation_numbers_of(s->type, s->weight[0] != NULL);
    deviation_rows_for(cpu_best(), s->type, band->numbers)(s, scratch, band);
}

#define DEFINE_MOST(A, suffix)                                        \
    static inline A most_##suffix(const A *numbers, uint32_t count) { \
        A most = 0;                                                   \
        for (uint32_t i = 0; i < count; i++)                          \
            most = numbers[i] > most ? numbers[i] : most;             \
        return most;                                                  \
    }
DEFINE_MOST(int16_t, i16)
DEFINE_MOST(int32_t, i32)
DEFINE_MOST(double, f64)

static double most_of(const deviation_band *band, uint32_t from, uint32_t count) {
    const void *most = band->most;
    return band->numbers == DEVIATION_I16   ? most_i16((const int16_t *)most + from, count) * 0.125
           : band->numbers == DEVIATION_I32 ? most_i32((const int32_t *)most + from, count) * 0.125
                                            : most_f64((const double *)most + from, count);
}

/* Brick x has the nodes 8 x .. 8 x + 8: five at even places, four at odd ones. */
double deviation_of_brick(const deviation_band *band, uint32_t x, uint32_t y) {
    const uint32_t half = DEVIATION_BRICK / 2, even = 2 * y * band->row;
    const uint32_t evens = (band->nodes + 1) / 2, odds = band->nodes / 2, from = half * x;
    const double a = most_of(band, even + from, evens - from < half + 1 ? evens - from : half + 1);
    const double b =
        most_of(band, even + band->row + from, odds - from < half ? odds - from : half);
    return a > b ? a : b;
}
