#include "formats/grid/heights_files.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "formats/base/num.h"
#include "formats/base/text.h"

/* Place terrain of rows from north to south; first: the world place of its north-west node. */
static void place(volume_layout *l, const double spacing[2], const double first[2]) {
    double direction[3][3] = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
    const double spacings[3] = {spacing[0], spacing[1], 1}, origin[3] = {first[0], first[1], 0};
    volume_layout_place(l, direction, spacings, origin);
    l->g.terrain = true;
}

static void set_missing(volume_layout *l, double value) {
    l->has_missing = true;
    l->missing = value;
}

/* ---- Arc ASCII grids ---- */

enum { ASC_HEAD_MAX = 2048, ASC_WORD = 64 };

typedef enum asc_key {
    COLUMNS,
    ROWS,
    X_CORNER,
    X_CENTRE,
    Y_CORNER,
    Y_CENTRE,
    CELL,
    NONE,
    KEYS
} asc_key;
static const char *const asc_names[KEYS] = {"ncols",     "nrows",     "xllcorner", "xllcenter",
                                            "yllcorner", "yllcenter", "cellsize",  "nodata_value"};

typedef struct asc_head {
    const char *name;
    double value[KEYS];
    bool has[KEYS];
} asc_head;

static bool asc_known(const char *path, const uint8_t *start, size_t size) {
    (void)path;
    return size > 6 && strncasecmp((const char *)start, "ncols", 5) == 0 && isspace(start[5]);
}

/* Take a word of at most ASC_WORD - 1 letters. Returns the text behind it; NULL: there is none. */
static const char *take_word(const char *at, char word[ASC_WORD]) {
    at += strspn(at, " \t\r\n");
    const size_t length = strcspn(at, " \t\r\n");
    if (length == 0 || length >= ASC_WORD || !at[length])
        return NULL;
    memcpy(word, at, length);
    word[length] = 0;
    return at + length;
}

static status take_pair(asc_head *h, const char **at) {
    char key[ASC_WORD], number[ASC_WORD];
    const char *behind = take_word(*at, key);
    const char *end = behind ? take_word(behind, number) : NULL;
    int k = 0;
    while (end && k < KEYS && strcasecmp(key, asc_names[k]) != 0)
        k++;
    if (!end || k == KEYS || h->has[k])
        return status_describe(ST_CORRUPT,
                               "%s: the head of an Arc ASCII grid: expected ncols, nrows, "
                               "xllcorner or xllcenter, yllcorner or yllcenter, cellsize or "
                               "NODATA_value, each once, with a number, found \"%s\"",
                               h->name, behind ? key : "");
    h->has[k] = true;
    *at = end;
    if (k == NONE && strcasecmp(number, "nan") == 0) {
        h->value[k] = (double)NAN;
        return ST_OK;
    }
    const status st = num_double(number, asc_names[k], &h->value[k]);
    return st == ST_OK ? ST_OK
                       : status_describe(ST_CORRUPT, "%s: %s: \"%s\" is no number", h->name,
                                         asc_names[k], number);
}

static bool is_count(double x) {
    return x >= 1 && x <= GRID_DIM_MAX && x == floor(x);
}

static status check_head(const asc_head *h) {
    const bool there = h->has[COLUMNS] && h->has[ROWS] && h->has[CELL] &&
                       h->has[X_CORNER] != h->has[X_CENTRE] && h->has[Y_CORNER] != h->has[Y_CENTRE];
    if (there && is_count(h->value[COLUMNS]) && is_count(h->value[ROWS]) && h->value[CELL] > 0 &&
        isfinite(h->value[CELL]))
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: the head of an Arc ASCII grid: expected ncols and nrows from 1 to "
                           "%d, cellsize above 0, and a place along x and y",
                           h->name, GRID_DIM_MAX);
}

/* Whether a pair of the head begins here. A first sample may be "nan". */
static bool is_key(const char *at) {
    const bool is_nan = strncasecmp(at, "nan", 3) == 0 && !isalpha((unsigned char)at[3]);
    return isalpha((unsigned char)*at) && !is_nan;
}

