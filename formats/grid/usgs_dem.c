#include "formats/grid/usgs_dem.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"

enum {
    RECORD = 1024,
    USED = 1020, /* of a record: the rest is blank */
    WORD = 6,
    FLOAT = 12,
    DOUBLE = 24,
    NONE = -32767
};

/* Columns of record A, from 0. */
enum {
    AT_SYSTEM = 156,
    AT_PLANE_UNIT = 528,
    AT_HEIGHT_UNIT = 534,
    AT_ANGLE = 786,
    AT_STEPS = 816,
    AT_ROWS = 852,
    AT_PROFILES = 858,
    AT_END = 864
};

/* Columns of a profile's first record. */
enum { AT_COUNT = 12, AT_WIDTH = 18, AT_FIRST = 24, AT_DATUM = 72, AT_HEIGHTS = 144 };

typedef enum plane_unit { RADIANS, FEET, METRES, ARC_SECONDS, PLANE_UNITS } plane_unit;
static const struct {
    const char *name;
    double factor; /* 0: not read */
} plane_units[PLANE_UNITS] = {{"", 0}, {"ft", 1}, {"m", 1}, {"degree", 1.0 / 3600.0}};

typedef struct profile {
    int64_t first; /* row of the southernmost node, counted from the first profile's */
    size_t at;     /* of its heights */
    uint32_t count;
} profile;

typedef struct dem {
    mem *m;
    byte_stream *data;
    const char *name;
    char record[RECORD + 1];
    int64_t plane, up, rows, profiles;
    double steps[3], angle;
    double first[2]; /* the southernmost node of the first profile */
    profile *of;
    float *heights;
    size_t count, room;
    int64_t lowest, highest; /* rows */
} dem;

static void dem_free(dem *d) {
    mem *m = d->m;
    byte_stream_close(d->data);
    mem_free(m, d->of);
    mem_free(m, d->heights);
    mem_free(m, d);
}

/* ---- records ---- */

/* Read the next record, without line ends in front of it. */
static status next_record(dem *d) {
    const uint8_t *start;
    size_t size, got = 0;
    status st = byte_stream_peek(d->data, 2, &start, &size);
    while (st == ST_OK && size > 0 && (*start == '\n' || *start == '\r')) {
        byte_stream_take(d->data, 1);
        st = byte_stream_peek(d->data, 2, &start, &size);
    }
    if (st == ST_OK)
        st = byte_stream_read(d->data, d->record, RECORD, &got);
    memset(d->record + got, ' ', RECORD - got);
    d->record[RECORD] = 0;
    if (st == ST_OK && got == 0)
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu, before its last profile",
                               d->name, (unsigned long long)byte_stream_position(d->data));
    return st;
}

static status bad_field(const dem *d, const char *what, const char *found) {
    return status_describe(ST_CORRUPT,
                           "%s: the record that ends at byte %llu: expected %s, found \"%s\"",
                           d->name, (unsigned long long)byte_stream_position(d->data), what, found);
}

/* Copy a field without the blanks around it. */
static void take_field(const dem *d, int at, int width, char out[DOUBLE + 1]) {
    const char *from = d->record + at, *end = from + width;
    while (from < end && *from == ' ')
        from++;
    while (end > from && end[-1] == ' ')
        end--;
    memcpy(out, from, (size_t)(end - from));
    out[end - from] = 0;
}

static status take_int(const dem *d, int at, const char *what, int64_t *out) {
    char text[DOUBLE + 1];
    take_field(d, at, WORD, text);
    return num_int(text, what, INT32_MIN, INT32_MAX, out) == ST_OK ? ST_OK
                                                                   : bad_field(d, what, text);
}

/* Read a number whose exponent Fortran may have written with a D. */
static status take_double(const dem *d, int at, int width, const char *what, double *out) {
    char text[DOUBLE + 1];
    take_field(d, at, width, text);
    char *exponent = strpbrk(text, "Dd");
    if (exponent)
        *exponent = 'e';
    if (num_double(text, what, out) == ST_OK && isfinite(*out))
        return ST_OK;
    return bad_field(d, what, text);
}

