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
    const double *isos;
    int iso_count;
    activity *active; /* per isovalue */
    histogram values; /* of the first set */
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

/* Find the next run of steps of the first field that have an isovalue, from *step on. Returns how
 * many there are, 0: none; *step: the first of them. */
static uint32_t next_run(const leaf_file *f, double iso, uint32_t *step) {
    const uint32_t steps = f->header.steps;
    uint32_t end;
    while (*step < steps && !leaf_stats_has(f, *step, iso))
        ++*step;
    for (end = *step; end < steps && leaf_stats_has(f, end, iso);)
        end++;
    return end - *step;
}

static void print_steps(const leaf_file *f, double iso) {
    char text[NUM_TEXT_MAX];
    bool any = false;
    printf("in steps");
    for (uint32_t step = 0, run; (run = next_run(f, iso, &step)) > 0; step += run, any = true) {
        printf("%s %u", any ? "," : "", step);
        if (run > 1)
            printf(" to %u", step + run - 1);
        if (!any)
            printf(" (time %s)", num_print(leaf_file_step_time(f, step), text));
    }
    printf("%s\n", any ? "" : ": none");
}

static json_t *steps_json(const leaf_file *f, double iso) {
    json_t *runs = json_array();
    for (uint32_t step = 0, run; (run = next_run(f, iso, &step)) > 0; step += run)
        json_array_append_new(
            runs, json_pack("[I, I]", (json_int_t)step, (json_int_t)step + (json_int_t)run - 1));
    return runs;
}

static void print_activity(const leaf_file *f, double iso, const activity levels) {
    const leaf_header *h = &f->header;
    const leaf_teller *kind = leaf_teller_of(f);
    const leaf_activity all = total_of(levels);
    char text[NUM_TEXT_MAX];
    printf("\nisovalue %s: %llu active %s", num_print(iso, text), (unsigned long long)all.cells,
           kind->cells);
    if (kind->cell_count)
        printf(", %.3f of all", (double)all.cells / (double)kind->cell_count(h));
    printf(", %llu active treelets, %.3f of the payload bytes, %.3f of the file\n",
           (unsigned long long)all.treelets, share_of(all.bytes, h->payload_bytes),
           share_of(all.bytes, h->file_bytes));
    if (f->header.steps > 1)
        print_steps(f, iso);
    if (kind->has_levels)
        print_levels(f, levels);
}

static json_t *levels_json(const leaf_file *f, const activity levels) {
    json_t *rows = json_array();
    for (uint32_t i = 0; i < f->layout.levels; i++)
        json_array_append_new(
            rows, json_pack("{s:I, s:I, s:I}", "treelets", (json_int_t)levels[i].treelets, "bytes",
                            (json_int_t)levels[i].bytes, "cells", (json_int_t)levels[i].cells));
    return rows;
}

static json_t *activity_json(const leaf_file *f, double iso, const activity levels) {
    const leaf_header *h = &f->header;
    const leaf_activity all = total_of(levels);
    char key[64];
    snprintf(key, sizeof key, "active_%s", leaf_teller_of(f)->cells);
    json_t *json = json_pack("{s:o, s:I, s:I, s:I, s:f, s:f}", "iso", cli_json_real(iso), key,
                             (json_int_t)all.cells, "active_treelets", (json_int_t)all.treelets,
                             "active_bytes", (json_int_t)all.bytes, "active_share",
                             share_of(all.bytes, h->payload_bytes), "active_share_of_file",
                             share_of(all.bytes, h->file_bytes));
    if (leaf_teller_of(f)->has_levels)
        json_object_set_new(json, "levels", levels_json(f, levels));
    if (f->header.steps > 1)
        json_object_set_new(json, "at_steps", steps_json(f, iso));
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
    fact_sheet_json(&to, "histogram", histogram_json(&r->values));
    info_next_tell(&to, next_command(r->common->input, next));
    if (r->iso_count) {
        json_t *isos = json_array();
        for (int i = 0; i < r->iso_count; i++)
            json_array_append_new(isos, activity_json(r->f, r->isos[i], r->active[i]));
        fact_sheet_json(&to, "isovalues", isos);
    }
    return cli_print_json(r->common, to.values);
}

static void print_text(const report *r) {
    const fact_sheet to = {.lines = stdout};
    char next[INFO_NEXT_MAX];
    cli_results(r->common, false);
    tell_file(r->f, &to);
    histogram_print(stdout, &r->values,
                    r->f->histograms ? leaf_teller_of(r->f)->drawn : "treelets");
    printf("\n");
    histogram_print_isovalues(stdout, &r->values);
    info_next_tell(&to, next_command(r->common->input, next));
    for (int i = 0; i < r->iso_count; i++)
        print_activity(r->f, r->isos[i], r->active[i]);
}

status info_leaf_report(cli_common *common, mem *m, leaf_file *f, const double *isos,
                        int iso_count) {
    report r = {.common = common, .f = f, .isos = isos, .iso_count = iso_count};
    r.active = mem_array(m, (size_t)iso_count, sizeof *r.active);
    if (!r.active)
        return ST_NOMEM;
    status st = leaf_histogram_get(m, f, 0, &r.values);
    for (int i = 0; i < iso_count && st == ST_OK; i++)
        st = leaf_stats_activity(m, f, isos[i], common->threads, cli_progress(common), r.active[i]);
    if (st == ST_OK && common->json)
        st = print_json(&r);
    else if (st == ST_OK)
        print_text(&r);
    mem_free(m, r.active);
    return st;
}
