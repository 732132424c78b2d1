/* leafcast info - what is in a treelet file, or in an input of convert. */
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/file.h"
#include "formats/base/num.h"
#include "formats/base/shell_line.h"
#include "formats/base/text.h"
#include "formats/input_facts.h"
#include "formats/leaf/histogram_text.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_histogram.h"
#include "formats/leaf/leaf_stats.h"
#include "formats/trust_options.h"

enum { ISOS_MAX = 64, HISTOGRAM_MAX = 32 };

typedef struct arguments {
    cli_common common;
    double isos[ISOS_MAX];
    int iso_count;
    input_question question; /* for inputs that are not treelet files */
} arguments;

enum { KEY_ISO = 0x2000, KEY_QUICK, KEY_FIELD, KEY_DIMS, KEY_TYPE, KEY_BIG_ENDIAN, KEY_SKIP };

static const struct argp_option options[] = {
    {"iso", KEY_ISO, "V", CLI_BASIC,
     "of a treelet file: count what this isovalue needs; may be repeated", 0},
    {NULL, 0, NULL, 0, "Other inputs:", 1},
    {"quick", KEY_QUICK, NULL, CLI_BASIC, "tell what the header says; do not read the values", 1},
    {"field", KEY_FIELD, "NAME", CLI_BASIC,
     "of several: this array, grid, data set or variable (default: the first)", 1},
    {"dims", KEY_DIMS, "X,Y,Z", CLI_BASIC, "of raw samples: how many per axis", 1},
    {"type", KEY_TYPE, "TYPE", CLI_BASIC,
     "of raw samples: u8 i8 u16 i16 u32 i32 u64 i64 f16 f32 f64", 1},
    {"big-endian", KEY_BIG_ENDIAN, NULL, 0, "of raw samples: most significant byte first", 1},
    {"skip", KEY_SKIP, "BYTES", 0, "of raw samples: header bytes to pass over", 1},
    TRUST_OPTIONS(1),
    {NULL, 0, NULL, 0, NULL, 0}};

static status add_iso(arguments *a, const char *text) {
    if (a->iso_count == ISOS_MAX)
        return status_describe(ST_USAGE, "more than %d isovalues", ISOS_MAX);
    return num_double(text, "--iso", &a->isos[a->iso_count++]);
}

static status set_option(void *own, int key, const char *text) {
    arguments *a = own;
    input_question *q = &a->question;
    switch (key) {
    case KEY_ISO: return add_iso(a, text);
    case KEY_QUICK: q->header_only = true; return ST_OK;
    case KEY_FIELD: q->mesh.field = q->grid.field = text; return ST_OK;
    case KEY_DIMS: return cli_dims(text, "--dims", 1, GRID_DIM_MAX, q->grid.dims);
    case KEY_TYPE: return cli_sample_type(text, &q->grid.type);
    case KEY_BIG_ENDIAN: q->grid.big_endian = true; return ST_OK;
    case KEY_SKIP: return num_size(text, "--skip", &q->grid.skip);
    default: return trust_option(&q->grid.trust, key);
    }
}

static status check(void *own) {
    const arguments *a = own;
    return a->common.input ? ST_OK : status_describe(ST_USAGE, "an INPUT is needed");
}

static const cli_verb verb = {
    .options = options,
    .set_option = set_option,
    .check = check,
    .input = "file",
    .args_doc = "INPUT",
    .doc = "Say what is in a treelet file, or in any input of convert: its format, sizes, fields, "
           "values as a histogram, the isovalues that are worth a look, and what to do next. An "
           "active treelet, cell or tet is one with min < V <= "
           "max over its samples.\vExample:\n  leafcast info bonsai.leaf --iso 37",
};

/* Facts of a treelet file, printed as text or as JSON. */
typedef struct facts {
    const leaf_file *f;
    double raw_bytes; /* of level 0's samples; of a mesh's arrays */
    uint64_t level_bytes[LEAF_LEVELS_MAX];
    uint64_t histogram[HISTOGRAM_MAX]; /* payloads counted by log2 of their stored size */
    leaf_activity (*activity)[LEAF_LEVELS_MAX];
    char id[LEAF_ID_TEXT];
    uint32_t implied;      /* payloads without bytes */
    leaf_mesh_parts parts; /* of a mesh */
    histogram values;      /* of the first set */
} facts;

