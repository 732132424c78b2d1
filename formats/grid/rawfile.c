#include "formats/grid/rawfile.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "formats/base/json_text.h"
#include "formats/base/text.h"
#include "formats/grid/volume.h"
#include "formats/input/foreign.h"

enum { PATH_ROOM = 4096, JSON_MAX = 1 << 20 };

/* What is known about the samples so far. */
typedef struct facts {
    uint32_t dims[3]; /* 0: not known */
    sample_type type; /* 0: not known */
    bool big_endian;
    uint64_t skip;
    double spacing[3], origin[3];
    char name[GRID_NAME_MAX];
    char file[1024]; /* the samples, as a JSON names them */
} facts;

static const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* ---- file names ---- */

/* Read "_WxHxD_type" at `at`. The type ends at the name's extension. */
static bool parse_tail(const char *at, facts *known) {
    unsigned d[3];
    int length = 0;
    char name[32];
    sample_type type;
    if (sscanf(at, "_%9ux%9ux%9u_%n", &d[0], &d[1], &d[2], &length) != 3 || length == 0)
        return false;
    size_t letters = strcspn(at + length, ".");
    if (letters >= sizeof name)
        return false;
    memcpy(name, at + length, letters);
    name[letters] = 0;
    if (!sample_parse(name, &type))
        return false;
    for (int a = 0; a < 3; a++)
        known->dims[a] = d[a];
    known->type = type;
    return true;
}

/* Take the facts that a file name tells. Returns the length of the part in front of
 * "_WxHxD_type.raw", or of the extension. */
static size_t parse_name(const char *name, facts *known) {
    for (const char *at = strchr(name, '_'); at; at = strchr(at + 1, '_'))
        if (parse_tail(at, known))
            return (size_t)(at - name);
    const char *dot = strrchr(name, '.');
    return dot ? (size_t)(dot - name) : strlen(name);
}

/* ---- JSON ---- */

static status bad_json(const char *path, const char *key, const char *expected) {
    return status_describe(ST_CORRUPT, "%s: \"%s\": expected %s", path, key, expected);
}

/* Read three numbers. An absent key leaves *out as it is. */
static status get_triple(const char *path, const json_t *root, const char *key, double out[3]) {
    const json_t *list = json_object_get(root, key);
    if (!list)
        return ST_OK;
    if (!json_is_array(list) || json_array_size(list) != 3)
        return bad_json(path, key, "three numbers");
    for (size_t i = 0; i < 3; i++) {
        const json_t *number = json_array_get(list, i);
        if (!json_is_number(number))
            return bad_json(path, key, "three numbers");
        out[i] = json_number_value(number);
    }
    return ST_OK;
}

static status get_sizes(const char *path, const json_t *root, facts *known) {
    double size[3] = {known->dims[0], known->dims[1], known->dims[2]};
    status st = get_triple(path, root, "size", size);
    for (int a = 0; st == ST_OK && a < 3; a++) {
        if (!(size[a] >= 0 && size[a] <= UINT32_MAX && size[a] == floor(size[a])))
            return bad_json(path, "size", "three whole numbers from 1 on");
        known->dims[a] = (uint32_t)size[a];
    }
    return st;
}

static status get_words(const char *path, const json_t *root, facts *known) {
    const char *type = json_string_value(json_object_get(root, "type"));
    if (type && !sample_parse(type, &known->type))
        return status_describe(ST_UNSUPPORTED, "%s: \"type\": \"%s\" is not supported", path, type);
    const char *endian = json_string_value(json_object_get(root, "endian"));
    if (endian && strcmp(endian, "big") != 0 && strcmp(endian, "little") != 0)
        return bad_json(path, "endian", "little or big");
    known->big_endian = endian && strcmp(endian, "big") == 0;
    const char *file = json_string_value(json_object_get(root, "file"));
    const char *url = json_string_value(json_object_get(root, "url"));
    const char *name = json_string_value(json_object_get(root, "name"));
    if (name)
        snprintf(known->name, sizeof known->name, "%s", name);
    if (file || url)
        snprintf(known->file, sizeof known->file, "%s", file ? file : base_name(url));
    return ST_OK;
}

static status read_facts(const char *path, const json_t *root, facts *known) {
    if (!json_is_object(root))
        return status_describe(ST_CORRUPT, "%s: expected a JSON object", path);
    status st = get_sizes(path, root, known);
    if (st == ST_OK)
        st = get_triple(path, root, "spacing", known->spacing);
    if (st == ST_OK)
        st = get_triple(path, root, "origin", known->origin);
    if (st == ST_OK)
        st = get_words(path, root, known);
    return st;
}

/* Read the JSON in a stream. */
static status parse_json(mem *m, byte_stream *s, facts *known) {
    const char *name = byte_stream_name(s);
    char *text = mem_alloc(m, JSON_MAX);
    if (!text)
        return ST_NOMEM;
    size_t size = 0;
    status st = byte_stream_read(s, text, JSON_MAX, &size);
    if (st == ST_OK && size == JSON_MAX)
        st = status_describe(ST_CORRUPT, "%s: more than %d bytes of JSON", name, JSON_MAX);
    if (st == ST_OK) {
        json_error_t error;
        json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
        if (root)
            st = read_facts(name, root, known);
        else
            st = status_describe(json_text_status(&error, ST_CORRUPT), "%s: line %d: %s", name,
                                 error.line, error.text);
        json_decref(root);
    }
    mem_free(m, text);
    return st;
}

