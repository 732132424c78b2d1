#include "render/view/view_volume.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "formats/base/cpu.h"
#include "formats/base/text.h"
#include "formats/base/world_frame.h"
#include "render/app/colour_map.h"
#include "render/app/transfer_preset.h"
#include "render/look/picture_bytes.h"
#include "render/view/view_state.h"

enum { MAP_COLOURS = 64, PRESET_COLOURS = 32, NAME_MAX_BYTES = 64 };
/* Most steps, of all fields together, that are described by more than their range. */
enum { TOLD_MAX = 64 };

/* Copy the file's name without its folder: what a page shows. */
static void file_name(char *name, size_t room, const char *path) {
    const char *slash = strrchr(path, '/');
    text_name(name, room, slash ? slash + 1 : path);
}

static json_t *histogram_json(const leafcast_histogram *h) {
    json_t *out = json_object(), *samples = json_array();
    for (uint32_t i = 0; i < h->bins; i++)
        json_array_append_new(samples, json_integer(h->samples[i]));
    json_object_set_new(out, "edges",
                        h->bins > 0 ? cli_json_reals(h->edges, (int)h->bins + 1) : json_array());
    json_object_set_new(out, "samples", samples);
    return out;
}

/* List `count` colours, evenly spaced from the first value to the last. */
static json_t *colours_json(const transfer_list *list, const double ends[2], int count,
                            const byte_table *table) {
    json_t *out = json_array();
    for (int i = 0; i < count; i++) {
        const double s = (double)i / (count - 1);
        const leafcast_transfer_point p =
            transfer_list_at(list, (1.0 - s) * ends[0] + s * ends[1], false);
        char text[16];
        snprintf(text, sizeof text, "#%02x%02x%02x", picture_byte(table, (float)p.rgb[0]),
                 picture_byte(table, (float)p.rgb[1]), picture_byte(table, (float)p.rgb[2]));
        json_array_append_new(out, json_string(text));
    }
    return out;
}

/* ---- Presets ---- */

static double diagonal(const leafcast_info *info) {
    double square = 0.0;
    for (int a = 0; a < 3; a++)
        square +=
            (info->bounds[1][a] - info->bounds[0][a]) * (info->bounds[1][a] - info->bounds[0][a]);
    return sqrt(square);
}

/* Describe a preset: its points (value and extinction), and its colours from the first to the
 * last. */
static json_t *preset_json(mem *m, const char *name, const leafcast_histogram *h, double length,
                           const byte_table *table) {
    transfer_list colours = {.m = m}, extinctions = {.m = m};
    json_t *out = NULL;
    if (transfer_preset_make(name, h, length, &colours, &extinctions) == ST_OK) {
        const double ends[2] = {extinctions.points[0].value,
                                extinctions.points[extinctions.count - 1].value};
        json_t *points = json_array();
        for (size_t i = 0; i < extinctions.count; i++)
            json_array_append_new(
                points, cli_json_reals((const double[2]){extinctions.points[i].value,
                                                         extinctions.points[i].extinction},
                                       2));
        out = json_pack("{s:o,s:o}", "points", points, "colours",
                        colours_json(&colours, ends, PRESET_COLOURS, table));
    }
    transfer_list_release(&colours);
    transfer_list_release(&extinctions);
    return out;
}

static json_t *presets_json(mem *m, const leafcast_histogram *h, double length,
                            const byte_table *table) {
    json_t *out = json_object();
    for (const char *at = transfer_preset_names(); *at;) {
        char name[NAME_MAX_BYTES];
        const size_t n = strcspn(at, "|");
        snprintf(name, sizeof name, "%.*s", (int)n, at);
        json_object_set_new(out, name, preset_json(m, name, h, length, table));
        at += n + (at[n] == '|');
    }
    return out;
}

/* ---- Fields ---- */

/* Set range[] to the range of a field's values over all steps, and data[] to the same without
 * values that stand for no data. Both are 0, 0 if no value is finite.
 */
static void find_ranges(const leafcast *volume, uint32_t field, double range[2], double data[2]) {
    const uint32_t steps = leafcast_describe(volume).steps;
    range[0] = data[0] = INFINITY;
    range[1] = data[1] = -INFINITY;
    for (uint32_t i = 0; i < steps; i++) {
        double all[2], some[2];
        if (leafcast_range(volume, field, i, all) != LEAFCAST_OK || all[0] > all[1])
            continue;
        memcpy(some, all, sizeof some);
        if (all[0] < all[1] && leafcast_data_range(volume, field, i, some) != LEAFCAST_OK)
            memcpy(some, all, sizeof some);
        range[0] = fmin(range[0], all[0]);
        range[1] = fmax(range[1], all[1]);
        data[0] = fmin(data[0], some[0]);
        data[1] = fmax(data[1], some[1]);
    }
    if (range[0] > range[1])
        range[0] = range[1] = data[0] = data[1] = 0.0;
}