static int log2_of(uint64_t size) {
    return 63 - __builtin_clzll(size);
}

/* Bytes before compression. Meshes: positions, values, indices as in mesh streams, indices once. */
static double raw_bytes(const leaf_file *f) {
    const leaf_header *h = &f->header;
    if (f->mesh)
        return (double)h->vertices *
                   (12 * (1 + (double)f->layout.moved_steps) + 4 * (double)f->layout.sets) +
               16 * (double)h->tets;
    return (double)h->dims[0] * h->dims[1] * h->dims[2] * (double)sample_size(f->layout.type) *
           f->layout.sets;
}

static void collect(facts *x, const leaf_file *f) {
    const leaf_header *h = &f->header;
    x->f = f;
    x->raw_bytes = raw_bytes(f);
    leaf_id_text(h, x->id);
    for (uint32_t p = 0; p < f->layout.payloads; p++) {
        x->level_bytes[f->layout.level_of[p % f->layout.treelets]] += f->sizes[p];
        x->implied += leaf_file_is_implied(f, p);
        if (f->sizes[p])
            x->histogram[log2_of(f->sizes[p]) % HISTOGRAM_MAX]++;
    }
    if (f->mesh)
        x->parts = leaf_stats_mesh(f);
}

/* ---- text ---- */

static const char *codec_name(const leaf_header *h) {
    return h->codec == LEAF_CODEC_RAW ? "raw" : "zstd";
}

static void print_common(const facts *x) {
    const leaf_header *h = &x->f->header;
    printf("name        %s\n", x->f->name);
    printf("made by     %s\n", h->provenance);
    printf("id          %s\n", x->id);
}

static void print_values(const leaf_header *h, const char *of) {
    char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
    printf("values      %s .. %s\n", num_print(h->value_min, a), num_print(h->value_max, b));
    if (h->non_finite)
        printf("no data     %llu %s are NaN or infinite\n", (unsigned long long)h->non_finite, of);
}

static void print_bytes(const facts *x) {
    const leaf_header *h = &x->f->header;
    printf("directory   %llu bytes, %.1f a treelet\n", (unsigned long long)x->f->directory_bytes,
           (double)x->f->directory_bytes / (double)h->treelets);
    printf("payloads    %llu bytes", (unsigned long long)h->payload_bytes);
    if (x->implied)
        printf("; %u of %u treelets have one value, and none", x->implied, x->f->layout.payloads);
    printf("\n");
}

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
static void print_fields(const facts *x) {
    const leaf_file *f = x->f;
    if (f->header.fields == 1) {
        if (f->names[0][0])
            printf("field       %s\n", f->names[0]);
        return;
    }
    for (uint32_t i = 0; i < f->header.fields; i++) {
        char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
        double range[2];
        field_range(f, i, range);
        printf("%s%s: %s .. %s\n", i ? "            " : "fields      ", f->names[i],
               num_print(range[0], a), num_print(range[1], b));
    }
}

static void print_steps(const facts *x) {
    const leaf_file *f = x->f;
    char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
    if (f->header.steps > 1)
        printf("steps       %u, times %s .. %s%s%s%s\n", f->header.steps, num_print(f->times[0], a),
               num_print(f->times[f->header.steps - 1], b), f->frame.time_unit[0] ? " " : "",
               f->frame.time_unit, f->layout.moved_steps ? ", vertices move" : "");
}

