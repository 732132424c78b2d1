#include "prep/mesh/convert_meshes.h"

#include <string.h>

#include "formats/base/clock.h"
#include "formats/mesh/mesh_input.h"
#include "formats/mesh/mesh_input_kind.h"
#include "prep/convert_append.h"
#include "prep/convert_choices.h"
#include "prep/further_step.h"
#include "prep/mesh/convert_mesh_report.h"
#include "prep/mesh/mixed_treelet.h"

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
                           .taken = of->count == 0,
                           .components = (uint32_t)components};
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
static status check_whole(const convert_request *a) {
    const struct {
        bool given;
        const char *what;
    } without[] = {{a->gradients, "--gradients"},
                   {a->sah, "--build sah"},
                   {a->leaf_tets_is_given, "--leaf-tets"}};
    for (size_t i = 0; i < sizeof without / sizeof *without && a->whole; i++)
        if (without[i].given)
            return status_describe(ST_USAGE, "--whole-cells goes without %s", without[i].what);
    if (a->whole && a->grow && a->treelet_tets > MIXED_TREELET_MAX)
        return status_describe(ST_UNSUPPORTED,
                               "%s: its treelets have up to %u cells; those of %d or fewer can "
                               "grow: convert it again",
                               a->common.output, a->treelet_tets, MIXED_TREELET_MAX);
    if (a->whole && a->treelet_tets > MIXED_TREELET_MAX)
        return status_describe(ST_USAGE, "--treelet-tets: with --whole-cells at most %d",
                               MIXED_TREELET_MAX);
    return ST_OK;
}

static status convert_mesh(convert_request *a, mem *m, mesh_input *x, const mesh_series *series,
                           double start) {
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
                            .cells = a->whole ? &mixed_treelets : NULL,
                            .refuse_empty = !a->allow_empty,
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
        st = convert_mesh_report(a, &r, clock_seconds() - start);
    return st;
}

static leaf_kind kind_of(const convert_request *a) {
    return a->whole ? LEAF_KIND_MIXED : LEAF_KIND_MESH;
}

static status run(convert_request *a, mem *m, input *in, double start) {
    mesh_input *x = in->own;
    status st = check_whole(a);
    if (st == ST_OK)
        st = take_sets(&a->sets, x, a->common.input);
    if (st == ST_OK)
        st = convert_request_times(a);
    mesh_series series = {convert_request_series(a), a->hints.mesh};
    if (st == ST_OK)
        st = step_series_check(&series.of);
    if (st == ST_OK && a->grow && leaf_grow_before(a->grow)->header.kind != kind_of(a))
        st = further_step_refuse(leaf_grow_before(a->grow), a->common.input,
                                 a->whole ? "it is a mesh of whole cells, and the file is of none"
                                          : "it is a mesh, and the file is of none");
    if (st == ST_OK)
        st = convert_append_check(a, &series.of.sets);
    return st == ST_OK ? convert_mesh(a, m, x, &series, start) : st;
}

const convert_kind convert_meshes = {
    .of = &mesh_input_kind, .is_collection = is_collection, .note = note, .run = run};
