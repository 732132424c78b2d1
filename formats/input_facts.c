#include "formats/input_facts.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "formats/base/num.h"
#include "formats/base/shell_line.h"
#include "formats/base/text.h"
#include "formats/input/unpack_stream.h"
#include "formats/input_open.h"
#include "formats/leaf/histogram_draw.h"
#include "formats/leaf/histogram_text.h"

enum { BLOCK_BYTES = 32 << 20 };

static void add_value(input_facts *x, double value) {
    if (!isfinite(value))
        x->non_finite++;
    else {
        x->range[0] = value < x->range[0] ? value : x->range[0];
        x->range[1] = value > x->range[1] ? value : x->range[1];
    }
}

/* ---- a grid ---- */

/* Slices as read, and as they would be stored. `held` stored slices begin at slice `first`. */
typedef struct slices {
    volume *v;
    const grid *g;
    void *read, *stored;
    uint64_t count; /* samples per slice */
    uint32_t room, first, held;
} slices;

static status make_slices(mem *m, volume *v, slices *s) {
    *s = (slices){.v = v, .g = volume_grid(v)};
    s->count = (uint64_t)s->g->dims[0] * s->g->dims[1];
    const uint64_t left = m->limit ? m->limit - mem_used(m) : UINT64_MAX;
    const uint64_t bytes = left / 4 < BLOCK_BYTES ? left / 4 : BLOCK_BYTES;
    const uint64_t room = bytes / grid_slice_bytes(s->g);
    s->room = room < 2 ? 2 : room < s->g->dims[2] ? (uint32_t)room : s->g->dims[2];
    s->read = mem_alloc(m, s->room * grid_slice_bytes(s->g));
    s->stored = mem_alloc(m, s->room * s->count * sample_size(sample_stored(s->g->type)));
    return s->read && s->stored ? ST_OK : ST_NOMEM;
}

/* Read slices behind those held, until the room is full or the grid ends. */
static status read_more(slices *s, input_facts *x) {
    const uint32_t left = s->g->dims[2] - s->first - s->held;
    const uint32_t more = s->room - s->held < left ? s->room - s->held : left;
    const sample_type type = sample_stored(s->g->type);
    char *to = (char *)s->stored + s->held * s->count * sample_size(type);
    status st = volume_read(s->v, more, s->read);
    if (st != ST_OK)
        return st;
    sample_to_stored(s->g->type, s->read, to, more * s->count);
    for (uint64_t i = 0; i < more * s->count; i++)
        add_value(x, (double)sample_get(type, to, i));
    s->held += more;
    return ST_OK;
}

/* Draw nodes of all slices held but the last. That one stays, as it belongs to the next block,
 * too. */
static void draw_held(slices *s, const histogram_draw *d, const histogram_space *space,
                      histogram_cell *cells) {
    const sample_type type = sample_stored(s->g->type);
    const bool last = s->first + s->held == s->g->dims[2];
    const uint32_t drawn = s->held - !last;
    const histogram_block b = {.first = {0, 0, s->first},
                               .end = {s->g->dims[0], s->g->dims[1], s->first + drawn},
                               .type = type,
                               .samples = s->stored,
                               .row = s->g->dims[0],
                               .slice = s->count};
    histogram_draw_take(d, space, &b, cells);
    const size_t bytes = s->count * sample_size(type);
    if (!last)
        memmove(s->stored, (char *)s->stored + drawn * bytes, bytes);
    s->first += drawn;
    s->held = !last;
}

static status count_slices(slices *s, const histogram_draw *d, histogram_cell *cells,
                           const progress *p, input_facts *x) {
    histogram_space space = histogram_space_of(x->to_world);
    for (int a = 0; a < 3; a++)
        space.axis[a] = s->g->axis[a];
    while (s->first < s->g->dims[2]) {
        status st = read_more(s, x);
        if (st == ST_OK)
            st = progress_step(p, "reading", (double)(s->first + s->held) / s->g->dims[2]);
        if (st != ST_OK)
            return st;
        draw_held(s, d, &space, cells);
    }
    return volume_finish(s->v, &x->trailing);
}