/* ---- record A ---- */

static status check_head(const dem *d) {
    if (d->plane < 0 || d->plane >= PLANE_UNITS || plane_units[d->plane].factor == 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: expected a plane of feet (1), metres (2) or arc-seconds (3), "
                               "found %lld",
                               d->name, (long long)d->plane);
    if (d->up != FEET && d->up != METRES)
        return status_describe(ST_CORRUPT,
                               "%s: expected elevations in feet (1) or metres (2), found %lld",
                               d->name, (long long)d->up);
    for (int a = 0; a < 3; a++)
        if (!(d->steps[a] > 0))
            return status_describe(ST_CORRUPT, "%s: expected three resolutions above 0", d->name);
    if (d->rows != 1 || d->profiles < 2 || d->profiles > GRID_DIM_MAX)
        return status_describe(ST_CORRUPT,
                               "%s: expected a row of 2 to %d profiles, found %lld rows of %lld",
                               d->name, GRID_DIM_MAX, (long long)d->rows, (long long)d->profiles);
    return ST_OK;
}

static status read_head(dem *d) {
    int64_t system; /* projections are not looked into */
    status st = next_record(d);
    if (st == ST_OK)
        st = take_int(d, AT_SYSTEM, "the number of a reference system", &system);
    if (st == ST_OK)
        st = take_int(d, AT_PLANE_UNIT, "the unit of the plane", &d->plane);
    if (st == ST_OK)
        st = take_int(d, AT_HEIGHT_UNIT, "the unit of elevations", &d->up);
    if (st == ST_OK)
        st = take_double(d, AT_ANGLE, DOUBLE, "an angle", &d->angle);
    for (int a = 0; a < 3 && st == ST_OK; a++)
        st = take_double(d, AT_STEPS + a * FLOAT, FLOAT, "a resolution", &d->steps[a]);
    if (st == ST_OK)
        st = take_int(d, AT_ROWS, "1 row of profiles", &d->rows);
    if (st == ST_OK)
        st = take_int(d, AT_PROFILES, "the number of profiles", &d->profiles);
    return st == ST_OK ? check_head(d) : st;
}

/* ---- profiles ---- */

/* Take the heights of a profile, which go on in further records. */
static status take_heights(dem *d, uint32_t count, double datum) {
    int at = AT_HEIGHTS;
    status st = ST_OK;
    for (uint32_t i = 0; i < count && st == ST_OK; i++, at += WORD) {
        int64_t height = 0;
        if (at + WORD > USED) {
            st = next_record(d);
            at = 0;
        }
        if (st == ST_OK)
            st = take_int(d, at, "an elevation", &height);
        if (st == ST_OK)
            st = mem_grow(d->m, &d->heights, sizeof *d->heights, d->count, 1 << 16, &d->room);
        if (st == ST_OK)
            d->heights[d->count++] =
                height == NONE ? NAN : (float)(datum + (double)height * d->steps[2]);
    }
    return st;
}

