#include "formats/grid/metaimage.h"
#include "formats/grid/volume_files.h"

#include <string.h>
#include <strings.h>

#include "formats/base/text.h"
#include "formats/input/header_fields.h"

typedef struct metaimage {
    header_fields fields;
    volume_layout *l;
    int axes;
    bool follow_links;
} metaimage;

static bool known(const char *path, const uint8_t *start, size_t size) {
    return text_ends_in(path, ".mhd") || text_ends_in(path, ".mha") ||
           (size >= 10 && memcmp(start, "ObjectType", 10) == 0);
}

/* Find the first field that exists of several names for one thing. The list ends with NULL. */
static const header_field *get(const metaimage *h, const char *const *keys) {
    const header_field *f = NULL;
    while (!f && *keys)
        f = header_fields_find(&h->fields, *keys++);
    return f;
}

static status need(const metaimage *h, const char *key, const header_field **out) {
    *out = header_fields_find(&h->fields, key);
    return *out ? ST_OK : header_fields_missing(&h->fields, key);
}

/* Read True or False; `otherwise` when the field is absent. */
static status read_flag(const metaimage *h, const char *const *keys, bool otherwise, bool *out) {
    const header_field *f = get(h, keys);
    *out = otherwise;
    if (!f)
        return ST_OK;
    *out = strchr("Tt1", f->value[0]) != NULL && f->value[0];
    if (*out || (f->value[0] && strchr("Ff0", f->value[0])))
        return ST_OK;
    return header_fields_fault(&h->fields, f, ST_CORRUPT, "\"%s\": expected True or False",
                               f->value);
}

static status read_sizes(metaimage *h) {
    const header_field *dimension, *sizes;
    int64_t axes = 0;
    uint32_t all[HEADER_FIELDS_AXES];
    status st = need(h, "NDims", &dimension);
    if (st == ST_OK)
        st = header_fields_int(&h->fields, dimension, 1, HEADER_FIELDS_AXES, &axes);
    if (st == ST_OK)
        st = need(h, "DimSize", &sizes);
    if (st == ST_OK)
        st = header_fields_sizes(&h->fields, sizes, (int)axes, all);
    if (st != ST_OK)
        return st;
    h->axes = (int)axes;
    if (axes != 3 && axes != 4)
        return header_fields_fault(&h->fields, sizes, ST_UNSUPPORTED,
                                   "\"%s\": a volume has three axes, or a fourth with its steps",
                                   sizes->value);
    h->l->steps = axes == 4 ? all[3] : 1;
    memcpy(h->l->g.dims, all, sizeof h->l->g.dims);
    return ST_OK;
}

static status read_type(metaimage *h) {
    const header_field *f;
    status st = need(h, "ElementType", &f);
    if (st != ST_OK)
        return st;
    /* MetaIO's long has 32 bits on every machine. */
    static const struct {
        const char *name;
        sample_type type;
    } names[] = {
        {"MET_CHAR", SAMPLE_I8},    {"MET_UCHAR", SAMPLE_U8},      {"MET_SHORT", SAMPLE_I16},
        {"MET_USHORT", SAMPLE_U16}, {"MET_INT", SAMPLE_I32},       {"MET_UINT", SAMPLE_U32},
        {"MET_LONG", SAMPLE_I32},   {"MET_ULONG", SAMPLE_U32},     {"MET_FLOAT", SAMPLE_F32},
        {"MET_DOUBLE", SAMPLE_F64}, {"MET_LONG_LONG", SAMPLE_I64}, {"MET_ULONG_LONG", SAMPLE_U64},
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strcasecmp(f->value, names[i].name) == 0) {
            h->l->stored.type = names[i].type;
            return ST_OK;
        }
    return header_fields_fault(&h->fields, f, ST_UNSUPPORTED,
                               "\"%s\": supported are 8 to 64 bit integers, float and double",
                               f->value);
}

/* Read the number of channels. Three or four bytes are a colour. */
static status read_channels(metaimage *h) {
    const header_field *f = header_fields_find(&h->fields, "ElementNumberOfChannels");
    int64_t channels = 1;
    status st = f ? header_fields_int(&h->fields, f, 1, INT32_MAX, &channels) : ST_OK;
    h->l->stored.components = (uint32_t)channels;
    h->l->stored.colours = h->l->stored.type == SAMPLE_U8 && (channels == 3 || channels == 4);
    return st;
}