static status count_volume(mem *m, volume *v, const progress *p, input_facts *x) {
    const grid *g = volume_grid(v);
    const histogram_draw d = histogram_draw_grid(g->dims);
    slices s;
    status st = make_slices(m, v, &s);
    histogram_cell *cells = mem_array(m, d.count, sizeof *cells);
    if (!cells)
        st = ST_NOMEM;
    if (st == ST_OK)
        st = count_slices(&s, &d, cells, p, x);
    if (st == ST_OK)
        histogram_build(&x->values, cells, d.count, sample_stored(g->type), x->range,
                        grid_samples(g));
    mem_free(m, cells);
    mem_free(m, s.read);
    mem_free(m, s.stored);
    return st;
}

/* Take the input's own name, or else the file's without the suffix. */
static void set_name(input_facts *x, const char *own) {
    if (*own || strcmp(x->path, "-") == 0)
        text_name(x->name, sizeof x->name, own);
    else
        text_file_name(x->name, sizeof x->name, x->path);
}

/* Returns the field of this name, adding it if needed; NULL: no room is left. */
static input_field *list_field(input_facts *x, const char *name) {
    char clean[MESH_NAME_MAX + 1];
    text_name(clean, sizeof clean, name);
    const uint32_t listed =
        x->field_count < INPUT_FACTS_FIELDS ? x->field_count : INPUT_FACTS_FIELDS;
    for (uint32_t i = 0; i < listed; i++)
        if (strcmp(x->fields[i].name, clean) == 0)
            return &x->fields[i];
    x->field_count++;
    if (listed == INPUT_FACTS_FIELDS)
        return NULL;
    memcpy(x->fields[listed].name, clean, sizeof clean);
    return &x->fields[listed];
}

static void take_field(input_facts *x, const char *name, uint32_t components) {
    input_field *f = *name ? list_field(x, name) : NULL;
    if (f)
        f->components = components > 1 ? components : 1;
    if (f && f->steps == 0)
        f->steps = 1;
}

static void take_times(input_facts *x, const slice_field *f) {
    const uint32_t listed = f->steps < INPUT_FACTS_TIMES ? f->steps : INPUT_FACTS_TIMES;
    x->timed = true;
    memcpy(x->times, f->times, listed * sizeof *x->times);
    x->last_time = f->times[f->steps - 1];
    if (f->time_unit)
        text_name(x->frame.time_unit, sizeof x->frame.time_unit, f->time_unit);
}

static status take_slice_field(void *ctx, const slice_field *f) {
    input_facts *x = ctx;
    take_field(x, f->name, f->components);
    input_field *listed = *f->name ? list_field(x, f->name) : NULL;
    if (listed)
        listed->steps = f->steps;
    if (!f->taken)
        return ST_OK;
    text_name(x->field, sizeof x->field, f->name);
    x->steps = f->steps;
    x->components = f->components > 1 ? f->components : 1;
    x->component = f->component;
    x->colours = f->colours;
    if (f->times)
        take_times(x, f);
    return ST_OK;
}

static status ask_volume(mem *m, volume *v, const input_question *q, const progress *p,
                         input_facts *x) {
    status st = ST_OK;
    const grid *g = volume_grid(v);
    x->format = volume_format(v);
    x->is_raw = strcmp(x->format, VOLUME_RAW_SAMPLES) == 0;
    x->has_fields = volume_has_fields(v);
    x->importer = volume_importer(v);
    x->type = g->type;
    x->source = grid_source(g);
    x->rectilinear = grid_is_rectilinear(g);
    x->absent = g->absent;
    memcpy(x->note, g->note, sizeof x->note);
    memcpy(x->dims, g->dims, sizeof x->dims);
    memcpy(x->to_world, g->to_world, sizeof x->to_world);
    x->frame = g->frame;
    set_name(x, g->name);
    if (q->opened)
        st = q->opened(q->ctx, x);
    if (st == ST_OK)
        st = volume_fields(v, &(slice_fields){take_slice_field, x});
    if (st == ST_OK && !q->header_only)
        st = count_volume(m, v, p, x);
    return st;
}

/* ---- a mesh ---- */

/* Positions and values of all points, and every step-th tet, few enough for the room. */
typedef struct gathered {
    mem *m;
    mesh_input *mesh;
    const progress *p;
    input_facts *x;
    float (*xyz)[3];
    float *values;
    size_t xyz_room, value_room, points;
    uint32_t (*ids)[4];
    uint64_t tets, step;
    uint32_t kept;
} gathered;