static status read_profile(dem *d, uint32_t i) {
    int64_t count, width;
    double first[2], datum;
    status st = next_record(d);
    if (st == ST_OK)
        st = take_int(d, AT_COUNT, "the elevations of a profile", &count);
    if (st == ST_OK)
        st = take_int(d, AT_WIDTH, "1 column", &width);
    for (int a = 0; a < 2 && st == ST_OK; a++)
        st = take_double(d, AT_FIRST + a * DOUBLE, DOUBLE, "the place of a profile", &first[a]);
    if (st == ST_OK)
        st = take_double(d, AT_DATUM, DOUBLE, "a local datum", &datum);
    if (st != ST_OK)
        return st;
    if (i == 0)
        memcpy(d->first, first, sizeof first);
    const double row = rint((first[1] - d->first[1]) / d->steps[1]);
    const double column = rint((first[0] - d->first[0]) / d->steps[0]);
    if (count < 1 || count > GRID_DIM_MAX || width != 1 || column != i ||
        !(fabs(row) <= GRID_DIM_MAX))
        return status_describe(ST_CORRUPT,
                               "%s: profile %u (counted from 0): expected one column of 1 to %d "
                               "elevations, %u steps east of the first",
                               d->name, i, GRID_DIM_MAX, i);
    d->of[i] = (profile){(int64_t)row, d->count, (uint32_t)count};
    const int64_t last = (int64_t)row + count - 1;
    d->lowest = i == 0 || d->of[i].first < d->lowest ? d->of[i].first : d->lowest;
    d->highest = i == 0 || last > d->highest ? last : d->highest;
    return take_heights(d, (uint32_t)count, datum);
}

static status read_all(dem *d) {
    status st = read_head(d);
    if (st == ST_OK && !(d->of = mem_array(d->m, (size_t)d->profiles, sizeof *d->of)))
        st = ST_NOMEM;
    for (uint32_t i = 0; st == ST_OK && i < (uint32_t)d->profiles; i++)
        st = read_profile(d, i);
    return st;
}

/* ---- a grid of one slice ---- */

static void describe(const dem *d, grid *g) {
    const uint32_t dims[3] = {(uint32_t)d->profiles, (uint32_t)(d->highest - d->lowest + 1), 1};
    const double factor = plane_units[d->plane].factor;
    grid_init(g, dims, SAMPLE_F32);
    g->to_world[0][0] = d->steps[0] * factor;
    g->to_world[1][1] = -d->steps[1] * factor;
    g->to_world[0][3] = d->first[0] * factor;
    g->to_world[1][3] = (d->first[1] + (double)d->highest * d->steps[1]) * factor;
    for (int a = 0; a < 3; a++)
        world_frame_set_unit(&g->frame, a, plane_units[a < 2 ? d->plane : d->up].name);
    g->terrain = true;
    if (d->angle != 0)
        snprintf(g->note, sizeof g->note, "its axes are turned by %g, which is not applied",
                 d->angle);
}

static status read_slice(void *ctx, uint32_t first, uint32_t count, void *slices) {
    const dem *d = ctx;
    float *to = slices;
    const size_t wide = (size_t)d->profiles, rows = (size_t)(d->highest - d->lowest + 1);
    (void)first, (void)count;
    for (size_t i = 0; i < wide * rows; i++)
        to[i] = NAN;
    for (size_t x = 0; x < wide; x++)
        for (uint32_t k = 0; k < d->of[x].count; k++)
            to[(size_t)(d->highest - d->of[x].first - k) * wide + x] = d->heights[d->of[x].at + k];
    return ST_OK;
}

static void close_dem(void *ctx) {
    dem_free(ctx);
}

static status open_slices(volume_layout *l, const volume_hints *hints, slice_source *out) {
    dem *d = mem_zalloc(l->m, sizeof *d);
    (void)hints;
    if (!d)
        return ST_NOMEM;
    d->m = l->m;
    d->data = l->data;
    d->name = byte_stream_name(l->data);
    l->data = NULL;
    *out = (slice_source){
        .name = d->name, .m = l->m, .read = read_slice, .close = close_dem, .ctx = d};
    status st = read_all(d);
    if (st != ST_OK)
        return st;
    describe(d, &out->g);
    return grid_check(&out->g, d->name);
}

/* Other elevations have the suffix, too, as raw numbers. */
static bool known(const char *path, const uint8_t *start, size_t size) {
    bool printed = text_ends_in(path, ".dem") || text_ends_in(path, ".DEM");
    for (size_t i = 0; i < size && i < AT_END && printed; i++)
        printed = isprint(start[i]) || isspace(start[i]);
    return printed;
}

const grid_reader usgs_dem_reader = {.format = "USGS DEM", .known = known, .slices = open_slices};
