#include "formats/grid/zarr_array.h"

#include <dirent.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/base/file.h"
#include "formats/base/json_text.h"
#include "formats/base/text.h"
#include "formats/grid/ngff_units.h"
#include "formats/grid/npy.h"

enum { JSON_MAX = 1 << 22, DEPTH_MAX = 4, LIST_MAX = 300, FILE_NAME = 320 };

/* ---- JSON ---- */

static bool is_there(const char *folder, const char *name) {
    char path[ZARR_PATH + FILE_NAME];
    struct stat info;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

/* Describe what is wrong with a value in the array's or group's JSON. */
static status bad(const zarr_array *z, const char *name, status st, const char *key,
                  const char *expected) {
    return status_describe(st, "%s/%s: \"%s\": expected %s", z->path, name, key, expected);
}

static status load(mem *m, const char *folder, const char *name, json_t **out) {
    char path[ZARR_PATH + FILE_NAME];
    file *f = NULL;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    status st = file_open(m, path, &f);
    if (st != ST_OK)
        return st;
    const uint64_t size = file_size(f);
    char *text = size <= JSON_MAX ? mem_alloc(m, size) : NULL;
    if (size > JSON_MAX)
        st = status_describe(ST_CORRUPT, "%s: more than %d bytes of JSON", path, JSON_MAX);
    else
        st = text ? file_read_at(f, 0, text, size) : ST_NOMEM;
    if (st == ST_OK) {
        json_error_t error;
        *out = json_loadb(text, size, 0, &error);
        if (!json_is_object(*out)) {
            st = *out ? ST_CORRUPT : json_text_status(&error, ST_CORRUPT);
            status_describe(st, "%s: expected a JSON object: line %d: %s", path,
                            *out ? 1 : error.line, *out ? "another value" : error.text);
            json_decref(*out);
            *out = NULL;
        }
    }
    mem_free(m, text);
    file_close(f);
    return st;
}

/* ---- which array ---- */

static status append(zarr_array *z, const char *name) {
    const size_t length = strlen(z->path);
    if (length + strlen(name) + 2 > sizeof z->path)
        return status_describe(ST_UNSUPPORTED, "%s: a path of more than %d bytes", z->path,
                               ZARR_PATH - 1);
    snprintf(z->path + length, sizeof z->path - length, "/%s", name);
    return ST_OK;
}

static bool is_node(const char *folder) {
    return is_there(folder, ".zarray") || is_there(folder, ".zgroup");
}

static int is_shown(const struct dirent *entry) {
    return entry->d_name[0] != '.';
}

/* Append the name of the only array or group in the group z->path to that path. With none or
 * several, fail; the message lists them. */
static status descend(zarr_array *z) {
    struct dirent **entries = NULL;
    char list[LIST_MAX] = "", only[256] = "";
    int nodes = 0;
    const int count = scandir(z->path, &entries, is_shown, alphasort);
    for (int i = 0; i < count; i++) {
        char path[ZARR_PATH + 260];
        snprintf(path, sizeof path, "%s/%s", z->path, entries[i]->d_name);
        if (is_node(path)) {
            const size_t length = strlen(list);
            nodes++;
            snprintf(only, sizeof only, "%s", entries[i]->d_name);
            snprintf(list + length, sizeof list - length, "%s%s", length ? ", " : "", only);
        }
        free(entries[i]);
    }
    free(entries);
    if (nodes == 1)
        return append(z, only);
    return status_describe(ST_UNSUPPORTED,
                           "%s: a Zarr group of %d arrays or groups%s%s: --field "
                           "NAME takes one",
                           z->path, nodes, nodes ? ": " : "", list);
}

/* ---- OME ---- */

static const json_t *multiscale(const json_t *attributes) {
    const json_t *ome = json_object_get(attributes, "ome");
    return json_array_get(json_object_get(ome ? ome : attributes, "multiscales"), 0);
}

/* Find the data set of a path; without a path the first one, of full resolution. */
static const json_t *find_dataset(const json_t *image, const char *path) {
    const json_t *sets = json_object_get(image, "datasets");
    for (size_t i = 0; path && i < json_array_size(sets); i++) {
        const json_t *set = json_array_get(sets, i);
        const char *own = json_string_value(json_object_get(set, "path"));
        if (own && strcmp(own, path) == 0)
            return set;
    }
    return path ? NULL : json_array_get(sets, 0);
}

/* Returns the number of an axis in a list; `otherwise` where there is no list. */
static double number_of(const json_t *list, int axis, double otherwise) {
    return json_is_array(list) ? json_number_value(json_array_get(list, (size_t)axis)) : otherwise;
}

static void apply_transformations(zarr_array *z, const json_t *list) {
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *scale = json_object_get(json_array_get(list, i), "scale");
        const json_t *translation = json_object_get(json_array_get(list, i), "translation");
        for (int a = 0; a < ZARR_AXES; a++) {
            const double factor = number_of(scale, a, 1);
            z->scale[a] *= factor;
            z->translation[a] = factor * z->translation[a] + number_of(translation, a, 0);
        }
    }
}

