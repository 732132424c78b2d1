#include "prep/prep_arguments.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "formats/grid/grid.h"
#include "formats/leaf/leaf.h"
#include "formats/leaf/mixed_geometry.h"
#include "formats/mesh/mesh_input.h"
#include "formats/mesh/mesh_stream.h"

enum { ZSTD_LEVEL_MAX = 22 };

/* ---- How to convert ---- */

static const public_field options_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_convert_options),
    PUBLIC_NUMBER(leafcast_convert_options, memory, 0, (double)UINT64_MAX, 0),
    PUBLIC_NUMBER(leafcast_convert_options, threads, 0, LEAFCAST_THREADS_MAX, 0),
    PUBLIC_FLAG(leafcast_convert_options, replace),
    PUBLIC_NUMBER(leafcast_convert_options, zstd_level, 0, ZSTD_LEVEL_MAX, 0),
    PUBLIC_FLAG(leafcast_convert_options, allow_empty),
    PUBLIC_PLACE(leafcast_convert_options, name, PUBLIC_OR_NULL),
    PUBLIC_ANY(leafcast_convert_options, watch),
    PUBLIC_ANY(leafcast_convert_options, watch_ctx),
    PUBLIC_NUMBER(leafcast_convert_options, treelet_cells, 1 << LEAF_CELLS_LOG2_MIN,
                  1 << LEAF_CELLS_LOG2_MAX, PUBLIC_OR_ZERO),
    PUBLIC_FLAG(leafcast_convert_options, without_halo),
    PUBLIC_FLAG(leafcast_convert_options, has_missing),
    PUBLIC_ANY(leafcast_convert_options, missing),
    PUBLIC_FLAG(leafcast_convert_options, gradients),
    PUBLIC_FLAG(leafcast_convert_options, coarse),
    PUBLIC_NUMBER(leafcast_convert_options, coarse_dims, 2, GRID_DIM_MAX, PUBLIC_OR_ZERO),
    PUBLIC_NUMBER(leafcast_convert_options, treelet_tets, 0, LEAF_TREELET_TETS_MAX, 0),
    PUBLIC_NUMBER(leafcast_convert_options, leaf_tets, 0, LEAF_LEAF_TETS_MAX, 0),
    PUBLIC_NUMBER(leafcast_convert_options, field_count, 0, LEAF_SETS_MAX, 0),
    {PUBLIC_MEMBER(leafcast_convert_options, fields), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "field_count"},
    PUBLIC_NUMBER(leafcast_convert_options, component, 0, INT_MAX, 0),
    PUBLIC_FLAG(leafcast_convert_options, cells_to_points),
    PUBLIC_FLAG(leafcast_convert_options, follow_links),
    PUBLIC_FLAG(leafcast_convert_options, allow_missing),
    PUBLIC_NUMBER(leafcast_convert_options, exaggerate, 1e-100, 1e100, PUBLIC_OR_ZERO),
    PUBLIC_FLAG(leafcast_convert_options, without_levels),
    PUBLIC_FLAG(leafcast_convert_options, whole_cells),
    PUBLIC_FLAG(leafcast_convert_options, by_corners),
    PUBLIC_ENUM(leafcast_convert_options, normals, LEAFCAST_NORMALS_FLAT),
};

static status options_together(const void *of) {
    const leafcast_convert_options *o = of;
    if (o->treelet_cells & (o->treelet_cells - 1))
        return status_describe(ST_USAGE,
                               "leafcast_convert_options.treelet_cells is %u: 16, 32 and 64 are "
                               "possible",
                               o->treelet_cells);
    if (o->whole_cells && (o->gradients || o->leaf_tets))
        return status_describe(ST_USAGE, "leafcast_convert_options.whole_cells goes without "
                                         "gradients and leaf_tets");
    if (o->whole_cells && o->treelet_tets > MIXED_QUADRATIC_MAX)
        return status_describe(
            ST_USAGE,
            "leafcast_convert_options.treelet_tets is %u: with whole_cells, 0 to "
            "%d are possible",
            o->treelet_tets, MIXED_QUADRATIC_MAX);
    for (uint32_t i = 0; i < o->field_count; i++)
        if (!o->fields[i])
            return status_describe(ST_USAGE, "leafcast_convert_options.fields[%u] is NULL", i);
    return ST_OK;
}

static const public_fields options_table =
    PUBLIC_TABLE(leafcast_convert_options, options_rows, .together = options_together);

/* ---- What to convert ---- */

static const public_field tets_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_tets),
    PUBLIC_NUMBER(leafcast_tets, vertex_count, 0, (double)MESH_POINTS_MAX, 0),
    PUBLIC_NUMBER(leafcast_tets, tet_count, 0, (double)MESH_STREAM_CELLS_MAX, 0),
    {PUBLIC_MEMBER(leafcast_tets, vertices), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "vertex_count"},
    {PUBLIC_MEMBER(leafcast_tets, values), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "vertex_count"},
    {PUBLIC_MEMBER(leafcast_tets, tets), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "tet_count"},
    PUBLIC_PLACE(leafcast_tets, field, PUBLIC_OR_NULL),
};
static const public_fields tets_table = PUBLIC_TABLE(leafcast_tets, tets_rows);

const public_fields *const *prep_arguments_tables(int *count) {
    static const public_fields *const tables[] = {&options_table, &tets_table};
    *count = (int)(sizeof tables / sizeof *tables);
    return tables;
}

/* ---- Checking ---- */

status prep_arguments_check_options(const leafcast_convert_options *options) {
    return public_fields_check(&options_table, options);
}

status prep_arguments_check_tets(const leafcast_tets *tets) {
    return public_fields_check(&tets_table, tets);
}

status prep_arguments_check_paths(const char *const *paths, uint32_t steps) {
    status st = public_in_range("leafcast_convert_steps", "steps", steps, 1, LEAF_SETS_MAX);
    for (uint32_t i = 0; i < steps && st == ST_OK; i++) {
        st = public_needs("leafcast_convert_steps", "path", (const void *[]){paths[i]});
        if (st == ST_OK && strcmp(paths[i], "-") == 0)
            st = status_describe(ST_USAGE, "-: standard input is none of the library's");
    }
    return st;
}