static void print_header(const facts *x) {
    const leaf_header *h = &x->f->header;
    char a[NUM_TEXT_MAX];
    print_common(x);
    printf("grid        %u x %u x %u %s%s%s\n", h->dims[0], h->dims[1], h->dims[2],
           sample_name(x->f->layout.type), h->source_type != h->sample_type ? " from " : "",
           h->source_type != h->sample_type ? sample_name((sample_type)h->source_type) : "");
    print_fields(x);
    print_values(h, "samples");
    print_steps(x);
    if (h->source_type != h->sample_type)
        printf("rounding    at most %s\n", num_print(h->rounding_error, a));
    for (int r = 0; r < 3; r++) {
        printf(r ? "            " : "to world    ");
        for (int c = 0; c < 4; c++)
            printf("%s%s", num_print(h->to_world[4 * r + c], a), c < 3 ? "  " : "\n");
    }
    printf("space       %s\n", h->rectilinear ? "rectilinear" : "regular");
    char axes[WORLD_FRAME_TEXT];
    if (world_frame_print(&x->f->frame, axes)[0])
        printf("axes        %s\n", axes);
    printf("treelets    %u^3 cells, halo %u, blocks of %u^3, runs at %u, %s\n", 1u << h->cells_log2,
           h->halo, 1u << h->block_log2, 1u << h->run_align_log2, codec_name(h));
    printf("file        %llu bytes, %.3f of the samples\n", (unsigned long long)h->file_bytes,
           (double)h->file_bytes / x->raw_bytes);
    print_bytes(x);
}

static void print_sizes(const facts *x) {
    printf("\nstored size        payloads\n");
    for (int i = 0; i < HISTOGRAM_MAX; i++)
        if (x->histogram[i])
            printf("%8llu .. %-8llu %8llu\n", 1ULL << i, (2ULL << i) - 1,
                   (unsigned long long)x->histogram[i]);
}

static const char *print_short(double x, char text[NUM_TEXT_MAX]) {
    snprintf(text, NUM_TEXT_MAX, "%.3g", x);
    return text;
}

static void print_levels(const facts *x) {
    const leaf_layout *l = &x->f->layout;
    const bool deviations = x->f->deviations;
    printf("\nlevel            samples   treelets          bytes%s\n",
           deviations ? "   off by, mean        at most" : "");
    for (uint32_t i = 0; i < l->levels; i++) {
        char dims[40], off[2][NUM_TEXT_MAX], off_by[3 * NUM_TEXT_MAX] = "";
        if (deviations && i > 0) {
            const leaf_deviation d = leaf_stats_deviation(x->f, i);
            snprintf(off_by, sizeof off_by, " %14s %14s", print_short(d.mean, off[0]),
                     d.unknown ? "unknown" : print_short(d.most, off[1]));
        }
        snprintf(dims, sizeof dims, "%ux%ux%u", l->level[i].dims[0], l->level[i].dims[1],
                 l->level[i].dims[2]);
        printf("%5u %18s %10u %14llu%s\n", i, dims, l->level[i].count,
               (unsigned long long)x->level_bytes[i], off_by);
    }
    print_sizes(x);
}

/* ---- text: a mesh ---- */

static void print_mesh_tets(const leaf_header *h) {
    printf("mesh        %llu tets, %llu vertices\n", (unsigned long long)h->tets,
           (unsigned long long)h->vertices);
    if (h->flat || h->inverted)
        printf("tets        %llu flat, %llu inverted\n", (unsigned long long)h->flat,
               (unsigned long long)h->inverted);
    if (h->repeated || h->bad)
        printf("left out    %llu tets with a vertex twice, %llu with a vertex that is none\n",
               (unsigned long long)h->repeated, (unsigned long long)h->bad);
}

static uint32_t coarse_sets(const leaf_file *f) {
    uint32_t sets = 0;
    for (uint32_t set = 0; set < f->layout.sets; set++)
        sets += leaf_file_has_coarse(f, set);
    return sets;
}

static unsigned long long coarse_bytes(const leaf_file *f) {
    return f->header.file_bytes - f->payloads_end;
}

static void print_mesh_header(const facts *x) {
    const leaf_header *h = &x->f->header;
    char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
    print_common(x);
    print_mesh_tets(h);
    print_fields(x);
    print_values(h, "values");
    print_steps(x);
    if (h->gradients)
        printf("gradients   of every field and step\n");
    if (x->f->header.file_bytes > x->f->payloads_end)
        printf("coarse      grids of %u of %u sets, %llu bytes, %.2f a tet\n", coarse_sets(x->f),
               x->f->layout.sets, coarse_bytes(x->f), (double)coarse_bytes(x->f) / (double)h->tets);
    for (int i = 0; i < 3; i++)
        printf("%s%s .. %s\n", i ? "            " : "bounds      ",
               num_print((double)h->bounds[i], a), num_print((double)h->bounds[i + 3], b));
    printf("treelets    %llu of up to %u tets, leaves of up to %u, runs at %u, %s\n",
           (unsigned long long)h->treelets, h->treelet_tets, h->leaf_tets, 1u << h->run_align_log2,
           codec_name(h));
    printf("file        %llu bytes, %.2f a tet, %.3f of the mesh\n",
           (unsigned long long)h->file_bytes, (double)h->file_bytes / (double)h->tets,
           (double)h->file_bytes / x->raw_bytes);
    print_bytes(x);
}

