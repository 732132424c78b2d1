/* tool_tet_oracle.c - compare an image of distances (render --depth-f64) of a tetrahedral mesh with
 * the reference, pixel by pixel.
 *
 *   tet_oracle MESH --depth FILE --size WxH --iso V [--iso V]... [options]
 *   tet_oracle --points FILE --values FILE --tets FILE ...
 *
 * MESH is a mesh stream (formats/MESH_STREAM.md); the second form takes raw arrays, plain or .zst:
 * tests/support/tet_load.h. The other options, camera and clips and the choice of pixels:
 * tests/support/oracle.h.
 *
 * Prints a table; a line that reruns it for each pixel that is wrong. Exit status 1 if, outside the
 * grazing band, a surface is missed, false, or more than 1e-5 of the local edge off (tet_judge.h).
 */
#include <string.h>

#include "tests/support/oracle.h"
#include "tests/support/tet_judge.h"
#include "tests/support/tet_load.h"

enum { POINTS = ORACLE_OPTIONS_END, VALUES, TETS };

static const struct option options[] = {
    ORACLE_OPTIONS,          {"points", 1, NULL, POINTS}, {"values", 1, NULL, VALUES},
    {"tets", 1, NULL, TETS}, {NULL, 0, NULL, 0},
};

static oracle o;

static void set_arrays(void *ctx, int option) {
    tet_arrays *from = ctx;
    *(option == POINTS ? &from->points : option == VALUES ? &from->values : &from->tets) = optarg;
}

static ref_verdict judge(const void *ctx, const oracle *of, const ref_ray *ray, double depth,
                         ref_tally *tally) {
    return tet_judge_pixel(tally, ctx, ray, of->isos, of->iso_count, &of->clip, depth);
}

static size_t trace(const void *ctx, const oracle *of, const ref_ray *ray, ref_hit *hits,
                    size_t capacity) {
    return tet_ref_trace(ctx, ray, of->isos, of->iso_count, &of->clip, hits, capacity);
}

int main(int argc, char **argv) {
    tet_arrays from = {0};
    tet_ref_mesh mesh;
    const char *why;
    int at = oracle_parse(&o, "tool_tet_oracle", argc, argv, options, set_arrays, &from);
    bool arrays = from.points && from.values && from.tets;
    if (at != argc - !arrays)
        oracle_stop(2, o.name, "MESH", "one, or three arrays (see tests/tools/tool_tet_oracle.c)");
    const char *path = arrays ? from.values : argv[at];
    if (!(arrays ? tet_load_arrays(&from, &mesh, &why) : tet_load_stream(path, &mesh, &why)))
        oracle_stop(3, o.name, path, why);
    tet_ref *reference = tet_ref_create(&mesh);
    if (!reference)
        oracle_stop(4, o.name, path, "no room");
    const char *slash = strrchr(path, '/');
    oracle_reference r = {
        .ctx = reference, .title = slash ? slash + 1 : path, .judge = judge, .trace = trace};
    tet_load_box(&mesh, r.lower, r.upper);
    int code = oracle_run(&o, &r);
    tet_ref_destroy(reference);
    tet_unload(&mesh);
    return code;
}
