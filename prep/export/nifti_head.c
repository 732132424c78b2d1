#include "prep/export/nifti_head.h"

#include <endian.h>
#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"

enum { BYTES1 = 348, BYTES2 = 540, EXTENSION = 4, DIM_MAX1 = 32767, ALIGNED = 2 };

static void put16(unsigned char *at, int value) {
    const uint16_t little = htole16((uint16_t)value);
    memcpy(at, &little, sizeof little);
}

static void put32(unsigned char *at, int32_t value) {
    const uint32_t little = htole32((uint32_t)value);
    memcpy(at, &little, sizeof little);
}

static void put64(unsigned char *at, int64_t value) {
    const uint64_t little = htole64((uint64_t)value);
    memcpy(at, &little, sizeof little);
}

static void put_float(unsigned char *at, double value) {
    const float rounded = (float)value;
    int32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    put32(at, bits);
}

static void put_double(unsigned char *at, double value) {
    int64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put64(at, bits);
}

static int type_code(sample_type type) {
    switch (type) {
    case SAMPLE_U8: return 2;
    case SAMPLE_I8: return 256;
    case SAMPLE_U16: return 512;
    case SAMPLE_I16: return 4;
    default: return 16;
    }
}

/* Turn the grid to RAS, the world of NIfTI. A grid without LPS or RAS stays as it is. */
static grid in_ras(const grid *g) {
    grid turned = *g;
    (void)world_axes_turn(g->frame.axes, WORLD_RAS, turned.to_world);
    return turned;
}

/* Number of the unit of all three axes in xyzt_units; 0: it has none. */
static int unit_code(const grid *g) {
    static const char *const names[] = {"", "m", "mm", "um"};
    int code = (int)(sizeof names / sizeof *names) - 1;
    while (code > 0 && strcmp(world_frame_unit(&g->frame), names[code]) != 0)
        code--;
    return code;
}

/* The same for times. Seconds are not assumed if the file tells no unit. */
static int time_code(const sample_times *times) {
    static const char *const names[] = {"s", "ms", "us"};
    for (int i = 0; i < (int)(sizeof names / sizeof *names); i++)
        if (strcmp(times->unit, names[i]) == 0)
            return 8 * (i + 1);
    return 0;
}

static double spacing(const grid *g, int a) {
    const double column[3] = {g->to_world[0][a], g->to_world[1][a], g->to_world[2][a]};
    return vec3_length(column);
}

status nifti_check2(const grid *g) {
    if (!grid_is_rectilinear(g))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "NIfTI has samples at equal distances; this grid's axes are uneven, "
                           "which .vtr and .nrrd can hold");
}

status nifti_check1(const grid *g) {
    for (int a = 0; a < 3; a++)
        if (g->dims[a] > DIM_MAX1)
            return status_describe(ST_UNSUPPORTED,
                                   "NIfTI-1 holds up to %d samples an axis, here are %u along %c: "
                                   "--format nifti2",
                                   DIM_MAX1, g->dims[a], "xyz"[a]);
    for (int row = 0; row < 3; row++)
        for (int a = 0; a < 4; a++)
            if (!isfinite((float)g->to_world[row][a]))
                return status_describe(ST_UNSUPPORTED,
                                       "the grid lies beyond the floats of NIfTI-1: "
                                       "--format nifti2");
    return nifti_check2(g);
}

bool nifti_exact1(const grid *g) {
    bool exact = true;
    for (int row = 0; row < 3; row++)
        for (int a = 0; a < 4; a++)
            exact &= (double)(float)g->to_world[row][a] == g->to_world[row][a];
    for (int a = 0; a < 3; a++)
        exact &= g->dims[a] <= DIM_MAX1;
    return exact;
}

