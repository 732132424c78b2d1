#include "prep/import/importer.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/clock.h"
#include "formats/base/file_guard.h"
#include "formats/base/text.h"
#include "formats/curvilinear_options.h"
#include "formats/grid/imported_chunks.h"
#include "formats/grid/nrrd_writer.h"
#include "formats/grid/sample_place.h"
#include "formats/grid/tile_stream.h"
#include "prep/convert_defaults.h"
#include "prep/import/crash.h"
#include "prep/import/file_door.h"
#include "prep/import/import_limits.h"
#include "prep/import/importer_options.h"

enum { BLOCK_BYTES = 16 << 20, COMPONENT_MAX = 1 << 16, STEP_MAX = INT32_MAX };

typedef struct arguments {
    cli_common common;
    const importer *importer;
    import_request q;
    bool list, tiles;
    const char *fields[MESH_STREAM_FIELDS_MAX];
} arguments;

/* ---- options ---- */

static status take_field(arguments *a, const char *name) {
    if (a->q.field_count == MESH_STREAM_FIELDS_MAX)
        return status_describe(ST_USAGE, "--field: at most %d are taken", MESH_STREAM_FIELDS_MAX);
    a->fields[a->q.field_count++] = a->q.field = name;
    return ST_OK;
}

static status set_option(void *own, int key, const char *text) {
    arguments *a = own;
    int word;
    switch (key) {
    case IMPORT_KEY_FIELD: return take_field(a, text);
    case IMPORT_KEY_BY_CORNERS: a->q.by_corners = true; return ST_OK;
    case IMPORT_KEY_CELLS_TO_POINTS: a->q.cells_to_points = true; return ST_OK;
    case IMPORT_KEY_ZONES: a->q.zones = true; return ST_OK;
    case IMPORT_KEY_TO: a->q.to = text; return cli_word(text, "--to", CURVILINEAR_PLACES, &word);
    case IMPORT_KEY_EXAGGERATE: return cli_positive(text, "--exaggerate", &a->q.exaggerate);
    case IMPORT_KEY_COMPONENT:
        return cli_uint(text, "--component", 1, COMPONENT_MAX, &a->q.component);
    case IMPORT_KEY_STEP: return cli_uint(text, "--step", 0, STEP_MAX, &a->q.step);
    case IMPORT_KEY_LIST: a->list = true; return ST_OK;
    case IMPORT_KEY_TILES: a->tiles = true; return ST_OK;
    case IMPORT_KEY_CHUNKS: a->q.chunks = true; return ST_OK;
    case IMPORT_KEY_GUARD: return file_guard_output(text);
    default: break;
    }
    status st = trust_option(&a->q.trust, key);
    return st == ST_AGAIN && a->importer->set_option ? a->importer->set_option(key, text) : st;
}

static status check(void *own) {
    arguments *a = own;
    if (!a->common.input)
        return status_describe(ST_USAGE, "an input is needed: %s", a->importer->inputs);
    if (a->common.output && a->list)
        return status_describe(ST_USAGE, "--list writes no file: -o would change nothing");
    if (a->common.json && !a->common.output && !a->list)
        return status_describe(ST_USAGE,
                               "--json: standard output is taken by the samples: give -o");
    if (a->q.exaggerate != 0 && !a->q.to)
        return status_describe(ST_USAGE, "--exaggerate goes with --to");
    if (a->q.exaggerate == 0)
        a->q.exaggerate = 1;
    if (!a->common.output)
        a->common.output = "-";
    a->q.paths = a->common.inputs;
    a->q.fields = a->fields;
    a->q.path_count = a->common.input_count;
    return ST_OK;
}

/* ---- what went wrong ---- */

/* Find the true reason of a failure. Libraries go on without a file that was refused, and report a
 * lack of memory in ways of their own. */
static status judge(const arguments *a, status st) {
    size_t bytes;
    const status refused = file_door_refused();
    if (refused != ST_OK)
        return refused;
    const bool vague = st == ST_CORRUPT || st == ST_UNSUPPORTED || st == ST_IO || st == ST_FAILED;
    if (!vague || !import_limits_short(&bytes))
        return st;
    char said[STATUS_TEXT_MAX / 2], much[64] = "";
    snprintf(said, sizeof said, "%s", status_text());
    if (bytes)
        snprintf(much, sizeof much, " (%.1f MiB more)", (double)bytes / 0x1p20);
    return status_describe(ST_NOMEM, "%s: %s got no memory%s; --memory gives it more: %s",
                           a->common.input, a->importer->format, much, said);
}