/* Returns an axis' place in "xyzct"; -1: none. An axis is a name, or an object with one. */
static int role_of(const json_t *axis) {
    const char *name = json_string_value(axis);
    if (!name)
        name = json_string_value(json_object_get(axis, "name"));
    const char *at = name && name[0] && !name[1] ? strchr("xyzct", name[0] | 0x20) : NULL;
    return at ? (int)(at - "xyzct") : -1;
}

/* Set the axes' roles, by name, and units. The array's shape is not known yet. */
static void name_axes(zarr_array *z, const json_t *axes) {
    z->chunks.axes = (int)json_array_size(axes);
    for (int i = 0; i < z->chunks.axes && i < ZARR_AXES; i++) {
        static const int roles[] = {ORDER_X, ORDER_Y, ORDER_Z, ORDER_COMPONENT, ORDER_STEP};
        const json_t *axis = json_array_get(axes, (size_t)i);
        const char *unit = json_string_value(json_object_get(axis, "unit"));
        const int role = role_of(axis);
        z->chunks.role[i] = role < 0 ? -1 : roles[role];
        text_name(z->unit[i], sizeof z->unit[i], unit ? ngff_units_symbol(unit) : "");
    }
}

static status take_image(zarr_array *z, const json_t *image, const char *field, bool *taken) {
    const json_t *set = find_dataset(image, field);
    const char *path = json_string_value(json_object_get(set, "path"));
    const char *name = json_string_value(json_object_get(image, "name"));
    *taken = path != NULL;
    if (!path)
        return field ? ST_OK
                     : bad(z, ".zattrs", ST_CORRUPT, "multiscales", "data sets with a path");
    if (strstr(path, "..") || *path == '/')
        return bad(z, ".zattrs", ST_UNSUPPORTED, "path", "a folder inside this one");
    name_axes(z, json_object_get(image, "axes"));
    apply_transformations(z, json_object_get(set, "coordinateTransformations"));
    apply_transformations(z, json_object_get(image, "coordinateTransformations"));
    snprintf(z->name, sizeof z->name, "%s", name ? name : "");
    return append(z, path);
}

/* Go one step from a group towards its array. */
static status enter(mem *m, zarr_array *z, const char **field) {
    json_t *attributes = NULL;
    bool taken = false;
    status st = is_there(z->path, ".zattrs") ? load(m, z->path, ".zattrs", &attributes) : ST_OK;
    const json_t *image = attributes ? multiscale(attributes) : NULL;
    if (st == ST_OK && image)
        st = take_image(z, image, *field, &taken);
    json_decref(attributes);
    if (taken)
        *field = NULL;
    if (st != ST_OK || taken)
        return st;
    if (!*field)
        return descend(z);
    if (strstr(*field, "..") || **field == '/')
        return status_describe(ST_USAGE, "%s: no array \"%s\"", z->path, *field);
    st = append(z, *field);
    if (st == ST_OK && !is_node(z->path))
        st = status_describe(ST_USAGE, "%s: there is no such array", z->path);
    *field = NULL;
    return st;
}

static status find_array(mem *m, zarr_array *z, const char *field) {
    status st = ST_OK;
    for (int depth = 0; st == ST_OK && !is_there(z->path, ".zarray"); depth++) {
        if (is_there(z->path, "zarr.json"))
            return status_describe(ST_UNSUPPORTED,
                                   "%s: Zarr of version 3; version 2 is read: save it so, with "
                                   "Python: zarr.save_array(.., zarr_format=2)",
                                   z->path);
        if (depth == DEPTH_MAX)
            return status_describe(ST_UNSUPPORTED, "%s: groups in groups, and no array", z->path);
        st = enter(m, z, &field);
    }
    if (st == ST_OK && field)
        st = status_describe(ST_USAGE, "%s: one array, without a field \"%s\"", z->path, field);
    return st;
}

/* ---- the array ---- */

