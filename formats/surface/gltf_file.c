#include "formats/surface/gltf_file.h"

#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/json_text.h"
#include "formats/input/binary_fields.h"
#include "formats/input/named_file.h"

enum {
    JSON_MAX = 1 << 28,
    JSON_GROWTH = 48,
    PLACED_MAX = 1 << 20,
    HEAD = 12,
    CHUNK_HEAD = 8,
    DEPTH_MAX = 64,
    BUFFERS_MAX = 4096
};
#define CHUNK_JSON 0x4e4f534aU
#define CHUNK_BIN  0x004e4942U
#define NUMBER_MAX ((int64_t)1 << 48)

typedef struct buffer {
    const char *path;
    uint64_t at, size; /* of its bytes in that file */
} buffer;

typedef struct scan {
    gltf_file *to;
    const mesh_source *source;
    json_t *root;
    size_t reserved;        /* bytes: the most that the root may take, of "[],[],[]" */
    uint64_t bin, bin_size; /* the BIN chunk; 0: there is none */
    bool binary;
    buffer *buffers;
    size_t buffer_count;
    bool *placed;      /* nodes that were gone through */
    size_t primitives; /* of them; nodes may share a mesh */
    size_t nodes;
} scan;

/* Node transforms: rows of x, y, z, and what is added. */
typedef double placement[3][4];

static status __attribute__((format(printf, 3, 4)))
fault(const scan *s, status st, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(st, "%s: %s", byte_stream_name(s->source->data), text);
}

/* ---- JSON ---- */

/* Read a whole number 0 .. most of an object; absent < 0: it must be there. */
static status get_whole(const scan *s, const json_t *of, const char *what, const char *key,
                        int64_t absent, int64_t most, int64_t *out) {
    const json_t *x = json_object_get(of, key);
    *out = absent;
    if (!x && absent >= 0)
        return ST_OK;
    if (!json_is_integer(x) || json_integer_value(x) < 0 || json_integer_value(x) > most)
        return fault(s, ST_CORRUPT, "%s: \"%s\": expected a whole number in 0 .. %lld", what, key,
                     (long long)most);
    *out = json_integer_value(x);
    return ST_OK;
}

/* Find an element of one of the root's arrays by the number that an object has under a key. */
static status get_element(const scan *s, const json_t *of, const char *what, const char *key,
                          const char *array, const json_t **out) {
    const json_t *all = json_object_get(s->root, array);
    const size_t count = json_array_size(all);
    int64_t number = 0;
    status st = get_whole(s, of, what, key, -1, NUMBER_MAX, &number);
    *out = st == ST_OK ? json_array_get(all, (size_t)number) : NULL;
    if (st == ST_OK && !json_is_object(*out))
        return fault(s, ST_CORRUPT, "%s: \"%s\": number %lld of \"%s\", which has %zu", what, key,
                     (long long)number, array, count);
    return st;
}

static status get_numbers(const scan *s, const json_t *of, const char *key, size_t count,
                          double *out) {
    const json_t *x = json_object_get(of, key);
    bool good = json_array_size(x) == count;
    if (!x)
        return ST_OK;
    for (size_t i = 0; good && i < count; i++) {
        good = json_is_number(json_array_get(x, i));
        out[i] = json_number_value(json_array_get(x, i));
    }
    return good ? ST_OK : fault(s, ST_CORRUPT, "a node: \"%s\": expected %zu numbers", key, count);
}

/* ---- arrays ---- */

static const struct {
    int64_t number;
    uint32_t width;
} types[] = {[GLTF_I8] = {5120, 1},  [GLTF_U8] = {5121, 1},  [GLTF_I16] = {5122, 2},
             [GLTF_U16] = {5123, 2}, [GLTF_U32] = {5125, 4}, [GLTF_F32] = {5126, 4}};

uint32_t gltf_file_width(gltf_type type) {
    return types[type].width;
}

static status get_type(const scan *s, const json_t *accessor, gltf_array *out) {
    static const char *const shapes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const char *shape = json_string_value(json_object_get(accessor, "type"));
    int64_t number;
    status st = get_whole(s, accessor, "an accessor", "componentType", -1, 5126, &number);
    if (st != ST_OK)
        return st;
    size_t i = 0, k = 0;
    while (i < sizeof types / sizeof *types && types[i].number != number)
        i++;
    while (shape && k < 4 && strcmp(shape, shapes[k]) != 0)
        k++;
    if (i == sizeof types / sizeof *types || !shape || k == 4)
        return fault(s, ST_CORRUPT,
                     "an accessor: componentType %lld and type \"%.20s\", expected numbers or "
                     "vectors of glTF",
                     (long long)number, shape ? shape : "");
    out->type = (gltf_type)i;
    out->components = (uint32_t)k + 1;
    return ST_OK;
}

