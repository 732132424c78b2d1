#include "tests/support/coarse_subjects.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "formats/leaf/leaf_file.h"
#include "tests/support/coarse_hexes.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/scratch.h"

enum { GRID_NODES = 37, THINNED_CELLS = 36 };

void coarse_subjects_take_part(mem *m, const char *name, uint32_t set, const char *part_name) {
    leaf_file *f = NULL;
    size_t size;
    char *bytes = scratch_read(scratch_path(name), &size);
    assert_int_equal(leaf_file_open(m, scratch_path(name), &f), ST_OK);
    const leaf_part part = f->coarse[set];
    (void)scratch_write(part_name, bytes + part.offset, (size_t)part.bytes);
    leaf_file_close(f);
    free(bytes);
}

static void make_hexes(mem *m, subject of, const char *name, bool coarse) {
    coarse_hexes c = of == THINNED ? coarse_hexes_of(false, THINNED_CELLS, 0)
                                   : coarse_hexes_of(of == WHOLE_CELLS, SUBJECT_CELLS, GRID_NODES);
    c.coarse = coarse;
    if (coarse_hexes_convert(m, &c, name) != ST_OK)
        fail_msg("%s", status_text());
}

static void make_tets(mem *m, const char *name, bool coarse) {
    mesh_case c = mesh_cases_kuhn(SUBJECT_CELLS, SUBJECT_CELLS, SUBJECT_CELLS);
    mesh_result r;
    c.options.treelet_tets = 400;
    c.options.coarse = coarse;
    c.options.coarse_dims = GRID_NODES;
    if (mesh_cases_convert(m, &c, name, 0, &r) != ST_OK)
        fail_msg("%s", status_text());
    m->limit = 0;
    mesh_cases_free(&c);
}

void coarse_subjects_make(mem *m, subject of, const char *name, const char *part_name,
                          bool coarse) {
    if (of == TETS)
        make_tets(m, name, coarse);
    else
        make_hexes(m, of, name, coarse);
    if (part_name)
        coarse_subjects_take_part(m, name, 0, part_name);
}
