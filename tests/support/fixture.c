#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "prep/grid/convert.h"
#include "render/experiments/experiments.h"
#include "tests/support/fixture.h"
#include "tests/support/scratch.h"

LINK_EXPERIMENTS;

static volume *open_field(mem *m, const field *f) {
    const char *path = scratch_path("fixture.nrrd");
    char axes[3][600];
    volume_hints hints = {0};
    volume *v = NULL;
    assert_true(field_write_nrrd(f, path));
    for (int a = 0; a < 3; a++) {
        snprintf(axes[a], sizeof axes[a], "%s.%c", path, "xyz"[a]);
        hints.axis_file[a] = f->axis[a] ? axes[a] : NULL;
    }
    if (volume_open(m, path, &hints, &v) != ST_OK)
        fail_msg("%s", status_text());
    return v;
}

const char *fixture_leaf_of(const field *f, const leaf_parameters *how) {
    static int serial;
    char name[64];
    mem m;
    convert_options o = {.file = *how, .memory = 1 << 30, .threads = 2};
    convert_plan plan;
    convert_result result;
    mem_init(&m, (size_t)o.memory);
    snprintf(name, sizeof name, "fixture-%d.leaf", serial++);
    const char *path = scratch_path(name);
    volume *v = open_field(&m, f);
    if (convert_plan_make(&m, volume_grid(v), &o, &plan) != ST_OK ||
        convert_run(&m, v, path, &o, &plan, NULL, &result) != ST_OK)
        fail_msg("%s: %s", f->name, status_text());
    volume_close(v);
    return path;
}

const char *fixture_leaf(const field *f, uint32_t cells_log2, uint32_t halo, bool compressed) {
    leaf_parameters p = leaf_parameters_default();
    p.cells_log2 = cells_log2;
    p.halo = halo;
    p.deviations = true;
    if (compressed) {
        p.codec = LEAF_CODEC_ZSTD;
        p.zstd_level = 3;
    }
    return fixture_leaf_of(f, &p);
}

leafcast *fixture_open(const char *path, const leafcast_options *options) {
    leafcast *opened = NULL;
    if (leafcast_open(path, options, &opened) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    return opened;
}
