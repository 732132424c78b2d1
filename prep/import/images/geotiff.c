#include "prep/import/images/geotiff.h"

#include <math.h>
#include <string.h>

#include "formats/base/num.h"
#include "prep/import/images/tiff_pages.h"

enum { MAP_NUMBERS = 16, TIE_NUMBERS = 6, SCALE_NUMBERS = 3, TEXT = 4096 };

/* Keys, and what they may say. */
enum {
    KEY_MODEL = 1024,
    KEY_RASTER = 1025,
    KEY_ANGLES = 2054,
    KEY_LENGTHS = 3076,
    KEY_HEIGHTS = 4099,
    MODEL_DEGREES = 2,
    RASTER_POINTS = 2,
    DEGREES = 9102
};

static const struct {
    uint16_t code;
    const char *name;
} units[] = {{9001, "m"}, {9002, "ft"}, {9003, "US survey ft"}, {9036, "km"}, {DEGREES, "degree"}};

static const char *unit_of(uint64_t code) {
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (units[i].code == code)
            return units[i].name;
    return "";
}

/* ---- numbers of a tag ---- */

/* Read `count` doubles. false: there are fewer, or one is not finite. */
static status read_doubles(const tiff *t, const tiff_numbers *n, int count, double *out,
                           bool *there) {
    status st = ST_OK;
    *there = n->count >= (uint64_t)count;
    for (int i = 0; i < count && *there && st == ST_OK; i++) {
        uint64_t bits;
        st = tiff_number(t, n->at + 8 * (uint64_t)i, 8, &bits);
        memcpy(&out[i], &bits, sizeof bits);
        *there = st == ST_OK && isfinite(out[i]);
    }
    return st;
}

/* Read the start of a text. */
static status read_text(const tiff *t, const tiff_numbers *n, char out[TEXT]) {
    const size_t size = n->count < TEXT ? (size_t)n->count : TEXT - 1;
    memset(out, 0, TEXT);
    return size ? file_read_at(t->file, n->at, out, size) : ST_OK;
}

/* Find a key's number: behind four numbers there are four for each, its own, 0 where the value
 * stands in the fourth, how many, the value. 0: it is not there. */
static status find_key(const tiff *t, const tiff_numbers *n, uint64_t key, uint64_t *value) {
    status st = ST_OK;
    *value = 0;
    for (uint64_t i = 1; 4 * i + 3 < n->count && st == ST_OK; i++) {
        uint64_t entry[4];
        for (uint64_t k = 0; k < 4 && st == ST_OK; k++)
            st = tiff_number(t, n->at + 2 * (4 * i + k), 2, &entry[k]);
        if (st == ST_OK && entry[0] == key && entry[1] == 0) {
            *value = entry[3];
            break;
        }
    }
    return st;
}

/* ---- the first page ---- */

static status read_map(const tiff *t, const tiff_page *p, geotiff *g) {
    double m[MAP_NUMBERS], scale[SCALE_NUMBERS], tie[TIE_NUMBERS];
    bool mapped, scaled, tied;
    status st = read_doubles(t, &p->geo[TIFF_GEO_MAP], MAP_NUMBERS, m, &mapped);
    if (st == ST_OK)
        st = read_doubles(t, &p->geo[TIFF_GEO_SCALE], SCALE_NUMBERS, scale, &scaled);
    if (st == ST_OK)
        st = read_doubles(t, &p->geo[TIFF_GEO_TIES], TIE_NUMBERS, tie, &tied);
    if (st != ST_OK)
        return st;
    if (scaled && tied) {
        const double map[2][3] = {{scale[0], 0.0, tie[3] - tie[0] * scale[0]},
                                  {0.0, -scale[1], tie[4] + tie[1] * scale[1]}};
        memcpy(g->map, map, sizeof map);
    } else if (mapped) {
        const double map[2][3] = {{m[0], m[1], m[3]}, {m[4], m[5], m[7]}};
        memcpy(g->map, map, sizeof map);
    }
    const double area = g->map[0][0] * g->map[1][1] - g->map[0][1] * g->map[1][0];
    g->placed = isfinite(area) && area != 0.0;
    return ST_OK;
}

static status read_keys(const tiff *t, const tiff_page *p, geotiff *g) {
    const tiff_numbers *keys = &p->geo[TIFF_GEO_KEYS];
    uint64_t model, raster, angles, lengths, heights;
    status st = find_key(t, keys, KEY_MODEL, &model);
    if (st == ST_OK)
        st = find_key(t, keys, KEY_RASTER, &raster);
    if (st == ST_OK)
        st = find_key(t, keys, KEY_ANGLES, &angles);
    if (st == ST_OK)
        st = find_key(t, keys, KEY_LENGTHS, &lengths);
    if (st == ST_OK)
        st = find_key(t, keys, KEY_HEIGHTS, &heights);
    if (st != ST_OK)
        return st;
    g->unit = unit_of(model == MODEL_DEGREES ? angles ? angles : DEGREES : lengths);
    g->up = unit_of(heights);
    for (int row = 0; row < 2 && raster != RASTER_POINTS; row++)
        g->map[row][2] += (g->map[row][0] + g->map[row][1]) / 2.0;
    return ST_OK;
}

static status read_texts(const tiff *t, const tiff_page *p, geotiff *g) {
    char text[TEXT];
    status st = read_text(t, &p->geo[TIFF_GEO_METADATA], text);
    g->scaled = st == ST_OK && (strstr(text, "role=\"scale\"") || strstr(text, "role=\"offset\""));
    if (st == ST_OK)
        st = read_text(t, &p->geo[TIFF_GEO_MISSING], text);
    if (st != ST_OK)
        return st;
    text[strcspn(text, " \t\r\n")] = 0;
    g->has_missing = num_double(text, "", &g->missing) == ST_OK && isfinite(g->missing);
    return ST_OK;
}

static status take_page(void *ctx, const tiff *t, const tiff_page *p, uint64_t number) {
    geotiff *g = ctx;
    status st = mem_grow(g->m, &g->beside, 1, (size_t)number, 256, &g->room);
    if (st != ST_OK)
        return st;
    g->beside[number] = p->beside && number > 0;
    if (number > 0)
        return ST_OK;
    st = read_map(t, p, g);
    if (st == ST_OK && g->placed)
        st = read_keys(t, p, g);
    return st == ST_OK ? read_texts(t, p, g) : st;
}

status geotiff_read(mem *m, const char *path, geotiff *out) {
    uint64_t pages;
    *out = (geotiff){.m = m, .unit = "", .up = ""};
    return tiff_pages_each(m, path, &(tiff_visit){take_page, out}, &pages);
}

void geotiff_release(geotiff *g) {
    if (g->m)
        mem_free(g->m, g->beside);
    *g = (geotiff){.m = NULL};
}

bool geotiff_is_beside(const geotiff *g, uint32_t page) {
    return page < g->room && g->beside[page];
}