static status grow(mem *m, void **array, size_t *room, size_t need, size_t size) {
    if (need <= *room)
        return ST_OK;
    const size_t more = need > 2 * *room ? need : 2 * *room;
    void *larger = mem_array(m, more, size);
    if (!larger)
        return ST_NOMEM;
    if (*array)
        memcpy(larger, *array, *room * size);
    mem_free(m, *array);
    *array = larger;
    *room = more;
    return ST_OK;
}

static status take_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    gathered *g = ctx;
    void *array = g->xyz;
    status st = grow(g->m, &array, &g->xyz_room, (size_t)first + count, sizeof *g->xyz);
    g->xyz = array;
    if (st != ST_OK)
        return st;
    memcpy(g->xyz + first, xyz, count * sizeof *xyz);
    g->points = (size_t)first + count;
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            g->x->bounds[a] = fminf(g->x->bounds[a], xyz[i][a]);
            g->x->bounds[a + 3] = fmaxf(g->x->bounds[a + 3], xyz[i][a]);
        }
    return progress_step(g->p, "reading", mesh_input_share(g->mesh));
}

static status take_values(void *ctx, uint64_t first, size_t count, const float *values) {
    gathered *g = ctx;
    void *array = g->values;
    status st = grow(g->m, &array, &g->value_room, (size_t)first + count, sizeof *g->values);
    g->values = array;
    if (st != ST_OK)
        return st;
    memcpy(g->values + first, values, count * sizeof *values);
    for (size_t i = 0; i < count; i++)
        add_value(g->x, (double)values[i]);
    return progress_step(g->p, "reading", mesh_input_share(g->mesh));
}

/* Drop every other tet that is kept. */
static void thin(gathered *g) {
    for (uint32_t i = 0; i < g->kept; i += 2)
        memcpy(g->ids[i / 2], g->ids[i], sizeof *g->ids);
    g->kept = (g->kept + 1) / 2;
    g->step *= 2;
}

static status take_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    gathered *g = ctx;
    for (size_t i = 0; i < count; i++, g->tets++) {
        if (g->kept == HISTOGRAM_TETS)
            thin(g);
        if (g->tets % g->step == 0)
            memcpy(g->ids[g->kept++], ids[i], sizeof *g->ids);
    }
    return progress_step(g->p, "reading", mesh_input_share(g->mesh));
}

static status count_tets(gathered *g) {
    histogram_cell *cells = mem_array(g->m, g->kept, sizeof *cells);
    if (!cells)
        return ST_NOMEM;
    for (uint32_t i = 0; i < g->kept; i++) {
        const float *corners[4];
        float values[4];
        for (int c = 0; c < 4; c++) {
            corners[c] = g->xyz[g->ids[i][c]];
            values[c] = g->values[g->ids[i][c]];
        }
        cells[i] = histogram_tet(corners, values);
    }
    histogram_build(&g->x->values, cells, g->kept, SAMPLE_F32, g->x->range, g->tets);
    mem_free(g->m, cells);
    return ST_OK;
}

static status count_mesh(mem *m, mesh_input *x, const progress *p, input_facts *out) {
    gathered g = {.m = m, .mesh = x, .p = p, .x = out, .step = 1};
    const mesh_sink sink = {&g, take_points, take_values, take_tets};
    g.ids = mem_array(m, HISTOGRAM_TETS, sizeof *g.ids);
    status st = g.ids ? mesh_input_read(x, &sink, &out->report) : ST_NOMEM;
    if (st == ST_OK)
        st = count_tets(&g);
    mem_free(m, g.ids);
    mem_free(m, g.xyz);
    mem_free(m, g.values);
    return st;
}

/* A name that comes again is another piece or step of that field. */
static void take_array(void *ctx, const char *name, int components) {
    input_facts *x = ctx;
    const uint32_t before = x->field_count;
    take_field(x, name, (uint32_t)components);
    if (*name && x->field_count == before)
        list_field(x, name)->steps++;
}

/* listed: the format lists the array of each step. A field of one array has it at all steps. */
static void take_mesh_steps(input_facts *x, bool listed, uint32_t steps, const double *times) {
    x->steps = steps;
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++)
        if (!listed || x->fields[i].steps == 1 || steps == 1)
            x->fields[i].steps = steps;
    if (times)
        take_times(x, &(slice_field){.steps = steps, .times = times});
}