/* Describe a field at a step: its histogram, suggested isovalues, presets. */
static json_t *field_step_json(mem *m, const leafcast *volume, uint32_t field, uint32_t step,
                               leafcast_histogram *h, const byte_table *table) {
    const leafcast_info info = leafcast_describe(volume);
    double suggested[LEAFCAST_SUGGESTIONS_MAX];
    int count = 0;
    if (leafcast_suggested_isovalues(volume, field, step, suggested, LEAFCAST_SUGGESTIONS_MAX,
                                     &count) != LEAFCAST_OK)
        count = 0;
    const bool known = leafcast_get_histogram(volume, field, step, h) == LEAFCAST_OK;
    if (!known)
        h->bins = 0;
    return json_pack("{s:o,s:o,s:o}", "suggested", cli_json_reals(suggested, count), "histogram",
                     histogram_json(h), "presets",
                     known ? presets_json(m, h, diagonal(&info), table) : json_object());
}

/* Describe a field at its first steps. */
static json_t *field_steps_json(const leafcast *volume, uint32_t field, const byte_table *table) {
    const leafcast_info info = leafcast_describe(volume);
    const uint32_t room = info.fields < TOLD_MAX ? TOLD_MAX / info.fields : 1;
    json_t *out = json_array();
    mem m;
    mem_init(&m, 0);
    leafcast_histogram *h = mem_zalloc(&m, sizeof *h);
    for (uint32_t i = 0; h && i < info.steps && i < room; i++)
        json_array_append_new(out, field_step_json(&m, volume, field, i, h, table));
    mem_free(&m, h);
    return out;
}

static json_t *field_json(const leafcast *volume, uint32_t field, const byte_table *table) {
    double range[2], data[2];
    const char *name = leafcast_field_name(volume, field);
    json_t *out = json_object(), *text = json_string(name);
    find_ranges(volume, field, range, data);
    /* A name from the file need not be valid UTF-8. */
    json_object_set_new(out, "name", text ? text : json_string(""));
    json_object_set_new(out, "range", cli_json_reals(range, 2));
    json_object_set_new(out, "data", cli_json_reals(data, 2));
    json_object_set_new(out, "steps", field_steps_json(volume, field, table));
    return out;
}

static json_t *maps_json(const byte_table *table) {
    json_t *out = json_object();
    mem m;
    mem_init(&m, 0);
    for (const char *at = colour_map_names(); *at;) {
        char name[NAME_MAX_BYTES];
        const size_t n = strcspn(at, "|");
        transfer_list map = {.m = &m};
        snprintf(name, sizeof name, "%.*s", (int)n, at);
        if (colour_map_named(name, &map) == ST_OK)
            json_object_set_new(
                out, name, colours_json(&map, (const double[2]){0.0, 1.0}, MAP_COLOURS, table));
        transfer_list_release(&map);
        at += n + (at[n] == '|');
    }
    return out;
}

static json_t *text_json(const char *text) {
    char printable[4096];
    return json_string(text_printable(printable, sizeof printable, text));
}

/* The path for a command. JSON cannot hold one that is not UTF-8: that is escaped. */
static json_t *path_json(const char *path) {
    json_t *out = json_string(path);
    return out ? out : text_json(path);
}

static json_t *files_json(const view_file *files, int count) {
    json_t *out = json_array();
    for (int i = 0; i < count; i++) {
        char name[300];
        file_name(name, sizeof name, files[i].path);
        json_array_append_new(out, text_json(name));
    }
    return out;
}

static json_t *steps_json(const leafcast *volume, uint32_t steps) {
    json_t *out = json_array();
    for (uint32_t i = 0; i < steps; i++)
        json_array_append_new(out, cli_json_real(leafcast_step_time(volume, i)));
    return out;
}