/* Find the bytes of a view, and check them against its buffer. */
static status get_view(const scan *s, const json_t *accessor, gltf_array *out, uint64_t *size) {
    const json_t *view = NULL;
    int64_t number = 0, at = 0, length = 0, stride = 0;
    const uint32_t element = types[out->type].width * out->components;
    status st = get_element(s, accessor, "an accessor", "bufferView", "bufferViews", &view);
    if (st == ST_OK)
        st = get_whole(s, view, "a bufferView", "buffer", -1, NUMBER_MAX, &number);
    if (st == ST_OK)
        st = get_whole(s, view, "a bufferView", "byteOffset", 0, NUMBER_MAX, &at);
    if (st == ST_OK)
        st = get_whole(s, view, "a bufferView", "byteLength", -1, NUMBER_MAX, &length);
    if (st == ST_OK)
        st = get_whole(s, view, "a bufferView", "byteStride", element, 252, &stride);
    if (st != ST_OK)
        return st;
    if ((size_t)number >= s->buffer_count || stride < element)
        return fault(s, ST_CORRUPT, "a bufferView of buffer %lld and stride %lld: %s",
                     (long long)number, (long long)stride,
                     stride < element ? "its elements are larger" : "there is no such buffer");
    const buffer *b = &s->buffers[number];
    if ((uint64_t)at + (uint64_t)length > b->size)
        return fault(s, ST_CORRUPT,
                     "a bufferView of bytes %lld to %lld, expected them in a buffer of %llu",
                     (long long)at, (long long)(at + length), (unsigned long long)b->size);
    out->path = b->path;
    out->at = b->at + (uint64_t)at;
    out->stride = (uint32_t)stride;
    *size = (uint64_t)length;
    return ST_OK;
}

/* Find the accessor that an object has under a key. */
static status get_array(const scan *s, const json_t *of, const char *what, const char *key,
                        gltf_array *out) {
    const json_t *accessor = NULL;
    int64_t at = 0, count = 0;
    uint64_t size = 0;
    *out = (gltf_array){0};
    status st = get_element(s, of, what, key, "accessors", &accessor);
    if (st == ST_OK && json_object_get(accessor, "sparse"))
        return fault(s, ST_UNSUPPORTED, "%s: \"%s\" is a sparse accessor, expected all of its data",
                     what, key);
    if (st == ST_OK && !json_object_get(accessor, "bufferView"))
        return fault(s, ST_UNSUPPORTED, "%s: \"%s\" is an accessor without data", what, key);
    if (st == ST_OK)
        st = get_type(s, accessor, out);
    if (st == ST_OK)
        st = get_whole(s, accessor, "an accessor", "count", -1, NUMBER_MAX, &count);
    if (st == ST_OK)
        st = get_whole(s, accessor, "an accessor", "byteOffset", 0, NUMBER_MAX, &at);
    if (st == ST_OK)
        st = get_view(s, accessor, out, &size);
    const uint64_t element = types[out->type].width * (uint64_t)out->components;
    if (st == ST_OK && count > 0 &&
        (size < (uint64_t)at + element ||
         (uint64_t)count - 1 > (size - (uint64_t)at - element) / out->stride))
        return fault(
            s, ST_CORRUPT,
            "%s: \"%s\": %lld elements from byte %lld on, expected them in a bufferView of "
            "%llu bytes",
            what, key, (long long)count, (long long)at, (unsigned long long)size);
    out->count = (uint64_t)count;
    out->at += (uint64_t)at;
    return st;
}

/* ---- buffers ---- */

static int hex_digit(char c) {
    const char *digits = "0123456789abcdef0123456789ABCDEF", *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) % 16 : -1;
}

/* Decode %20 and the like. */
static void decode(char *uri) {
    char *to = uri;
    for (const char *at = uri; *at; to++) {
        const int hi = *at == '%' ? hex_digit(at[1]) : -1, lo = hi >= 0 ? hex_digit(at[2]) : -1;
        *to = lo >= 0 ? (char)(16 * hi + lo) : *at;
        at += lo >= 0 ? 3 : 1;
    }
    *to = 0;
}

