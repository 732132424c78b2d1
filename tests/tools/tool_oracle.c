/* tool_oracle.c - compare an image of distances (render --depth-f64) with the reference, pixel by
 * pixel.
 *
 *   oracle VOLUME --depth FILE --size WxH --iso V [--iso V]... [options]
 *
 * VOLUME is a plain NRRD file, or raw samples with --dims X,Y,Z --type
 * u8|i8|u16|i16|u32|i32|f32|f64 [--skip BYTES] [--big]
 * [--spacing X,Y,Z] [--origin X,Y,Z]; node coordinates of a rectilinear one come from --axis-x, -y,
 * -z FILE. The other options, camera and clips and the choice of pixels: tests/support/oracle.h.
 *
 * Prints a table; a line that reruns it for each pixel that is wrong. Exit status 1 if, outside the
 * grazing band, a surface is missed, false, or more than 1e-4 cell off.
 */
#include <stdlib.h>
#include <string.h>

#include "tests/support/oracle.h"
#include "tests/support/ref_load.h"

enum { DIMS = ORACLE_OPTIONS_END, TYPE, SKIP, BIG, SPACING, ORIGIN, AXIS_X, AXIS_Y, AXIS_Z };

static const struct option options[] = {
    ORACLE_OPTIONS,
    {"dims", 1, NULL, DIMS},
    {"type", 1, NULL, TYPE},
    {"skip", 1, NULL, SKIP},
    {"big", 0, NULL, BIG},
    {"spacing", 1, NULL, SPACING},
    {"origin", 1, NULL, ORIGIN},
    {"axis-x", 1, NULL, AXIS_X},
    {"axis-y", 1, NULL, AXIS_Y},
    {"axis-z", 1, NULL, AXIS_Z},
    {NULL, 0, NULL, 0},
};

static oracle o;

typedef struct source {
    ref_source from;
    double spacing[3], origin[3];
} source;

static void set_source(void *ctx, int option) {
    source *s = ctx;
    double n[3];
    switch (option) {
    case DIMS:
        oracle_numbers(&o, optarg, 3, n);
        for (int a = 0; a < 3; a++)
            s->from.dims[a] = (long)n[a];
        break;
    case TYPE: s->from.type = optarg; break;
    case SKIP: s->from.skip = atol(optarg); break;
    case BIG: s->from.big_endian = true; break;
    case SPACING: oracle_numbers(&o, optarg, 3, s->spacing); break;
    case ORIGIN: oracle_numbers(&o, optarg, 3, s->origin); break;
    default: s->from.axis_path[option - AXIS_X] = optarg; break;
    }
}

static ref_verdict judge(const void *ctx, const oracle *of, const ref_ray *ray, double depth,
                         ref_tally *tally) {
    return ref_judge(tally, ctx, ray, of->isos, of->iso_count, &of->clip, depth);
}

static size_t trace(const void *ctx, const oracle *of, const ref_ray *ray, ref_hit *hits,
                    size_t capacity) {
    return ref_trace(ctx, ray, of->isos, of->iso_count, &of->clip, hits, capacity);
}

int main(int argc, char **argv) {
    source s = {.spacing = {1, 1, 1}};
    ref_volume volume;
    const char *why;
    int at = oracle_parse(&o, "tool_oracle", argc, argv, options, set_source, &s);
    if (at != argc - 1)
        oracle_stop(2, o.name, "VOLUME", "one, please (see the head of tests/tools/tool_oracle.c)");
    s.from.path = argv[at];
    ref_source_set(&s.from, s.spacing, s.origin);
    if (!ref_load(&s.from, &volume, &why))
        oracle_stop(3, o.name, s.from.path, why);
    const char *slash = strrchr(s.from.path, '/');
    oracle_reference r = {
        .ctx = &volume, .title = slash ? slash + 1 : s.from.path, .judge = judge, .trace = trace};
    ref_world_box(&volume, r.lower, r.upper);
    int code = oracle_run(&o, &r);
    ref_unload(&volume);
    return code;
}
