#include "formats/info_leaf.h"

#include <limits.h>
#include <stdio.h>

#include "formats/base/cli_json.h"
#include "formats/base/num.h"
#include "formats/base/shell_line.h"
#include "formats/base/text.h"
#include "formats/info_next.h"
#include "formats/leaf/histogram_text.h"
#include "formats/leaf/leaf_histogram.h"
#include "formats/leaf/leaf_stats.h"
#include "formats/leaf/leaf_tell.h"

enum { SIZES_MAX = 32 };

typedef leaf_activity activity[LEAF_LEVELS_MAX];

typedef struct report {
    cli_common *common;
    const leaf_file *f;
    info_leaf_question *q;
    uint32_t field, first; /* and the first of the steps */
    activity *active;      /* per isovalue */
    /* Of several steps, else NULL: */
    time_tree *tree;
    leaf_presence *present; /* per isovalue */
    uint8_t *asked;         /* per step */
    uint8_t *has;           /* per isovalue and step */
    histogram values;       /* of the field at the first step */
} report;

/* ---- stored sizes ---- */

/* Count payloads by log2 of their stored size, and tell the counts. */
static void tell_sizes(const leaf_file *f, const fact_sheet *to) {
    uint64_t counts[SIZES_MAX] = {0};
    json_t *rows = json_array();
    for (uint32_t p = 0; p < f->layout.payloads; p++)
        if (leaf_file_is_home(f, p))
            counts[(63 - __builtin_clzll(f->sizes[p])) % SIZES_MAX]++;
    fact_sheet_row(to, "\nstored size        payloads");
    for (int i = 0; i < SIZES_MAX; i++) {
        if (counts[i] == 0)
            continue;
        fact_sheet_row(to, "%8llu .. %-8llu %8llu", 1ULL << i, (2ULL << i) - 1,
                       (unsigned long long)counts[i]);
        json_array_append_new(rows, json_pack("{s:I, s:I}", "at_least_bytes", (json_int_t)1 << i,
                                              "payloads", (json_int_t)counts[i]));
    }
    fact_sheet_json(to, "payload_sizes", rows);
}

/* ---- what an isovalue needs ---- */

/* A file may have no payloads: in place, without coarse levels. */
static double share_of(uint64_t bytes, uint64_t all) {
    return all > 0 ? (double)bytes / (double)all : 0.0;
}

static leaf_activity total_of(const activity levels) {
    leaf_activity sum = {0};
    for (int i = 0; i < LEAF_LEVELS_MAX; i++) {
        sum.treelets += levels[i].treelets;
        sum.bytes += levels[i].bytes;
    }
    sum.cells = levels[0].cells;
    return sum;
}

static void print_levels(const leaf_file *f, const activity levels) {
    printf("level   treelets          bytes          cells\n");
    for (uint32_t i = 0; i < f->layout.levels; i++)
        printf("%5u %10llu %14llu %14llu\n", i, (unsigned long long)levels[i].treelets,
               (unsigned long long)levels[i].bytes, (unsigned long long)levels[i].cells);
}

static const uint8_t *steps_with(const report *r, int i) {
    return r->has + (size_t)i * r->f->header.steps;
}

/* Find the next run of steps with has[step] from *step on. Returns how many there are, 0: none;
 * *step: the first of them. */
static uint32_t next_run(const report *r, const uint8_t *has, uint32_t *step) {
    const uint32_t steps = r->f->header.steps;
    uint32_t end;
    while (*step < steps && !has[*step])
        ++*step;
    for (end = *step; end < steps && has[end];)
        end++;
    return end - *step;
}

static void print_runs(const report *r, const uint8_t *has) {
    const char *between = " ";
    for (uint32_t step = 0, run; (run = next_run(r, has, &step)) > 0; step += run) {
        printf("%s%u", between, step);
        if (run > 1)
            printf(" to %u", step + run - 1);
        between = ", ";
    }
}

static void print_presence(const report *r, int i) {
    const leaf_presence *p = &r->present[i];
    const uint8_t *has = steps_with(r, i);
    char text[NUM_TEXT_MAX];
    uint32_t first = 0;
    if (!next_run(r, has, &first)) {
        printf("in none of the steps");
        print_runs(r, r->asked);
        printf("\n");
        return;
    }
    printf("in %u of the steps", p->steps);
    print_runs(r, r->asked);
    printf(":");
    print_runs(r, has);
    printf("; first at time %s\n", num_print(leaf_file_step_time(r->f, first), text));
    printf("in %llu treelets of level 0 at any of them, at most %llu at once (step %u); "
           "%llu bytes in all\n",
           (unsigned long long)p->treelets, (unsigned long long)p->most, p->step_of_most,
           (unsigned long long)p->bytes);
}