static status open_named(scan *s, const char *uri, buffer *b) {
    gltf_file *f = s->to;
    byte_stream *data = NULL;
    char *name = NULL, *path = NULL;
    if (strncmp(uri, "data:", 5) == 0)
        return fault(s, ST_UNSUPPORTED,
                     "a buffer as a data: URI, expected .glb, or a file beside it");
    if (strstr(uri, "://"))
        return fault(s, ST_UNSUPPORTED, "a buffer \"%.80s\", expected a file beside it", uri);
    status st = mem_grow(f->m, &f->paths, sizeof *f->paths, f->path_count, 4, &f->path_room);
    if (st == ST_OK)
        st = (name = mem_copy_text(f->m, uri)) ? ST_OK : ST_NOMEM;
    if (st == ST_OK) {
        decode(name);
        st = named_file_find(f->m, s->source->path, name, s->source->hints.trust.follow_links,
                             &path);
    }
    mem_free(f->m, name);
    if (st != ST_OK)
        return st;
    b->path = f->paths[f->path_count++] = path;
    st = byte_stream_open_stored(f->m, path, &data);
    b->size = st == ST_OK ? byte_stream_left(data) : 0;
    byte_stream_close(data);
    return st;
}

static status read_buffer(scan *s, const json_t *of, size_t number) {
    buffer *b = &s->buffers[number];
    const char *uri = json_string_value(json_object_get(of, "uri"));
    int64_t length;
    status st = get_whole(s, of, "a buffer", "byteLength", -1, NUMBER_MAX, &length);
    if (st != ST_OK)
        return st;
    if (s->binary && uri)
        return fault(s, ST_UNSUPPORTED, "a .glb with a buffer outside of it, \"%.80s\"", uri);
    if (!uri && (!s->binary || number > 0 || s->bin == 0))
        return fault(s, ST_CORRUPT, "buffer %zu: expected %s", number,
                     s->binary ? "a BIN chunk" : "a uri");
    *b = (buffer){s->source->path, s->bin, s->bin_size};
    st = uri ? open_named(s, uri, b) : ST_OK;
    if (st == ST_OK && (uint64_t)length > b->size)
        return fault(s, ST_CORRUPT, "buffer %zu of %lld bytes, but %s has %llu", number,
                     (long long)length, uri ? b->path : "the BIN chunk",
                     (unsigned long long)b->size);
    b->size = (uint64_t)length;
    return st;
}

static status read_buffers(scan *s) {
    const json_t *all = json_object_get(s->root, "buffers");
    const size_t count = json_array_size(all);
    status st = ST_OK;
    if (count > BUFFERS_MAX)
        return fault(s, ST_UNSUPPORTED, "%zu buffers, expected at most %d", count, BUFFERS_MAX);
    s->buffers = mem_array(s->to->m, count + 1, sizeof *s->buffers);
    if (!s->buffers)
        return ST_NOMEM;
    for (s->buffer_count = 0; st == ST_OK && s->buffer_count < count; s->buffer_count++)
        st = read_buffer(s, json_array_get(all, s->buffer_count), s->buffer_count);
    return st;
}

/* ---- primitives ---- */

static bool is_position(const gltf_array *a) {
    return a->type == GLTF_F32 && a->components == 3;
}

static bool is_colour(const gltf_array *a) {
    return a->components >= 3 && (a->type == GLTF_F32 || a->type == GLTF_U8 || a->type == GLTF_U16);
}

static bool is_index(const gltf_array *a) {
    return a->components == 1 && (a->type == GLTF_U8 || a->type == GLTF_U16 || a->type == GLTF_U32);
}

/* Returns the number of points, lines or triangles that so many corners make. */
static uint64_t elements_of(int64_t mode, uint64_t corners) {
    switch (mode) {
    case 0: return corners;
    case 1: return corners / 2;
    case 2: return corners;
    case 3: return corners ? corners - 1 : 0;
    case GLTF_TRIANGLES: return corners / 3;
    default: return corners > 2 ? corners - 2 : 0;
    }
}