typedef struct mesh_part {
    const char *name, *key;
    uint64_t count, bytes;
} mesh_part;

enum { MESH_PARTS = 9 };

static void list_parts(const facts *x, mesh_part parts[MESH_PARTS]) {
    const leaf_mesh_parts *p = &x->parts;
    const mesh_part all[MESH_PARTS] = {
        {"tets", "tets", x->f->header.tets, p->tets},
        {"positions", "positions", p->vertices, p->positions},
        {"nodes", "nodes", p->node_count, p->nodes},
        {"values", "values", p->vertices, p->values},
        {"value codes", "value_codes", p->node_count, p->codes},
        {"gradients", "gradients", p->gradients ? p->vertices : 0, p->gradients},
        {"later boxes", "moved_boxes", p->moved ? p->node_count : 0, p->moved_boxes},
        {"later places", "moved", p->moved ? p->vertices : 0, p->moved},
        {"padding", "padding", 0, p->padding}};
    memcpy(parts, all, sizeof all);
}

static void print_mesh_parts(const facts *x) {
    const double tets = (double)x->f->header.tets;
    mesh_part parts[MESH_PARTS];
    list_parts(x, parts);
    printf("\npart                 count          bytes   a tet\n");
    for (int i = 0; i < MESH_PARTS; i++)
        if (parts[i].bytes || i + 1 == MESH_PARTS)
            printf("%-12s %13llu %14llu %7.3f\n", parts[i].name, (unsigned long long)parts[i].count,
                   (unsigned long long)parts[i].bytes, (double)parts[i].bytes / tets);
    printf("\nstored                              bytes   a tet\n");
    const char *const names[] = {"topology", "values", "gradients", "positions"};
    const uint64_t stored[] = {x->parts.stored_topology, x->parts.stored_values,
                               x->parts.stored_gradients, x->parts.stored_positions};
    for (int i = 0; i < 4; i++)
        if (stored[i])
            printf("%-12s %28llu %7.3f\n", names[i], (unsigned long long)stored[i],
                   (double)stored[i] / tets);
    print_sizes(x);
}

static void print_mesh_activity(const facts *x, double iso, const leaf_activity *level) {
    char text[NUM_TEXT_MAX];
    const leaf_header *h = &x->f->header;
    printf(
        "\nisovalue %s: %llu active tets, %.3f of all, %llu active treelets, %.3f of the payload "
        "bytes, %.3f of the file\n",
        num_print(iso, text), (unsigned long long)level->cells,
        (double)level->cells / (double)h->tets, (unsigned long long)level->treelets,
        (double)level->bytes / (double)h->payload_bytes,
        (double)level->bytes / (double)h->file_bytes);
}

static leaf_activity total_of(const leaf_activity levels[LEAF_LEVELS_MAX]) {
    leaf_activity sum = {0};
    for (int i = 0; i < LEAF_LEVELS_MAX; i++) {
        sum.treelets += levels[i].treelets;
        sum.bytes += levels[i].bytes;
    }
    sum.cells = levels[0].cells;
    return sum;
}

static void print_activity(const facts *x, double iso,
                           const leaf_activity levels[LEAF_LEVELS_MAX]) {
    char text[NUM_TEXT_MAX];
    leaf_activity all = total_of(levels);
    printf("\nisovalue %s: %llu active cells, %llu active treelets, %.3f of the payload bytes, "
           "%.3f of the file\n",
           num_print(iso, text), (unsigned long long)all.cells, (unsigned long long)all.treelets,
           (double)all.bytes / (double)x->f->header.payload_bytes,
           (double)all.bytes / (double)x->f->header.file_bytes);
    printf("level   treelets          bytes          cells\n");
    for (uint32_t i = 0; i < x->f->layout.levels; i++)
        printf("%5u %10llu %14llu %14llu\n", i, (unsigned long long)levels[i].treelets,
               (unsigned long long)levels[i].bytes, (unsigned long long)levels[i].cells);
}

