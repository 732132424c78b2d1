#include "tests/support/mesh_grown.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_grow.h"
#include "tests/support/mesh_movies.h"
#include "tests/support/scratch.h"

static void require(status st) {
    if (st == ST_OK)
        return;
    fprintf(stderr, "%s\n", status_text());
    abort();
}

const char *mesh_grown_make(uint32_t n, uint32_t segments, leaf_codec codec, const char *name) {
    mesh_case c = mesh_cases_kuhn(n, n, n - 1);
    mesh_result r;
    mem m;
    const char *path = scratch_path(name);
    mem_init(&m, 0);
    c.options.treelet_tets = 300;
    c.options.gradients = c.options.grows = true;
    c.options.file.codec = codec;
    c.options.file.zstd_level = 1;
    c.options.file.run_align_log2 = 9;
    mesh_movie v = mesh_movies_make(c, 1, segments, segments, 0);
    if (segments > 2)
        memcpy(v.values[2][0], v.values[1][0], c.point_count * sizeof *c.values);
    mesh_movies_write(&v);
    v.series.of.sets.steps = 1;
    v.series.of.sets.times = NULL;
    for (uint32_t s = 0; s < segments; s++, v.series.of.paths++) {
        if (s > 0)
            require(leaf_grow_open(&m, path, &v.c.options.grow));
        require(mesh_movies_convert(&m, &v, path, &r, false));
        leaf_grow_close(v.c.options.grow);
    }
    mesh_movies_release(&v);
    return path;
}