static status ask_mesh(mem *m, mesh_input *found, const input_question *q, const progress *p,
                       input_facts *x) {
    status st = ST_OK;
    x->is_mesh = true;
    x->format = mesh_input_format(found);
    set_name(x, mesh_input_name(found));
    mesh_input_fields(found, take_array, x);
    take_mesh_steps(x, !mesh_input_names_files(found), mesh_input_steps(found),
                    mesh_input_times(found));
    if (q->opened)
        st = q->opened(q->ctx, x);
    if (st == ST_OK && !q->header_only)
        st = count_mesh(m, found, p, x);
    const char *asked = q->mesh.field ? q->mesh.field : x->field_count ? x->fields[0].name : "";
    text_name(x->field, sizeof x->field, x->read ? x->report.field : asked);
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++)
        if (strcmp(x->fields[i].name, x->field) == 0)
            x->components = x->fields[i].components;
    x->component = (uint32_t)q->mesh.component;
    return st;
}

/* ---- both kinds ---- */

status input_facts_read(mem *m, const input_question *q, const progress *p, input_facts *out) {
    input in;
    *out = (input_facts){.path = q->path,
                         .read = !q->header_only,
                         .steps = 1,
                         .components = 1,
                         .range = {DBL_MAX, -DBL_MAX},
                         .bounds = {FLT_MAX, FLT_MAX, FLT_MAX, -FLT_MAX, -FLT_MAX, -FLT_MAX}};
    mesh_hints of_meshes = q->mesh;
    of_meshes.trust = q->grid.trust;
    status st = input_open(m, q->path, &q->grid, &of_meshes, &in);
    if (st == ST_OK)
        st = in.x ? ask_mesh(m, in.x, q, p, out) : ask_volume(m, in.v, q, p, out);
    input_close(&in);
    return st;
}

/* ---- for people ---- */

static double spacing_of(const input_facts *x, int a) {
    const double *w = x->to_world;
    return sqrt(w[a] * w[a] + w[a + 4] * w[a + 4] + w[a + 8] * w[a + 8]);
}

static void print_grid(FILE *to, const input_facts *x) {
    char n[3][NUM_TEXT_MAX], absent[ABSENT_TEXT];
    const double bytes =
        (double)x->dims[0] * x->dims[1] * x->dims[2] * (double)sample_size(x->type);
    fprintf(to, "grid        %u x %u x %u %s, %.1f MiB", x->dims[0], x->dims[1], x->dims[2],
            sample_name(x->type), bytes / 0x1p20);
    if (x->source != x->type)
        fprintf(to, " (of %s)", sample_name(x->source));
    fputc('\n', to);
    if (x->absent.count)
        fprintf(to, "absent      %s\n", absent_print(&x->absent, absent));
    if (x->note[0])
        fprintf(to, "note        %s\n", x->note);
    fprintf(to, "spacing     %s %s %s%s\n", num_print(spacing_of(x, 0), n[0]),
            num_print(spacing_of(x, 1), n[1]), num_print(spacing_of(x, 2), n[2]),
            x->rectilinear ? ", times the coordinates of its axes (rectilinear)" : "");
    fprintf(to, "origin      %s %s %s\n", num_print(x->to_world[3], n[0]),
            num_print(x->to_world[7], n[1]), num_print(x->to_world[11], n[2]));
    char axes[WORLD_FRAME_TEXT];
    if (world_frame_print(&x->frame, axes)[0])
        fprintf(to, "axes        %s\n", axes);
}

static void print_mesh(FILE *to, const input_facts *x) {
    char n[2][NUM_TEXT_MAX];
    if (x->read)
        fprintf(to, "mesh        %llu tets, %llu points\n", (unsigned long long)x->report.tets,
                (unsigned long long)x->report.points);
    if (x->read && x->report.ghosts)
        fprintf(to, "ghosts      %llu cells of other pieces, or hidden, are left out\n",
                (unsigned long long)x->report.ghosts);
    if (x->field_count == 0)
        fprintf(to, "fields      none\n");
    for (int a = 0; a < 3 && x->read && x->report.points > 0; a++)
        fprintf(to, "%s%s .. %s\n", a ? "            " : "bounds      ",
                num_print((double)x->bounds[a], n[0]), num_print((double)x->bounds[a + 3], n[1]));
}