static status read_numbers(zarr_array *z, const json_t *root, const char *key, uint32_t *out,
                           int *count) {
    const json_t *list = json_object_get(root, key);
    *count = (int)json_array_size(list);
    if (!json_is_array(list) || *count < 1 || *count > ZARR_AXES)
        return bad(z, ".zarray", ST_UNSUPPORTED, key, "sizes of 1 to 8 axes");
    for (int i = 0; i < *count; i++) {
        const json_int_t n = json_integer_value(json_array_get(list, (size_t)i));
        if (n < 1 || n > INT32_MAX)
            return bad(z, ".zarray", ST_CORRUPT, key, "whole numbers from 1 on");
        out[i] = (uint32_t)n;
    }
    return ST_OK;
}

static status read_shape(zarr_array *z, const json_t *root) {
    const int named = z->chunks.axes;
    int chunks = 0;
    status st = read_numbers(z, root, "shape", z->shape, &z->chunks.axes);
    if (st == ST_OK)
        st = read_numbers(z, root, "chunks", z->chunks.chunk, &chunks);
    if (st == ST_OK && chunks != z->chunks.axes)
        st = bad(z, ".zarray", ST_CORRUPT, "chunks", "as many sizes as \"shape\" has");
    if (st == ST_OK && named && named != z->chunks.axes)
        st = bad(z, ".zarray", ST_CORRUPT, "shape", "a size for each of the image's axes");
    return st;
}

/* Guess the roles of axes that nobody names. */
static void guess_roles(zarr_array *z) {
    static const int roles[] = {ORDER_STEP, ORDER_COMPONENT, ORDER_Z, ORDER_Y, ORDER_X};
    static const int numbers[] = {ORDER_Z, ORDER_Y, ORDER_X, ORDER_COMPONENT};
    int first = 0;
    while (z->chunks.axes - first > 3 && z->shape[first] == 1)
        z->chunks.role[first++] = -1;
    const int left = z->chunks.axes - first;
    for (int i = 0; i < left; i++)
        z->chunks.role[first + i] = left > 5 ? -1 : roles[5 - left + i];
    if (left == 4 && z->shape[z->chunks.axes - 1] <= NPY_NUMBERS)
        memcpy(z->chunks.role + first, numbers, sizeof numbers);
    else if (left == 4)
        z->chunks.role[first] = ORDER_STEP;
}

static status find_axes(zarr_array *z, bool named) {
    if (!named)
        guess_roles(z);
    for (int r = 0; r < ORDER_AXES; r++)
        z->axis[r] = -1;
    for (int i = 0; i < z->chunks.axes; i++) {
        const int r = z->chunks.role[i];
        if (r >= 0 ? z->axis[r] >= 0 : z->shape[i] > 1)
            return bad(z, ".zarray", ST_UNSUPPORTED, "shape",
                       "(z, y, x), (z, y, x, numbers), (t, z, y, x), (t, c, z, y, x), or axes that "
                       "OME-Zarr names");
        if (r >= 0)
            z->axis[r] = i;
    }
    const int c = z->axis[ORDER_COMPONENT];
    z->stored.components = c < 0 ? 1 : z->shape[c];
    /* Channels are no vector, whether OME names them or they stand before the axes of space. */
    if (named || (c >= 0 && c + 1 < z->chunks.axes))
        z->stored.component = 1;
    return ST_OK;
}

static status read_filters(zarr_array *z, const json_t *list) {
    char json[ZARR_PATH + FILE_NAME];
    const zarr_number array = {z->stored.type, z->chunks.big_endian};
    snprintf(json, sizeof json, "%s/.zarray", z->path);
    return zarr_filters_read(list, array, json, &z->chunks.filters);
}

static status read_storage(zarr_array *z, const json_t *root) {
    const char *type = json_string_value(json_object_get(root, "dtype"));
    const char *order = json_string_value(json_object_get(root, "order"));
    const char *separator = json_string_value(json_object_get(root, "dimension_separator"));
    const json_t *compressor = json_object_get(root, "compressor");
    const char *id = json_string_value(json_object_get(compressor, "id"));
    if (!type || !npy_type(type, &z->stored, &z->chunks.big_endian) || z->stored.components > 1)
        return bad(z, ".zarray", ST_UNSUPPORTED, "dtype",
                   "bool, an 8 to 64 bit integer, half, float or double");
    z->chunks.type = z->stored.type;
    status st = read_filters(z, json_object_get(root, "filters"));
    if (st != ST_OK)
        return st;
    if (json_object_get(root, "order") &&
        (!order || (strcmp(order, "C") != 0 && strcmp(order, "F") != 0)))
        return bad(z, ".zarray", ST_UNSUPPORTED, "order", "\"C\" or \"F\"");
    z->chunks.fortran = order && strcmp(order, "F") == 0;
    z->chunks.separator = separator ? *separator : '.';
    if (separator && strcmp(separator, ".") != 0 && strcmp(separator, "/") != 0)
        return bad(z, ".zarray", ST_UNSUPPORTED, "dimension_separator", "\".\" or \"/\"");
    z->chunks.codec = json_is_object(compressor) ? zarr_codec_find(id ? id : "") : ZARR_RAW;
    if (z->chunks.codec)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s/.zarray: \"compressor\": \"%s\"; supported are blosc, zlib, gzip, "
                           "zstd, lz4, bz2 and lzma",
                           z->path, id ? id : "");
}

