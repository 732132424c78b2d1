#include "formats/leaf/float_steps.h"

#include <math.h>

static const double tenths[FLOAT_DECIMALS] = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
static const double tens[FLOAT_DECIMALS] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6};

double float_step_size(unsigned step) {
    if (step == 0)
        return 0;
    return step <= FLOAT_DECIMALS ? tenths[step - 1] : ldexp(1, -(int)(step - FLOAT_DECIMALS));
}

double float_steps_in_one(unsigned step) {
    if (step == 0)
        return 0;
    return step <= FLOAT_DECIMALS ? tens[step - 1] : ldexp(1, (int)(step - FLOAT_DECIMALS));
}

bool float_step_multiple(uint32_t bits, double size, double in_one, int32_t *multiple) {
    float value;
    memcpy(&value, &bits, sizeof value);
    const double m = (double)value * in_one;
    if (!(fabs(m) < FLOAT_MULTIPLES - 1))
        return false;
    *multiple = (int32_t)(m < 0 ? m - 0.5 : m + 0.5);
    return float_step_bits(*multiple, size) == bits;
}

unsigned float_step_join(unsigned step, unsigned last, uint32_t bits) {
    int32_t multiple;
    if (bits == FLOAT_MISSING)
        return step;
    for (; step <= last; step++)
        if (float_step_multiple(bits, float_step_size(step), float_steps_in_one(step), &multiple))
            return step;
    return 0;
}

static unsigned find_between(const uint32_t *bits, size_t n, unsigned first, unsigned last) {
    unsigned step = first;
    for (size_t i = 0; i < n && step; i++)
        step = float_step_join(step, last, bits[i]);
    return step;
}

unsigned float_step_find(const uint32_t *bits, size_t n) {
    const unsigned step = find_between(bits, n, 1, FLOAT_DECIMALS);
    return step ? step : find_between(bits, n, FLOAT_DECIMALS + 1, FLOAT_STEPS - 1);
}