static status step(const progress *p, double fraction) {
    import_limits_progress();
    return progress_step(p, "importing", fraction);
}

/* ---- writing ---- */

static status write_slices(mem *m, slice_source *from, const progress *p, nrrd_writer *w) {
    const grid *g = &from->g;
    const uint64_t bytes = grid_slice_bytes(g);
    const uint64_t room = m->limit && m->limit / 4 < BLOCK_BYTES ? m->limit / 4 : BLOCK_BYTES;
    const uint32_t most = bytes < room ? (uint32_t)(room / bytes) : 1;
    void *block = mem_alloc(m, most < g->dims[2] ? most * bytes : g->dims[2] * bytes);
    status st = block ? ST_OK : ST_NOMEM;
    for (uint32_t z = 0, n; z < g->dims[2] && st == ST_OK; z += n) {
        n = g->dims[2] - z < most ? g->dims[2] - z : most;
        st = step(p, (double)z / g->dims[2]);
        if (st == ST_OK)
            st = from->read(from->ctx, z, n, block);
        if (st == ST_OK)
            st = nrrd_writer_append(w, block, (size_t)n * g->dims[0] * g->dims[1]);
    }
    mem_free(m, block);
    return st == ST_OK ? step(p, 1) : st;
}

static status write_nrrd(mem *m, arguments *a, slice_source *from) {
    nrrd_writer *w = NULL;
    uint64_t trailing = 0;
    status st = nrrd_writer_create(m, a->common.output, a->common.force, &from->g, &w);
    if (st == ST_OK)
        st = write_slices(m, from, cli_progress(&a->common), w);
    if (st == ST_OK && from->finish)
        st = from->finish(from->ctx, &trailing);
    st = judge(a, st);
    if (st == ST_OK)
        return nrrd_writer_commit(w);
    nrrd_writer_discard(w);
    return st;
}

/* Buffers for some slices, their maps, and one packed slice. */
typedef struct tile_block {
    uint32_t room;
    char *slices, *packed;
    uint8_t *busy;
} tile_block;

enum { TILE_SLICES = 8 };

static status make_block(mem *m, const grid *g, tile_block *b) {
    const uint64_t bytes = grid_slice_bytes(g),
                   room = m->limit ? m->limit / 4 / bytes : TILE_SLICES;
    b->room = room < 1 ? 1 : room < TILE_SLICES ? (uint32_t)room : TILE_SLICES;
    b->slices = mem_alloc(m, b->room * bytes);
    b->packed = mem_alloc(m, bytes);
    b->busy = mem_alloc(m, b->room * slice_tiles_count(g->dims));
    if (!b->slices || !b->packed || !b->busy)
        return ST_NOMEM;
    memset(b->busy, 1, b->room * slice_tiles_count(g->dims));
    return ST_OK;
}

static status send_block(out_stream *out, const grid *g, const tile_block *b, uint32_t count) {
    status st = ST_OK;
    for (uint32_t i = 0; i < count && st == ST_OK; i++)
        st = tile_stream_slice(out, g, b->slices + i * grid_slice_bytes(g),
                               b->busy + i * slice_tiles_count(g->dims), b->packed);
    return st;
}

static status send_slices(const slice_source *from, const progress *p, const tile_block *b,
                          out_stream *out) {
    const grid *g = &from->g;
    status st = ST_OK;
    for (uint32_t z = 0, n; z < g->dims[2] && st == ST_OK; z += n) {
        n = g->dims[2] - z < b->room ? g->dims[2] - z : b->room;
        st = step(p, (double)z / g->dims[2]);
        if (st == ST_OK)
            st = from->read_tiles(from->ctx, z, n, b->slices, b->busy);
        if (st == ST_OK)
            st = send_block(out, g, b, n);
    }
    return st;
}

static status write_tiles(mem *m, arguments *a, const slice_source *from) {
    tile_block b = {0};
    out_stream *out = NULL;
    status st = make_block(m, &from->g, &b);
    if (st == ST_OK)
        st = out_stream_create(m, a->common.output, a->common.force, false, &out);
    if (st == ST_OK)
        st = tile_stream_begin(out, &from->g, from->quiet);
    if (st == ST_OK)
        st = send_slices(from, cli_progress(&a->common), &b, out);
    st = judge(a, st);
    if (st == ST_OK)
        st = out_stream_commit(out);
    else
        out_stream_discard(out);
    mem_free(m, b.slices);
    mem_free(m, b.packed);
    mem_free(m, b.busy);
    return st;
}