static status get_arrays(const scan *s, const json_t *primitive, gltf_part *p) {
    const json_t *has = json_object_get(primitive, "attributes");
    status st = get_array(s, has, "a primitive", "POSITION", &p->positions);
    if (st == ST_OK && !is_position(&p->positions))
        return fault(s, ST_UNSUPPORTED, "positions that are no vectors of three floats");
    if (st == ST_OK && json_object_get(has, "COLOR_0"))
        st = get_array(s, has, "a primitive", "COLOR_0", &p->colours);
    if (st == ST_OK && p->colours.path && !is_colour(&p->colours))
        return fault(s, ST_CORRUPT, "COLOR_0 of a type that is no colour's");
    if (st == ST_OK && p->colours.path && p->colours.count != p->positions.count)
        return fault(s, ST_CORRUPT, "COLOR_0 of %llu vertices, expected %llu",
                     (unsigned long long)p->colours.count, (unsigned long long)p->positions.count);
    if (st == ST_OK && json_object_get(has, "NORMAL"))
        st = get_array(s, has, "a primitive", "NORMAL", &p->normals);
    if (st == ST_OK && p->normals.path && !is_position(&p->normals))
        return fault(s, ST_CORRUPT, "NORMAL that is no vectors of three floats");
    if (st == ST_OK && p->normals.path && p->normals.count != p->positions.count)
        return fault(s, ST_CORRUPT, "NORMAL of %llu vertices, expected %llu",
                     (unsigned long long)p->normals.count, (unsigned long long)p->positions.count);
    if (st == ST_OK && json_object_get(primitive, "indices"))
        st = get_array(s, primitive, "a primitive", "indices", &p->indices);
    if (st == ST_OK && p->indices.path && !is_index(&p->indices))
        return fault(s, ST_CORRUPT, "indices that are no unsigned whole numbers");
    return st;
}

static double determinant(const placement a) {
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
           a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

static status add_primitive(scan *s, const json_t *primitive, const placement to) {
    gltf_file *f = s->to;
    gltf_part p = {.mirrored = determinant(to) < 0};
    int64_t mode;
    if (++s->primitives > PLACED_MAX)
        return fault(s, ST_UNSUPPORTED, "more than %d primitives at nodes", PLACED_MAX);
    status st = get_whole(s, primitive, "a primitive", "mode", GLTF_TRIANGLES, GLTF_FAN, &mode);
    if (st == ST_OK)
        st = get_arrays(s, primitive, &p);
    if (st != ST_OK)
        return st;
    const uint64_t corners = p.indices.path ? p.indices.count : p.positions.count;
    if (mode < GLTF_TRIANGLES) {
        f->skipped += elements_of(mode, corners);
        return ST_OK;
    }
    if (mode == GLTF_TRIANGLES && corners % 3 != 0)
        return fault(s, ST_CORRUPT, "triangles of %llu corners, expected a multiple of 3",
                     (unsigned long long)corners);
    p.mode = (gltf_mode)mode;
    memcpy(p.to, to, sizeof p.to);
    if (p.positions.count > MESH_POINTS_MAX || f->points + p.positions.count > MESH_POINTS_MAX)
        return fault(s, ST_UNSUPPORTED, "more than %llu points",
                     (unsigned long long)MESH_POINTS_MAX);
    f->points += p.positions.count;
    f->faces += elements_of(mode, corners);
    st = mem_grow(f->m, &f->parts, sizeof *f->parts, f->count, 8, &f->room);
    if (st == ST_OK)
        f->parts[f->count++] = p;
    return st;
}

/* ---- nodes ---- */

static void multiply(const placement a, const placement b, placement out) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            out[i][k] =
                a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k] + (k == 3 ? a[i][3] : 0);
}

