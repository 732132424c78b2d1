#include "prep/export/export_cells.h"

#include "formats/leaf/mesh_geometry.h"
#include "formats/leaf/triangle_geometry.h"
#include "prep/export/export_pieces.h"
#include "prep/export/hex_solids.h"
#include "prep/export/hex_surface.h"
#include "prep/export/tet_solids.h"
#include "prep/export/tet_surface.h"
#include "prep/export/triangle_cells.h"

/* Makers of isosurfaces and of cells, and what each of their threads needs. */
typedef struct cell_makers {
    status (*surface)(mem *m, const cell_choice *choice, const double *isovalues, uint32_t count,
                      int threads, piece_source *out);
    status (*cells)(mem *m, const cell_choice *choice, int threads, piece_source *out);
    uint64_t (*surface_worker)(const cell_choice *choice);
    uint64_t (*cells_worker)(const cell_choice *choice);
} cell_makers;

static status write_surface(export_request *a, mem *m, const cell_choice *choice,
                            const cell_makers *by, piece_info *info) {
    piece_source source = {.ctx = NULL};
    const int threads = export_pieces_threads(a, m, by->surface_worker(choice));
    status st = by->surface(m, choice, a->isos, a->iso_count, threads, &source);
    if (st == ST_OK)
        st = export_pieces_write(a, m, &source, threads, info);
    piece_source_release(&source);
    return st;
}

static status write_cells(export_request *a, mem *m, const cell_choice *choice,
                          const cell_makers *by, piece_info *info) {
    piece_source source = {.ctx = NULL};
    const uint64_t known = choice->f->header.vertices;
    const int threads = export_pieces_threads(a, m, by->cells_worker(choice));
    info->floats = true;
    status st = by->cells(m, choice, threads, &source);
    if (st == ST_OK)
        st = export_pieces_write(a, m, &source, threads, info);
    piece_source_release(&source);
    if (st == ST_OK && !a->pieces->loose && info->vertices < known)
        cli_note(&a->common, 1,
                 "%llu vertices lay on others, with the same values, and are one now",
                 (unsigned long long)(known - info->vertices));
    return st;
}

/* The fields that are asked for, and their names. Release them in any case. */
static status choose(export_request *a, mem *m, leaf_file *f, export_fields *fields,
                     cell_choice *choice, piece_info *info) {
    const status st = export_request_fields(a, m, f, fields);
    *choice =
        (cell_choice){.f = f, .fields = fields->fields, .count = fields->count, .step = a->step};
    info->fields = fields->names;
    info->field_count = fields->count;
    return st;
}

static status write_pieces(export_request *a, mem *m, leaf_file *f, const cell_makers *by,
                           piece_info *info) {
    const bool surface = !a->pieces->solid;
    double time = leaf_file_step_time(f, a->step < f->header.steps ? a->step : 0);
    export_fields fields;
    cell_choice choice;
    status st = choose(a, m, f, &fields, &choice, info);
    if (st == ST_OK) {
        choice.gradients = surface;
        info->time = f->header.steps > 1 && !surface ? &time : NULL;
        st =
            surface ? write_surface(a, m, &choice, by, info) : write_cells(a, m, &choice, by, info);
    }
    export_request_release(m, &fields);
    return st;
}

static status write_tets(export_request *a, mem *m, leaf_file *f, piece_info *info) {
    static const cell_makers by = {tet_surface_create, tet_solids_create, tet_surface_worker,
                                   tet_solids_worker};
    return write_pieces(a, m, f, &by, info);
}

static status write_hexes(export_request *a, mem *m, leaf_file *f, piece_info *info) {
    static const cell_makers by = {hex_surface_create, hex_solids_create, hex_surface_worker,
                                   hex_solids_worker};
    return write_pieces(a, m, f, &by, info);
}

static status write_triangles(export_request *a, mem *m, leaf_file *f, piece_info *info) {
    static const cell_makers by = {.cells = triangle_cells_create,
                                   .cells_worker = triangle_cells_worker};
    export_fields fields;
    cell_choice choice;
    info->given = true;
    info->normals = triangle_have_normals(f);
    status st = choose(a, m, f, &fields, &choice, info);
    if (st == ST_OK)
        st = write_cells(a, m, &choice, &by, info);
    export_request_release(m, &fields);
    return st;
}

#define INSTEAD "leafcast resample makes some, or export it as .vtu"

const export_kind export_tets = {&mesh_geometry, NULL, NULL, write_tets, "tets", INSTEAD, false};
const export_kind export_hexes = {NULL, NULL, NULL, write_hexes, "cells", INSTEAD, false};
const export_kind export_triangles = {
    &triangle_geometry, NULL, NULL, write_triangles, NULL, "export it as .ply, .stl or .vtp", true};