/* Read the JSON beside the samples, if there is one: NAME.json, or the front part of NAME with
 * .json. */
static status read_json_beside(mem *m, const char *path, size_t front, facts *known) {
    const char *name = base_name(path);
    const char *dot = strrchr(name, '.');
    const size_t lengths[2] = {front, dot ? (size_t)(dot - name) : strlen(name)};
    for (int i = 0; i < 2; i++) {
        char json[PATH_ROOM];
        int length = snprintf(json, sizeof json, "%.*s.json",
                              (int)((size_t)(name - path) + lengths[i]), path);
        struct stat info;
        if (length >= PATH_ROOM || stat(json, &info) != 0 || !S_ISREG(info.st_mode))
            continue;
        byte_stream *s;
        status st = byte_stream_open(m, json, &s);
        if (st != ST_OK)
            return st;
        st = parse_json(m, s, known);
        byte_stream_close(s);
        return st;
    }
    return ST_OK;
}

/* Read the JSON `path`, and open its samples: the file that it names, else the file of its own
 * name. */
static status open_json(volume_layout *l, const char *path, bool follow_links, facts *known) {
    status st = parse_json(l->m, l->data, known);
    if (st != ST_OK)
        return st;
    const bool implied = !known->file[0];
    if (implied) {
        const char *name = base_name(path);
        snprintf(known->file, sizeof known->file, "%.*s.raw", (int)(strlen(name) - strlen(".json")),
                 name);
    }
    return volume_layout_open(l, path, known->file, implied || follow_links,
                              byte_stream_open_stored);
}

/* ---- all together ---- */

static void apply_hints(facts *known, const volume_hints *hints) {
    for (int a = 0; a < 3; a++)
        if (hints->dims[a])
            known->dims[a] = hints->dims[a];
    if (hints->type)
        known->type = hints->type;
    known->big_endian |= hints->big_endian;
    known->skip = hints->skip;
}

static status gather(volume_layout *l, const char *path, bool follow_links, facts *known) {
    if (strcmp(path, "-") == 0)
        return ST_OK;
    if (text_ends_in(path, ".json"))
        return open_json(l, path, follow_links, known);
    size_t front = parse_name(base_name(path), known);
    return read_json_beside(l->m, path, front, known);
}

/* Find how the samples lie in the file. If there are too few bytes, and the first ones tell a
 * packed format, they are packed: bonsai_256x256x256_uint8.raw.gz is unpacked on the way, .zst is
 * refused by name. */
static status find_encoding(volume_layout *l, const facts *known) {
    const double want =
        (double)known->dims[0] * known->dims[1] * known->dims[2] * (double)sample_size(known->type);
    const uint8_t *start;
    size_t size;
    l->encoding = VOLUME_RAW;
    if ((double)byte_stream_left(l->data) >= want)
        return ST_OK;
    status st = byte_stream_peek(l->data, FOREIGN_PEEK, &start, &size);
    if (st != ST_OK)
        return st;
    if (size > 2 && memcmp(start, "\x1f\x8b\x08", 3) == 0)
        l->encoding = VOLUME_DEFLATE;
    else if (foreign_find("-", start, size, UINT64_MAX))
        return foreign_refuse(l->data, "");
    return ST_OK;
}

static status open_layout(volume_layout *l, const volume_hints *hints) {
    const char *path = l->path;
    facts known = {.spacing = {1, 1, 1}};
    grid_init(&l->g, known.dims, SAMPLE_U8);
    status st = gather(l, path, hints->trust.follow_links, &known);
    if (st != ST_OK)
        return st;
    apply_hints(&known, hints);
    const bool unknown = !known.type || !known.dims[0] || !known.dims[1] || !known.dims[2];
    if (unknown && text_ends_in(path, ".json"))
        return status_describe(ST_UNSUPPORTED,
                               "%s: expected \"size\" and \"type\" of the samples (or --dims and "
                               "--type)",
                               path);
    if (unknown)
        return foreign_refuse(l->data, "raw samples need --dims and --type, a JSON beside the "
                                       "file, or a name like x_64x64x64_uint8.raw");
    st = find_encoding(l, &known);
    if (st != ST_OK)
        return st;
    grid_init(&l->g, known.dims, SAMPLE_U8);
    l->stored.type = known.type;
    double direction[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    volume_layout_place(l, direction, known.spacing, known.origin);
    memcpy(l->g.name, known.name, sizeof l->g.name);
    l->big_endian = known.big_endian;
    if (known.skip > INT64_MAX)
        return status_describe(ST_USAGE, "%s: cannot skip %llu bytes", path,
                               (unsigned long long)known.skip);
    return volume_layout_skip(l, 0, (int64_t)known.skip);
}

static bool known(const char *path, const uint8_t *start, size_t size) {
    (void)path, (void)start, (void)size;
    return true;
}

const grid_reader raw_reader = {
    .format = VOLUME_RAW_SAMPLES, .known = known, .layout = open_layout};