static json_t *runs_json(const report *r, const uint8_t *has) {
    json_t *runs = json_array();
    for (uint32_t step = 0, run; (run = next_run(r, has, &step)) > 0; step += run)
        json_array_append_new(
            runs, json_pack("[I, I]", (json_int_t)step, (json_int_t)step + (json_int_t)run - 1));
    return runs;
}

static json_t *presence_json(const report *r, int i) {
    const leaf_presence *p = &r->present[i];
    return json_pack("{s:I, s:I, s:I, s:I}", "treelets", (json_int_t)p->treelets, "most_treelets",
                     (json_int_t)p->most, "most_at_step", (json_int_t)p->step_of_most, "bytes",
                     (json_int_t)p->bytes);
}

static void print_activity(const report *r, int i) {
    const leaf_file *f = r->f;
    const leaf_header *h = &f->header;
    const leaf_teller *kind = leaf_teller_of(f);
    const leaf_activity all = total_of(r->active[i]);
    char text[NUM_TEXT_MAX];
    printf("\nisovalue %s", num_print(r->q->isos[i], text));
    if (h->fields > 1)
        printf(" of %s", f->names[r->field]);
    if (h->steps > 1)
        printf(" at step %u", r->first);
    printf(": %llu active %s", (unsigned long long)all.cells, kind->cells);
    if (kind->cell_count)
        printf(", %.3f of all", (double)all.cells / (double)kind->cell_count(h));
    printf(", %llu active treelets, %.3f of the payload bytes, %.3f of the file\n",
           (unsigned long long)all.treelets, share_of(all.bytes, h->payload_bytes),
           share_of(all.bytes, h->file_bytes));
    if (kind->has_levels)
        print_levels(f, r->active[i]);
    if (r->tree)
        print_presence(r, i);
}

static json_t *levels_json(const leaf_file *f, const activity levels) {
    json_t *rows = json_array();
    for (uint32_t i = 0; i < f->layout.levels; i++)
        json_array_append_new(
            rows, json_pack("{s:I, s:I, s:I}", "treelets", (json_int_t)levels[i].treelets, "bytes",
                            (json_int_t)levels[i].bytes, "cells", (json_int_t)levels[i].cells));
    return rows;
}

static json_t *activity_json(const report *r, int i) {
    const leaf_file *f = r->f;
    const leaf_header *h = &f->header;
    const leaf_activity all = total_of(r->active[i]);
    char key[64];
    snprintf(key, sizeof key, "active_%s", leaf_teller_of(f)->cells);
    json_t *json = json_pack("{s:o, s:I, s:I, s:I, s:f, s:f}", "iso", cli_json_real(r->q->isos[i]),
                             key, (json_int_t)all.cells, "active_treelets",
                             (json_int_t)all.treelets, "active_bytes", (json_int_t)all.bytes,
                             "active_share", share_of(all.bytes, h->payload_bytes),
                             "active_share_of_file", share_of(all.bytes, h->file_bytes));
    if (leaf_teller_of(f)->has_levels)
        json_object_set_new(json, "levels", levels_json(f, r->active[i]));
    if (r->tree) {
        json_object_set_new(json, "at_steps", runs_json(r, steps_with(r, i)));
        json_object_set_new(json, "over_steps", presence_json(r, i));
    }
    return json;
}

/* ---- all of it ---- */

/* Print the command that draws the file; NULL where it does not fit. */
static const char *next_command(const char *path, char line[INFO_NEXT_MAX]) {
    size_t length;
    const char *stem = text_stem(path, &length);
    char picture[PATH_MAX];
    shell_line l = shell_line_begin(line, INFO_NEXT_MAX);
    if (snprintf(picture, sizeof picture, "%.*s.png", (int)length, stem) >= (int)sizeof picture)
        return NULL;
    shell_line_put(&l, "leafcast render ");
    shell_line_path(&l, path);
    shell_line_put(&l, " -o ");
    shell_line_path(&l, picture);
    return l.full ? NULL : line;
}

/* Tell what the kind does, between what all treelet files have. */
static void tell_file(const leaf_file *f, const fact_sheet *to) {
    const leaf_teller *kind = leaf_teller_of(f);
    kind->tell(f, to);
    fact_sheet_text(to, "format", "treelet file");
    fact_sheet_text(to, "kind", kind->name);
    if (kind->tell_parts)
        kind->tell_parts(f, to);
    tell_sizes(f, to);
}

