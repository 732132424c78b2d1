#include "prep/generate/field.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

#include "prep/generate/analytic.h"
#include "prep/generate/attractor.h"

struct field {
    mem *m;
    uint32_t dims[3];
    double lo, hi;
    analytic formula;  /* used if orbits is NULL */
    attractor *orbits; /* NULL: the field is a formula */
};

const field_info *field_at(size_t index) {
    size_t count;
    const analytic_kind *kinds = analytic_kinds(&count);
    if (index < count)
        return &kinds[index].info;
    return index == count ? &attractor_info : NULL;
}

const field_info *field_find(const char *name) {
    const field_info *info;
    for (size_t i = 0; (info = field_at(i)) != NULL; i++)
        if (strcmp(info->name, name) == 0)
            return info;
    return NULL;
}

/* The formula behind an info; NULL for the attractor. */
static const analytic_kind *find_kind(const field_info *info) {
    size_t count;
    const analytic_kind *kinds = analytic_kinds(&count);
    for (size_t i = 0; i < count; i++)
        if (&kinds[i].info == info)
            return &kinds[i];
    return NULL;
}

status field_create(mem *m, const field_choice *which, const uint32_t dims[3], size_t samples,
                    field **out) {
    field *f = mem_zalloc(m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    f->m = m;
    memcpy(f->dims, dims, sizeof f->dims);
    f->lo = which->info->lo;
    f->hi = which->info->hi;
    const analytic_kind *kind = find_kind(which->info);
    status st = kind ? analytic_init(&f->formula, m, kind, dims, which->seed, which->time)
                     : attractor_create(m, dims, which->seed, samples, &f->orbits);
    if (st != ST_OK) {
        field_destroy(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

void field_destroy(field *f) {
    if (!f)
        return;
    attractor_destroy(f->orbits);
    analytic_release(&f->formula, f->m);
    mem_free(f->m, f);
}

/* ---- values to samples ---- */

/* Linear, rounded to nearest (halves up), clamped. */
#define QUANTISE_ALL(type, most)                       \
    {                                                  \
        type *to = samples;                            \
        double scale = (most) / (hi - lo);             \
        for (size_t n = 0; n < count; n++) {           \
            double v = (values[n] - lo) * scale + 0.5; \
            v = v > 0 ? v : 0;                         \
            v = v < (most) ? v : (most);               \
            to[n] = (type)(int)v;                      \
        }                                              \
        break;                                         \
    }

void field_quantise(double lo, double hi, sample_type type, const double *values, size_t count,
                    void *samples) {
    switch (type) {
    case SAMPLE_U8: QUANTISE_ALL(uint8_t, 255.0)
    case SAMPLE_U16: QUANTISE_ALL(uint16_t, 65535.0)
    case SAMPLE_F32:
        for (size_t n = 0; n < count; n++)
            ((float *)samples)[n] = (float)values[n];
        break;
    default: assert(false); break; /* a caller's bug: fields have no other type */
    }
}

/* ---- filling ---- */

typedef struct filling {
    const field *f;
    const field_block *block;
    sample_type type;
    char *samples;
} filling;

static char *sample_at(const filling *fill, uint32_t i, uint32_t row, uint32_t slice) {
    size_t index = ((size_t)slice * fill->block->rows + row) * fill->f->dims[0] + i;
    return fill->samples + index * sample_size(fill->type);
}

/* Fill one strip of a row in every slice of the block. */
static void fill_strips(const filling *fill, uint32_t i, uint32_t row) {
    const field *f = fill->f;
    const analytic *a = &f->formula;
    uint32_t left = f->dims[0] - i;
    analytic_strip s = {.i = i,
                        .width = left < ANALYTIC_STRIP ? left : ANALYTIC_STRIP,
                        .j = fill->block->row + row};
    double shared[ANALYTIC_STRIP], values[ANALYTIC_STRIP];
    if (a->kind->prepare)
        a->kind->prepare(a, &s, shared);
    for (uint32_t slice = 0; slice < fill->block->slices; slice++) {
        s.k = fill->block->slice + slice;
        a->kind->evaluate(a, &s, shared, values);
        field_quantise(f->lo, f->hi, fill->type, values, s.width, sample_at(fill, i, row, slice));
    }
}

static status fill_row(void *ctx, size_t row, int worker) {
    (void)worker;
    const filling *fill = ctx;
    for (uint32_t i = 0; i < fill->f->dims[0]; i += ANALYTIC_STRIP)
        fill_strips(fill, i, (uint32_t)row);
    return ST_OK;
}

/* Make the samples of one slice from the attractor's counts of orbit points. */
static status convert_slice(void *ctx, size_t slice, int worker) {
    (void)worker;
    const filling *fill = ctx;
    const field *f = fill->f;
    size_t size = (size_t)fill->block->rows * f->dims[0], first = slice * size;
    for (size_t done = 0; done < size; done += ANALYTIC_STRIP) {
        double values[ANALYTIC_STRIP];
        size_t part = size - done < ANALYTIC_STRIP ? size - done : ANALYTIC_STRIP;
        attractor_values(f->orbits, first + done, part, values);
        field_quantise(f->lo, f->hi, fill->type, values, part,
                       fill->samples + (first + done) * sample_size(fill->type));
    }
    return ST_OK;
}

status field_fill(field *f, pool *p, const field_block *block, sample_type type, void *samples) {
    filling fill = {.f = f, .block = block, .type = type, .samples = samples};
    if (!f->orbits)
        return pool_run(p, block->rows, fill_row, &fill);
    status st = attractor_count(f->orbits, p, block);
    return st == ST_OK ? pool_run(p, block->slices, convert_slice, &fill) : st;
}