/* ---- JSON ---- */

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

static json_t *times_json(const leaf_file *f) {
    json_t *times = json_array();
    for (uint32_t step = 0; step < f->header.steps; step++)
        json_array_append_new(times, json_real(f->times[step]));
    return times;
}

/* Add fields and steps: for grids of several sets, and for every mesh. */
static void add_sets(json_t *json, const leaf_file *f) {
    json_object_set_new(json, "field_count", json_integer(f->header.fields));
    json_object_set_new(json, "steps", json_integer(f->header.steps));
    json_object_set_new(json, "fields", fields_json(f));
    json_object_set_new(json, "times", times_json(f));
}

static json_t *header_json(const facts *x) {
    const leaf_header *h = &x->f->header;
    json_t *world = json_array();
    for (int i = 0; i < 12; i++)
        json_array_append_new(world, json_real(h->to_world[i]));
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:[I,I,I], s:s, s:s, s:b, s:o, s:o, s:o, s:I, s:o}", "name", x->f->name,
        "provenance", h->provenance, "id", x->id, "dims", (json_int_t)h->dims[0],
        (json_int_t)h->dims[1], (json_int_t)h->dims[2], "sample_type",
        sample_name(x->f->layout.type), "source_type", sample_name((sample_type)h->source_type),
        "rectilinear", (int)h->rectilinear, "to_world", world, "value_min",
        cli_json_real(h->value_min), "value_max", cli_json_real(h->value_max), "non_finite",
        (json_int_t)h->non_finite, "rounding_error", cli_json_real(h->rounding_error));
    json_t *sizes = json_pack(
        "{s:i, s:i, s:i, s:i, s:s, s:I, s:I, s:I, s:I, s:f}", "treelet_cells", 1 << h->cells_log2,
        "halo", (int)h->halo, "block_cells", 1 << h->block_log2, "run_align",
        1 << h->run_align_log2, "codec", h->codec == LEAF_CODEC_RAW ? "raw" : "zstd", "treelets",
        (json_int_t)h->treelets, "file_bytes", (json_int_t)h->file_bytes, "directory_bytes",
        (json_int_t)x->f->directory_bytes, "payload_bytes", (json_int_t)h->payload_bytes, "ratio",
        (double)h->file_bytes / x->raw_bytes);
    json_object_update(json, sizes);
    json_decref(sizes);
    json_object_set_new(json, "implied_payloads", json_integer(x->implied));
    cli_json_frame(json, &x->f->frame);
    if (x->f->layout.sets > 1)
        add_sets(json, x->f);
    return json;
}

static json_t *bounds_json(const leaf_header *h) {
    json_t *bounds = json_array();
    for (int i = 0; i < 6; i++)
        json_array_append_new(bounds, json_real((double)h->bounds[i]));
    return bounds;
}

static json_t *parts_json(const facts *x) {
    mesh_part parts[MESH_PARTS];
    list_parts(x, parts);
    json_t *json =
        json_pack("{s:I, s:I, s:I, s:I}", "stored_topology", (json_int_t)x->parts.stored_topology,
                  "stored_values", (json_int_t)x->parts.stored_values, "stored_gradients",
                  (json_int_t)x->parts.stored_gradients, "stored_positions",
                  (json_int_t)x->parts.stored_positions);
    for (int i = 0; i < MESH_PARTS; i++)
        json_object_set_new(json, parts[i].key, json_integer((json_int_t)parts[i].bytes));
    return json;
}