static void print_field(FILE *to, const input_facts *x, const input_field *f) {
    fputs(f->name, to);
    if (f->components > 1)
        fprintf(to, ", %u components", f->components);
    if (f->steps > 1)
        fprintf(to, ", %u steps", f->steps);
    fputs(strcmp(f->name, x->field) == 0 ? " (taken here)\n" : "\n", to);
}

/* Print what can be chosen where there are several, and the default. */
static void print_choices(FILE *to, const input_facts *x) {
    char n[2][NUM_TEXT_MAX];
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++) {
        fputs(i ? "            " : "fields      ", to);
        print_field(to, x, &x->fields[i]);
    }
    if (x->field_count > INPUT_FACTS_FIELDS)
        fprintf(to, "            .. %u in all\n", x->field_count);
    if (x->components > 1 && x->component)
        fprintf(to, "components  %u a sample, number %u is taken here\n", x->components,
                x->component);
    else if (x->components > 1)
        fprintf(to, "components  %u a sample, taken here as their %s\n", x->components,
                x->colours ? "luminance" : "magnitude");
    if (x->steps > 1)
        fprintf(to, "steps       %u, the first is taken here\n", x->steps);
    if (x->steps > 1 && x->timed)
        fprintf(to, "times       %s .. %s%s%s\n", num_print(x->times[0], n[0]),
                num_print(x->last_time, n[1]), x->frame.time_unit[0] ? " " : "",
                x->frame.time_unit);
}

static void print_values(FILE *to, const input_facts *x) {
    char lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX];
    if (x->range[0] <= x->range[1])
        fprintf(to, "values      %s .. %s\n", num_print(x->range[0], lo),
                num_print(x->range[1], hi));
    else
        fprintf(to, "values      none that are finite\n");
    if (x->non_finite)
        fprintf(to, "no data     %llu values are NaN or infinite\n",
                (unsigned long long)x->non_finite);
    if (x->trailing)
        fprintf(to, "behind      %llu bytes behind the samples\n", (unsigned long long)x->trailing);
    histogram_print(to, &x->values, x->is_mesh ? "tets" : "samples");
    histogram_print_isovalues(to, &x->values);
}

void input_facts_print(FILE *to, const input_facts *x) {
    char path[4096];
    fprintf(to, "input       %s\n", text_printable(path, sizeof path, x->path));
    fprintf(to, "format      %s\n", x->format);
    if (x->name[0])
        fprintf(to, "name        %s\n", x->name);
    if (x->is_mesh)
        print_mesh(to, x);
    else
        print_grid(to, x);
    print_choices(to, x);
    if (x->read)
        print_values(to, x);
}

/* Remove slashes behind a folder, and the suffix of a compressed file. Cut if too long. */
static const char *unpacked_path(const char *path, char copy[PATH_MAX]) {
    snprintf(copy, PATH_MAX, "%s", path);
    for (size_t n = strlen(copy); n > 1 && copy[n - 1] == '/'; n--)
        copy[n - 1] = 0;
    if (packer_is_suffix(copy))
        *strrchr(copy, '.') = 0;
    return copy;
}

/* Append NAME.leaf, in the current folder, for an input called NAME with its last suffix. */
static void put_leaf_name(shell_line *c, const char *path) {
    char name[PATH_MAX], copy[PATH_MAX];
    size_t length;
    const char *stem = text_stem(unpacked_path(path, copy), &length);
    if (strcmp(path, "-") == 0)
        shell_line_put(c, "F.leaf");
    else if (snprintf(name, sizeof name, "%.*s.leaf", (int)length, stem) < (int)sizeof name)
        shell_line_path(c, name);
    else
        c->full = true;
}

