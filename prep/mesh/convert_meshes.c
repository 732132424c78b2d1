#include "prep/mesh/convert_meshes.h"

#include <stdlib.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/mesh/mesh_input.h"
#include "formats/mesh/mesh_input_kind.h"
#include "formats/surface/surface_input_kind.h"
#include "formats/surface/surface_readers.h"
#include "prep/convert_append.h"
#include "prep/convert_choices.h"
#include "prep/further_step.h"
#include "prep/mesh/convert_mesh_report.h"
#include "prep/mesh/mixed_treelet.h"
#include "prep/mesh/triangle_treelet.h"

/* ---- notes ---- */

static bool is_collection(const void *own) {
    return mesh_input_names_files(own) && mesh_input_times(own);
}

typedef struct mesh_choices {
    convert_choices choices;
    uint32_t steps;
} mesh_choices;

/* The first array is the default. A name that comes again belongs to another piece or step: skip
 * it. */
static void take_array(void *ctx, const char *name, int components) {
    mesh_choices *c = ctx;
    convert_choices *of = &c->choices;
    const slice_field f = {.name = name,
                           .steps = c->steps,
                           .taken = of->count == 0 && components > 0,
                           .components = (uint32_t)abs(components)};
    name_list before = {0};
    name_list_add(&before, name);
    if (!strstr(of->taken.text, before.text) && !strstr(of->others.text, before.text))
        convert_choices_take(of, &f);
}

static void note(const convert_request *a, const void *own) {
    mesh_choices c = {.choices = {.common = &a->common,
                                  .sets = &a->sets,
                                  .component = (uint32_t)a->hints.mesh.component,
                                  .step = a->step || step_list_given(&a->sets.taken)},
                      .steps = mesh_input_steps(own)};
    if (a->common.verbosity <= 0)
        return;
    mesh_input_fields(own, take_array, &c);
    /* Of a surface that has normals alone, nothing is taken unasked. */
    if (c.choices.taken.text[0])
        convert_choices_note(&c.choices);
}

/* ---- fields and steps ---- */

typedef struct taking {
    convert_sets *s;
    status st;
} taking;

static void take_field(void *ctx, const char *name, int components) {
    (void)components;
    taking *t = ctx;
    if (t->st == ST_OK)
        t->st = convert_sets_take_copy(t->s, name);
}

/* Resolve "all fields" and the list of steps, if asked for. ST_USAGE: there is no such step. */
static status take_sets(convert_sets *s, const mesh_input *x, const char *name) {
    taking t = {s, ST_OK};
    if (s->all_fields)
        mesh_input_fields(x, take_field, &t);
    return t.st == ST_OK
               ? convert_sets_take_steps(s, name, mesh_input_steps(x), mesh_input_times(x))
               : t.st;
}

/* ---- one series ---- */

/* What does not go with cells that are not split. */
static status check_whole(const convert_request *a, const cell_treelets *cells) {
    const bool surface = cells == &triangle_treelets;
    const struct {
        bool given, of_all;
        const char *what;
    } without[] = {{a->gradients, true, "--gradients"},
                   {a->sah, true, "--build sah"},
                   {a->leaf_tets_is_given, true, "--leaf-tets"},
                   {a->coarse, surface, "--coarse"},
                   {a->whole, surface, "--whole-cells"},
                   {a->hints.mesh.by_corners, surface, "--by-corners"}};
    for (size_t i = 0; i < sizeof without / sizeof *without && cells; i++)
        if (without[i].given && without[i].of_all)
            return status_describe(ST_USAGE, "%s without %s",
                                   surface ? "a surface is converted" : "--whole-cells goes",
                                   without[i].what);
    if (a->normals_are_given && !surface)
        return status_describe(ST_USAGE,
                               "--normals: %s is no surface of triangles; --gradients "
                               "makes a mesh of tets smooth",
                               a->common.input);
    const uint32_t most = cells ? cells->cells_max : a->treelet_tets;
    if (a->grow && a->treelet_tets > most)
        return status_describe(ST_UNSUPPORTED,
                               "%s: its treelets have up to %u cells; those of %u or fewer can "
                               "grow: convert it again",
                               a->common.output, a->treelet_tets, most);
    if (a->treelet_tets > most)
        return status_describe(ST_USAGE, "--treelet-tets: %s at most %u",
                               surface ? "of triangles" : "with --whole-cells", most);
    return ST_OK;
}

static status convert_mesh(convert_request *a, mem *m, mesh_input *x, const mesh_series *series,
                           const cell_treelets *cells, double start) {
    const mesh_options o = {.file = a->file,
                            .series = series,
                            .treelet_tets = a->treelet_tets,
                            .leaf_tets = a->leaf_tets,
                            .sah = a->sah,
                            .coarse = a->coarse,
                            .coarse_dims = a->coarse_dims,
                            .memory = m->limit - convert_append_memory(a, m),
                            .threads = a->common.threads,
                            .force = a->common.force,
                            .gradients = a->gradients,
                            .normals = (surface_normals)a->normals,
                            .cells = cells,
                            .refuse_empty = !a->allow_empty && cells != &triangle_treelets,
                            .grows = a->append,
                            .grow = a->grow,
                            .work = a->work.folder,
                            .job = &a->work.job};
    mesh_result r;
    const progress *p = cli_progress(&a->common);
    status st = a->dry_run ? mesh_convert_dry(m, x, &o, p, &r)
                           : mesh_convert_run(m, x, a->common.output, &o, p, &r);
    if (st == ST_OK)
        convert_append_note(a, &series->of.sets);
    if (st == ST_OK)
        st = convert_mesh_report(a, cells, &r, clock_seconds() - start);
    return st;
}

/* cells: NULL: tets. what: the input is. */
static status run_as(convert_request *a, mem *m, input *in, double start,
                     const cell_treelets *cells, const char *what) {
    mesh_input *x = in->own;
    status st = check_whole(a, cells);
    if (st == ST_OK)
        st = take_sets(&a->sets, x, a->common.input);
    if (st == ST_OK)
        st = convert_request_times(a);
    mesh_series series = {convert_request_series(a), a->hints.mesh,
                          cells == &triangle_treelets ? &surface_readers : NULL};
    if (st == ST_OK)
        st = step_series_check(&series.of);
    const uint32_t kind = cells ? cells->kind : LEAF_KIND_MESH;
    if (st == ST_OK && a->grow && leaf_grow_before(a->grow)->header.kind != kind)
        st = further_step_refuse(leaf_grow_before(a->grow), a->common.input, "%s", what);
    if (st == ST_OK)
        st = convert_append_check(a, &series.of.sets);
    return st == ST_OK ? convert_mesh(a, m, x, &series, cells, start) : st;
}

static status run(convert_request *a, mem *m, input *in, double start) {
    return run_as(a, m, in, start, a->whole ? &mixed_treelets : NULL,
                  a->whole ? "it is a mesh of whole cells, and the file is of none"
                           : "it is a mesh, and the file is of none");
}

static status run_surface(convert_request *a, mem *m, input *in, double start) {
    return run_as(a, m, in, start, &triangle_treelets, "it is a surface, and the file is of none");
}

const convert_kind convert_meshes = {
    .of = &mesh_input_kind, .is_collection = is_collection, .note = note, .run = run};

const convert_kind convert_surfaces = {
    .of = &surface_input_kind, .is_collection = is_collection, .note = note, .run = run_surface};
