#include "formats/leaf/leaf_tell.h"

#include <math.h>

#include "formats/base/cli_json.h"
#include "formats/base/num.h"
#include "formats/leaf/leaf_histogram.h"

void leaf_tell_begin(const leaf_file *f, const fact_sheet *to) {
    char id[LEAF_ID_TEXT];
    leaf_id_text(&f->header, id);
    fact_sheet_line(to, "name", "%s", f->name);
    fact_sheet_line(to, "made by", "%s", f->header.provenance);
    fact_sheet_line(to, "id", "%s", id);
    fact_sheet_text(to, "name", f->name);
    fact_sheet_text(to, "provenance", f->header.provenance);
    fact_sheet_text(to, "id", id);
}

void leaf_tell_values(const leaf_file *f, const fact_sheet *to, const char *counted,
                      unsigned copies) {
    const leaf_header *h = &f->header;
    char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
    fact_sheet_line(to, "values", "%s .. %s", num_print(h->value_min, a),
                    num_print(h->value_max, b));
    const uint64_t non_finite = h->non_finite / copies;
    if (non_finite)
        fact_sheet_line(to, "no data", "%llu %s are NaN or infinite",
                        (unsigned long long)non_finite, counted);
    fact_sheet_real(to, "value_min", h->value_min);
    fact_sheet_real(to, "value_max", h->value_max);
    fact_sheet_whole(to, "non_finite", non_finite);
}

/* ---- fields and steps ---- */

static void field_range(const leaf_file *f, uint32_t field, double range[2]) {
    range[0] = (double)INFINITY;
    range[1] = -(double)INFINITY;
    for (uint32_t step = 0; step < f->header.steps; step++) {
        double own[2];
        leaf_histogram_range(f, leaf_layout_set(&f->layout, field, step), own);
        range[0] = fmin(range[0], own[0]);
        range[1] = fmax(range[1], own[1]);
    }
}

/* Print the name of a single field; of several, their ranges too. */
void leaf_tell_print_fields(const leaf_file *f, const fact_sheet *to) {
    if (f->header.fields == 1) {
        if (f->names[0][0])
            fact_sheet_line(to, "field", "%s", f->names[0]);
        return;
    }
    for (uint32_t i = 0; to->lines && i < f->header.fields; i++) {
        char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
        double range[2];
        field_range(f, i, range);
        fact_sheet_line(to, i ? "" : "fields", "%s: %s .. %s", f->names[i], num_print(range[0], a),
                        num_print(range[1], b));
    }
}

void leaf_tell_print_steps(const leaf_file *f, const fact_sheet *to) {
    char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
    if (f->header.steps > 1)
        fact_sheet_line(to, "steps", "%u, times %s .. %s%s%s%s", f->header.steps,
                        num_print(f->times[0], a), num_print(f->times[f->header.steps - 1], b),
                        f->frame.time_unit[0] ? " " : "", f->frame.time_unit,
                        leaf_layout_moves(&f->layout) ? ", vertices move" : "");
}

/* For each field its name, and the range of its values at each step. */
static json_t *fields_json(const leaf_file *f) {
    json_t *fields = json_array();
    for (uint32_t i = 0; i < f->header.fields; i++) {
        json_t *ranges = json_array();
        for (uint32_t step = 0; step < f->header.steps; step++) {
            double range[2];
            leaf_histogram_range(f, leaf_layout_set(&f->layout, i, step), range);
            json_array_append_new(
                ranges, json_pack("[o, o]", cli_json_real(range[0]), cli_json_real(range[1])));
        }
        json_array_append_new(fields,
                              json_pack("{s:s, s:o}", "name", f->names[i], "step_ranges", ranges));
    }
    return fields;
}

void leaf_tell_set_fields(const leaf_file *f, const fact_sheet *to) {
    if (!to->values)
        return;
    fact_sheet_whole(to, "field_count", f->header.fields);
    fact_sheet_whole(to, "steps", f->header.steps);
    fact_sheet_json(to, "fields", fields_json(f));
    fact_sheet_reals(to, "times", f->times, (int)f->header.steps);
}

/* ---- bytes ---- */

