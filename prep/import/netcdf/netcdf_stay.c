#include "prep/import/netcdf/netcdf_stay.h"

#include <math.h>

#include "prep/import/netcdf/netcdf_classic.h"

/* ---- what numbers become ---- */

/* The type of a number in the file. */
static sample_type type_of(const packed_samples *p) {
    return p->wide == PACKED_I64 ? SAMPLE_I64 : p->wide == PACKED_U64 ? SAMPLE_U64 : p->type;
}

static bool is_scaled(const packed_samples *p) {
    return p->scale != 1 || p->offset != 0;
}

/* The value that a number becomes, as it is compared with `missing`. */
static double value_of(const packed_samples *p, double number) {
    const double value = is_scaled(p) ? number * p->scale + p->offset : number;
    return sample_computed(p->type) == SAMPLE_F32 && is_scaled(p) ? (double)(float)value : value;
}

/* The next number of the variable's type that a double holds. */
static double next_to(const packed_samples *p, double number, double towards) {
    const bool whole = p->wide || sample_is_integer(p->type);
    const double next = whole                   ? number + copysign(1, towards)
                        : p->type == SAMPLE_F32 ? (double)nextafterf((float)number, (float)towards)
                                                : number;
    return next != number ? next : nextafter(number, towards);
}

/* Whether no number but the fill value becomes what it becomes. Values grow or shrink with numbers:
 * so the neighbours tell. */
static bool is_alone(const packed_samples *p, double fill) {
    const double value = value_of(p, fill);
    return value != value_of(p, next_to(p, fill, INFINITY)) &&
           value != value_of(p, next_to(p, fill, -INFINITY));
}

/* Whether a number of the variable can have the value. */
static bool can_be(const packed_samples *p, long double value) {
    return p->wide || sample_holds(p->type, (double)value);
}

/* Set the value for missing data, if there are any. Returns NULL, or what cannot be told. */
static const char *tell_missing(const packed_samples *p, sample_place *out) {
    for (int i = 0; i < p->fills; i++) {
        const double fill = (double)p->fill[i];
        if (!can_be(p, p->fill[i]))
            continue;
        if ((long double)fill != p->fill[i])
            return "a fill value that no double holds";
        if (out->has_missing && value_of(p, fill) != out->missing)
            return "several fill values";
        if (!is_alone(p, fill))
            return "a fill value that others become, too";
        out->has_missing = true;
        out->missing = value_of(p, fill);
    }
    if (is_scaled(p) || !sample_is_integer(p->type) || !p->fills)
        return NULL;
    /* Integers become floats, whether or not one of them is missing. */
    if (!out->has_missing)
        out->missing = (double)p->fill[0];
    out->has_missing = true;
    return sample_size(p->type) > 2 ? "a fill value among integers of 32 bits" : NULL;
}

const char *netcdf_stay_numbers(const netcdf_variable *v, sample_place *out) {
    const packed_samples *p = &v->packed;
    out->stored = (stored_samples){.type = type_of(p)};
    if (is_scaled(p)) {
        out->stored.slope = p->scale;
        out->stored.intercept = p->offset;
    }
    if (v->minc || p->has_range)
        return "a valid range";
    if (p->components != 1 || p->out)
        return "numbers side by side";
    if (p->scale == 0 || !isfinite(p->scale) || !isfinite(p->offset))
        return "a scale that is 0 or not finite";
    return tell_missing(p, out);
}

/* ---- where they lie ---- */

bool netcdf_stay_find(file *f, const netcdf_variable *v, const size_t *start, sample_place *out) {
    bool apart = false;
    uint64_t begin = 0;
    *out = (sample_place){.path = NULL};
    if (netcdf_classic_step(f, v, start, &begin, &apart) != ST_OK || begin == 0)
        return false;
    out->offset = begin;
    out->big_endian = true;
    out->refused = apart ? "slices lie a record apart" : netcdf_stay_numbers(v, out);
    return true;
}