/* ---- the fill value ---- */

static bool find_half(double value, uint16_t *out) {
    for (unsigned h = 0; h < 65536; h++) {
        double is;
        *out = (uint16_t)h;
        sample_to_doubles(SAMPLE_F16, out, &is, 1);
        if (is == value || (isnan(is) && isnan(value)))
            return true;
    }
    return false;
}

#define STORE(type)                           \
    {                                         \
        const type v = (type)value;           \
        memcpy(z->chunks.fill, &v, sizeof v); \
        return true;                          \
    }

static bool store_fill(zarr_array *z, double value) {
    uint16_t half;
    if (z->stored.type != SAMPLE_F16 && !sample_holds(z->stored.type, value) &&
        z->stored.type != SAMPLE_F32)
        return false;
    switch (z->stored.type) {
    case SAMPLE_U8: STORE(uint8_t)
    case SAMPLE_I8: STORE(int8_t)
    case SAMPLE_U16: STORE(uint16_t)
    case SAMPLE_I16: STORE(int16_t)
    case SAMPLE_U32: STORE(uint32_t)
    case SAMPLE_I32: STORE(int32_t)
    case SAMPLE_F32: STORE(float)
    case SAMPLE_F64: STORE(double)
    case SAMPLE_U64: STORE(uint64_t)
    case SAMPLE_I64: STORE(int64_t)
    case SAMPLE_F16: break;
    }
    if (!find_half(value, &half))
        return false;
    memcpy(z->chunks.fill, &half, sizeof half);
    return true;
}

static status read_fill(zarr_array *z, const json_t *root) {
    const json_t *fill = json_object_get(root, "fill_value");
    const char *word = json_string_value(fill);
    double value = json_is_true(fill) ? 1 : json_number_value(fill);
    if (word)
        value = strcmp(word, "NaN") == 0         ? (double)NAN
                : strcmp(word, "Infinity") == 0  ? (double)INFINITY
                : strcmp(word, "-Infinity") == 0 ? -(double)INFINITY
                                                 : (double)NAN;
    const bool known = !word || strcmp(word, "NaN") == 0 || isinf(value);
    if (json_is_integer(fill) && (z->stored.type == SAMPLE_I64 || z->stored.type == SAMPLE_U64)) {
        const int64_t whole = json_integer_value(fill);
        memcpy(z->chunks.fill, &whole, sizeof whole);
        return ST_OK;
    }
    if (known && !json_is_array(fill) && !json_is_object(fill) && store_fill(z, value))
        return ST_OK;
    return bad(z, ".zarray", ST_UNSUPPORTED, "fill_value", "a number of the array's type");
}

status zarr_array_read(mem *m, const char *folder, const volume_hints *hints, zarr_array *out) {
    json_t *root = NULL;
    *out = (zarr_array){.shape = {0}};
    for (int a = 0; a < ZARR_AXES; a++)
        out->scale[a] = 1;
    snprintf(out->path, sizeof out->path, "%s", folder);
    status st = strlen(folder) < sizeof out->path
                    ? find_array(m, out, hints->field)
                    : status_describe(ST_UNSUPPORTED, "%s: too long a path", folder);
    const bool named = out->chunks.axes > 0;
    if (st == ST_OK)
        st = load(m, out->path, ".zarray", &root);
    if (st == ST_OK && json_integer_value(json_object_get(root, "zarr_format")) != 2)
        st = bad(out, ".zarray", ST_UNSUPPORTED, "zarr_format", "2");
    if (st == ST_OK)
        st = read_shape(out, root);
    if (st == ST_OK)
        st = read_storage(out, root);
    if (st == ST_OK)
        st = find_axes(out, named);
    if (st == ST_OK)
        st = read_fill(out, root);
    json_decref(root);
    return st;
}
