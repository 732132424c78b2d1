#include "prep/import/dicom/dicom_slices.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "prep/import/dicom/dicom_order.h"
#include "prep/import/packed_samples.h"

typedef struct dicom_slices {
    mem *m;
    dicom_study study;
    uint32_t series;     /* the chosen one */
    dicom_image image;   /* of that series */
    dicom_slice *slices; /* slices of the grid, in order */
    size_t count;
    packed_samples packed; /* scale and offset are set for each slice */
    uint8_t *buffer;       /* twice the bytes of a stored frame */
    size_t frame_bytes;
    dicom_reader *reader; /* open on reader_file */
    uint32_t reader_file;
} dicom_slices;

static void close_slices(void *ctx) {
    dicom_slices *s = ctx;
    dicom_reader_close(s->reader);
    mem_free(s->m, s->buffer);
    mem_free(s->m, s->slices);
    dicom_study_release(&s->study);
    mem_free(s->m, s);
}

/* ---- the type ---- */

static sample_type stored_type(const dicom_image *i) {
    switch (i->allocated) {
    case 8: return i->is_signed ? SAMPLE_I8 : SAMPLE_U8;
    case 16: return i->is_signed ? SAMPLE_I16 : SAMPLE_U16;
    default: return i->is_signed ? SAMPLE_I32 : SAMPLE_U32;
    }
}

/* Widen [least, most] by the values that a slice may have. */
static void value_range(const dicom_image *i, const dicom_place *p, double *least, double *most) {
    const double low = i->is_signed ? -ldexp(1, (int)i->stored - 1) : 0;
    const double high = ldexp(1, (int)i->stored - i->is_signed) - 1;
    const double a = low * p->slope + p->intercept, b = high * p->slope + p->intercept;
    *least = fmin(*least, fmin(a, b));
    *most = fmax(*most, fmax(a, b));
}

static bool is_whole(double v) {
    return v == rint(v);
}

/* Choose the samples' type. If nothing is scaled: the stored type. Else i16 or u16 if all values
 * are whole and fit, judged by their bits. Else floats. */
static sample_type value_type(const dicom_slices *s) {
    bool plain = true, whole = true;
    double least = 0, most = 0;
    for (size_t i = 0; i < s->count; i++) {
        const dicom_place *p = &s->slices[i].place;
        plain = plain && p->slope == 1 && p->intercept == 0;
        whole = whole && is_whole(p->slope) && is_whole(p->intercept);
        value_range(&s->image, p, &least, &most);
    }
    if (plain)
        return stored_type(&s->image);
    if (whole && least >= INT16_MIN && most <= INT16_MAX)
        return SAMPLE_I16;
    if (whole && least >= 0 && most <= UINT16_MAX)
        return SAMPLE_U16;
    return s->image.allocated <= 16 ? SAMPLE_F32 : SAMPLE_F64;
}

static status choose_type(dicom_slices *s, const import_request *q) {
    const dicom_image *i = &s->image;
    packed_init(&s->packed, stored_type(i), PACKED_NARROW);
    if (q->component > i->samples)
        return status_describe(ST_USAGE, "%s: --component %u: it has %u", q->paths[0], q->component,
                               i->samples);
    s->packed.components = i->samples;
    s->packed.component = i->samples > 1 ? q->component : 0;
    if (i->samples == 1)
        s->packed.out = value_type(s);
    return ST_OK;
}

/* ---- reading ---- */

/* Numbers with fewer bits than their storage: clear the other bits, or extend the sign. */
#define TRIM_ALL(type)                                               \
    for (size_t i = 0; i < count; i++) {                             \
        type v;                                                      \
        memcpy(&v, (char *)numbers + i * sizeof v, sizeof v);        \
        v = (type)((uint32_t)v << (8 * sizeof v - 1 - image->high)); \
        v = (type)(v >> (8 * sizeof v - image->stored));             \
        memcpy((char *)numbers + i * sizeof v, &v, sizeof v);        \
    }

static void trim(const dicom_image *image, void *numbers, size_t count) {
    if (image->stored == image->allocated)
        return;
    switch (stored_type(image)) {
    case SAMPLE_U8: TRIM_ALL(uint8_t) break;
    case SAMPLE_I8: TRIM_ALL(int8_t) break;
    case SAMPLE_U16: TRIM_ALL(uint16_t) break;
    case SAMPLE_I16: TRIM_ALL(int16_t) break;
    case SAMPLE_U32: TRIM_ALL(uint32_t) break;
    default: TRIM_ALL(int32_t) break;
    }
}

static status read_stored(dicom_slices *s, const dicom_slice *slice) {
    status st = ST_OK;
    if (s->reader && s->reader_file != slice->file) {
        dicom_reader_close(s->reader);
        s->reader = NULL;
    }
    if (!s->reader)
        st = dicom_reader_open(s->study.files.path[slice->file], &s->reader);
    s->reader_file = slice->file;
    if (st == ST_OK)
        st = dicom_reader_frame(s->reader, slice->frame, s->buffer, s->frame_bytes);
    return st;
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    dicom_slices *s = ctx;
    const size_t samples = (size_t)s->image.columns * s->image.rows;
    const size_t bytes = samples * sample_size(packed_type(&s->packed));
    for (uint32_t i = 0; i < count; i++) {
        const dicom_slice *slice = &s->slices[first + i];
        status st = read_stored(s, slice);
        if (st != ST_OK)
            return st;
        trim(&s->image, s->buffer, samples * s->image.samples);
        packed_samples packed = s->packed;
        if (s->image.samples == 1) {
            packed.scale = slice->place.slope;
            packed.offset = slice->place.intercept;
        }
        packed_unpack(&packed, s->buffer, (char *)slices + i * bytes, samples);
    }
    return ST_OK;
}

