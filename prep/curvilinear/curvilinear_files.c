#include "prep/curvilinear/curvilinear_files.h"

#include "formats/base/text.h"

static const char *path_of(void *ctx, uint32_t step) {
    const curvilinear_files *f = ctx;
    return f->of.in_file ? curvilinear_input_file(f->first) : step_series_path(&f->of, step);
}

static status open_step(void *ctx, uint32_t step, const curvilinear_source **out) {
    curvilinear_files *f = ctx;
    curvilinear_input_close(f->later);
    f->later = NULL;
    curvilinear_input *x = f->first;
    status st = ST_OK;
    if (f->of.in_file) {
        uint32_t of_file;
        step_series_seek(&f->of, step, &of_file);
        st = curvilinear_input_seek(x, of_file);
    } else if (step > 0) {
        st = curvilinear_input_open(f->m, path_of(f, step), &f->hints, &f->later);
        x = f->later;
    }
    if (st == ST_OK && f->of.fields)
        st = curvilinear_input_take(x, f->of.fields, f->of.sets.fields);
    if (st == ST_OK)
        *out = curvilinear_input_source(x);
    return st;
}

status curvilinear_files_check(const curvilinear_files *f) {
    if (curvilinear_input_fields(f->first) > 0)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: the grid has no values, so there is nothing to draw (--allow-empty "
                           "converts it all the same); those of PLOT3D are in files of their own: "
                           "--solution, --functions",
                           step_series_path(&f->of, 0));
}

curvilinear_series curvilinear_files_series(curvilinear_files *f) {
    curvilinear_series s = {.ctx = f,
                            .open = open_step,
                            .path = path_of,
                            .sets = f->of.sets,
                            .still = f->of.in_file && curvilinear_input_still(f->first)};
    uint32_t component;
    text_name(f->field, sizeof f->field, curvilinear_input_taken(f->first, 0, &component));
    f->names[0] = f->field;
    if (!s.sets.names)
        s.sets.names = f->names;
    return s;
}

void curvilinear_files_release(curvilinear_files *f) {
    curvilinear_input_close(f->later);
    f->later = NULL;
}