static status write_head1(out_stream *out, const grid *g, const sample_times *times) {
    unsigned char h[BYTES1 + EXTENSION] = {0};
    const grid ras = in_ras(g);
    put32(h, BYTES1);
    put16(h + 40, times ? 4 : 3);
    put_float(h + 76, 1);
    for (int a = 0; a < 3; a++) {
        put16(h + 42 + 2 * a, (int)g->dims[a]);
        put_float(h + 80 + 4 * a, spacing(g, a));
        for (int c = 0; c < 4; c++)
            put_float(h + 280 + 16 * a + 4 * c, ras.to_world[a][c]);
    }
    for (int i = 4; i < 8; i++)
        put16(h + 40 + 2 * i, 1);
    put16(h + 70, type_code(g->type));
    put16(h + 72, 8 * (int)sample_size(g->type));
    put_float(h + 108, BYTES1 + EXTENSION);
    put_float(h + 112, 1);
    h[123] = (unsigned char)unit_code(g);
    memcpy(h + 148, g->name, strlen(g->name));
    put16(h + 254, ALIGNED);
    memcpy(h + 344, "n+1", 4);
    if (times) {
        put16(h + 48, (int)times->steps);
        put_float(h + 92, times->apart);
        put_float(h + 136, times->first);
        h[123] |= (unsigned char)time_code(times);
    }
    return out_stream_write(out, h, sizeof h);
}

static status write_head2(out_stream *out, const grid *g, const sample_times *times) {
    unsigned char h[BYTES2 + EXTENSION] = {0};
    const grid ras = in_ras(g);
    put32(h, BYTES2);
    memcpy(h + 4, "n+2\0\r\n\032\n", 8);
    put16(h + 12, type_code(g->type));
    put16(h + 14, 8 * (int)sample_size(g->type));
    put64(h + 16, times ? 4 : 3);
    put_double(h + 104, 1);
    for (int a = 0; a < 3; a++) {
        put64(h + 24 + 8 * a, g->dims[a]);
        put_double(h + 112 + 8 * a, spacing(g, a));
        for (int c = 0; c < 4; c++)
            put_double(h + 400 + 32 * a + 8 * c, ras.to_world[a][c]);
    }
    for (int i = 4; i < 8; i++)
        put64(h + 16 + 8 * i, 1);
    put64(h + 168, BYTES2 + EXTENSION);
    put_double(h + 176, 1);
    put32(h + 500, unit_code(g) | (times ? time_code(times) : 0));
    memcpy(h + 240, g->name, strlen(g->name));
    put32(h + 348, ALIGNED);
    if (times) {
        put64(h + 48, times->steps);
        put_double(h + 136, times->apart);
        put_double(h + 216, times->first);
    }
    return out_stream_write(out, h, sizeof h);
}

status nifti_head1(mem *m, out_stream *out, const grid *g) {
    (void)m;
    return write_head1(out, g, NULL);
}

status nifti_head2(mem *m, out_stream *out, const grid *g) {
    (void)m;
    return write_head2(out, g, NULL);
}

status nifti_head(mem *m, out_stream *out, const grid *g) {
    return nifti_exact1(g) ? nifti_head1(m, out, g) : nifti_head2(m, out, g);
}

status nifti_head1_steps(mem *m, out_stream *out, const grid *g, const sample_times *times) {
    (void)m;
    if (times->steps > DIM_MAX1)
        return status_describe(ST_UNSUPPORTED,
                               "NIfTI-1 holds up to %d steps, here are %u: --format nifti2",
                               DIM_MAX1, times->steps);
    return write_head1(out, g, times);
}

status nifti_head2_steps(mem *m, out_stream *out, const grid *g, const sample_times *times) {
    (void)m;
    return write_head2(out, g, times);
}

status nifti_head_steps(mem *m, out_stream *out, const grid *g, const sample_times *times) {
    const bool one = nifti_exact1(g) && times->steps <= DIM_MAX1;
    return one ? nifti_head1_steps(m, out, g, times) : nifti_head2_steps(m, out, g, times);
}

const char *nifti_head_loses_times(const sample_times *times) {
    if (times->uneven)
        return "the steps are at uneven times, which NIfTI cannot say: they count 0, 1, .. there";
    if (times->unit[0] && !time_code(times))
        return "NIfTI has no number for the unit of times: they are without one";
    return NULL;
}