static status print_json(const report *r) {
    const fact_sheet to = {.values = json_object()};
    char next[INFO_NEXT_MAX];
    tell_file(r->f, &to);
    if (leaf_teller_of(r->f)->drawn)
        fact_sheet_json(&to, "histogram",
                        histogram_json(&r->values, !leaf_teller_of(r->f)->is_surface));
    info_next_tell(&to, next_command(r->common->input, next));
    if (r->q->iso_count) {
        json_t *isos = json_array();
        for (int i = 0; i < r->q->iso_count; i++)
            json_array_append_new(isos, activity_json(r, i));
        fact_sheet_json(&to, "isovalues", isos);
    }
    return cli_print_json(r->common, to.values);
}

static void print_text(const report *r) {
    const leaf_teller *kind = leaf_teller_of(r->f);
    const fact_sheet to = {.lines = stdout};
    char next[INFO_NEXT_MAX];
    cli_results(r->common, false);
    tell_file(r->f, &to);
    if (!kind->drawn) {
        printf("\n");
    } else {
        histogram_print(stdout, &r->values, r->f->histograms ? kind->drawn : "treelets",
                        !kind->is_surface);
        printf("\n");
        histogram_print_isovalues(stdout, &r->values, !kind->is_surface);
    }
    info_next_tell(&to, next_command(r->common->input, next));
    for (int i = 0; i < r->q->iso_count; i++)
        print_activity(r, i);
}

/* ---- what is asked ---- */

/* Find the field and the steps that are asked for. */
static status settle(report *r, mem *m) {
    step_list *list = &r->q->steps;
    const uint32_t steps = r->f->header.steps;
    if (!step_list_given(list))
        list->all = true;
    status st = r->q->field ? leaf_file_find_field(r->f, r->q->field, &r->field) : ST_OK;
    if (st == ST_OK)
        st = step_list_settle(list, "--steps", r->common->input, steps);
    if (st != ST_OK)
        return st;
    r->asked = mem_array(m, steps, sizeof *r->asked);
    if (!r->asked)
        return ST_NOMEM;
    r->first = steps;
    for (uint64_t i = 0; i < step_list_count(list); i++) {
        const uint32_t step = step_list_at(list, i);
        r->asked[step] = 1;
        r->first = step < r->first ? step : r->first;
    }
    return ST_OK;
}

static status count(report *r, mem *m, leaf_file *f) {
    cli_common *common = r->common;
    const uint32_t steps = f->header.steps;
    const size_t isos = (size_t)r->q->iso_count;
    status st = ST_OK;
    r->active = mem_array(m, isos, sizeof *r->active);
    r->present = mem_array(m, isos, sizeof *r->present);
    r->has = mem_array(m, isos * steps, sizeof *r->has);
    if (!r->active || !r->present || !r->has)
        return ST_NOMEM;
    if (isos > 0 && steps > 1)
        st = time_tree_create(m, f, r->field, TIME_ORDER_MOST, &r->tree);
    for (size_t i = 0; i < isos && st == ST_OK; i++) {
        const double iso = r->q->isos[i];
        st = leaf_stats_activity(m, f, leaf_layout_set(&f->layout, r->field, r->first), iso,
                                 common->threads, cli_progress(common), r->active[i]);
        if (st == ST_OK && r->tree)
            st = leaf_stats_presence(m, f, r->tree, r->field, iso, r->asked, r->has + i * steps,
                                     &r->present[i]);
    }
    return st;
}

/* Refuse isovalues of what is a surface already. */
static status check_isovalues(const report *r) {
    if (!leaf_teller_of(r->f)->is_surface || (!r->q->iso_count && !step_list_given(&r->q->steps)))
        return ST_OK;
    return status_describe(ST_USAGE,
                           "%s: a surface of %s, which has no isosurfaces: --iso and --steps are "
                           "for volumes",
                           r->common->input, leaf_teller_of(r->f)->cells);
}

status info_leaf_report(cli_common *common, mem *m, leaf_file *f, info_leaf_question *q) {
    report r = {.common = common, .f = f, .q = q};
    status st = check_isovalues(&r);
    if (st == ST_OK)
        st = settle(&r, m);
    if (st == ST_OK && leaf_teller_of(f)->drawn)
        st = leaf_histogram_get(m, f, leaf_layout_set(&f->layout, r.field, r.first), &r.values);
    if (st == ST_OK)
        st = count(&r, m, f);
    if (st == ST_OK && common->json)
        st = print_json(&r);
    else if (st == ST_OK)
        print_text(&r);
    time_tree_destroy(r.tree);
    mem_free(m, r.has);
    mem_free(m, r.present);
    mem_free(m, r.active);
    mem_free(m, r.asked);
    return st;
}
