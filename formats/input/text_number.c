#include "formats/input/text_number.h"

#include "formats/base/num.h"

/* Scale up to 19 digits by a power of ten. Both numbers must be exact doubles: then one operation
 * rounds once, so correctly. */
static bool scale_exactly(uint64_t digits, int exponent, double *out) {
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (digits > (uint64_t)1 << 53 || exponent < -22 || exponent > 22)
        return false;
    *out = exponent < 0 ? (double)digits / power[-exponent] : (double)digits * power[exponent];
    return true;
}

/* Read a plain decimal, the usual case. Returns false where strtod() must decide. */
static bool plain_double(const char *at, double *out) {
    bool negative = *at == '-', negative_power;
    uint64_t digits = 0;
    int count = 0, exponent = 0, power = 0, behind = 0;
    at += negative;
    for (; *at >= '0' && *at <= '9'; at++, count++)
        digits = 10 * digits + (uint64_t)(*at - '0');
    if (*at == '.')
        for (at++; *at >= '0' && *at <= '9'; at++, count++, exponent--)
            digits = 10 * digits + (uint64_t)(*at - '0');
    if (count == 0 || count > 19)
        return false;
    if (*at == 'e' || *at == 'E') {
        negative_power = at[1] == '-';
        at += at[1] == '-' || at[1] == '+' ? 2 : 1;
        for (; *at >= '0' && *at <= '9' && behind < 4; at++, behind++)
            power = 10 * power + (*at - '0');
        if (behind == 0)
            return false;
        exponent += negative_power ? -power : power;
    }
    if (*at || !scale_exactly(digits, exponent, out))
        return false;
    *out = negative ? -*out : *out;
    return true;
}

bool text_number_double(const char *word, double *out) {
    return plain_double(word, out) || num_double(word, "", out) == ST_OK;
}

bool text_number_whole(const char *word, uint64_t *out) {
    bool negative = *word == '-';
    const char *at = word + negative;
    int count = 0;
    *out = 0;
    for (; *at >= '0' && *at <= '9' && count < 19; at++, count++)
        *out = 10 * *out + (uint64_t)(*at - '0');
    if (negative || (*at >= '0' && *at <= '9')) {
        while (*at >= '0' && *at <= '9')
            at++;
        *out = UINT64_MAX;
    }
    return count > 0 && !*at;
}

bool text_number_int(const char *word, int64_t lo, int64_t hi, int64_t *out) {
    bool negative = *word == '-';
    const char *at = word + negative;
    int64_t value = 0;
    int count = 0;
    for (; *at >= '0' && *at <= '9' && count < 18; at++, count++)
        value = 10 * value + (*at - '0');
    if (count == 0 || *at) /* not the usual case */
        return num_int(word, "", lo, hi, out) == ST_OK;
    value = negative ? -value : value;
    if (value < lo || value > hi)
        return false;
    *out = value;
    return true;
}
