#include "prep/curvilinear/convert_curvilinear.h"

#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/text.h"
#include "formats/curvilinear/curvilinear_input_kind.h"
#include "prep/convert_append.h"
#include "prep/convert_choices.h"
#include "prep/curvilinear/convert_curvilinear_report.h"
#include "prep/curvilinear/curvilinear_files.h"
#include "prep/further_step.h"

/* ---- notes ---- */

static bool is_collection(const void *own) {
    const double *times;
    return !curvilinear_input_has_library(own) && curvilinear_input_steps(own, &times) > 1;
}

static void note(const convert_request *a, const void *own) {
    curvilinear_input *x = (curvilinear_input *)own; /* asking for names takes room in it */
    convert_choices c = {.common = &a->common,
                         .sets = &a->sets,
                         .component = (uint32_t)a->hints.curvilinear.component,
                         .step = a->step || step_list_given(&a->sets.taken)};
    const double *times;
    const uint32_t steps = curvilinear_input_steps(own, &times);
    if (a->common.verbosity <= 0)
        return;
    for (uint32_t i = 0; i < curvilinear_input_fields(x); i++) {
        uint32_t components;
        const char *name = curvilinear_input_field(x, i, &components);
        const slice_field f = {
            .name = name, .steps = steps, .taken = i == 0, .components = components};
        convert_choices_take(&c, &f);
    }
    convert_choices_note(&c);
}

/* ---- fields and steps ---- */

static status take_sets(convert_sets *s, curvilinear_input *x, const char *name) {
    const double *times;
    const uint32_t steps = curvilinear_input_steps(x, &times);
    status st = ST_OK;
    for (uint32_t i = 0; i < curvilinear_input_fields(x) && s->all_fields && st == ST_OK; i++) {
        uint32_t components;
        st = convert_sets_take_copy(s, curvilinear_input_field(x, i, &components));
    }
    if (step_list_given(&s->taken) && !s->times)
        text_name(s->time_unit, sizeof s->time_unit, curvilinear_input_time_unit(x));
    return st == ST_OK ? convert_sets_take_steps(s, name, steps, times) : st;
}

/* ---- one series ---- */

static status refuse(const convert_request *a) {
    const curvilinear_hints *h = &a->hints.curvilinear;
    if (a->grow && leaf_grow_before(a->grow)->header.kind != LEAF_KIND_CURVILINEAR)
        return further_step_refuse(leaf_grow_before(a->grow), a->common.input,
                                   "it is a curvilinear grid, and the file is of none");
    if (a->common.input_count > 1 && (h->solutions.count || h->functions.count))
        return status_describe(ST_USAGE, "--solution and --functions go with one INPUT");
    return ST_OK;
}

static status convert_files(convert_request *a, mem *m, curvilinear_files *files, double start) {
    const curvilinear_options o = {.file = a->file,
                                   .memory = m->limit - convert_append_memory(a, m),
                                   .threads = a->common.threads,
                                   .force = a->common.force,
                                   .grows = a->append,
                                   .grow = a->grow,
                                   .refuse_empty = !a->allow_empty,
                                   .coarse = a->coarse,
                                   .coarse_dims = a->coarse_dims};
    const curvilinear_series series = curvilinear_files_series(files);
    const curvilinear_source *source;
    curvilinear_plan plan;
    curvilinear_result r;
    status st = series.open(series.ctx, 0, &source);
    if (st == ST_OK && a->grow && !files->of.sets.names)
        st = further_step_check_field(leaf_grow_before(a->grow), a->common.input, 0, files->field);
    if (st == ST_OK)
        st = curvilinear_plan_make(m, &series, source, &o, &plan);
    if (st == ST_OK && !a->dry_run)
        st = curvilinear_convert(m, &series, curvilinear_input_name(files->first), a->common.output,
                                 &o, cli_progress(&a->common), &r);
    if (st == ST_OK && !a->dry_run)
        convert_append_note(a, &files->of.sets);
    if (st == ST_OK)
        st = series.open(series.ctx, 0, &source);
    return st == ST_OK ? convert_curvilinear_report(a, source, files->field, &plan,
                                                    a->dry_run ? NULL : &r, clock_seconds() - start)
                       : st;
}

static status run(convert_request *a, mem *m, input *in, double start) {
    curvilinear_files files = {.m = m, .hints = a->hints.curvilinear, .first = in->own};
    status st = refuse(a);
    if (st == ST_OK)
        st = take_sets(&a->sets, files.first, a->common.input);
    if (st == ST_OK)
        st = convert_request_times(a);
    files.of = convert_request_series(a);
    if (st == ST_OK)
        st = step_series_check(&files.of);
    if (st == ST_OK)
        st = convert_append_check(a, &files.of.sets);
    if (st == ST_OK && !a->allow_empty)
        st = curvilinear_files_check(&files);
    if (st == ST_OK)
        st = convert_files(a, m, &files, start);
    curvilinear_files_release(&files);
    return st;
}

const convert_kind convert_curvilinear = {
    .of = &curvilinear_input_kind, .is_collection = is_collection, .note = note, .run = run};