static status write_chunks(mem *m, const arguments *a, const slice_source *from) {
    sample_place at = {.path = a->common.input};
    out_stream *out = NULL;
    if (!from->place || !from->place(from->place_ctx, &at) || !at.table)
        return status_describe(ST_UNSUPPORTED, "%s: --chunks: it has none that others can read",
                               a->common.input);
    at.path = a->common.input;
    status st = out_stream_create(m, a->common.output, a->common.force, false, &out);
    if (st == ST_OK)
        st = imported_chunks_write(&at, from->g.dims[2], out);
    if (st == ST_OK)
        return out_stream_commit(out);
    out_stream_discard(out);
    return st;
}

static void note_grid(const arguments *a, const grid *g) {
    char text[ABSENT_TEXT];
    if (g->note[0])
        cli_note(&a->common, 1, "%s: %s", a->common.input, g->note);
    if (g->absent.count)
        cli_note(&a->common, 1, "%s: %s", a->common.input, absent_print(&g->absent, text));
}

static status report(const arguments *a, const grid *g, double seconds) {
    note_grid(a, g);
    if (!a->common.json)
        return ST_OK;
    return cli_print_json(&a->common,
                          json_pack("{s:s, s:s, s:s, s:s, s:[i,i,i], s:s, s:s, s:I, s:I, s:f}",
                                    "input", a->common.input, "output", a->common.output, "format",
                                    a->importer->format, "name", g->name, "dims", (int)g->dims[0],
                                    (int)g->dims[1], (int)g->dims[2], "type", sample_name(g->type),
                                    "note", g->note, "absent", (json_int_t)g->absent.count,
                                    "absent_of", (json_int_t)g->absent.of, "seconds", seconds));
}

/* ---- listing ---- */

static json_t *shape_json(const uint64_t shape[4]) {
    json_t *list = json_array();
    for (int i = 0; i < 4 && shape[i]; i++)
        json_array_append_new(list, json_integer((json_int_t)shape[i]));
    return list;
}

/* What is told of all fields. */
typedef struct listing {
    json_t *root, *fields;
} listing;

static status set_array(json_t *to, const char *key, uint64_t count, const double *numbers) {
    json_t *list = json_array();
    for (uint64_t i = 0; i < count; i++)
        json_array_append_new(list, json_real(numbers[i]));
    return json_object_set_new(to, key, list) == 0 ? ST_OK : ST_NOMEM;
}

static status list_about(void *ctx, const char *name, uint64_t steps, const double *times) {
    json_t *root = ((listing *)ctx)->root;
    if (*name)
        json_object_set_new(root, "name", json_string(name));
    return times ? set_array(root, "times", steps, times) : ST_OK;
}

static status list_grid(void *ctx, const import_mesh *x) {
    json_t *root = ((listing *)ctx)->root, *zones = json_array();
    for (uint32_t z = 0; z < x->zone_count; z++)
        json_array_append_new(zones,
                              json_pack("[I, I, I]", (json_int_t)x->zones[z][0],
                                        (json_int_t)x->zones[z][1], (json_int_t)x->zones[z][2]));
    json_object_set_new(root, "blanked", json_boolean(x->blanks != NULL));
    json_object_set_new(root, "still", json_boolean(x->still));
    return json_object_set_new(root, "zones", zones) == 0 ? ST_OK : ST_NOMEM;
}

static void set_times(json_t *entry, const import_item *item) {
    (void)set_array(entry, "times", item->shape[3], item->times);
    if (item->time_unit)
        json_object_set_new(entry, "time_unit", json_string(item->time_unit));
}

static void set_components(json_t *entry, const import_item *item) {
    json_object_set_new(entry, "components", json_integer(item->components));
    json_object_set_new(entry, "component", json_integer(item->component));
    json_object_set_new(entry, "colours", json_boolean(item->colours));
}

static status list_json(void *ctx, const import_item *item) {
    json_t *entry =
        json_pack("{s:s, s:s, s:o, s:b, s:b}", "name", item->name, "type", item->type, "shape",
                  shape_json(item->shape), "readable", item->refuse == NULL, "taken", item->taken);
    if (entry && item->times)
        set_times(entry, item);
    if (entry && item->components > 1)
        set_components(entry, item);
    if (entry && item->of_cells)
        json_object_set_new(entry, "of_cells", json_true());
    if (entry && item->refuse)
        json_object_set_new(entry, "why", json_string(item->refuse));
    return json_array_append_new(((listing *)ctx)->fields, entry) == 0 ? ST_OK : ST_NOMEM;
}

