#include "formats/surface/surface_gltf.h"

#include <string.h>
#include <sys/stat.h>

#include "formats/base/portable_math.h"
#include "formats/base/text.h"
#include "formats/base/vec3.h"
#include "formats/input/binary_fields.h"
#include "formats/surface/gltf_file.h"
#include "formats/surface/surface_colour.h"
#include "formats/surface/surface_flow.h"

typedef struct gltf {
    surface_choice choice;
    mem *m;
    gltf_file file;
} gltf;

/* ---- elements of an array, front to back ---- */

typedef struct elements {
    const gltf_array *of;
    byte_stream *s;
    uint64_t next;
} elements;

static status open_elements(mem *m, const gltf_array *of, elements *out) {
    *out = (elements){.of = of};
    status st = byte_stream_open(m, of->path, &out->s);
    return st == ST_OK ? byte_stream_skip(out->s, of->at) : st;
}

static double number_at(const uint8_t *at, gltf_type type) {
    const int width = (int)gltf_file_width(type);
    return type == GLTF_F32 ? binary_real(at, width, false)
                            : (double)binary_unsigned(at, width, false);
}

static status next_element(elements *e, double numbers[4]) {
    const gltf_array *of = e->of;
    const uint32_t width = gltf_file_width(of->type), size = width * of->components;
    const uint8_t *at;
    size_t held;
    status st = byte_stream_peek(e->s, size, &at, &held);
    if (st == ST_OK && held < size)
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu, inside an array", of->path,
                               (unsigned long long)(byte_stream_position(e->s) + held));
    if (st != ST_OK)
        return st;
    for (uint32_t c = 0; c < of->components; c++)
        numbers[c] = number_at(at + (size_t)c * width, of->type);
    byte_stream_take(e->s, size);
    e->next++;
    return e->next < of->count ? byte_stream_skip(e->s, of->stride - size) : ST_OK;
}

/* ---- points ---- */

static status read_points(const gltf *g, const gltf_part *p, surface_flow *flow) {
    elements e;
    double at[4], to[3];
    status st = open_elements(g->m, &p->positions, &e);
    for (uint64_t i = 0; st == ST_OK && i < p->positions.count; i++) {
        st = next_element(&e, at);
        for (int a = 0; st == ST_OK && a < 3; a++)
            to[a] = p->to[a][0] * at[0] + p->to[a][1] * at[1] + p->to[a][2] * at[2] + p->to[a][3];
        if (st == ST_OK)
            st = surface_flow_point(flow, to);
    }
    byte_stream_close(e.s);
    return st;
}

static bool has_normals(const gltf *g) {
    bool any = false;
    for (size_t i = 0; i < g->file.count; i++)
        any = any || g->file.parts[i].normals.path;
    return any;
}

/* Normals go by the inverse transpose: its rows are cross products of the placement's. */
static void place_normal(const gltf_part *p, const double normal[3], double to[3]) {
    for (int a = 0; a < 3; a++) {
        double row[3];
        vec3_cross(p->to[(a + 1) % 3], p->to[(a + 2) % 3], row);
        to[a] = (p->mirrored ? -1.0 : 1.0) * vec3_dot(row, normal);
    }
}

static status read_normals(const gltf *g, const gltf_part *p, surface_flow *flow) {
    elements e;
    double normal[4], to[3];
    if (!p->normals.path)
        return surface_flow_no_normals(flow, p->positions.count);
    status st = open_elements(g->m, &p->normals, &e);
    for (uint64_t i = 0; st == ST_OK && i < p->normals.count; i++) {
        st = next_element(&e, normal);
        if (st == ST_OK) {
            place_normal(p, normal, to);
            st = surface_flow_normal(flow, to);
        }
    }
    byte_stream_close(e.s);
    return st;
}

/* Returns the sRGB of a linear number, both 0 .. 1. */
static double srgb(double linear) {
    if (!(linear > 0.0031308))
        return linear > 0 ? 12.92 * linear : 0;
    return linear < 1 ? 1.055 * portable_exp(portable_log(linear) / 2.4) - 0.055 : 1;
}

static status read_colours(const gltf *g, const gltf_part *p, uint32_t k, surface_flow *flow) {
    elements e = {.s = NULL};
    const double most = p->colours.type == GLTF_U8 ? 255 : p->colours.type == GLTF_U16 ? 65535 : 1;
    double rgb[4] = {1, 1, 1, 1};
    status st = p->colours.path ? open_elements(g->m, &p->colours, &e) : ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < p->positions.count; i++) {
        if (e.s)
            st = next_element(&e, rgb);
        for (int c = 0; st == ST_OK && e.s && c < 3; c++)
            rgb[c] = srgb(rgb[c] / most);
        if (st == ST_OK)
            st = surface_flow_value(flow, k, surface_colour_value(rgb, 1));
    }
    byte_stream_close(e.s);
    return st;
}

/* ---- triangles ---- */

/* Corners of a part's triangles, one by one. */
typedef struct corners {
    uint64_t ids[3];
    uint64_t count;
    bool mirrored;
} corners;

