#include "prep/curvilinear/convert_curvilinear_report.h"

#include <jansson.h>
#include <stdio.h>

#include "formats/base/num.h"
#include "formats/leaf/curvilinear_zones.h"
#include "prep/convert_report.h"

enum { ZONES_TOLD = 8 };

static unsigned long long whole(uint64_t n) {
    return n;
}

static void print_input(const convert_request *a, const curvilinear_source *source,
                        const char *field, const curvilinear_plan *plan) {
    printf("input       %llu nodes, %llu cells, %u zones\n", whole(plan->nodes), whole(plan->cells),
           source->zones);
    for (uint32_t z = 0; z < source->zones && z < ZONES_TOLD; z++)
        printf("%-11s %u x %u x %u nodes\n", z ? "" : "zones", source->nodes[z][0],
               source->nodes[z][1], source->nodes[z][2]);
    if (source->zones > ZONES_TOLD)
        printf("%-11s and %u more\n", "", source->zones - ZONES_TOLD);
    convert_report_print_sets(a, field);
}

static void print_plan(const curvilinear_plan *plan) {
    printf("treelets    %llu\n", whole(plan->treelets));
    printf("file        at most %.1f MiB of payloads\n", (double)plan->file_bytes / 0x1p20);
    printf("memory      %.1f MiB\n", (double)plan->memory / 0x1p20);
}

static void print_result(const convert_request *a, const curvilinear_plan *plan,
                         const curvilinear_result *r, double seconds) {
    const leaf_header *h = &r->header;
    char lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX], id[LEAF_ID_TEXT], each[64];
    snprintf(each, sizeof each, "%.2f bytes a cell", (double)h->file_bytes / (double)plan->cells);
    convert_report_print_bytes(a, h->file_bytes, each);
    printf("treelets    %llu\n", whole(h->treelets));
    printf("cells       %llu right-handed, %llu left-handed", whole(r->cells[HEX_RIGHT]),
           whole(r->cells[HEX_LEFT]));
    if (r->cells[HEX_FOLDED])
        printf(", %llu folded or flat", whole(r->cells[HEX_FOLDED]));
    if (r->cells[HEX_NONE])
        printf(", %llu blanked", whole(r->cells[HEX_NONE]));
    printf("\nvalues      %s .. %s\n", num_print(h->value_min, lo), num_print(h->value_max, hi));
    if (h->steps > 1)
        printf("nodes       %s\n", h->moving ? "move from step to step" : "stay where they are");
    if (h->non_finite)
        printf("no data     %llu values are NaN or infinite, or blanked\n", whole(h->non_finite));
    printf("id          %s\n", leaf_id_text(h, id));
    printf("time        %.2f s, %.2f million cells a second\n", seconds,
           (double)plan->cells / 1e6 / seconds);
    printf("memory      %.1f MiB at most\n", (double)convert_report_peak() / 0x1p20);
}

static void add_result(json_t *json, const curvilinear_plan *plan, const curvilinear_result *r,
                       double seconds) {
    const leaf_header *h = &r->header;
    char id[LEAF_ID_TEXT];
    json_t *more = json_pack(
        "{s:f, s:I, s:I, s:I, s:I, s:I, s:b, s:o, s:o, s:s, s:f, s:f, s:I}", "bytes_per_cell",
        (double)h->file_bytes / (double)plan->cells, "right_handed",
        (json_int_t)r->cells[HEX_RIGHT], "left_handed", (json_int_t)r->cells[HEX_LEFT], "folded",
        (json_int_t)r->cells[HEX_FOLDED], "blanked", (json_int_t)r->cells[HEX_NONE], "non_finite",
        (json_int_t)h->non_finite, "moving", (int)h->moving, "value_min",
        cli_json_real(h->value_min), "value_max", cli_json_real(h->value_max), "id",
        leaf_id_text(h, id), "seconds", seconds, "cells_per_s", (double)plan->cells / seconds,
        "peak_rss_bytes", (json_int_t)convert_report_peak());
    json_object_update(json, more);
    json_decref(more);
}

static json_t *plan_json(const curvilinear_source *source, const curvilinear_plan *plan) {
    json_t *zones = json_array();
    for (uint32_t z = 0; z < source->zones; z++)
        json_array_append_new(zones, json_pack("[I, I, I]", (json_int_t)source->nodes[z][0],
                                               (json_int_t)source->nodes[z][1],
                                               (json_int_t)source->nodes[z][2]));
    return json_pack("{s:o, s:I, s:I, s:I, s:I}", "zones", zones, "nodes", (json_int_t)plan->nodes,
                     "cells", (json_int_t)plan->cells, "treelets", (json_int_t)plan->treelets,
                     "memory_planned", (json_int_t)plan->memory);
}

status convert_curvilinear_report(const convert_request *a, const curvilinear_source *source,
                                  const char *field, const curvilinear_plan *plan,
                                  const curvilinear_result *r, double seconds) {
    if (a->common.json) {
        json_t *json = plan_json(source, plan);
        convert_report_set_sets(json, a, field);
        convert_report_set_bytes(json, a, r ? r->header.file_bytes : plan->file_bytes);
        if (r)
            add_result(json, plan, r, seconds);
        return cli_print_json(&a->common, json);
    }
    if (!cli_results(&a->common, r != NULL))
        return ST_OK;
    print_input(a, source, field, plan);
    if (r)
        print_result(a, plan, r, seconds);
    else
        print_plan(plan);
    return ST_OK;
}
