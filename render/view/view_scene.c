#include "render/view/view_scene.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/box3.h"
#include "formats/base/cli_json.h"
#include "formats/base/num.h"
#include "formats/base/text.h"
#include "render/app/scene_file.h"
#include "render/app/view_camera.h"
#include "render/ray/placement.h"

enum { NAME_ROOM = 320 };

/* ---- Objects ---- */

leafcast *view_scene_volume(const view_scene *s, int object) {
    return object == 0 ? s->job.volume : s->job.also[object - 1].volume;
}

const char *view_scene_path(const view_scene *s, int object) {
    return object == 0 ? s->job.source : s->job.also[object - 1].path;
}

const render_places *view_scene_places(const view_scene *s, int object) {
    return object == 0 ? &s->job.places : &s->job.also[object - 1].places;
}

int view_scene_keeper(const view_scene *s, int object) {
    const int same = object == 0 ? -1 : s->job.also[object - 1].same;
    return same >= 0 ? same : object;
}

const char *view_scene_told(const view_scene *s, const char *path) {
    const char *slash = strrchr(s->path, '/');
    const size_t folder = slash ? (size_t)(slash + 1 - s->path) : 0;
    return strncmp(path, s->path, folder) == 0 ? path + folder : path;
}

/* ---- Opening ---- */

uint64_t view_scene_bit(const char *flag) {
    bool repeats;
    view_value takes;
    const int first = view_options_key("iso", &repeats, &takes),
              key = view_options_key(flag, &repeats, &takes);
    return key >= first ? (uint64_t)1 << (key - first) : 0;
}

uint64_t view_scene_bits_of_one(void) {
    const struct argp_option *const tables[] = {view_options_table, medium_options_table};
    uint64_t bits = 0;
    for (int t = 0; t < 2; t++)
        for (const struct argp_option *o = tables[t]; o->name || o->doc; o++)
            if (o->name && view_options_of_one(o->key))
                bits |= view_scene_bit(o->name);
    return bits;
}

/* Keep checked flags of one volume, with the colours that were chosen. */
static void keep_view(view_options *to, const view_options *from) {
    *to = *from;
    to->given &= view_scene_bits_of_one();
    to->colours = to->isos;
    to->others_transparent = to->others_surfaces = to->others_filled = to->others_coloured = false;
}

static status check_scene(view_scene *s) {
    script_frame *frame = mem_zalloc(&s->m, sizeof *frame);
    if (!frame)
        return ST_NOMEM;
    s->picture_view = frame->view = s->options.view;
    s->picture_view.given &= ~view_scene_bits_of_one();
    const status st = render_job_check(&s->job, frame);
    for (int i = 0; i < s->count && st == ST_OK; i++)
        keep_view(&s->views[i], i == 0 ? &frame->view : &s->job.also[i - 1].view);
    mem_free(&s->m, frame);
    return st;
}