static status read_encoding(metaimage *h) {
    static const char *const binary[] = {"BinaryData", NULL};
    static const char *const compressed[] = {"CompressedData", NULL};
    static const char *const msb[] = {"ElementByteOrderMSB", "BinaryDataByteOrderMSB", NULL};
    bool is_binary, is_compressed;
    status st = read_flag(h, binary, true, &is_binary);
    if (st == ST_OK)
        st = read_flag(h, compressed, false, &is_compressed);
    if (st == ST_OK)
        st = read_flag(h, msb, false, &h->l->big_endian);
    if (st == ST_OK)
        h->l->encoding = is_compressed ? VOLUME_DEFLATE : is_binary ? VOLUME_RAW : VOLUME_TEXT;
    return st;
}

static status read_numbers(const metaimage *h, const char *const *keys, double out[3]) {
    const header_field *f = get(h, keys);
    double all[HEADER_FIELDS_AXES];
    status st = f ? header_fields_numbers(&h->fields, f, h->axes, all) : ST_OK;
    if (st == ST_OK && f)
        memcpy(out, all, 3 * sizeof *out);
    return st;
}

/* Read the directions. Row a of the matrix is the direction of axis a. */
static status read_directions(const metaimage *h, double direction[3][3]) {
    static const char *const keys[] = {"TransformMatrix", "Orientation", "Rotation", NULL};
    const header_field *f = get(h, keys);
    double all[16];
    if (!f)
        return ST_OK;
    status st = header_fields_numbers(&h->fields, f, h->axes * h->axes, all);
    for (int a = 0; st == ST_OK && a < 3; a++)
        memcpy(direction[a], all + a * h->axes, 3 * sizeof *all);
    return st;
}

static status read_placement(metaimage *h) {
    static const char *const spacings[] = {"ElementSpacing", "ElementSize", NULL};
    static const char *const origins[] = {"Offset", "Position", "Origin", NULL};
    double direction[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0};
    status st = read_numbers(h, spacings, spacing);
    if (st == ST_OK)
        st = read_numbers(h, origins, origin);
    if (st == ST_OK)
        st = read_directions(h, direction);
    if (st == ST_OK)
        volume_layout_place(h->l, direction, spacing, origin);
    world_frame_set(&h->l->g.frame, WORLD_LPS, "mm"); /* as ITK has it, whatever the header says */
    return st;
}

static status find_samples(metaimage *h) {
    const header_field *file, *size = header_fields_find(&h->fields, "HeaderSize");
    int64_t header_size = 0;
    status st = need(h, "ElementDataFile", &file);
    if (st == ST_OK && size)
        st = header_fields_int(&h->fields, size, -1, INT64_MAX, &header_size);
    if (st != ST_OK)
        return st;
    bool local = strcasecmp(file->value, "LOCAL") == 0;
    if (volume_files_are(file->value))
        return volume_files_open(h->l, h->fields.name, file->value, h->follow_links, 0,
                                 header_size);
    if (!local)
        st = volume_layout_open(h->l, h->fields.name, file->value, h->follow_links,
                                byte_stream_open_stored);
    return st == ST_OK ? volume_layout_skip(h->l, 0, header_size) : st;
}

static status open_layout(volume_layout *l, const volume_hints *hints) {
    static const header_style style = {.separator = '=', .end_key = "ElementDataFile"};
    static status (*const steps[])(metaimage *) = {read_sizes,    read_type,      read_channels,
                                                   read_encoding, read_placement, find_samples};
    metaimage h = {.l = l, .follow_links = hints->trust.follow_links};
    const uint32_t none[3] = {0, 0, 0};
    grid_init(&l->g, none, SAMPLE_U8);
    status st = header_fields_read(&h.fields, l->m, l->data, &style);
    for (size_t i = 0; st == ST_OK && i < sizeof steps / sizeof steps[0]; i++)
        st = steps[i](&h);
    header_fields_release(&h.fields);
    return st;
}

const grid_reader metaimage_reader = {.format = "MetaImage", .known = known, .layout = open_layout};
