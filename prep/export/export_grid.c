#include "prep/export/export_grid.h"

#include <jansson.h>
#include <stdio.h>

#include "formats/base/clock.h"
#include "formats/base/text.h"
#include "formats/leaf/grid_facts.h"
#include "formats/leaf/grid_geometry.h"
#include "prep/export/export_pieces.h"
#include "prep/export/grid_slices.h"
#include "prep/export/grid_surface.h"
#include "prep/export/heights_surface.h"
#include "prep/export/sample_stream.h"
#include "prep/export/slice_files.h"

/* The part of a grid to export, of its first chosen field. */
static status choose_part(const export_request *a, const leaf_file *f, uint32_t field,
                          grid_part *part) {
    status st = grid_part_of(f, a->level, a->boxed ? a->box : NULL, part);
    part->set = leaf_layout_set(&f->layout, field, a->step < f->header.steps ? a->step : 0);
    return st == ST_OK ? export_request_step(a, f) : st;
}

/* ---- samples ---- */

static status write_slices(const export_request *a, mem *m, const sample_export *e, const grid *g) {
    slice_files *files = NULL;
    status st = slice_files_create(m, e->path, e->force, a->samples, g, &files);
    if (st == ST_OK)
        st = grid_slices_run(m, e->f, e->part, e->threads, e->p, slice_files_take, files);
    return slice_files_end(files, st);
}

static status write_samples(const export_request *a, mem *m, const sample_export *e,
                            const grid *g) {
    if (a->samples->write)
        return a->samples->write(m, e);
    return export_request_is_sequence(a) ? write_slices(a, m, e, g)
                                         : sample_stream_write(m, a->samples, e, g, a->gzip);
}

static status report_samples(const export_request *a, const grid *g, uint32_t steps,
                             double seconds) {
    if (a->common.json)
        return cli_print_json(
            &a->common,
            json_pack("{s:s, s:s, s:[i,i,i], s:s, s:i, s:f}", "output", a->common.output, "format",
                      a->samples->name, "dims", (int)g->dims[0], (int)g->dims[1], (int)g->dims[2],
                      "type", sample_name(g->type), "steps", (int)steps, "seconds", seconds));
    if (export_request_to_stdout(a) || !cli_results(&a->common, true))
        return ST_OK;
    printf("samples     %u x %u x %u %s, little endian, as %s\n", g->dims[0], g->dims[1],
           g->dims[2], sample_name(g->type), a->samples->name);
    if (steps > 1)
        printf("steps       %u\n", steps);
    printf("time        %.2f s\n", seconds);
    return ST_OK;
}

/* Tell what the file will not keep, and set the name of its array. */
static void settle_head(const export_request *a, const char *field, const sample_times *times,
                        grid *g) {
    const char *lost[] = {a->samples->loses ? a->samples->loses(g) : NULL,
                          a->all_steps ? a->samples->loses_times(times) : NULL};
    for (int i = 0; i < 2; i++)
        if (lost[i])
            cli_note(&a->common, 1, "%s: %s", a->common.output, lost[i]);
    if (a->samples->named && field[0])
        text_name(g->name, sizeof g->name, field);
}

static status export_samples(export_request *a, mem *m, leaf_file *f, double start) {
    grid_part part;
    grid g = {.dims = {0}};
    export_fields fields;
    const sample_times times = sample_times_of(f, a->all_steps);
    status st = export_request_fields(a, m, f, &fields);
    if (st == ST_OK)
        st = choose_part(a, f, fields.fields[0], &part);
    if (st == ST_OK)
        st = grid_part_describe(m, f, &part, &g);
    if (st == ST_OK && a->samples->check)
        st = a->samples->check(&g);
    if (st == ST_OK)
        settle_head(a, f->names[fields.fields[0]], &times, &g);
    if (st == ST_OK)
        st = write_samples(a, m,
                           &(sample_export){.f = f,
                                            .part = &part,
                                            .sets = fields.sets,
                                            .names = fields.names,
                                            .count = fields.count,
                                            .times = &times,
                                            .path = a->common.output,
                                            .force = a->common.force,
                                            .threads = a->common.threads,
                                            .p = cli_progress(&a->common)},
                           &g);
    if (st == ST_OK)
        st = report_samples(a, &g, times.steps, clock_seconds() - start);
    grid_release(&g, m);
    export_request_release(m, &fields);
    return st;
}

/* ---- surfaces ---- */

static status export_grid_surface(export_request *a, mem *m, leaf_file *f, piece_info *info) {
    grid_part part;
    piece_source source = {.ctx = NULL};
    uint32_t field = 0;
    status st = a->field_count ? export_request_field(f, a->fields[0], &field) : ST_OK;
    const int threads = export_pieces_threads(a, m, grid_surface_worker(f));
    if (st == ST_OK)
        st = choose_part(a, f, field, &part);
    if (st == ST_OK)
        st = grid_surface_create(m, f, &part, a->isos, a->iso_count, threads, &source);
    if (st == ST_OK)
        st = export_pieces_write(a, m, &source, threads, info);
    piece_source_release(&source);
    return st;
}

/* Of the fields that are chosen, the first is the elevations. */
static status export_terrain(export_request *a, mem *m, leaf_file *f, piece_info *info) {
    grid_part part;
    export_fields fields;
    piece_source source = {.ctx = NULL};
    int threads = 1;
    status st = export_request_fields(a, m, f, &fields);
    if (st == ST_OK)
        st = choose_part(a, f, fields.fields[0], &part);
    if (st == ST_OK) {
        threads = export_pieces_threads(a, m, heights_surface_worker(f, fields.count));
        st = heights_surface_create(m, f, &part, fields.sets, fields.count, threads, &source);
    }
    info->given = true;
    info->fields = fields.names;
    info->field_count = fields.count;
    if (st == ST_OK)
        st = export_pieces_write(a, m, &source, threads, info);
    piece_source_release(&source);
    export_request_release(m, &fields);
    return st;
}

const export_kind export_heights = {.told = &heights_facts,
                                    .samples = export_samples,
                                    .pieces = export_terrain,
                                    .instead = "export it as .ply, .stl or .vtp",
                                    .given = true};

const export_kind export_grid = {.of = &grid_geometry,
                                 .samples = export_samples,
                                 .pieces = export_grid_surface,
                                 .instead = "try .vti"};