/* ---- opening ---- */

static status create(mem *m, const import_request *q, dicom_slices **out) {
    dicom_slices *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    status st = dicom_study_read(m, q->paths, q->path_count, &s->study);
    if (st != ST_OK) {
        close_slices(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

/* Get the slices of the series that was asked for. */
static status choose(dicom_slices *s, const import_request *q) {
    uint32_t series = 0;
    status st = dicom_study_choose(&s->study, q, &series);
    if (st != ST_OK)
        return st;
    const dicom_series *chosen = &s->study.series[series];
    s->series = series;
    s->image = chosen->image;
    if (s->image.refuse[0] || chosen->slices == 0)
        return status_describe(ST_UNSUPPORTED, "%s: series %s cannot be read: %s",
                               s->study.files.path[chosen->file], s->image.series,
                               s->image.refuse[0] ? s->image.refuse : "no slices");
    s->slices = mem_array(s->m, chosen->slices, sizeof *s->slices);
    for (size_t i = 0; s->slices && i < s->study.slice_count; i++)
        if (s->study.slices[i].series == series)
            s->slices[s->count++] = s->study.slices[i];
    return s->slices ? ST_OK : ST_NOMEM;
}

static status make_grid(dicom_slices *s, const import_request *q, bool gaps, grid *g) {
    const uint32_t dims[3] = {s->image.columns, s->image.rows, 1};
    grid_init(g, dims, SAMPLE_U8);
    text_name(g->name, sizeof g->name,
              s->image.description[0] ? s->image.description : s->image.modality);
    status st = dicom_order(&s->study, s->slices, s->count, q->step, gaps, g, &s->count);
    if (st == ST_OK)
        st = choose_type(s, q);
    g->type = packed_type(&s->packed);
    return st == ST_OK ? grid_check(g, q->paths[0]) : st;
}

/* A pixel of several segments keeps the least number. Note how often that happens. */
static status note_overlaps(dicom_slices *s, grid *g) {
    const char *path = s->study.files.path[s->slices[0].file];
    dicom_reader *r = NULL;
    uint64_t pixels = 0;
    if (s->image.segments < 2)
        return ST_OK;
    status st = dicom_reader_open(path, &r);
    if (st == ST_OK)
        st = dicom_reader_overlaps(r, &pixels);
    dicom_reader_close(r);
    if (st == ST_OK && pixels)
        snprintf(g->note, sizeof g->note,
                 "segments overlap, %llu times at a pixel, which has the least of their numbers",
                 (unsigned long long)pixels);
    return st;
}

static status make_room(dicom_slices *s) {
    s->frame_bytes =
        (size_t)s->image.columns * s->image.rows * s->image.samples * (s->image.allocated / 8);
    s->buffer = mem_alloc(s->m, 2 * s->frame_bytes + 2);
    return s->buffer ? ST_OK : ST_NOMEM;
}

status dicom_slices_open(mem *m, const import_request *q, bool gaps, slice_source *out) {
    dicom_slices *s = NULL;
    grid g = {0};
    status st = create(m, q, &s);
    if (st != ST_OK)
        return st;
    st = choose(s, q);
    if (st == ST_OK)
        st = make_grid(s, q, gaps, &g);
    if (st == ST_OK)
        st = make_room(s);
    if (st == ST_OK)
        st = note_overlaps(s, &g);
    if (st != ST_OK) {
        grid_release(&g, m);
        close_slices(s);
        return st;
    }
    *out = (slice_source){.format = "DICOM",
                          .name = q->paths[0],
                          .m = m,
                          .g = g,
                          .read = read_slices,
                          .close = close_slices,
                          .ctx = s};
    return ST_OK;
}

/* Number of steps in the series that would be read; 0: none would. */
static uint32_t steps_of_choice(dicom_slices *s, const import_request *q) {
    grid g = {0};
    status st = choose(s, q);
    const size_t slices = s->count;
    if (st == ST_OK)
        st = make_grid(s, q, true, &g);
    grid_release(&g, s->m);
    return st == ST_OK && s->count > 0 ? (uint32_t)(slices / s->count) : 0;
}

status dicom_slices_list(mem *m, const import_request *q, const import_list *to) {
    dicom_slices *s = NULL;
    status st = create(m, q, &s);
    if (st != ST_OK)
        return st;
    const uint32_t steps = steps_of_choice(s, q);
    for (size_t i = 0; i < s->study.series_count && st == ST_OK; i++) {
        const dicom_series *one = &s->study.series[i];
        import_item item = {.name = one->image.series,
                            .type = one->type,
                            .shape = {one->image.columns, one->image.rows, one->slices},
                            .refuse = one->image.refuse[0] ? one->image.refuse : NULL,
                            .taken = steps > 0 && i == s->series,
                            .components = one->image.samples,
                            .component = q->component,
                            .colours = one->image.samples == 3};
        if (item.taken && steps > 1) {
            item.shape[2] = one->slices / steps;
            item.shape[3] = steps;
        }
        st = to->take(to->ctx, &item);
    }
    close_slices(s);
    return st;
}
