#include "render/view/view_volume.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "formats/base/text.h"
#include "render/app/colour_map.h"
#include "render/picture_bytes.h"
#include "render/view/view_state.h"

enum { MAP_COLOURS = 64, MAP_NAME_MAX = 64 };

static json_t *reals(const double *x, int count) {
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        json_array_append_new(list, cli_json_real(x[i]));
    return list;
}

/* Without its folder, which is nobody's business. */
static void file_name(char *name, size_t room, const char *path) {
    const char *slash = strrchr(path, '/');
    text_name(name, room, slash ? slash + 1 : path);
}

static json_t *histogram_json(const leafcast *volume, uint32_t field) {
    leafcast_histogram *h = NULL;
    mem m;
    json_t *out = json_object(), *samples = json_array(), *area = json_array();
    mem_init(&m, 0);
    h = mem_zalloc(&m, sizeof *h);
    const bool known = h && leafcast_get_histogram(volume, field, 0, h) == LEAFCAST_OK;
    for (uint32_t i = 0; known && i < h->bins; i++) {
        json_array_append_new(samples, json_integer(h->samples[i]));
        json_array_append_new(area, cli_json_real((double)h->area[i]));
    }
    json_object_set_new(out, "edges",
                        known && h->bins > 0 ? reals(h->edges, (int)h->bins + 1) : json_array());
    json_object_set_new(out, "samples", samples);
    json_object_set_new(out, "area", area);
    mem_free(&m, h);
    return out;
}

static json_t *field_json(const leafcast *volume, uint32_t field) {
    double range[2] = {0.0, 0.0}, suggested[LEAFCAST_SUGGESTIONS_MAX];
    int count = 0;
    const char *name = leafcast_field_name(volume, field);
    json_t *out = json_object(), *text = json_string(name);
    if (leafcast_range(volume, field, 0, range) != LEAFCAST_OK || range[0] > range[1])
        range[0] = range[1] = 0.0;
    if (leafcast_suggested_isovalues(volume, field, 0, suggested, LEAFCAST_SUGGESTIONS_MAX,
                                     &count) != LEAFCAST_OK)
        count = 0;
    /* Names of files need not be UTF-8. */
    json_object_set_new(out, "name", text ? text : json_string(""));
    double data[2] = {range[0], range[1]};
    if (range[0] < range[1])
        (void)leafcast_data_range(volume, field, 0, data);
    json_object_set_new(out, "range", reals(range, 2));
    json_object_set_new(out, "data", reals(data, 2));
    json_object_set_new(out, "suggested", reals(suggested, count));
    json_object_set_new(out, "histogram", histogram_json(volume, field));
    return out;
}

static json_t *map_json(const transfer_list *map, const byte_table *table) {
    json_t *out = json_array();
    for (int i = 0; i < MAP_COLOURS; i++) {
        const leafcast_transfer_point p =
            transfer_list_at(map, (double)i / (MAP_COLOURS - 1), false);
        char text[16];
        snprintf(text, sizeof text, "#%02x%02x%02x", picture_byte(table, p.rgb[0]),
                 picture_byte(table, p.rgb[1]), picture_byte(table, p.rgb[2]));
        json_array_append_new(out, json_string(text));
    }
    return out;
}

static json_t *maps_json(void) {
    byte_table *table = NULL;
    json_t *out = json_object();
    mem m;
    mem_init(&m, 0);
    table = mem_alloc(&m, sizeof *table);
    if (table)
        picture_bytes_init(table);
    for (const char *at = colour_map_names(); table && *at;) {
        char name[MAP_NAME_MAX];
        const size_t n = strcspn(at, "|");
        transfer_list map = {.m = &m};
        snprintf(name, sizeof name, "%.*s", (int)n, at);
        if (colour_map_named(name, &map) == ST_OK)
            json_object_set_new(out, name, map_json(&map, table));
        transfer_list_release(&map);
        at += n + (at[n] == '|');
    }
    mem_free(&m, table);
    return out;
}

static json_t *text_json(const char *text) {
    char printable[4096];
    return json_string(text_printable(printable, sizeof printable, text));
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

json_t *view_volume_json(const view_file *files, int count, int which,
                         const view_machine *machine) {
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
        json_array_append_new(fields, field_json(volume, i));
    json_object_set_new(out, "name", text_json(info.name));
    json_object_set_new(out, "file", text_json(name));
    json_object_set_new(out, "files", files_json(files, count));
    json_object_set_new(out, "which", json_integer(which));
    json_object_set_new(out, "dims",
                        json_pack("[I,I,I]", (json_int_t)info.dims[0], (json_int_t)info.dims[1],
                                  (json_int_t)info.dims[2]));
    json_object_set_new(out, "tets", json_integer((json_int_t)info.tets));
    json_object_set_new(out, "vertices", json_integer((json_int_t)info.vertices));
    json_object_set_new(out, "bounds",
                        json_pack("[o,o]", reals(info.bounds[0], 3), reals(info.bounds[1], 3)));
    json_object_set_new(out, "cell_size", cli_json_real(info.cell_size));
    json_object_set_new(out, "levels", json_integer(info.levels));
    json_object_set_new(out, "treelets", json_integer(info.treelets));
    json_object_set_new(out, "file_bytes", json_integer((json_int_t)info.file_bytes));
    json_object_set_new(out, "memory", json_integer((json_int_t)machine->memory));
    json_object_set_new(out, "threads", json_integer(machine->threads));
    json_object_set_new(out, "isa", json_string(machine->isa ? machine->isa : "auto"));
    json_object_set_new(out, "fields", fields);
    json_object_set_new(out, "steps", steps_json(volume, info.steps));
    json_object_set_new(out, "colour_maps", maps_json());
    json_object_set_new(out, "state", view_state_first(volume));
    return out;
}
