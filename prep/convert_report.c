#include "prep/convert_report.h"

#include <jansson.h>
#include <stdio.h>
#include <sys/resource.h>

#include "formats/base/num.h"

static uint64_t peak_rss(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (uint64_t)usage.ru_maxrss * 1024;
}

/* ---- grids ---- */

static json_t *plan_json(const convert_plan *plan, const grid *g) {
    json_t *levels = json_array();
    for (uint32_t i = 0; i < plan->layout.levels; i++) {
        const leaf_level *v = &plan->layout.level[i];
        json_array_append_new(levels, json_pack("{s:[i,i,i], s:I}", "dims", (int)v->dims[0],
                                                (int)v->dims[1], (int)v->dims[2], "treelets",
                                                (json_int_t)v->count));
    }
    return json_pack("{s:s, s:s, s:I, s:o, s:I, s:I, s:I, s:I, s:i}", "source_type",
                     sample_name(grid_source(g)), "sample_type", sample_name(plan->layout.type),
                     "input_bytes", (json_int_t)(grid_samples(g) * sample_size(grid_source(g))),
                     "levels", levels, "treelets", (json_int_t)plan->layout.treelets,
                     "memory_planned", (json_int_t)plan->memory, "memory_least",
                     (json_int_t)plan->memory_least, "spill_bytes", (json_int_t)plan->spill_bytes,
                     "spilled_levels", (int)plan->spilled_levels);
}

static void print_plan(const convert_plan *plan, const grid *g) {
    uint64_t raw = grid_samples(g) * sample_size(plan->layout.type) * plan->layout.sets;
    printf("input       %u x %u x %u %s, %.1f MiB\n", g->dims[0], g->dims[1], g->dims[2],
           sample_name(grid_source(g)),
           (double)(grid_samples(g) * sample_size(grid_source(g))) / 0x1p20);
    printf("levels      %u, %u treelets\n", plan->layout.levels, plan->layout.treelets);
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

/* field: name of the only field; "": it has none. */
static void print_sets(const convert_report *a, const char *field) {
    if (a->sets->count > 1)
        for (int i = 0; i < a->sets->count; i++)
            printf("%s%s\n", i ? "            " : "fields      ", a->sets->names[i]);
    else if (*field)
        printf("field       %s\n", field);
    const uint32_t steps = convert_sets_count_steps(a->sets, a->common->input_count);
    if (steps > 1)
        printf("steps       %u\n", steps);
}

/* field: as for print_sets(). */
static void add_sets(json_t *json, const convert_report *a, const char *field) {
    json_t *fields = json_array();
    for (int i = 0; i < a->sets->count; i++)
        json_array_append_new(fields, json_string(a->sets->names[i]));
    if (a->sets->count == 0)
        json_array_append_new(fields, json_string(field));
    json_object_set_new(json, "steps",
                        json_integer(convert_sets_count_steps(a->sets, a->common->input_count)));
    json_object_set_new(json, "fields", fields);
}

static void print_outcome(const convert_outcome *o, const convert_plan *plan, const grid *g) {
    const leaf_header *h = &o->result.header;
    double raw = (double)(grid_samples(g) * sample_size(plan->layout.type)) * plan->layout.sets;
    char lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX], error[NUM_TEXT_MAX], id[LEAF_ID_TEXT];
    printf("file        %.1f MiB, %.3f of raw\n", (double)h->file_bytes / 0x1p20,
           (double)h->file_bytes / raw);
    printf("grid        %u x %u x %u %s, %u levels, %llu treelets\n", h->dims[0], h->dims[1],
           h->dims[2], sample_name((sample_type)h->sample_type), h->levels,
           (unsigned long long)h->treelets);
    printf("values      %s .. %s\n", num_print(h->value_min, lo), num_print(h->value_max, hi));
    if (h->non_finite)
        printf("no data     %llu samples are NaN or infinite\n", (unsigned long long)h->non_finite);
    if (h->source_type != h->sample_type)
        printf("rounding    %s to %s, off by at most %s\n",
               sample_name((sample_type)h->source_type), sample_name((sample_type)h->sample_type),
               num_print(h->rounding_error, error));
    printf("id          %s\n", leaf_id_text(h, id));
    printf("time        %.2f s, %.0f MB/s\n", o->seconds, raw / 1e6 / o->seconds);
    printf("memory      %.1f MiB at most, %u levels spilled\n", (double)peak_rss() / 0x1p20,
           plan->spilled_levels);
}

static void add_outcome(json_t *json, const convert_outcome *o) {
    const leaf_header *h = &o->result.header;
    double raw = (double)h->dims[0] * h->dims[1] * h->dims[2] *
                 (double)sample_size((sample_type)h->sample_type) * h->fields * h->steps;
    char id[LEAF_ID_TEXT];
    json_t *more = json_pack(
        "{s:I, s:I, s:f, s:o, s:o, s:I, s:o, s:I, s:s, s:f, s:f, s:I, s:I, s:I}", "file_bytes",
        (json_int_t)h->file_bytes, "payload_bytes", (json_int_t)h->payload_bytes, "ratio",
        (double)h->file_bytes / raw, "value_min", cli_json_real(h->value_min), "value_max",
        cli_json_real(h->value_max), "non_finite", (json_int_t)h->non_finite, "rounding_error",
        cli_json_real(h->rounding_error), "trailing_bytes", (json_int_t)o->result.trailing_bytes,
        "id", leaf_id_text(h, id), "seconds", o->seconds, "mb_per_s", raw / 1e6 / o->seconds,
        "peak_rss_bytes", (json_int_t)peak_rss(), "absent", (json_int_t)o->result.absent.count,
        "absent_of", (json_int_t)o->result.absent.of);
    json_object_update(json, more);
    json_decref(more);
}