bool input_facts_next(const input_facts *x, const input_question *q, char *text, size_t room) {
    shell_line c = shell_line_begin(text, room);
    char number[64];
    shell_line_put(&c, "leafcast convert ");
    if (strcmp(x->path, "-") == 0)
        shell_line_put(&c, "-");
    else
        shell_line_path(&c, x->path);
    if (q->grid.dims[0]) {
        snprintf(number, sizeof number, " --dims %u,%u,%u", q->grid.dims[0], q->grid.dims[1],
                 q->grid.dims[2]);
        shell_line_put(&c, number);
    }
    if (q->grid.type) {
        shell_line_put(&c, " --type ");
        shell_line_put(&c, sample_name(q->grid.type));
    }
    if (q->mesh.field) {
        shell_line_put(&c, " --field ");
        shell_line_word(&c, q->mesh.field);
    }
    if (q->mesh.cells_to_points)
        shell_line_put(&c, " --cells-to-points");
    if (q->grid.trust.follow_links)
        shell_line_put(&c, " --follow-links");
    if (q->grid.trust.allow_missing)
        shell_line_put(&c, " --allow-missing");
    /* Without this option convert would refuse it: there is nothing to draw. */
    if (x->is_mesh && x->field_count == 0)
        shell_line_put(&c, " --allow-empty");
    shell_line_put(&c, " -o ");
    put_leaf_name(&c, x->path);
    return !c.full;
}

/* ---- for programs ---- */

static void set_grid(json_t *json, const input_facts *x) {
    json_t *world = json_array();
    for (int i = 0; i < 12; i++)
        json_array_append_new(world, json_real(x->to_world[i]));
    json_t *more =
        json_pack("{s:[I,I,I], s:s, s:s, s:b, s:o, s:s, s:I, s:I, s:I}", "dims",
                  (json_int_t)x->dims[0], (json_int_t)x->dims[1], (json_int_t)x->dims[2],
                  "sample_type", sample_name(sample_stored(x->type)), "source_type",
                  sample_name(x->source), "rectilinear", (int)x->rectilinear, "to_world", world,
                  "note", x->note, "trailing_bytes", (json_int_t)x->trailing, "absent",
                  (json_int_t)x->absent.count, "absent_of", (json_int_t)x->absent.of);
    json_object_update(json, more);
    json_decref(more);
    cli_json_frame(json, &x->frame);
}

static void set_mesh(json_t *json, const input_facts *x) {
    json_t *bounds = json_array();
    for (int i = 0; i < 6 && x->read && x->report.points > 0; i++)
        json_array_append_new(bounds, json_real((double)x->bounds[i]));
    json_object_set_new(json, "bounds", bounds);
    if (x->read) {
        json_object_set_new(json, "tets", json_integer((json_int_t)x->report.tets));
        json_object_set_new(json, "vertices", json_integer((json_int_t)x->report.points));
        json_object_set_new(json, "repeated", json_integer((json_int_t)x->report.repeated));
        json_object_set_new(json, "bad", json_integer((json_int_t)x->report.bad_indices));
        json_object_set_new(json, "ghosts", json_integer((json_int_t)x->report.ghosts));
    }
}

static void set_choices(json_t *json, const input_facts *x) {
    json_t *fields = json_array(), *times = json_array();
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++) {
        const input_field *f = &x->fields[i];
        json_array_append_new(fields, json_pack("{s:s, s:I, s:I}", "name", f->name, "steps",
                                                (json_int_t)f->steps, "components",
                                                (json_int_t)f->components));
    }
    json_object_set_new(json, "field_count", json_integer(x->field_count));
    json_object_set_new(json, "fields", fields);
    json_object_set_new(json, "field", json_string(x->field));
    json_object_set_new(json, "steps", json_integer(x->steps));
    json_object_set_new(json, "components", json_integer(x->components));
    json_object_set_new(json, "component", json_integer(x->component));
    json_object_set_new(json, "colours", json_boolean(x->colours));
    for (uint32_t i = 0; x->timed && i < x->steps && i < INPUT_FACTS_TIMES; i++)
        json_array_append_new(times, json_real(x->times[i]));
    json_object_set_new(json, "times", times);
}

json_t *input_facts_json(const input_facts *x) {
    const bool any = x->range[0] <= x->range[1];
    json_t *json = json_pack("{s:s, s:s, s:s}", "format", x->format, "kind",
                             x->is_mesh ? "mesh" : "grid", "name", x->name);
    set_choices(json, x);
    if (x->is_mesh)
        set_mesh(json, x);
    else
        set_grid(json, x);
    if (x->read) {
        json_object_set_new(json, "value_min", cli_json_real(any ? x->range[0] : NAN));
        json_object_set_new(json, "value_max", cli_json_real(any ? x->range[1] : NAN));
        json_object_set_new(json, "non_finite", json_integer((json_int_t)x->non_finite));
        json_object_set_new(json, "histogram", histogram_json(&x->values));
    }
    return json;
}