void leaf_tell_coarse(const leaf_file *f, const fact_sheet *to) {
    uint32_t sets = 0;
    uint64_t bytes = 0;
    for (uint32_t set = 0; set < f->layout.sets; set++)
        if (leaf_file_has_coarse(f, set)) {
            sets++;
            bytes += f->coarse[set].bytes;
        }
    if (sets)
        fact_sheet_line(to, "coarse", "grids of %u of %u sets, %llu bytes, %.3f of the file", sets,
                        f->layout.sets, (unsigned long long)bytes,
                        (double)bytes / (double)f->header.file_bytes);
    fact_sheet_whole(to, "coarse_sets", sets);
    fact_sheet_whole(to, "coarse_bytes", bytes);
}

void leaf_tell_bounds(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    char lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX];
    double bounds[6];
    for (int i = 0; i < 6; i++)
        bounds[i] = (double)h->bounds[i];
    for (int i = 0; i < 3; i++)
        fact_sheet_line(to, i ? "" : "bounds", "%s .. %s", num_print(bounds[i], lo),
                        num_print(bounds[i + 3], hi));
    fact_sheet_reals(to, "bounds", bounds, 6);
}

const char *leaf_tell_codec(const leaf_file *f) {
    return f->header.codec == LEAF_CODEC_RAW ? "raw" : "zstd";
}

uint32_t leaf_tell_implied(const leaf_file *f) {
    uint32_t implied = 0;
    const uint32_t shells = f->layout.shells * f->layout.sets; /* may be needless, and are last */
    for (uint32_t p = 0; p < f->layout.payloads - shells; p++)
        implied += leaf_file_is_implied(f, p);
    return implied;
}

static void print_bytes(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    const unsigned long long payload_bytes = h->payload_bytes;
    const leaf_layout *l = &f->layout;
    const uint32_t implied = leaf_tell_implied(f), bare = h->bare ? l->level[0].first : 0;
    fact_sheet_line(to, "directory", "%llu bytes, %.1f a treelet",
                    (unsigned long long)f->directory_bytes,
                    (double)f->directory_bytes / (double)h->treelets);
    if (implied)
        fact_sheet_line(to, "payloads", "%llu bytes; %u of %u treelets have one value, and none",
                        payload_bytes, implied, l->payloads - (l->shells + bare) * l->sets);
    else
        fact_sheet_line(to, "payloads", "%llu bytes", payload_bytes);
}

/* What the sets of a file have in common. */
static void tell_series(const leaf_file *f, const fact_sheet *to) {
    uint32_t same = 0, differences = 0;
    if (f->layout.sets == 1)
        return;
    for (uint32_t p = 0; p < f->layout.payloads; p++) {
        same += f->links.same && f->links.same[p];
        differences += f->links.bases && f->links.bases[p];
    }
    fact_sheet_line(to, "series",
                    "%u payloads are the same as earlier ones, %u differences to them", same,
                    differences);
    fact_sheet_whole(to, "same_payloads", same);
    fact_sheet_whole(to, "difference_payloads", differences);
}

void leaf_tell_bytes(const leaf_file *f, const fact_sheet *to, double raw) {
    const leaf_header *h = &f->header;
    print_bytes(f, to);
    tell_series(f, to);
    fact_sheet_whole(to, "run_align", 1U << h->run_align_log2);
    fact_sheet_text(to, "codec", leaf_tell_codec(f));
    fact_sheet_whole(to, "treelets", h->treelets);
    fact_sheet_whole(to, "file_bytes", h->file_bytes);
    fact_sheet_whole(to, "directory_bytes", f->directory_bytes);
    fact_sheet_whole(to, "payload_bytes", h->payload_bytes);
    fact_sheet_real(to, "ratio", (double)h->file_bytes / raw);
}

/* ---- a kind without a row ---- */

static void tell_other(const leaf_file *f, const fact_sheet *to) {
    leaf_tell_begin(f, to);
    leaf_tell_print_fields(f, to);
    leaf_tell_values(f, to, "values", 1);
    leaf_tell_print_steps(f, to);
    leaf_tell_bytes(f, to, (double)f->header.payload_bytes);
    leaf_tell_set_fields(f, to);
}

const leaf_teller leaf_tell_other = {
    .name = "other", .cells = "cells", .drawn = "cells", .tell = tell_other};
