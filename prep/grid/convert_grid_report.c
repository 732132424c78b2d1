#include "prep/grid/convert_grid_report.h"

#include <jansson.h>
#include <stdio.h>

#include "formats/base/num.h"
#include "prep/convert_report.h"

static json_t *plan_json(const convert_plan *plan, const grid *g) {
    json_t *levels = json_array();
    for (uint32_t i = 0; i < plan->layout.levels; i++) {
        const leaf_level *v = &plan->layout.level[i];
        json_array_append_new(levels,
                              json_pack("{s:[i,i,i], s:I, s:b}", "dims", (int)v->dims[0],
                                        (int)v->dims[1], (int)v->dims[2], "treelets",
                                        (json_int_t)v->count, "sampled", i < plan->layout.sampled));
    }
    return json_pack("{s:s, s:s, s:I, s:o, s:I, s:I, s:I, s:I, s:i}", "source_type",
                     sample_name(grid_source(g)), "sample_type", sample_name(plan->layout.type),
                     "input_bytes", (json_int_t)(grid_samples(g) * sample_size(grid_source(g))),
                     "levels", levels, "treelets", (json_int_t)plan->layout.treelets,
                     "memory_planned", (json_int_t)plan->memory, "memory_least",
                     (json_int_t)plan->memory_least, "spill_bytes", (json_int_t)plan->spill_bytes,
                     "spilled_levels", (int)plan->spilled_levels);
}

static const char *alone(const leaf_layout *l) {
    return l->sampled < l->levels ? " (0 alone with samples)" : "";
}

static void print_plan(const convert_plan *plan, const grid *g) {
    uint64_t raw = grid_samples(g) * sample_size(plan->layout.type) * plan->layout.sets;
    printf("input       %u x %u x %u %s, %.1f MiB\n", g->dims[0], g->dims[1], g->dims[2],
           sample_name(grid_source(g)),
           (double)(grid_samples(g) * sample_size(grid_source(g))) / 0x1p20);
    printf("levels      %u%s, %u treelets\n", plan->layout.levels, alone(&plan->layout),
           plan->layout.treelets);
    printf("file        at most %.1f MiB, %.3f of raw\n", (double)plan->file_bytes / 0x1p20,
           (double)plan->file_bytes / (double)raw);
    printf("memory      %.1f MiB, at least %.1f MiB\n", (double)plan->memory / 0x1p20,
           (double)plan->memory_least / 0x1p20);
    if (plan->spilled_levels)
        printf("spilled     %u levels through a temporary file of %.1f MiB\n", plan->spilled_levels,
               (double)plan->spill_bytes / 0x1p20);
    else
        printf("spilled     nothing\n");
}

static void print_outcome(const convert_request *a, const convert_outcome *o,
                          const convert_plan *plan, const grid *g) {
    const leaf_header *h = &o->result.header;
    double raw = (double)(grid_samples(g) * sample_size(plan->layout.type)) * plan->layout.sets;
    char lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX], error[NUM_TEXT_MAX], id[LEAF_ID_TEXT], each[64];
    snprintf(each, sizeof each, "%.3f of raw", (double)h->file_bytes / raw);
    convert_report_print_bytes(a, h->file_bytes, each);
    if (g->heights)
        printf("heights     %u x %u", h->dims[0], h->dims[2]);
    else
        printf("grid        %u x %u x %u", h->dims[0], h->dims[1], h->dims[2]);
    printf(" %s, %u levels%s, %llu treelets\n", sample_name((sample_type)h->sample_type), h->levels,
           alone(&plan->layout), (unsigned long long)h->treelets);
    printf("values      %s .. %s\n", num_print(h->value_min, lo), num_print(h->value_max, hi));
    /* Of terrain, which has each height twice, the heights. */
    if (h->non_finite)
        printf("no data     %llu samples are NaN or infinite\n",
               (unsigned long long)h->non_finite / (g->heights ? 2 : 1));
    if (h->source_type != h->sample_type)
        printf("rounding    %s to %s, off by at most %s\n",
               sample_name((sample_type)h->source_type), sample_name((sample_type)h->sample_type),
               num_print(h->rounding_error, error));
    printf("id          %s\n", leaf_id_text(h, id));
    printf("time        %.2f s, %.0f MB/s\n", o->seconds, raw / 1e6 / o->seconds);
    printf("memory      %.1f MiB at most, %u levels spilled\n",
           (double)convert_report_peak() / 0x1p20, plan->spilled_levels);
}

static void add_outcome(json_t *json, const convert_outcome *o) {
    const leaf_header *h = &o->result.header;
    double raw = (double)h->dims[0] * h->dims[1] * h->dims[2] *
                 (double)sample_size((sample_type)h->sample_type) * h->fields * h->steps;
    char id[LEAF_ID_TEXT];
    json_t *more = json_pack(
        "{s:I, s:f, s:o, s:o, s:I, s:o, s:I, s:s, s:f, s:f, s:I, s:I, s:I}", "payload_bytes",
        (json_int_t)h->payload_bytes, "ratio", (double)h->file_bytes / raw, "value_min",
        cli_json_real(h->value_min), "value_max", cli_json_real(h->value_max), "non_finite",
        (json_int_t)h->non_finite, "rounding_error", cli_json_real(h->rounding_error),
        "trailing_bytes", (json_int_t)o->result.trailing_bytes, "id", leaf_id_text(h, id),
        "seconds", o->seconds, "mb_per_s", raw / 1e6 / o->seconds, "peak_rss_bytes",
        (json_int_t)convert_report_peak(), "absent", (json_int_t)o->result.absent.count,
        "absent_of", (json_int_t)o->result.absent.of);
    json_object_update(json, more);
    json_decref(more);
}

status convert_grid_report(const convert_request *a, const convert_plan *plan, const grid *g,
                           const convert_outcome *o) {
    if (!a->common.json) {
        if (!cli_results(&a->common, o != NULL))
            return ST_OK;
        convert_report_print_sets(a, a->sets.count ? a->sets.names[0] : "");
        if (o)
            print_outcome(a, o, plan, g);
        else
            print_plan(plan, g);
        return ST_OK;
    }
    json_t *json = plan_json(plan, g);
    convert_report_set_sets(json, a, "");
    convert_report_set_bytes(json, a, o ? o->result.header.file_bytes : plan->file_bytes);
    if (o)
        add_outcome(json, o);
    return cli_print_json(&a->common, json);
}