/* List the letters of the ends +x, -x, +y, ...; empty if the directions are unknown. */
static json_t *ends_json(leafcast_axes axes) {
    json_t *out = json_array();
    for (int i = 0; i < 6 && axes != LEAFCAST_AXES_FILE; i++) {
        const char letter[2] = {world_axes_end(axes, i / 2, i % 2 == 0), 0};
        json_array_append_new(out, json_string(letter));
    }
    return out;
}

/* The instructions that are used; what names no ISA is an experiment's, which names itself. */
static const char *isa_used(const char *asked) {
    cpu_isa isa;
    return cpu_isa_find(asked, &isa) ? cpu_isa_name(isa) : asked;
}

static json_t *describe(const view_file *files, int count, int which, const view_machine *machine,
                        const byte_table *table) {
    const leafcast *volume = files[which].volume;
    const leafcast_info info = leafcast_describe(volume);
    char name[300];
    file_name(name, sizeof name, files[which].path);
    json_t *out = json_pack("{s:s,s:s,s:s,s:s}", "type", "volume", "version", LEAFCAST_VERSION,
                            "kind", info.kind, "sample_type", info.sample_type);
    json_t *fields = json_array();
    if (!out)
        return NULL;
    for (uint32_t i = 0; i < info.fields; i++)
        json_array_append_new(fields, field_json(volume, i, table));
    json_object_set_new(out, "name", text_json(info.name));
    json_object_set_new(out, "file", text_json(name));
    json_object_set_new(out, "path", path_json(files[which].path));
    json_object_set_new(out, "files", files_json(files, count));
    json_object_set_new(out, "which", json_integer(which));
    json_object_set_new(out, "dims",
                        json_pack("[I,I,I]", (json_int_t)info.dims[0], (json_int_t)info.dims[1],
                                  (json_int_t)info.dims[2]));
    json_object_set_new(out, "cell", json_string(info.cell));
    json_object_set_new(out, "cells", json_integer((json_int_t)info.cells));
    json_object_set_new(out, "nodes", json_integer((json_int_t)info.nodes));
    json_object_set_new(out, "surface", json_boolean(info.abilities & LEAFCAST_ABILITY_GIVEN));
    json_object_set_new(out, "analytic_normals",
                        json_boolean(info.abilities & LEAFCAST_ABILITY_ANALYTIC_NORMALS));
    json_object_set_new(
        out, "bounds",
        json_pack("[o,o]", cli_json_reals(info.bounds[0], 3), cli_json_reals(info.bounds[1], 3)));
    json_object_set_new(out, "cell_size", cli_json_real(info.cell_size));
    json_object_set_new(out, "gradients", json_boolean(info.gradients));
    json_object_set_new(out, "ends", ends_json(info.axes));
    json_object_set_new(out, "units",
                        json_pack("[s,s,s]", info.units[0], info.units[1], info.units[2]));
    json_object_set_new(out, "levels", json_integer(info.levels));
    json_object_set_new(out, "treelets", json_integer(info.treelets));
    json_object_set_new(out, "file_bytes", json_integer((json_int_t)info.file_bytes));
    json_object_set_new(out, "memory", json_integer((json_int_t)machine->memory));
    json_object_set_new(out, "threads", json_integer(machine->threads));
    json_object_set_new(out, "isa", json_string(isa_used(machine->isa)));
    json_object_set_new(out, "fields", fields);
    json_object_set_new(out, "steps", steps_json(volume, info.steps));
    json_object_set_new(out, "colour_maps", maps_json(table));
    json_object_set_new(out, "state", view_state_first(volume));
    json_object_set_new(out, "fits", view_state_fits(volume));
    return out;
}

/* Objects of a scene have names of their own, and what the scene says. */
static void describe_scene(json_t *out, const view_scene *scene) {
    json_t *names = json_array();
    for (int i = 0; i < scene->count; i++)
        json_array_append_new(names, text_json(scene->names[i]));
    json_object_set_new(out, "files", names);
    json_t *told = view_scene_json(scene);
    json_object_set_new(told, "path", path_json(scene->path));
    json_object_set_new(out, "scene", told);
    json_object_set_new(out, "state", view_scene_state(scene));
}

json_t *view_volume_json(const view_file *files, int count, int which, const view_scene *scene,
                         const view_machine *machine) {
    mem m;
    mem_init(&m, 0);
    byte_table *table = mem_alloc(&m, sizeof *table);
    json_t *out = NULL;
    if (table) {
        picture_bytes_init(table);
        out = describe(files, count, which, machine, table);
        if (out && scene)
            describe_scene(out, scene);
    }
    mem_free(&m, table);
    return out;
}
