#include "formats/leaf/grid_facts.h"

#include <stdio.h>

#include "formats/base/num.h"
#include "formats/base/sample.h"
#include "formats/base/text.h"
#include "formats/leaf/leaf_stats.h"
#include "formats/leaf/outside_samples.h"

static bool is_heights(const leaf_file *f) {
    return f->header.kind == LEAF_KIND_HEIGHTS;
}

/* Bytes of all samples of level 0 before compression; of a height field, as its input has them. */
static double raw_bytes(const leaf_file *f) {
    const leaf_header *h = &f->header;
    return (double)h->dims[0] * (is_heights(f) ? 1 : h->dims[1]) * h->dims[2] *
           (double)sample_size(f->layout.type) * f->layout.sets;
}

static void tell_samples(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    const bool other = h->source_type != h->sample_type;
    const char *source = sample_name((sample_type)h->source_type);
    if (is_heights(f))
        fact_sheet_line(to, "heights", "%u x %u %s%s%s", h->dims[0], h->dims[2],
                        sample_name(f->layout.type), other ? " from " : "", other ? source : "");
    else
        fact_sheet_line(to, "grid", "%u x %u x %u %s%s%s", h->dims[0], h->dims[1], h->dims[2],
                        sample_name(f->layout.type), other ? " from " : "", other ? source : "");
    fact_sheet_wholes(to, "dims", h->dims, 3);
    fact_sheet_text(to, "sample_type", sample_name(f->layout.type));
    fact_sheet_text(to, "source_type", source);
    fact_sheet_flag(to, "rectilinear", h->rectilinear);
    fact_sheet_reals(to, "to_world", h->to_world, 12);
}

static void tell_rounding(const leaf_header *h, const fact_sheet *to) {
    char a[NUM_TEXT_MAX];
    if (h->source_type != h->sample_type)
        fact_sheet_line(to, "rounding", "at most %s", num_print(h->rounding_error, a));
    fact_sheet_real(to, "rounding_error", h->rounding_error);
}

static void print_place(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    char n[4][NUM_TEXT_MAX], axes[WORLD_FRAME_TEXT];
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 4; c++)
            num_print(h->to_world[4 * r + c], n[c]);
        fact_sheet_line(to, r ? "" : "to world", "%s  %s  %s  %s", n[0], n[1], n[2], n[3]);
    }
    fact_sheet_line(to, "space", "%s", h->rectilinear ? "rectilinear" : "regular");
    if (world_frame_print(&f->frame, axes)[0])
        fact_sheet_line(to, "axes", "%s", axes);
}

static void tell_treelets(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    const double raw = raw_bytes(f);
    fact_sheet_line(to, "treelets", "%u^3 cells, halo %u, blocks of %u^3, runs at %u, %s",
                    1u << h->cells_log2, h->halo, 1u << h->block_log2, 1u << h->run_align_log2,
                    leaf_tell_codec(f));
    fact_sheet_whole(to, "treelet_cells", 1u << h->cells_log2);
    fact_sheet_whole(to, "halo", h->halo);
    fact_sheet_whole(to, "block_cells", 1u << h->block_log2);
    fact_sheet_line(to, "file", "%llu bytes, %.3f of the samples",
                    (unsigned long long)h->file_bytes, (double)h->file_bytes / raw);
    leaf_tell_bytes(f, to, raw);
    if (f->samples) {
        char path[TEXT_NAME_MAX];
        text_name(path, sizeof path, outside_samples_path(f->samples));
        fact_sheet_line(to, "level 0", "in place, in %s", path);
        fact_sheet_text(to, "in_place", path);
    }
    fact_sheet_whole(to, "implied_payloads", leaf_tell_implied(f));
}

