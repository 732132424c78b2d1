#include "prep/export/export_tets.h"

#include "formats/leaf/mesh_geometry.h"
#include "prep/export/export_pieces.h"
#include "prep/export/tet_pieces.h"
#include "prep/export/tet_surface.h"

static status export_mesh_surface(export_request *a, mem *m, const tet_choice *choice,
                                  piece_info *info) {
    tet_surface *s = NULL;
    const int threads = export_pieces_threads(a, m, tet_surface_worker(choice));
    status st = tet_surface_create(m, choice, a->isos, a->iso_count, threads, &s);
    if (st == ST_OK) {
        const piece_source source = tet_surface_source(s);
        st = export_pieces_write(a, m, &source, threads, info);
    }
    tet_surface_destroy(s);
    return st;
}

static status export_tets(export_request *a, mem *m, const tet_choice *choice, piece_info *info) {
    tet_pieces *s = NULL;
    const leaf_header *h = &choice->f->header;
    const int threads = export_pieces_threads(a, m, tet_bench_bytes(choice));
    info->floats = true;
    status st = tet_pieces_create(m, choice, threads, &s);
    if (st == ST_OK) {
        const piece_source source = tet_pieces_source(s);
        st = export_pieces_write(a, m, &source, threads, info);
    }
    tet_pieces_destroy(s);
    if (st == ST_OK && info->vertices < h->vertices)
        cli_note(&a->common, 1,
                 "%llu vertices lay on others, with the same values, and are one now",
                 (unsigned long long)(h->vertices - info->vertices));
    return st;
}

static status export_mesh(export_request *a, mem *m, leaf_file *f, piece_info *info) {
    const bool surface = a->pieces->corners == 3;
    double time = leaf_file_step_time(f, a->step < f->header.steps ? a->step : 0);
    export_fields fields;
    status st = export_request_fields(a, m, f, &fields);
    if (st == ST_OK) {
        const tet_choice choice = {.f = f,
                                   .fields = fields.fields,
                                   .count = fields.count,
                                   .step = a->step,
                                   .gradients = surface};
        info->fields = fields.names;
        info->field_count = fields.count;
        info->time = f->header.steps > 1 && !surface ? &time : NULL;
        st = surface ? export_mesh_surface(a, m, &choice, info) : export_tets(a, m, &choice, info);
    }
    export_request_release(m, &fields);
    return st;
}

const export_kind export_tets_kind = {.of = &mesh_geometry,
                                      .pieces = export_mesh,
                                      .corners = 4,
                                      .instead =
                                          "leafcast resample makes some, or export it as .vtu"};
