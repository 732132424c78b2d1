#include "formats/leaf/places_verify.h"

#include <math.h>

status places_wrong(const places_subject *s, uint64_t at, const char *what) {
    return status_describe(ST_CORRUPT, "%s: byte %llu: treelet %u: %s", file_path(s->f->source),
                           (unsigned long long)(s->f->offsets[s->payload] + at), s->t, what);
}

status places_check_zeros(const places_subject *s, const void *bytes, uint32_t from, uint32_t end) {
    for (uint32_t i = from; i < end; i++)
        if (((const char *)bytes)[i])
            return places_wrong(s, i, "expected 0 as padding");
    return ST_OK;
}

status places_check_box(const places_subject *s, const float bounds[6]) {
    for (uint32_t a = 0; a < 3; a++) {
        float lo = INFINITY, hi = -INFINITY;
        for (uint32_t n = 0; n < s->nodes; n++) {
            const float x = s->places[a * s->nodes + n];
            if (!isfinite(x))
                return places_wrong(s, (a * s->nodes + n) * sizeof(float), "a node is nowhere");
            lo = x < lo ? x : lo;
            hi = x > hi ? x : hi;
        }
        if (s->widen)
            s->widen(s, s->places + a * (size_t)s->nodes, &lo, &hi);
        if (lo != bounds[a] || hi != bounds[a + 3])
            return places_wrong(s, a * s->nodes * sizeof(float),
                                "its box is not that of its nodes");
    }
    return ST_OK;
}

status places_check_values(places_subject *s, uint32_t set, uint32_t value_bytes,
                           uint64_t *non_finite) {
    const size_t element = leaf_layout_samples(&s->f->layout, set, s->t);
    const float *own = s->f->own[element];
    float lo = INFINITY, hi = -INFINITY;
    uint64_t odd = 0;
    s->payload = leaf_layout_values(&s->f->layout, set, s->t);
    for (uint32_t n = 0; n < s->nodes; n++) {
        const float v = s->values[n];
        odd += !isfinite(v);
        lo = isfinite(v) && v < lo ? v : lo;
        hi = isfinite(v) && v > hi ? v : hi;
    }
    *non_finite += odd;
    if (s->widen)
        s->widen(s, s->values, &lo, &hi);
    if (lo != own[0] || hi != own[1])
        return places_wrong(s, 0, "its range is not that of its values");
    if ((odd > 0) != ((s->f->flags[element] & LEAF_FLAG_NON_FINITE) != 0))
        return places_wrong(s, 0, "its flags and its values differ about what is not finite");
    return places_check_zeros(s, s->values, sizeof(float) * s->nodes, value_bytes);
}

hex_code places_code(const places_subject *s, const uint32_t row[CELL_ROW]) {
    curved_cell c = {.quadratic = cell_row_is_quadratic(row)};
    for (int n = 0; n < curved_cell_nodes(&c); n++) {
        double p[3];
        for (uint32_t a = 0; a < 3; a++)
            p[a] = (double)s->places[a * s->nodes + row[n]];
        curved_cell_put(&c, n, p, 0.0);
    }
    return hex_code_of(curved_cell_sense(&c));
}