/* A node's own transform: a matrix by columns, or scaling, then a rotation, then a shift. */
static status get_placement(const scan *s, const json_t *node, placement out) {
    double m[16] = {0}, t[3] = {0}, q[4] = {0, 0, 0, 1}, by[3] = {1, 1, 1};
    status st = get_numbers(s, node, "matrix", 16, m);
    if (st == ST_OK)
        st = get_numbers(s, node, "translation", 3, t);
    if (st == ST_OK)
        st = get_numbers(s, node, "rotation", 4, q);
    if (st == ST_OK)
        st = get_numbers(s, node, "scale", 3, by);
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double turn[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                               {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                               {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    const bool matrix = json_object_get(node, "matrix");
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            out[i][k] = matrix ? m[4 * k + i] : k < 3 ? turn[i][k] * by[k] : t[i];
    return st;
}

static status add_mesh(scan *s, const json_t *node, const placement to) {
    const json_t *mesh = NULL;
    status st = get_element(s, node, "a node", "mesh", "meshes", &mesh);
    const json_t *all = st == ST_OK ? json_object_get(mesh, "primitives") : NULL;
    for (size_t i = 0; st == ST_OK && i < json_array_size(all); i++)
        st = add_primitive(s, json_array_get(all, i), to);
    return st;
}

/* Nodes make trees: one that is reached twice is an error, so this ends. */
static status add_node(scan *s, const json_t *number, const placement parent, int depth) {
    const int64_t at = json_is_integer(number) ? json_integer_value(number) : -1;
    placement own, to;
    if (at < 0 || (uint64_t)at >= s->nodes || s->placed[at])
        return fault(s, ST_CORRUPT, "node %lld: expected one of %zu nodes, each at most once",
                     (long long)at, s->nodes);
    if (depth == DEPTH_MAX)
        return fault(s, ST_UNSUPPORTED, "more than %d nodes in each other", DEPTH_MAX);
    s->placed[at] = true;
    const json_t *node = json_array_get(json_object_get(s->root, "nodes"), (size_t)at);
    status st = get_placement(s, node, own);
    multiply(parent, own, to);
    if (st == ST_OK && json_object_get(node, "mesh"))
        st = add_mesh(s, node, to);
    const json_t *children = json_object_get(node, "children");
    for (size_t i = 0; st == ST_OK && i < json_array_size(children); i++)
        st = add_node(s, json_array_get(children, i), to, depth + 1);
    return st;
}

/* Make a list of the nodes that are no one's children. */
static json_t *find_roots(const scan *s) {
    const json_t *all = json_object_get(s->root, "nodes");
    json_t *roots = json_array();
    for (size_t i = 0; i < s->nodes; i++) {
        const json_t *children = json_object_get(json_array_get(all, i), "children");
        for (size_t k = 0; k < json_array_size(children); k++) {
            const json_int_t child = json_integer_value(json_array_get(children, k));
            if (child >= 0 && (size_t)child < s->nodes)
                s->placed[child] = true;
        }
    }
    for (size_t i = 0; i < s->nodes; i++)
        if (!s->placed[i])
            json_array_append_new(roots, json_integer((json_int_t)i));
    memset(s->placed, 0, s->nodes * sizeof *s->placed);
    return roots;
}

static status add_scene(scan *s) {
    static const placement still = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    const json_t *scenes = json_object_get(s->root, "scenes"), *scene = NULL;
    int64_t number = 0;
    s->nodes = json_array_size(json_object_get(s->root, "nodes"));
    s->placed = mem_array(s->to->m, s->nodes + 1, sizeof *s->placed);
    if (!s->placed)
        return ST_NOMEM;
    status st = get_whole(s, s->root, "the file", "scene", 0, NUMBER_MAX, &number);
    scene = json_array_get(scenes, (size_t)number);
    if (st == ST_OK && json_array_size(scenes) > 0 && !scene)
        st = fault(s, ST_CORRUPT, "scene %lld of %zu", (long long)number, json_array_size(scenes));
    json_t *made = scene ? NULL : find_roots(s);
    const json_t *roots = scene ? json_object_get(scene, "nodes") : made;
    for (size_t i = 0; st == ST_OK && i < json_array_size(roots); i++)
        st = add_node(s, json_array_get(roots, i), still, 0);
    json_decref(made);
    return st;
}

/* ---- the file ---- */

/* What only looks otherwise does not matter here. */
static status check_extensions(const scan *s) {
    static const char *const harmless[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                           "KHR_lights_"};
    const json_t *all = json_object_get(s->root, "extensionsRequired");
    for (size_t i = 0; i < json_array_size(all); i++) {
        const char *name = json_string_value(json_array_get(all, i));
        bool fine = false;
        for (size_t k = 0; name && k < sizeof harmless / sizeof *harmless; k++)
            fine = fine || strncmp(name, harmless[k], strlen(harmless[k])) == 0;
        if (!fine)
            return fault(s, ST_UNSUPPORTED, "it requires %.80s, expected plain glTF",
                         name ? name : "an extension without a name");
    }
    return ST_OK;
}

static status check_version(const scan *s) {
    const json_t *asset = json_object_get(s->root, "asset");
    const char *version = json_string_value(json_object_get(asset, "version"));
    if (!version)
        return fault(s, ST_CORRUPT, "expected an \"asset\" with a \"version\"");
    return version[0] == '2' && version[1] == '.'
               ? ST_OK
               : fault(s, ST_UNSUPPORTED, "glTF %.20s, expected 2.0", version);
}

static status parse(scan *s, uint64_t size) {
    byte_stream *data = s->source->data;
    json_error_t error;
    size_t got = 0;
    if (size > JSON_MAX)
        return fault(s, ST_UNSUPPORTED, "JSON of %llu bytes, expected at most %d",
                     (unsigned long long)size, JSON_MAX);
    const size_t room = JSON_GROWTH * (size_t)size;
    if (!mem_reserve(s->to->m, room))
        return ST_NOMEM;
    s->reserved = room;
    char *text = mem_alloc(s->to->m, (size_t)size + 1);
    if (!text)
        return ST_NOMEM;
    status st = byte_stream_read(data, text, (size_t)size, &got);
    if (st == ST_OK && got < size)
        st = fault(s, ST_CORRUPT, "ends at byte %llu, inside its JSON",
                   (unsigned long long)byte_stream_position(data));
    if (st == ST_OK && !(s->root = json_loadb(text, got, 0, &error))) {
        st = json_text_status(&error, ST_CORRUPT);
        st = fault(s, st, "JSON: line %d: %s", error.line, error.text);
    }
    mem_free(s->to->m, text);
    if (st == ST_OK && !json_is_object(s->root))
        return fault(s, ST_CORRUPT, "JSON: expected an object");
    return st;
}

/* Read the heads of a .glb: its own, that of JSON, and that of the bytes behind. */
static status read_binary(scan *s) {
    byte_stream *data = s->source->data;
    uint8_t head[HEAD + CHUNK_HEAD];
    size_t got;
    status st = byte_stream_read(data, head, sizeof head, &got);
    if (st != ST_OK)
        return st;
    const uint64_t size = got == sizeof head ? binary_unsigned(head + HEAD, 4, false) : 0;
    if (got < sizeof head || binary_unsigned(head + HEAD + 4, 4, false) != CHUNK_JSON)
        return fault(s, ST_CORRUPT, "byte %d: expected a chunk of JSON", HEAD);
    if (binary_unsigned(head + 4, 4, false) != 2)
        return fault(s, ST_UNSUPPORTED, "binary glTF of version %llu, expected 2",
                     (unsigned long long)binary_unsigned(head + 4, 4, false));
    if (size > byte_stream_left(data))
        return fault(s, ST_CORRUPT, "JSON of %llu bytes, but only %llu follow",
                     (unsigned long long)size, (unsigned long long)byte_stream_left(data));
    st = parse(s, size);
    if (st == ST_OK)
        st = byte_stream_read(data, head, CHUNK_HEAD, &got);
    if (st != ST_OK || got < CHUNK_HEAD || binary_unsigned(head + 4, 4, false) != CHUNK_BIN)
        return st;
    s->bin = byte_stream_position(data);
    s->bin_size = binary_unsigned(head, 4, false);
    if (s->bin_size > byte_stream_left(data) && byte_stream_left(data) != UINT64_MAX)
        return fault(s, ST_CORRUPT, "a BIN chunk of %llu bytes, but only %llu follow",
                     (unsigned long long)s->bin_size, (unsigned long long)byte_stream_left(data));
    return ST_OK;
}

bool gltf_file_is_binary(const uint8_t *start, size_t size) {
    return size >= 4 && memcmp(start, "glTF", 4) == 0;
}

status gltf_file_read(const mesh_source *source, gltf_file *out) {
    scan s = {.to = out, .source = source};
    const uint8_t *start;
    size_t size;
    *out = (gltf_file){.m = source->m};
    status st = byte_stream_peek(source->data, 4, &start, &size);
    if (st != ST_OK)
        return st;
    s.binary = gltf_file_is_binary(start, size);
    st = s.binary ? read_binary(&s) : parse(&s, byte_stream_left(source->data));
    if (st == ST_OK)
        st = check_version(&s);
    if (st == ST_OK)
        st = check_extensions(&s);
    if (st == ST_OK)
        st = read_buffers(&s);
    if (st == ST_OK)
        st = add_scene(&s);
    json_decref(s.root);
    mem_unreserve(out->m, s.reserved);
    mem_free(out->m, s.buffers);
    mem_free(out->m, s.placed);
    return st;
}

void gltf_file_release(gltf_file *f) {
    for (size_t i = 0; i < f->path_count; i++)
        mem_free(f->m, f->paths[i]);
    mem_free(f->m, f->paths);
    mem_free(f->m, f->parts);
}