static void tell(const leaf_file *f, const fact_sheet *to) {
    leaf_tell_begin(f, to);
    tell_samples(f, to);
    leaf_tell_print_fields(f, to);
    leaf_tell_values(f, to, "samples", is_heights(f) ? 2 : 1);
    leaf_tell_print_steps(f, to);
    tell_rounding(&f->header, to);
    print_place(f, to);
    tell_treelets(f, to);
    fact_sheet_frame(to, &f->frame);
    if (f->layout.sets > 1)
        leaf_tell_set_fields(f, to);
}

/* ---- levels ---- */

static const char *print_short(double x, char text[NUM_TEXT_MAX]) {
    snprintf(text, NUM_TEXT_MAX, "%.3g", x);
    return text;
}

static void print_level(const leaf_file *f, const fact_sheet *to, uint32_t i, uint64_t bytes) {
    const leaf_level *l = &f->layout.level[i];
    char dims[40], off[2][NUM_TEXT_MAX], off_by[3 * NUM_TEXT_MAX] = "";
    if (f->deviations && i > 0) {
        const leaf_deviation d = leaf_stats_deviation(f, i);
        snprintf(off_by, sizeof off_by, " %14s %14s", print_short(d.mean, off[0]),
                 d.unknown ? "unknown" : print_short(d.most, off[1]));
    }
    snprintf(dims, sizeof dims, "%ux%ux%u", l->dims[0], l->dims[1], l->dims[2]);
    if (i >= f->layout.sampled)
        snprintf(dims, sizeof dims, "none");
    fact_sheet_row(to, "%5u %18s %10u %14llu%s", i, dims, l->count, (unsigned long long)bytes,
                   off_by);
}

static json_t *deviation_json(const leaf_file *f, uint32_t level) {
    const leaf_deviation d = leaf_stats_deviation(f, level);
    return json_pack("{s:f, s:f, s:I, s:I}", "mean", d.mean, "most", d.most, "bricks",
                     (json_int_t)d.bricks, "unknown", (json_int_t)d.unknown);
}

static json_t *level_json(const leaf_file *f, uint32_t i, uint64_t bytes) {
    const leaf_level *l = &f->layout.level[i];
    json_t *level =
        json_pack("{s:[I,I,I], s:I, s:I, s:b}", "dims", (json_int_t)l->dims[0],
                  (json_int_t)l->dims[1], (json_int_t)l->dims[2], "treelets", (json_int_t)l->count,
                  "bytes", (json_int_t)bytes, "sampled", i < f->layout.sampled);
    if (f->deviations && i > 0)
        json_object_set_new(level, "deviation", deviation_json(f, i));
    return level;
}

/* The level of a treelet's payload, or of those that share a shell. */
static uint32_t level_of(const leaf_layout *l, uint32_t p) {
    uint32_t set, parent;
    if (leaf_layout_is_shell(l, p, &set, &parent))
        return l->level_of[parent] - 1U;
    return l->level_of[p % l->treelets];
}

static void tell_parts(const leaf_file *f, const fact_sheet *to) {
    uint64_t bytes[LEAF_LEVELS_MAX] = {0};
    json_t *levels = json_array();
    for (uint32_t p = 0; p < f->layout.payloads; p++)
        bytes[level_of(&f->layout, p)] += leaf_file_is_home(f, p) ? f->sizes[p] : 0;
    fact_sheet_row(to, "\nlevel            samples   treelets          bytes%s",
                   f->deviations ? "   off by, mean        at most" : "");
    for (uint32_t i = 0; i < f->layout.levels; i++) {
        if (to->lines)
            print_level(f, to, i, bytes[i]);
        if (to->values)
            json_array_append_new(levels, level_json(f, i, bytes[i]));
    }
    fact_sheet_json(to, "levels", levels);
}

const leaf_teller grid_facts = {.name = "grid",
                                .cells = "cells",
                                .drawn = "samples",
                                .has_levels = true,
                                .tell = tell,
                                .tell_parts = tell_parts};

const leaf_teller heights_facts = {.name = "heights",
                                   .cells = "patches",
                                   .drawn = "samples",
                                   .is_surface = true,
                                   .has_levels = true,
                                   .tell = tell,
                                   .tell_parts = tell_parts};