static status list_line(void *ctx, const import_item *item) {
    (void)ctx;
    char shape[96] = "";
    for (int i = 0; i < 4 && item->shape[i]; i++)
        text_add(shape, sizeof shape, "%s%llu", i ? " x " : "", (unsigned long long)item->shape[i]);
    printf("%-24s %-24s %s%s%s\n", item->name, shape, item->type,
           item->refuse ? "; not read: " : "", item->refuse ? item->refuse : "");
    return ST_OK;
}

/* List the fields as JSON, in an object. */
static status read_list(mem *m, const arguments *a, json_t **out) {
    listing l = {.root = json_object(), .fields = json_array()};
    const import_list to = {.take = list_json, .about = list_about, .grid = list_grid, .ctx = &l};
    const status st = a->importer->list(m, &a->q, &to);
    json_object_set_new(l.root, "fields", l.fields);
    if (st != ST_OK)
        json_decref(l.root);
    *out = st == ST_OK ? l.root : NULL;
    return st;
}

static status list(mem *m, const arguments *a) {
    if (!a->common.json)
        return judge(a, a->importer->list(m, &a->q, &(import_list){.take = list_line}));
    json_t *told = NULL;
    status st = judge(a, read_list(m, a, &told));
    if (st != ST_OK)
        return st;
    json_t *root = json_pack("{s:s, s:s}", "input", a->common.input, "format", a->importer->format);
    json_object_update(root, told);
    json_decref(told);
    return cli_print_json(&a->common, root);
}

/* ---- importing ---- */

/* Tell convert, which has started this, and where it would start this again: the place of the
 * samples; what else can be read, if that is one file's, not long, and without escapes. */
static void tell_convert(mem *m, const arguments *a, slice_source *from) {
    sample_place at;
    if (from->place && from->place(from->place_ctx, &at))
        (void)sample_place_print(&at, from->g.place);
    json_t *root = NULL;
    struct stat about;
    if (a->q.path_count != 1 || stat(a->q.paths[0], &about) != 0 || !S_ISREG(about.st_mode) ||
        read_list(m, a, &root) != ST_OK)
        return;
    char *text = json_dumps(root, JSON_COMPACT);
    if (text && strlen(text) < sizeof from->g.fields && !strchr(text, '\\'))
        memcpy(from->g.fields, text, strlen(text) + 1);
    free(text);
    json_decref(root);
}

static status import(mem *m, arguments *a) {
    slice_source from = {0};
    if (strcmp(a->common.output, "-") == 0 && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "samples do not go to a terminal: give -o F.nrrd");
    const double start = clock_seconds();
    status st = a->importer->open(m, &a->q, &from);
    if (st == ST_OK)
        st = grid_check(&from.g, from.name);
    if (st == ST_OK && a->tiles)
        tell_convert(m, a, &from);
    if (st == ST_OK)
        st = a->q.chunks                   ? write_chunks(m, a, &from)
             : a->tiles && from.read_tiles ? write_tiles(m, a, &from)
                                           : write_nrrd(m, a, &from);
    st = judge(a, st);
    if (st == ST_OK)
        st = report(a, &from.g, clock_seconds() - start);
    if (st == ST_OK)
        st = cli_flush();
    /* The output is complete: a crash while the library closes changes nothing. */
    if (st == ST_OK)
        crash_done(0);
    slice_source_close(&from);
    return st;
}

/* ---- importing a mesh ---- */

static status mesh_step(const void *ctx, double fraction) {
    return step(ctx, fraction);
}

static status report_grid(const arguments *a, const import_mesh *x, double seconds) {
    return cli_print_json(&a->common,
                          json_pack("{s:s, s:s, s:s, s:s, s:I, s:I, s:f}", "input", a->common.input,
                                    "output", a->common.output, "format", a->importer->format,
                                    "name", x->header.name, "zones", (json_int_t)x->zone_count,
                                    "nodes", (json_int_t)x->header.points, "seconds", seconds));
}

