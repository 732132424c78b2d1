#include "tests/support/lab_leaf.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

#include "formats/mesh/mesh_stream.h"
#include "prep/generate/tet_generate.h"
#include "prep/mesh/mesh_convert.h"
#include "tests/support/scratch.h"

const char *lab_leaf_make(const lab_mesh *lab, uint32_t treelet_tets, bool gradients) {
    static unsigned serial; /* two may be open at a time */
    const char *input = scratch_path("mesh"),
               *output = scratch_path(serial++ % 2 ? "leaf" : "leaf2");
    mem m;
    mesh_stream_writer *w;
    mesh_input *x;
    mesh_result result;
    mesh_options o = mesh_options_default();
    const mesh_stream_header head = {
        .name = "lab", .field = "f", .points = lab->point_count, .tets = lab->tet_count};
    mem_init(&m, 0);
    o.force = true;
    o.treelet_tets = treelet_tets;
    o.gradients = gradients;
    assert_int_equal(mesh_stream_create(&m, input, true, &head, &w), ST_OK);
    assert_int_equal(mesh_stream_points(w, lab->point_count, (const float(*)[3])lab->points),
                     ST_OK);
    assert_int_equal(mesh_stream_values(w, lab->point_count, lab->values), ST_OK);
    assert_int_equal(mesh_stream_tets(w, lab->tet_count, (const uint32_t(*)[4])lab->tets), ST_OK);
    assert_int_equal(mesh_stream_commit(w), ST_OK);
    assert_int_equal(mesh_input_open(&m, input, NULL, &x), ST_OK);
    assert_int_equal(mesh_convert_run(&m, x, output, &o, NULL, &result), ST_OK);
    mesh_input_close(x);
    return output;
}

const char *lab_leaf_field(const char *name, uint32_t dims) {
    const char *input = scratch_path("mesh"), *output = scratch_path("leaf");
    mem m;
    mesh_input *x;
    mesh_result result;
    mesh_options o = mesh_options_default();
    tet_generate_options made = {.info = field_find(name), .threads = 1};
    for (int a = 0; a < 3; a++) {
        made.shape.dims[a] = dims;
        made.shape.copies[a] = 1;
        made.shape.spacing[a] = 1.0;
    }
    mem_init(&m, 0);
    o.force = true;
    assert_int_equal(tet_generate_files(&m, &made, input, true, NULL), ST_OK);
    assert_int_equal(mesh_input_open(&m, input, NULL, &x), ST_OK);
    assert_int_equal(mesh_convert_run(&m, x, output, &o, NULL, &result), ST_OK);
    mesh_input_close(x);
    return output;
}