static json_t *mesh_json(const facts *x) {
    const leaf_header *h = &x->f->header;
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:o, s:I}", "name",
        x->f->name, "provenance", h->provenance, "id", x->id, "field", h->field, "tets",
        (json_int_t)h->tets, "vertices", (json_int_t)h->vertices, "flat", (json_int_t)h->flat,
        "inverted", (json_int_t)h->inverted, "repeated", (json_int_t)h->repeated, "bad",
        (json_int_t)h->bad, "bounds", bounds_json(h), "value_min", cli_json_real(h->value_min),
        "value_max", cli_json_real(h->value_max), "non_finite", (json_int_t)h->non_finite);
    json_t *sizes = json_pack(
        "{s:I, s:I, s:i, s:s, s:I, s:I, s:I, s:I, s:f, s:f, s:I, s:I, s:I, s:o}", "treelet_tets",
        (json_int_t)h->treelet_tets, "leaf_tets", (json_int_t)h->leaf_tets, "run_align",
        1 << h->run_align_log2, "codec", codec_name(h), "treelets", (json_int_t)h->treelets,
        "file_bytes", (json_int_t)h->file_bytes, "directory_bytes",
        (json_int_t)x->f->directory_bytes, "payload_bytes", (json_int_t)h->payload_bytes, "ratio",
        (double)h->file_bytes / x->raw_bytes, "bytes_per_tet",
        (double)h->file_bytes / (double)h->tets, "treelet_vertices", (json_int_t)x->parts.vertices,
        "nodes", (json_int_t)x->parts.node_count, "leaves", (json_int_t)x->parts.leaves, "parts",
        parts_json(x));
    json_object_update(json, sizes);
    json_decref(sizes);
    json_object_set_new(json, "gradients", json_boolean(h->gradients));
    json_object_set_new(json, "moving", json_boolean(h->moving));
    add_sets(json, x->f);
    json_object_set_new(json, "coarse_sets", json_integer(coarse_sets(x->f)));
    json_object_set_new(json, "coarse_bytes", json_integer((json_int_t)coarse_bytes(x->f)));
    return json;
}

static json_t *deviation_json(const leaf_file *f, uint32_t level) {
    const leaf_deviation d = leaf_stats_deviation(f, level);
    return json_pack("{s:f, s:f, s:I, s:I}", "mean", d.mean, "most", d.most, "bricks",
                     (json_int_t)d.bricks, "unknown", (json_int_t)d.unknown);
}

static json_t *levels_json(const facts *x) {
    const leaf_layout *l = &x->f->layout;
    json_t *levels = json_array();
    for (uint32_t i = 0; i < l->levels; i++) {
        json_t *level =
            json_pack("{s:[I,I,I], s:I, s:I}", "dims", (json_int_t)l->level[i].dims[0],
                      (json_int_t)l->level[i].dims[1], (json_int_t)l->level[i].dims[2], "treelets",
                      (json_int_t)l->level[i].count, "bytes", (json_int_t)x->level_bytes[i]);
        if (x->f->deviations && i > 0)
            json_object_set_new(level, "deviation", deviation_json(x->f, i));
        json_array_append_new(levels, level);
    }
    return levels;
}

static json_t *sizes_json(const facts *x) {
    json_t *rows = json_array();
    for (int i = 0; i < HISTOGRAM_MAX; i++)
        if (x->histogram[i])
            json_array_append_new(rows,
                                  json_pack("{s:I, s:I}", "at_least_bytes", (json_int_t)1 << i,
                                            "payloads", (json_int_t)x->histogram[i]));
    return rows;
}

static json_t *activity_json(const facts *x, double iso,
                             const leaf_activity levels[LEAF_LEVELS_MAX]) {
    const leaf_header *h = &x->f->header;
    const leaf_activity all = total_of(levels);
    json_t *json = json_pack("{s:o, s:I, s:I, s:I, s:f, s:f}", "iso", cli_json_real(iso),
                             x->f->mesh ? "active_tets" : "active_cells", (json_int_t)all.cells,
                             "active_treelets", (json_int_t)all.treelets, "active_bytes",
                             (json_int_t)all.bytes, "active_share",
                             (double)all.bytes / (double)h->payload_bytes, "active_share_of_file",
                             (double)all.bytes / (double)h->file_bytes);
    json_t *rows = x->f->mesh ? NULL : json_array();
    for (uint32_t i = 0; rows && i < x->f->layout.levels; i++)
        json_array_append_new(
            rows, json_pack("{s:I, s:I, s:I}", "treelets", (json_int_t)levels[i].treelets, "bytes",
                            (json_int_t)levels[i].bytes, "cells", (json_int_t)levels[i].cells));
    if (rows)
        json_object_set_new(json, "levels", rows);
    return json;
}