static status report_mesh(const arguments *a, const import_mesh *x, double seconds) {
    const mesh_stream_header *h = &x->header;
    if (h->by_corners > 0)
        cli_note(&a->common, 1, "%s: %llu cells of higher order are taken by their corners",
                 a->common.input, (unsigned long long)h->by_corners);
    if (h->skipped > 0)
        cli_note(&a->common, 1, "%s: %llu cells of fewer dimensions are left out", a->common.input,
                 (unsigned long long)h->skipped);
    if (x->absent && x->absent->count) {
        char text[ABSENT_TEXT];
        cli_note(&a->common, 1, "%s: %s", a->common.input, absent_print(x->absent, text));
    }
    if (!a->common.json)
        return ST_OK;
    if (x->zone_count)
        return report_grid(a, x, seconds);
    return cli_print_json(
        &a->common,
        json_pack("{s:s, s:s, s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f}", "input",
                  a->common.input, "output", a->common.output, "format", a->importer->format,
                  "name", h->name, "points", (json_int_t)h->points, "tets", (json_int_t)h->tets,
                  "pyramids", (json_int_t)h->cells[CELL_PYRAMID], "wedges",
                  (json_int_t)h->cells[CELL_WEDGE], "hexahedra",
                  (json_int_t)h->cells[CELL_HEXAHEDRON], "quadratic_tets",
                  (json_int_t)h->cells[CELL_QUADRATIC_TET], "polyhedra", (json_int_t)h->polyhedra,
                  "by_corners", (json_int_t)h->by_corners, "skipped", (json_int_t)h->skipped,
                  "seconds", seconds));
}

static status import_the_mesh(mem *m, arguments *a) {
    import_mesh x = {0};
    const bool has_zones = a->q.zones || a->q.to;
    if (strcmp(a->common.output, "-") == 0 && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "a mesh does not go to a terminal: give -o F.%s",
                               has_zones ? "curv" : "mesh");
    const double start = clock_seconds();
    status st = a->importer->open_mesh(m, &a->q, &x);
    if (st == ST_OK)
        st = import_mesh_write(m, &x, a->common.output, a->common.force, mesh_step,
                               cli_progress(&a->common));
    st = judge(a, st);
    if (st == ST_OK)
        st = report_mesh(a, &x, clock_seconds() - start);
    if (st == ST_OK)
        st = cli_flush();
    if (st == ST_OK)
        crash_done(0);
    import_mesh_close(&x);
    return st;
}

/* ---- the fence ---- */

/* Register the files before the library opens any: an output must not be an input. */
static status guard_files(const arguments *a) {
    const char *output = a->list ? NULL : a->common.output;
    file_guard_watch();
    status st = file_guard_output(output);
    for (int i = 0; i < a->q.path_count && st == ST_OK; i++)
        st = file_guard_input(a->q.paths[i]);
    return st;
}

static void fence(const arguments *a) {
    const char *open =
        file_door_grant(&(file_door_grants){.inputs = a->q.paths,
                                            .input_count = a->q.path_count,
                                            .beside = a->importer->beside,
                                            .anywhere = a->q.trust.follow_links,
                                            .output = a->list ? NULL : a->common.output});
    if (open)
        cli_note(&a->common, 2, "%s is not kept from %s", a->importer->format, open);
}

/* Returns whether a mesh or a curvilinear grid is asked for, and not samples. */
static bool gives_nodes(const arguments *a) {
    return a->importer->open_mesh && (!a->importer->open || a->q.to);
}

static const output_kind *output(const void *own) {
    const arguments *a = own;
    static const output_kind zones = {
        .what = "a curvilinear stream", .suffixes = ".curv ", .instead = OUTPUT_BY_EXPORT};
    static const output_kind samples = {
        .what = "NRRD", .suffixes = ".nrrd ", .instead = OUTPUT_BY_EXPORT};
    static const output_kind mesh = {
        .what = "a mesh stream", .suffixes = ".mesh ", .instead = OUTPUT_BY_EXPORT};
    if (a->q.zones || a->q.to)
        return &zones;
    return gives_nodes(a) ? &mesh : &samples;
}

int importer_main(const importer *x, int argc, char **argv) {
    arguments a = {
        .common = {.verb = x->verb, .without = "threads"}, .importer = x, .q = {.verb = x->verb}};
    char usage[256];
    snprintf(usage, sizeof usage, "%s [-o F.%s]\n%s --list", x->inputs,
             x->open_mesh ? "mesh" : "nrrd", x->inputs);
    const cli_verb verb = {.options = x->options,
                           .args_doc = usage,
                           .doc = x->doc,
                           .input = "input",
                           .inputs_max = x->inputs_max,
                           .set_option = set_option,
                           .check = check,
                           .output = output};
    cli_parse(&verb, &a.common, argc, argv);
    mem m;
    mem_init(&m, a.common.memory ? a.common.memory : CONVERT_MEMORY_DEFAULT);
    crash_watch(x->verb, x->format, a.common.input);
    import_limits_begin(m.limit, IMPORT_SECONDS);
    fence(&a);
    status st = guard_files(&a);
    if (st == ST_OK)
        st = a.list ? list(&m, &a) : gives_nodes(&a) ? import_the_mesh(&m, &a) : import(&m, &a);
    const int code = cli_finish(&a.common, st);
    crash_done(code);
    return code;
}