static status asc_layout(volume_layout *l, const volume_hints *hints) {
    asc_head h = {.name = byte_stream_name(l->data)};
    const uint8_t *start;
    char text[ASC_HEAD_MAX + 1];
    size_t size;
    (void)hints;
    status st = byte_stream_peek(l->data, ASC_HEAD_MAX, &start, &size);
    if (st != ST_OK)
        return st;
    size = size < ASC_HEAD_MAX ? size : ASC_HEAD_MAX;
    memcpy(text, start, size);
    text[size] = 0;
    const char *at = text;
    while (st == ST_OK && is_key(at + strspn(at, " \t\r\n")))
        st = take_pair(&h, &at);
    if (st == ST_OK)
        st = check_head(&h);
    if (st != ST_OK)
        return st;
    byte_stream_take(l->data, (size_t)(at - text));
    const uint32_t dims[3] = {(uint32_t)h.value[COLUMNS], (uint32_t)h.value[ROWS], 1};
    const double cell = h.value[CELL], spacing[2] = {cell, cell};
    const double first[2] = {h.has[X_CENTRE] ? h.value[X_CENTRE] : h.value[X_CORNER] + cell / 2,
                             (h.has[Y_CENTRE] ? h.value[Y_CENTRE] : h.value[Y_CORNER] + cell / 2) +
                                 (dims[1] - 1) * cell};
    grid_init(&l->g, dims, SAMPLE_F32);
    l->stored.type = SAMPLE_F32;
    l->encoding = VOLUME_TEXT;
    place(l, spacing, first);
    if (h.has[NONE] && !isnan(h.value[NONE]))
        set_missing(l, (double)(float)h.value[NONE]);
    return grid_check(&l->g, h.name);
}

const grid_reader heights_asc_reader = {
    .format = "Arc ASCII grid", .known = asc_known, .layout = asc_layout};

/* ---- SRTM tiles ---- */

enum { HGT_NONE = -32768 };

static bool hgt_known(const char *path, const uint8_t *start, size_t size) {
    (void)start, (void)size;
    return text_ends_in(path, ".hgt") || text_ends_in(path, ".HGT");
}

/* Degrees of the south-west corner from a name such as N47E006.hgt; 0 where it says nothing. */
static void hgt_place(const char *path, double corner[2]) {
    const char *slash = strrchr(path, '/'), *n = slash ? slash + 1 : path;
    bool told = strlen(n) == 11 && strchr("NSns", n[0]) && strchr("EWew", n[3]);
    for (int i = 1; i < 7 && told; i++)
        told = i == 3 || isdigit((unsigned char)n[i]);
    corner[0] = corner[1] = 0;
    if (!told)
        return;
    corner[1] = (10 * (n[1] - '0') + (n[2] - '0')) * (strchr("Ss", n[0]) ? -1 : 1);
    corner[0] =
        (100 * (n[4] - '0') + 10 * (n[5] - '0') + (n[6] - '0')) * (strchr("Ww", n[3]) ? -1 : 1);
}

static status hgt_layout(volume_layout *l, const volume_hints *hints) {
    const uint64_t bytes = byte_stream_left(l->data);
    const uint32_t side = bytes < UINT64_C(1) << 40 ? (uint32_t)sqrt((double)bytes / 2) : 0;
    const uint32_t dims[3] = {side, side, 1};
    double corner[2];
    (void)hints;
    if (side < 2 || (uint64_t)side * side * 2 != bytes)
        return status_describe(ST_CORRUPT,
                               "%s: a tile of elevations (.hgt) is a square of 16 bit numbers, not "
                               "packed, as 1201 x 1201 of 2884802 bytes",
                               byte_stream_name(l->data));
    hgt_place(byte_stream_path(l->data), corner);
    const double spacing[2] = {1.0 / (side - 1), 1.0 / (side - 1)};
    const double first[2] = {corner[0], corner[1] + 1};
    grid_init(&l->g, dims, SAMPLE_I16);
    l->stored.type = SAMPLE_I16;
    l->encoding = VOLUME_RAW;
    l->big_endian = true;
    place(l, spacing, first);
    world_frame_set_unit(&l->g.frame, 0, "degree");
    world_frame_set_unit(&l->g.frame, 1, "degree");
    world_frame_set_unit(&l->g.frame, 2, "m");
    set_missing(l, HGT_NONE);
    return ST_OK;
}

const grid_reader heights_hgt_reader = {
    .format = "SRTM tile", .known = hgt_known, .layout = hgt_layout};
