#include "prep/mesh/convert_mesh_report.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"
#include "prep/convert_report.h"

static unsigned long long whole(uint64_t n) {
    return (unsigned long long)n;
}

/* What a cell is called, in the plural. */
static const char *name_of(const cell_treelets *cells) {
    return cells ? cells->cells : "tets";
}

/* JSON counts cells of all shapes as tets, too. */
static const char *key_of(const cell_treelets *cells) {
    return cells && cells->corners == 3 ? cells->cells : "tets";
}

static void print_input(const convert_request *a, const cell_treelets *cells,
                        const mesh_report *r) {
    static const char *const kinds[CELL_SHAPES] = {"hexahedra", "wedges", "pyramids",
                                                   "voxels",    "tets",   "quadratic tets"};
    printf("input       %llu points, %llu %s\n", whole(r->points), whole(r->tets), name_of(cells));
    convert_report_print_sets(a, r->field);
    for (int i = 0; i < CELL_SPLIT_SHAPES; i++)
        if (r->split[i])
            printf("split       %llu %s\n", whole(r->split[i]), kinds[i]);
    if (r->normals)
        printf("normals     of the file's own, at its points\n");
    if (r->polyhedra)
        printf("split       %llu polyhedra, about middles with mean values\n", whole(r->polyhedra));
    for (int i = 0; i < CELL_SHAPES; i++)
        if (r->whole[i])
            printf("whole       %llu %s\n", whole(r->whole[i]), kinds[i]);
    if (r->by_corners)
        printf("linear now  %llu cells of higher order, by their corners\n", whole(r->by_corners));
    if (r->skipped)
        printf("passed over %llu cells without a volume\n", whole(r->skipped));
    if (r->ghosts)
        printf("ghosts      %llu cells of other pieces, or hidden, are left out\n",
               whole(r->ghosts));
}

static void print_mesh_plan(const mesh_plan *plan) {
    printf("memory      %.1f MiB, at least %.1f MiB\n", (double)plan->memory / 0x1p20,
           (double)plan->memory_least / 0x1p20);
    printf("spilled     %.1f MiB\n", (double)plan->spill_bytes / 0x1p20);
}

static void print_mesh(const convert_request *a, const cell_treelets *cells, const mesh_result *r,
                       double seconds) {
    const bool surface = cells && cells->corners == 3;
    const leaf_header *h = &r->header;
    char lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX], id[LEAF_ID_TEXT], each[64];
    snprintf(each, sizeof each, "%.2f bytes a %.*s", (double)h->file_bytes / (double)h->tets,
             (int)strlen(name_of(cells)) - 1, name_of(cells));
    convert_report_print_bytes(a, h->file_bytes, each);
    printf("%-11s %llu %s, %llu vertices, %llu treelets\n", surface ? "surface" : "mesh",
           whole(h->tets), name_of(cells), whole(h->vertices), whole(h->treelets));
    printf("values      %s .. %s\n", num_print(h->value_min, lo), num_print(h->value_max, hi));
    if (h->steps > 1)
        printf("points      %s\n", h->moving ? "move from step to step" : "stay where they are");
    if (h->non_finite)
        printf("no data     %llu values are NaN or infinite\n", whole(h->non_finite));
    if (cells && h->flat)
        printf("kept        %llu %s\n", whole(h->flat),
               surface ? "triangles without an area" : "folded cells");
    else if (h->flat || h->inverted)
        printf("kept        %llu flat tets, %llu inverted ones\n", whole(h->flat),
               whole(h->inverted));
    if (h->repeated || h->bad)
        printf("left out    %llu %s, %llu cells with an id that is no point\n", whole(h->repeated),
               surface ? "triangles with a vertex twice"
               : cells ? "cells of less than four vertices"
                       : "tets with a vertex twice",
               whole(h->bad));
    printf("id          %s\n", leaf_id_text(h, id));
    printf("time        %.2f s (read %.2f, sort %.2f, build %.2f), %.2f million %s a second\n",
           seconds, r->read_s, r->sort_s, r->build_s, (double)h->tets / 1e6 / seconds,
           name_of(cells));
    printf("memory      %.1f MiB at most, %.1f MiB spilled\n",
           (double)convert_report_peak() / 0x1p20, (double)r->plan.spill_bytes / 0x1p20);
}