status convert_report_grid(const convert_report *a, const convert_plan *plan, const grid *g,
                           const convert_outcome *o) {
    if (!a->common->json) {
        if (!cli_results(a->common, o != NULL))
            return ST_OK;
        print_sets(a, a->sets->count ? a->sets->names[0] : "");
        if (o)
            print_outcome(o, plan, g);
        else
            print_plan(plan, g);
        return ST_OK;
    }
    json_t *json = plan_json(plan, g);
    add_sets(json, a, "");
    if (o)
        add_outcome(json, o);
    else
        json_object_set_new(json, "file_bytes", json_integer((json_int_t)plan->file_bytes));
    return cli_print_json(a->common, json);
}

/* ---- meshes ---- */

static unsigned long long whole(uint64_t n) {
    return (unsigned long long)n;
}

static void print_input(const convert_report *a, const mesh_report *r) {
    static const char *const kinds[] = {"hexahedra", "wedges", "pyramids", "voxels"};
    printf("input       %llu points, %llu tets\n", whole(r->points), whole(r->tets));
    print_sets(a, r->field);
    for (int i = 0; i < MESH_SPLIT_KINDS; i++)
        if (r->split[i])
            printf("split       %llu %s\n", whole(r->split[i]), kinds[i]);
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

static void print_mesh(const mesh_result *r, double seconds) {
    const leaf_header *h = &r->header;
    char lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX], id[LEAF_ID_TEXT];
    printf("file        %.1f MiB, %.2f bytes a tet\n", (double)h->file_bytes / 0x1p20,
           (double)h->file_bytes / (double)h->tets);
    printf("mesh        %llu tets, %llu vertices, %llu treelets\n", whole(h->tets),
           whole(h->vertices), whole(h->treelets));
    printf("values      %s .. %s\n", num_print(h->value_min, lo), num_print(h->value_max, hi));
    if (h->steps > 1)
        printf("points      %s\n", h->moving ? "move from step to step" : "stay where they are");
    if (h->non_finite)
        printf("no data     %llu values are NaN or infinite\n", whole(h->non_finite));
    if (h->flat || h->inverted)
        printf("kept        %llu flat tets, %llu inverted ones\n", whole(h->flat),
               whole(h->inverted));
    if (h->repeated || h->bad)
        printf(
            "left out    %llu tets with a vertex twice, %llu cells with an id that is no point\n",
            whole(h->repeated), whole(h->bad));
    printf("id          %s\n", leaf_id_text(h, id));
    printf("time        %.2f s (read %.2f, sort %.2f, build %.2f), %.2f million tets a second\n",
           seconds, r->read_s, r->sort_s, r->build_s, (double)h->tets / 1e6 / seconds);
    printf("memory      %.1f MiB at most, %.1f MiB spilled\n", (double)peak_rss() / 0x1p20,
           (double)r->plan.spill_bytes / 0x1p20);
}

static json_t *mesh_plan_json(const mesh_result *r) {
    const mesh_report *in = &r->report;
    return json_pack("{s:I, s:I, s:s, s:[I,I,I,I], s:I, s:I, s:I, s:I, s:I}", "input_points",
                     (json_int_t)in->points, "input_tets", (json_int_t)in->tets, "field", in->field,
                     "split", (json_int_t)in->split[0], (json_int_t)in->split[1],
                     (json_int_t)in->split[2], (json_int_t)in->split[3], "skipped",
                     (json_int_t)in->skipped, "ghosts", (json_int_t)in->ghosts, "memory_planned",
                     (json_int_t)r->plan.memory, "memory_least", (json_int_t)r->plan.memory_least,
                     "spill_bytes", (json_int_t)r->plan.spill_bytes);
}

static void add_mesh(json_t *json, const mesh_result *r, double seconds) {
    const leaf_header *h = &r->header;
    char id[LEAF_ID_TEXT];
    json_t *more = json_pack(
        "{s:I, s:I, s:I, s:I, s:f, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:s}", "file_bytes",
        (json_int_t)h->file_bytes, "tets", (json_int_t)h->tets, "vertices", (json_int_t)h->vertices,
        "treelets", (json_int_t)h->treelets, "bytes_per_tet",
        (double)h->file_bytes / (double)h->tets, "flat", (json_int_t)h->flat, "inverted",
        (json_int_t)h->inverted, "repeated", (json_int_t)h->repeated, "bad", (json_int_t)h->bad,
        "non_finite", (json_int_t)h->non_finite, "value_min", cli_json_real(h->value_min),
        "value_max", cli_json_real(h->value_max), "id", leaf_id_text(h, id));
    json_t *times = json_pack("{s:f, s:f, s:f, s:f, s:f, s:I}", "seconds", seconds, "read_s",
                              r->read_s, "sort_s", r->sort_s, "build_s", r->build_s, "tets_per_s",
                              (double)h->tets / seconds, "peak_rss_bytes", (json_int_t)peak_rss());
    json_object_set_new(more, "moving", json_boolean(h->moving));
    json_object_update(json, more);
    json_object_update(json, times);
    json_decref(more);
    json_decref(times);
}

status convert_report_mesh(const convert_report *a, const mesh_result *r, double seconds) {
    if (a->common->json) {
        json_t *json = mesh_plan_json(r);
        add_sets(json, a, r->report.field);
        if (!a->dry_run)
            add_mesh(json, r, seconds);
        return cli_print_json(a->common, json);
    }
    if (!cli_results(a->common, !a->dry_run))
        return ST_OK;
    print_input(a, &r->report);
    if (a->dry_run)
        print_mesh_plan(&r->plan);
    else
        print_mesh(r, seconds);
    return ST_OK;
}
