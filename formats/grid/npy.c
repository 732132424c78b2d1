#include "formats/grid/npy.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "formats/input/binary_fields.h"

enum { HEADER_MAX = 1 << 16, AXES_MAX = 32 };

/* A header that is being interpreted. */
typedef struct npy {
    volume_layout *l;
    const char *name;
    char *text; /* a Python dictionary */
    bool fortran;
    uint32_t shape[AXES_MAX];
    int axes;
} npy;

static bool known(const char *path, const uint8_t *start, size_t size) {
    (void)path;
    return size >= 6 && memcmp(start, "\x93NUMPY", 6) == 0;
}

static status fault(const npy *n, status st, const char *what) {
    return status_describe(st, "%s: the header of the array: %s: \"%.200s\"", n->name, what,
                           n->text);
}

/* Read the dictionary as a string. The stream then stands at the samples. */
static status read_text(npy *n, byte_stream *s) {
    const uint8_t *start;
    size_t size, got = 0;
    status st = byte_stream_peek(s, 12, &start, &size);
    if (st != ST_OK)
        return st;
    const int major = size > 6 ? start[6] : 0, width = major == 1 ? 2 : 4;
    if (size < 12 || major < 1 || major > 3)
        return status_describe(
            ST_UNSUPPORTED, "%s: a NumPy array of version %d: expected 1, 2 or 3", n->name, major);
    const uint64_t length = binary_unsigned(start + 8, width, false);
    if (length > HEADER_MAX)
        return status_describe(ST_CORRUPT,
                               "%s: byte 8: a header of %llu bytes; at most %d are "
                               "taken",
                               n->name, (unsigned long long)length, HEADER_MAX);
    byte_stream_take(s, 8 + (size_t)width);
    n->text = mem_zalloc(n->l->m, length + 1);
    if (!n->text)
        return ST_NOMEM;
    st = byte_stream_read(s, n->text, length, &got);
    if (st == ST_OK && got < length)
        st = status_describe(ST_CORRUPT, "%s: ends at byte %llu, inside the header", n->name,
                             (unsigned long long)byte_stream_position(s));
    return st;
}

/* Returns the value of a key in the dictionary; NULL when there is none. */
static const char *find(const npy *n, const char *key) {
    const size_t length = strlen(key);
    for (const char *at = n->text; (at = strstr(at, key)); at++) {
        const char quote = at > n->text ? at[-1] : 0;
        if ((quote != '\'' && quote != '"') || at[length] != quote)
            continue;
        const char *value = at + length + 1 + strspn(at + length + 1, " ");
        if (*value == ':')
            return value + 1 + strspn(value + 1, " ");
    }
    return NULL;
}

/* A word holds byte order, kind, bytes. */
bool npy_type(const char *word, stored_samples *s, bool *big_endian) {
    static const struct {
        char name[4];
        sample_type type;
        uint32_t components;
    } types[] = {
        {"b1", SAMPLE_U8, 1},  {"u1", SAMPLE_U8, 1},   {"i1", SAMPLE_I8, 1},  {"u2", SAMPLE_U16, 1},
        {"i2", SAMPLE_I16, 1}, {"u4", SAMPLE_U32, 1},  {"i4", SAMPLE_I32, 1}, {"u8", SAMPLE_U64, 1},
        {"i8", SAMPLE_I64, 1}, {"f2", SAMPLE_F16, 1},  {"f4", SAMPLE_F32, 1}, {"f8", SAMPLE_F64, 1},
        {"c8", SAMPLE_F32, 2}, {"c16", SAMPLE_F64, 2},
    };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if (!*word || !strchr("<>|=", *word) || strcmp(word + 1, types[i].name) != 0)
            continue;
        s->type = types[i].type;
        s->components = types[i].components;
        *big_endian = *word == '>';
        return true;
    }
    return false;
}

static status read_type(npy *n) {
    const char *value = find(n, "descr");
    char word[8] = "";
    if (!value)
        return fault(n, ST_CORRUPT, "expected 'descr'");
    const size_t length = strcspn(value + (*value != 0), "'\"");
    if ((*value == '\'' || *value == '"') && length < sizeof word && value[1 + length] == *value)
        memcpy(word, value + 1, length);
    if (npy_type(word, &n->l->stored, &n->l->big_endian))
        return ST_OK;
    return fault(n, ST_UNSUPPORTED,
                 "'descr': supported are bool, 8 to 64 bit integers, half, float, double and "
                 "complex of these");
}