static status put_triangle(surface_flow *flow, const corners *c, uint64_t a, uint64_t b,
                           uint64_t last) {
    const uint64_t ids[3] = {a, c->mirrored ? last : b, c->mirrored ? b : last};
    return surface_flow_polygon(flow, ids, 3, NULL);
}

static status put_corner(surface_flow *flow, corners *c, gltf_mode mode, uint64_t id) {
    const uint64_t n = c->count++;
    status st = ST_OK;
    if (mode == GLTF_TRIANGLES) {
        c->ids[n % 3] = id;
        return n % 3 == 2 ? put_triangle(flow, c, c->ids[0], c->ids[1], id) : ST_OK;
    }
    if (n >= 2)
        st = mode == GLTF_STRIP && n % 2 ? put_triangle(flow, c, c->ids[1], c->ids[0], id)
                                         : put_triangle(flow, c, c->ids[0], c->ids[1], id);
    if (n == 0 || mode == GLTF_STRIP)
        c->ids[0] = n == 0 ? id : c->ids[1];
    c->ids[1] = id;
    return st;
}

static status read_faces(const gltf *g, const gltf_part *p, surface_flow *flow) {
    corners c = {.mirrored = p->mirrored};
    elements e = {.s = NULL};
    const uint64_t count = p->indices.path ? p->indices.count : p->positions.count;
    status st = p->indices.path ? open_elements(g->m, &p->indices, &e) : ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < count; i++) {
        double id[4] = {(double)i};
        if (e.s)
            st = next_element(&e, id);
        if (st == ST_OK)
            st = put_corner(flow, &c, p->mode, (uint64_t)id[0]);
    }
    byte_stream_close(e.s);
    return st;
}

static status pass(void *state, surface_flow *flow) {
    const gltf *g = state;
    status st = ST_OK;
    surface_flow_skip(flow, g->file.skipped);
    for (size_t i = 0; st == ST_OK && i < g->file.count; i++) {
        const gltf_part *p = &g->file.parts[i];
        st = surface_flow_piece(flow, p->positions.count);
        if (st == ST_OK)
            st = read_points(g, p, flow);
        if (st == ST_OK && mesh_feed_takes_normals(flow->feed) && has_normals(g))
            st = read_normals(g, p, flow);
        for (uint32_t k = 0; st == ST_OK && k < g->choice.taken_count; k++)
            st = read_colours(g, p, k, flow);
        if (st == ST_OK)
            st = read_faces(g, p, flow);
        if (st == ST_OK)
            st = surface_flow_end_piece(flow);
    }
    return st;
}

/* ---- the readers ---- */

static bool is_glb(const char *path, const uint8_t *start, size_t size) {
    return gltf_file_is_binary(start, size) || text_ends_in(path, ".glb");
}

static bool is_gltf(const char *path, const uint8_t *start, size_t size) {
    (void)start, (void)size;
    return text_ends_in(path, ".gltf");
}

static status check_file(const mesh_source *source) {
    struct stat info;
    if (stat(source->path, &info) == 0 && S_ISREG(info.st_mode))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: glTF is read at several places, so from a regular file alone",
                           byte_stream_name(source->data));
}

static status open_file(mesh_source *source, void **state) {
    gltf *g = mem_zalloc(source->m, sizeof *g);
    if (!g)
        return ST_NOMEM;
    *state = g;
    g->m = source->m;
    g->choice.source = source;
    g->file.m = source->m;
    status st = check_file(source);
    if (st == ST_OK)
        st = gltf_file_read(source, &g->file);
    bool coloured = false;
    for (size_t i = 0; st == ST_OK && i < g->file.count; i++)
        coloured = coloured || g->file.parts[i].colours.path;
    const surface_field rgb = {.name = COLOUR_FIELD, .components = 1, .colour = true};
    return coloured ? surface_choice_add(&g->choice, &rgb) : st;
}

static status read(void *state, mesh_feed *feed) {
    gltf *g = state;
    mesh_feed_expect_cells(feed, g->file.faces + g->file.skipped);
    return surface_flow_run(&g->choice, feed, g->file.points, true, pass, g);
}

static void counts(const void *state, uint64_t *points, uint64_t *cells) {
    const gltf *g = state;
    *points = g->file.points;
    *cells = g->file.faces;
}

static void close_file(void *state) {
    gltf *g = state;
    if (!g)
        return;
    gltf_file_release(&g->file);
    surface_choice_release(&g->choice);
    mem_free(g->m, g);
}

static const char *tell_file(const void *state) {
    return ((const gltf *)state)->choice.source->path;
}

const mesh_reader surface_glb_reader = {.format = "glTF binary",
                                        .known = is_glb,
                                        .open = open_file,
                                        .read = read,
                                        .close = close_file,
                                        .take = surface_choice_take,
                                        .fields = surface_choice_fields,
                                        .counts = counts};

/* It names other files, unlike .glb. */
const mesh_reader surface_gltf_reader = {.format = "glTF",
                                         .known = is_gltf,
                                         .open = open_file,
                                         .read = read,
                                         .close = close_file,
                                         .take = surface_choice_take,
                                         .fields = surface_choice_fields,
                                         .file = tell_file,
                                         .counts = counts};