static const char *file_of(const view_scene *s, int object) {
    const char *path = view_scene_path(s, object), *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static int number_of_name(const view_scene *s, int object) {
    int number = 1;
    for (int i = 0; i < object; i++)
        number += strcmp(file_of(s, i), file_of(s, object)) == 0;
    return number;
}

/* Name objects for their files, with numbers where several have one name. */
static status name_objects(view_scene *s) {
    status st = ST_OK;
    for (int i = 0; i < s->count && st == ST_OK; i++) {
        char name[NAME_ROOM], text[NAME_ROOM + 16];
        const int number = number_of_name(s, i);
        text_name(name, sizeof name, file_of(s, i));
        snprintf(text, sizeof text, number > 1 ? "%s (%d)" : "%s", name, number);
        s->names[i] = mem_copy_text(&s->m, text);
        st = s->names[i] ? ST_OK : ST_NOMEM;
    }
    return st;
}

static void box_of(const view_scene *s, int object, double box[2][3]) {
    const leafcast_info info = leafcast_describe(view_scene_volume(s, object));
    const render_places *p = view_scene_places(s, object);
    box3_begin(box);
    for (int k = 0; k < (p->count > 0 ? p->count : 1); k++) {
        const placement place = placement_of(p->count > 0 ? p->at + 12 * (size_t)k : NULL);
        double own[2][3];
        placement_box(&place, info.bounds, own);
        box3_widen(box, own[0], own[1]);
    }
}

static status read_picture(view_scene *s) {
    const status st = script_load(s->path, &s->picture);
    if (st == ST_OK)
        json_object_del(s->picture, "objects");
    return st;
}

static status open_files(view_scene *s, const leafcast_options *options) {
    s->job.also = s->options.also;
    s->job.also_count = s->options.also_count;
    s->job.places = s->options.places;
    s->job.fits_all = true;
    s->count = s->job.also_count + 1;
    s->views = mem_array(&s->m, (size_t)s->count, sizeof *s->views);
    s->names = mem_array(&s->m, (size_t)s->count, sizeof *s->names);
    if (!s->views || !s->names)
        return ST_NOMEM;
    return render_job_open(&s->job, s->options.common.input, options);
}

static status open_scene(view_scene *s, const leafcast_options *options) {
    status st = scene_file_load(&s->options);
    if (st == ST_OK && s->options.group_count > 0)
        st = status_describe(ST_USAGE,
                             "%s: scenes and objects that are placed many times, as groups, are of "
                             "leafcast render",
                             s->path);
    if (st == ST_OK)
        st = read_picture(s);
    if (st == ST_OK)
        st = open_files(s, options);
    if (st == ST_OK)
        st = check_scene(s);
    if (st == ST_OK)
        st = name_objects(s);
    if (st != ST_OK)
        return st;
    box3_begin(s->box);
    for (int i = 0; i < s->count; i++) {
        double own[2][3];
        box_of(s, i, own);
        box3_widen(s->box, own[0], own[1]);
    }
    return ST_OK;
}

status view_scene_open(const char *path, bool follow_links, const leafcast_options *options,
                       view_scene **out) {
    mem m;
    char name[NAME_ROOM];
    const char *slash = strrchr(path, '/');
    mem_init(&m, 0);
    view_scene *s = mem_zalloc(&m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    mem_init(&s->m, 0);
    s->path = path;
    s->follow_links = s->options.follow_links = follow_links;
    s->options.common.input = path;
    view_options_init(&s->options.view);
    s->options.view.takes_media = true;
    text_name(name, sizeof name, slash ? slash + 1 : path);
    s->name = mem_copy_text(&s->m, name);
    const status st = s->name ? open_scene(s, options) : ST_NOMEM;
    if (st == ST_OK)
        *out = s;
    else
        view_scene_close(s);
    return st;
}

void view_scene_close(view_scene *s) {
    mem m;
    if (!s)
        return;
    render_job_close(&s->job);
    render_options_release(&s->options);
    json_decref(s->picture);
    for (int i = 0; i < s->count && s->names; i++)
        mem_free(&s->m, s->names[i]);
    mem_free(&s->m, s->names);
    mem_free(&s->m, s->views);
    mem_free(&s->m, s->name);
    mem_init(&m, 0);
    mem_free(&m, s);
}

/* ---- Flags as JSON ---- */

static void put(json_t *out, const char *key, json_t *value) {
    json_object_set_new(out, key, value);
}

static void put_surfaces(json_t *out, const view_options *v) {
    json_t *isos = json_array(), *colours = json_array(), *opacities = json_array(),
           *reflects = json_array(), *refracts = json_array();
    bool clear = false, mirrors = false, bends = false;
    for (int i = 0; i < v->isos; i++) {
        const leafcast_surface *s = &v->surfaces[i];
        const double rgb[3] = {s->rgb[0], s->rgb[1], s->rgb[2]};
        char text[NUM_TEXT_MAX + 16], weight[NUM_TEXT_MAX];
        json_array_append_new(isos, cli_json_real(s->isovalue));
        json_array_append_new(colours, cli_json_reals(rgb, 3));
        json_array_append_new(opacities, cli_json_real(s->opacity));
        snprintf(text, sizeof text, "%s,%d", num_print(s->reflectivity, weight),
                 v->reflect_bounces > 0 ? v->reflect_bounces : 1);
        json_array_append_new(reflects, json_string(text));
        num_print(s->refraction > 0.0f ? s->refraction : 1.0, weight);
        snprintf(text, sizeof text, v->refract_bounces > 0 ? "%s,%d" : "%s", weight,
                 v->refract_bounces); /* a default that is told would be one that is asked for */
        json_array_append_new(refracts, json_string(text));
        clear |= s->opacity < 1.0f;
        mirrors |= s->reflectivity > 0.0f;
        bends |= s->refraction > 0.0f;
    }
    if (v->isos > 0 && !v->is_surface)
        json_object_set(out, "iso", isos);
    if (v->isos > 0)
        json_object_set(out, "colour", colours);
    if (clear)
        json_object_set(out, "opacity", opacities);
    if (mirrors)
        json_object_set(out, "reflect", reflects);
    if (bends && clear) /* nothing is seen through what is not */
        json_object_set(out, "refract", refracts);
    json_decref(isos);
    json_decref(colours);
    json_decref(opacities);
    json_decref(reflects);
    json_decref(refracts);
}

/* Append a medium's opacities "V:A,V:A,..." to those of surfaces. */
static void put_opacities(json_t *out, const medium_options *m) {
    char text[MEDIUM_OPACITIES_MAX * 2 * (NUM_TEXT_MAX + 1)] = "";
    size_t n = 0;
    if (m->opacities == 0)
        return;
    for (int i = 0; i < m->opacities; i++) {
        char value[NUM_TEXT_MAX], opacity[NUM_TEXT_MAX];
        n += (size_t)snprintf(text + n, sizeof text - n, "%s%s:%s", i ? "," : "",
                              num_print(m->opacity[i][0], value),
                              num_print(m->opacity[i][1], opacity));
    }
    if (!json_object_get(out, "opacity"))
        put(out, "opacity", json_array());
    json_array_append_new(json_object_get(out, "opacity"), json_string(text));
}

json_t *view_scene_flags(const view_scene *s, const view_options *v) {
    const medium_options *m = &v->medium;
    json_t *out = json_object();
    if (v->field[0])
        put(out, "field", json_string(v->field));
    if (v->time.given)
        put(out, "time", cli_json_real(v->time.time));
    else if (v->step > 0)
        put(out, "step", json_integer(v->step));
    if (v->time.given && v->time.interpolate)
        put(out, "interpolate", json_true());
    put_surfaces(out, v);
    put_opacities(out, m);
    if (v->colour_by[0])
        put(out, "colour-by", json_string(v->colour_by));
    if (m->tf[0])
        put(out, "tf", json_string(view_scene_told(s, m->tf)));
    if (m->colour_map[0])
        put(out, "colour-map", json_string(view_scene_told(s, m->colour_map)));
    if (m->windowed)
        put(out, "window", cli_json_reals(m->window, 2));
    if (m->opacity_length > 0.0)
        put(out, "opacity-length", cli_json_real(m->opacity_length));
    return out;
}

/* ---- What a page is told ---- */

static json_t *box_json(const double box[2][3]) {
    return json_pack("[o,o]", cli_json_reals(box[0], 3), cli_json_reals(box[1], 3));
}

static json_t *object_json(const view_scene *s, int i) {
    const leafcast_info info = leafcast_describe(view_scene_volume(s, i));
    const render_places *p = view_scene_places(s, i);
    double box[2][3];
    box_of(s, i, box);
    return json_pack("{s:s,s:s,s:b,s:i,s:o,s:o,s:o}", "name", s->names[i], "cell", info.cell,
                     "surface", (int)((info.abilities & LEAFCAST_ABILITY_GIVEN) != 0), "same",
                     view_scene_keeper(s, i), "place",
                     p->count > 0 ? cli_json_reals(p->at, 12) : json_null(), "box",
                     box_json((const double(*)[3])box), "flags", view_scene_flags(s, &s->views[i]));
}

/* The camera of render's picture, for a wide page. */
static void put_camera(json_t *state, const view_scene *s) {
    enum { WIDTH = 1280, HEIGHT = 720 };
    static const char *const keys[] = {"camera", "view", "size",    "eye",  "look-at",
                                       "up",     "fov",  "look_at", "ortho"};
    render_job job = s->job;
    view_options v = s->picture_view;
    v.camera.width = WIDTH;
    v.camera.height = HEIGHT;
    const leafcast_camera c = render_job_camera(&job, &v);
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        json_object_del(state, keys[i]);
    put(state, "eye", cli_json_reals(c.eye, 3));
    put(state, "look-at", cli_json_reals(c.look_at, 3));
    put(state, "up", cli_json_reals(c.up, 3));
    if (c.ortho_height > 0.0)
        put(state, "ortho", cli_json_real(c.ortho_height));
    else
        put(state, "fov", cli_json_real(c.fov));
}

json_t *view_scene_json(const view_scene *s) {
    json_t *objects = json_array();
    for (int i = 0; i < s->count; i++)
        json_array_append_new(objects, object_json(s, i));
    return json_pack("{s:s,s:b,s:b,s:o,s:o}", "file", s->name, "links", (int)s->follow_links,
                     "fitted", (int)view_camera_fits(&s->picture_view), "box", box_json(s->box),
                     "objects", objects);
}

json_t *view_scene_state(const view_scene *s) {
    json_t *state = json_deep_copy(s->picture);
    put_camera(state, s);
    return state;
}