/* Room for the next command, and for it as printed: there a byte may take four. */
enum { NEXT_MAX = 6000, NEXT_SHOWN_MAX = 4 * NEXT_MAX };

static void print_next(const char *line) {
    char shown[NEXT_SHOWN_MAX];
    if (line)
        printf("next        %s\n", text_printable(shown, sizeof shown, line));
}

static void set_next(json_t *json, const char *line) {
    char shown[NEXT_SHOWN_MAX];
    if (line)
        json_object_set_new(json, "next", json_string(text_printable(shown, sizeof shown, line)));
}

/* Print the command that draws the file; NULL where it does not fit. */
static const char *next_command(const arguments *a, char line[NEXT_MAX]) {
    size_t length;
    const char *stem = text_stem(a->common.input, &length);
    char picture[PATH_MAX];
    shell_line l = shell_line_begin(line, NEXT_MAX);
    if (snprintf(picture, sizeof picture, "%.*s.png", (int)length, stem) >= (int)sizeof picture)
        return NULL;
    shell_line_put(&l, "leafcast render ");
    shell_line_path(&l, a->common.input);
    shell_line_put(&l, " -o ");
    shell_line_path(&l, picture);
    return l.full ? NULL : line;
}

static status print_json(const arguments *a, const facts *x) {
    const bool is_mesh = x->f->mesh != NULL;
    json_t *json = is_mesh ? mesh_json(x) : header_json(x);
    json_object_set_new(json, "format", json_string("treelet file"));
    json_object_set_new(json, "kind", json_string(is_mesh ? "mesh" : "grid"));
    if (!is_mesh)
        json_object_set_new(json, "levels", levels_json(x));
    json_object_set_new(json, "payload_sizes", sizes_json(x));
    char next[NEXT_MAX];
    json_object_set_new(json, "histogram", histogram_json(&x->values));
    set_next(json, next_command(a, next));
    if (a->iso_count) {
        json_t *isos = json_array();
        for (int i = 0; i < a->iso_count; i++)
            json_array_append_new(isos, activity_json(x, a->isos[i], x->activity[i]));
        json_object_set_new(json, "isovalues", isos);
    }
    return cli_print_json(&a->common, json);
}

/* Print the distribution of the values, and what to do next. */
static void print_values_of_first(const arguments *a, const facts *x) {
    char next[NEXT_MAX];
    histogram_print(stdout, &x->values,
                    !x->f->histograms ? "treelets"
                    : x->f->mesh      ? "tets"
                                      : "samples");
    printf("\n");
    histogram_print_isovalues(stdout, &x->values);
    print_next(next_command(a, next));
}

static void print_text(const arguments *a, const facts *x) {
    const bool is_mesh = x->f->mesh != NULL;
    cli_results(&a->common, false);
    if (is_mesh) {
        print_mesh_header(x);
        print_mesh_parts(x);
    } else {
        print_header(x);
        print_levels(x);
    }
    print_values_of_first(a, x);
    for (int i = 0; i < a->iso_count; i++)
        if (is_mesh)
            print_mesh_activity(x, a->isos[i], x->activity[i]);
        else
            print_activity(x, a->isos[i], x->activity[i]);
}

static status report(arguments *a, mem *m, leaf_file *f) {
    facts x = {0};
    collect(&x, f);
    x.activity = mem_array(m, (size_t)a->iso_count, sizeof *x.activity);
    if (!x.activity)
        return ST_NOMEM;
    status st = leaf_histogram_get(m, f, 0, &x.values);
    for (int i = 0; i < a->iso_count && st == ST_OK; i++)
        st = leaf_stats_activity(m, f, a->isos[i], a->common.threads, cli_progress(&a->common),
                                 x.activity[i]);
    if (st == ST_OK && a->common.json)
        st = print_json(a, &x);
    if (st == ST_OK && !a->common.json)
        print_text(a, &x);
    mem_free(m, x.activity);
    return st;
}