static status read_order(npy *n) {
    const char *value = find(n, "fortran_order");
    n->fortran = value && strncmp(value, "True", 4) == 0;
    if (n->fortran || (value && strncmp(value, "False", 5) == 0))
        return ST_OK;
    return fault(n, ST_CORRUPT, "'fortran_order': expected True or False");
}

static status read_shape(npy *n) {
    const char *at = find(n, "shape");
    if (!at || *at != '(')
        return fault(n, ST_CORRUPT, "expected 'shape'");
    for (at++; *(at += strspn(at, " ,")) != ')';) {
        char *end;
        const unsigned long long size = isdigit((unsigned char)*at) ? strtoull(at, &end, 10) : 0;
        if (size < 1 || size > UINT32_MAX || n->axes == AXES_MAX)
            return fault(n, ST_CORRUPT, "'shape': expected sizes from 1 on");
        at = *end == 'L' ? end + 1 : end;
        n->shape[n->axes++] = (uint32_t)size;
    }
    return ST_OK;
}

/* ---- what the axes are ---- */

/* Drop axes of one sample in front of z, y and x. */
static void drop_front(npy *n) {
    while (n->axes > 3 && n->shape[0] == 1)
        memmove(n->shape, n->shape + 1, (size_t)--n->axes * sizeof *n->shape);
}

/* Set the order of the samples from the axes' roles. In Fortran order the first axis is fastest,
 * behind the numbers of an element (complex), which are no axis. */
static void set_order(npy *n, const uint8_t *roles) {
    uint8_t *order = n->l->order;
    int at = 0;
    if (!n->fortran) /* the order is a grid's */
        return;
    n->l->ordered = true;
    if (!memchr(roles, ORDER_COMPONENT, (size_t)n->axes))
        order[at++] = ORDER_COMPONENT;
    for (int i = 0; i < n->axes; i++)
        order[at++] = roles[i];
    if (at < ORDER_AXES)
        order[at] = ORDER_STEP;
}

static status set_axes(npy *n) {
    static const uint8_t plain[] = {ORDER_Z, ORDER_Y, ORDER_X};
    static const uint8_t numbers[] = {ORDER_Z, ORDER_Y, ORDER_X, ORDER_COMPONENT};
    static const uint8_t steps[] = {ORDER_STEP, ORDER_Z, ORDER_Y, ORDER_X};
    volume_layout *l = n->l;
    drop_front(n);
    if (n->axes == 2) { /* one slice */
        memmove(n->shape + 1, n->shape, 2 * sizeof *n->shape);
        n->shape[0] = 1;
        n->axes = 3;
    }
    const bool four = n->axes == 4, last = four && n->shape[3] <= NPY_NUMBERS;
    if ((n->axes != 3 && !four) || (last && l->stored.components > 1))
        return fault(n, ST_UNSUPPORTED,
                     "'shape': expected (z, y, x), (z, y, x, numbers) or (steps, z, y, x)");
    const uint32_t *z = n->shape + (four && !last);
    const uint32_t dims[3] = {z[2], z[1], z[0]};
    grid_init(&l->g, dims, SAMPLE_U8);
    if (last)
        l->stored.components = n->shape[3];
    else if (four)
        l->steps = n->shape[0];
    set_order(n, !four ? plain : last ? numbers : steps);
    return ST_OK;
}

static status open_layout(volume_layout *l, const volume_hints *hints) {
    static status (*const steps[])(npy *) = {read_type, read_order, read_shape, set_axes};
    (void)hints;
    npy n = {.l = l, .name = byte_stream_name(l->data)};
    status st = read_text(&n, l->data);
    for (size_t i = 0; st == ST_OK && i < sizeof steps / sizeof *steps; i++)
        st = steps[i](&n);
    mem_free(l->m, n.text);
    return st;
}

const grid_reader npy_reader = {.format = "NumPy array", .known = known, .layout = open_layout};