static json_t *mesh_plan_json(const cell_treelets *cells, const mesh_result *r) {
    const mesh_report *in = &r->report;
    char input[32];
    snprintf(input, sizeof input, "input_%s", key_of(cells));
    return json_pack(
        "{s:I, s:I, s:s, s:[I,I,I,I], s:I, s:I, s:[I,I,I,I,I,I], s:I, s:I, s:I, s:I, s:I}",
        "input_points", (json_int_t)in->points, input, (json_int_t)in->tets, "field", in->field,
        "split", (json_int_t)in->split[0], (json_int_t)in->split[1], (json_int_t)in->split[2],
        (json_int_t)in->split[3], "polyhedra", (json_int_t)in->polyhedra, "by_corners",
        (json_int_t)in->by_corners, "whole", (json_int_t)in->whole[0], (json_int_t)in->whole[1],
        (json_int_t)in->whole[2], (json_int_t)in->whole[3], (json_int_t)in->whole[4],
        (json_int_t)in->whole[5], "skipped", (json_int_t)in->skipped, "ghosts",
        (json_int_t)in->ghosts, "memory_planned", (json_int_t)r->plan.memory, "memory_least",
        (json_int_t)r->plan.memory_least, "spill_bytes", (json_int_t)r->plan.spill_bytes);
}

static void add_mesh(json_t *json, const cell_treelets *cells, const mesh_result *r,
                     double seconds) {
    const leaf_header *h = &r->header;
    const char *key = key_of(cells);
    char each[40], rate[32];
    snprintf(each, sizeof each, "bytes_per_%.*s", (int)strlen(key) - 1, key);
    snprintf(rate, sizeof rate, "%s_per_s", key);
    char id[LEAF_ID_TEXT];
    json_t *more = json_pack(
        "{s:I, s:I, s:I, s:f, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:s}", key, (json_int_t)h->tets,
        "vertices", (json_int_t)h->vertices, "treelets", (json_int_t)h->treelets, each,
        (double)h->file_bytes / (double)h->tets, "flat", (json_int_t)h->flat, "inverted",
        (json_int_t)h->inverted, "repeated", (json_int_t)h->repeated, "bad", (json_int_t)h->bad,
        "non_finite", (json_int_t)h->non_finite, "value_min", cli_json_real(h->value_min),
        "value_max", cli_json_real(h->value_max), "id", leaf_id_text(h, id));
    json_t *times =
        json_pack("{s:f, s:f, s:f, s:f, s:f, s:I}", "seconds", seconds, "read_s", r->read_s,
                  "sort_s", r->sort_s, "build_s", r->build_s, rate, (double)h->tets / seconds,
                  "peak_rss_bytes", (json_int_t)convert_report_peak());
    json_object_set_new(more, "moving", json_boolean(h->moving));
    json_object_update(json, more);
    json_object_update(json, times);
    json_decref(more);
    json_decref(times);
}

status convert_mesh_report(const convert_request *a, const cell_treelets *cells,
                           const mesh_result *r, double seconds) {
    if (a->common.json) {
        json_t *json = mesh_plan_json(cells, r);
        if (cells && cells->corners == 3)
            json_object_set_new(json, "normals", json_integer((json_int_t)r->report.normals));
        convert_report_set_sets(json, a, r->report.field);
        if (!a->dry_run) {
            convert_report_set_bytes(json, a, r->header.file_bytes);
            add_mesh(json, cells, r, seconds);
        }
        return cli_print_json(&a->common, json);
    }
    if (!cli_results(&a->common, !a->dry_run))
        return ST_OK;
    print_input(a, cells, &r->report);
    if (a->dry_run)
        print_mesh_plan(&r->plan);
    else
        print_mesh(a, cells, r, seconds);
    return ST_OK;
}