/* ---- an input that is not a treelet file ---- */

/* Kinds of inputs, as bits: an option lists those that can use it. */
enum { LEAF = 1, RAW = 2, HEADED = 4, MESH = 8, FIELDS = 16 };
enum { GRID = RAW | HEADED | FIELDS, INPUT = GRID | MESH };
static const char *const input_names[] = {
    [LEAF] = "treelet files", [RAW] = "raw samples",
    [MESH] = "meshes",        [MESH | FIELDS] = "formats that have several",
    [GRID] = "grids",         [INPUT] = "inputs of convert"};
static const cli_use uses[] = {{KEY_ISO, LEAF}, {KEY_QUICK, INPUT},      {KEY_FIELD, MESH | FIELDS},
                               {KEY_DIMS, RAW}, {KEY_TYPE, RAW},         {KEY_BIG_ENDIAN, RAW},
                               {KEY_SKIP, RAW}, {TRUST_KEY_LINKS, GRID}, {TRUST_KEY_MISSING, GRID}};

/* Refuse options that the input cannot use. */
static status check_uses(const arguments *a, unsigned input, const char *format) {
    return cli_check_uses(&a->common, uses, sizeof uses / sizeof *uses, input, input_names, format);
}

static status report_input(arguments *a, const input_facts *x) {
    char line[NEXT_MAX];
    const char *next = input_facts_next(x, &a->question, line, sizeof line) ? line : NULL;
    if (a->common.json) {
        json_t *json = input_facts_json(x);
        set_next(json, next);
        return cli_print_json(&a->common, json);
    }
    cli_results(&a->common, false);
    input_facts_print(stdout, x);
    print_next(next);
    return ST_OK;
}

static status check_opened(void *ctx, const input_facts *x) {
    return check_uses(ctx,
                      x->is_mesh      ? MESH
                      : x->is_raw     ? RAW
                      : x->has_fields ? FIELDS
                                      : HEADED,
                      x->format);
}

static status run_input(arguments *a, mem *m) {
    input_facts *x = mem_zalloc(m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    a->question.path = a->common.input;
    a->question.opened = check_opened;
    a->question.ctx = a;
    status st = input_facts_read(m, &a->question, cli_progress(&a->common), x);
    if (st == ST_OK)
        st = report_input(a, x);
    mem_free(m, x);
    return st;
}

/* By first bytes or name. F.leaf counts in any case: opening it tells what is wrong. */
static status is_leaf(mem *m, const char *path, bool *is) {
    const size_t length = strlen(path);
    *is = length > 5 && strcmp(path + length - 5, ".leaf") == 0;
    if (*is || strcmp(path, "-") == 0)
        return ST_OK;
    file *f = NULL;
    char magic[sizeof LEAF_MAGIC - 1];
    struct stat info;
    if (stat(path, &info) != 0 || !S_ISREG(info.st_mode))
        return ST_OK;
    status st = file_open(m, path, &f);
    if (st == ST_OK && file_size(f) >= sizeof magic)
        st = file_read_at(f, 0, magic, sizeof magic);
    *is =
        st == ST_OK && file_size(f) >= sizeof magic && memcmp(magic, LEAF_MAGIC, sizeof magic) == 0;
    file_close(f);
    return st;
}

static status run(arguments *a) {
    mem m;
    mem_init(&m, a->common.memory);
    leaf_file *f = NULL;
    bool leaf = false;
    status st = is_leaf(&m, a->common.input, &leaf);
    if (st == ST_OK && !leaf)
        return run_input(a, &m);
    if (st == ST_OK)
        st = check_uses(a, LEAF, "a treelet file");
    if (st == ST_OK)
        st = leaf_file_open(&m, a->common.input, &f);
    if (st == ST_OK)
        st = report(a, &m, f);
    leaf_file_close(f);
    return st;
}

int main(int argc, char **argv) {
    arguments a = {.common = {.verb = "info", .without = "output force"}};
    cli_parse(&verb, &a.common, argc, argv);
    return cli_finish(&a.common, run(&a));
}
