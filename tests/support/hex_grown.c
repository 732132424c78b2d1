#include "tests/support/hex_grown.h"
#include "prep/mesh/mixed_treelet.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "formats/leaf/leaf_grow.h"
#include "tests/support/curvilinear_steps.h"
#include "tests/support/mixed_file.h"
#include "tests/support/scratch.h"

enum { RUN_ALIGN_LOG2 = 9, MEMORY = 1 << 30, TREELET = 60 };

static leaf_parameters parameters_of(leaf_codec codec) {
    leaf_parameters p = leaf_parameters_default();
    p.codec = codec;
    p.zstd_level = 1;
    p.run_align_log2 = RUN_ALIGN_LOG2;
    return p;
}

static bool changes(uint32_t segment) {
    return segment != 0 && segment != 2;
}

const char *hex_grown_grid(int lab, uint32_t segments, leaf_codec codec, const char *name) {
    hex_lab s;
    const char *path = scratch_path(name);
    const curvilinear_zone zone = {{HEX_LAB_NODES, HEX_LAB_NODES, HEX_LAB_NODES},
                                   (const float(*)[3])s.p,
                                   (const float *)s.value,
                                   NULL};
    curvilinear_options o = {.file = parameters_of(codec), .memory = MEMORY, .threads = 1};
    hex_lab_make(&s, lab, FIELD_SEED);
    o.force = o.grows = true;
    for (uint32_t i = 0; i < segments; i++) {
        mem m;
        curvilinear_steps steps;
        curvilinear_result result;
        mem_init(&m, MEMORY);
        for (float *v = (float *)s.value; changes(i) && v < (float *)s.value + sizeof s.value / 4;)
            *v++ += 0.1F;
        curvilinear_steps_init(&steps, &zone, 1, 1, 1);
        if (i)
            assert_int_equal(leaf_grow_open(&m, path, &o.grow), ST_OK);
        assert_int_equal(curvilinear_convert(&m, &steps.series, "lab", path, &o, NULL, &result),
                         ST_OK);
        leaf_grow_close(o.grow);
    }
    return path;
}

const char *hex_grown_mix(int lab, uint32_t segments, leaf_codec codec, const char *name) {
    static cell_mix mix;
    const char *path = scratch_path(name);
    const char *input = strdup(scratch_path("grown.vtk"));
    const mesh_series series = {.of = {.paths = &input, .sets = {.fields = 1, .steps = 1}}};
    mesh_options o = mesh_options_default();
    cell_mix_make(&mix, lab, FIELD_SEED);
    o.file = parameters_of(codec);
    o.cells = &mixed_treelets;
    o.force = o.grows = true;
    o.treelet_tets = TREELET;
    o.memory = MEMORY;
    o.series = &series;
    for (uint32_t i = 0; i < segments; i++) {
        mem m;
        mesh_input *x = NULL;
        mesh_result result;
        mem_init(&m, MEMORY);
        for (int c = 0; changes(i) && c < mix.count; c++)
            for (int v = 0; v < cell_shape_vertices(mix.cell[c].shape); v++)
                mix.cell[c].value[v] += 0.125;
        (void)mixed_file_write(mix.cell, mix.count, input);
        if (i)
            assert_int_equal(leaf_grow_open(&m, path, &o.grow), ST_OK);
        assert_int_equal(mesh_input_open(&m, input, NULL, &x), ST_OK);
        assert_int_equal(mesh_convert_run(&m, x, path, &o, NULL, &result), ST_OK);
        mesh_input_close(x);
        leaf_grow_close(o.grow);
    }
    free((void *)(uintptr_t)input);
    return path;
}
