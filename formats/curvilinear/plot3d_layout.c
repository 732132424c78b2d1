#include "formats/curvilinear/plot3d_layout.h"

#include <stdio.h>
#include <string.h>

#include "formats/input/binary_fields.h"

/* ---- words ---- */

static const char *const words[][2] = {
    {"binary", "records"}, {"big", "little"},   {"f32", "f64"}, {"no-blanks", "blanks"},
    {"single", "multi"},   {"whole", "planes"}, {"3d", "2d"}};
enum { WORDS = sizeof words / sizeof *words };
enum { BYTES = PLOT3D_RECORDS | PLOT3D_LITTLE | PLOT3D_F64 }; /* text has none of them */

_Static_assert(1 << WORDS == PLOT3D_LAYOUTS, "each has a word");

static bool is_word(const char *word, size_t length, const char *which) {
    return strlen(which) == length && memcmp(which, word, length) == 0;
}

static bool take_word(const char *word, size_t length, plot3d_words *out) {
    if (is_word(word, length, "text")) {
        out->said |= PLOT3D_TEXT;
        out->layout |= PLOT3D_TEXT;
        return !(out->said & BYTES);
    }
    for (unsigned i = 0; i < 2 * WORDS; i++) {
        const unsigned bit = 1U << i / 2, value = i % 2 ? bit : 0;
        if (!is_word(word, length, words[i / 2][i % 2]))
            continue;
        const bool agrees = (!(out->said & bit) || (out->layout & bit) == value) &&
                            !(bit & BYTES && out->said & PLOT3D_TEXT);
        out->said |= bit;
        out->layout |= value;
        return agrees;
    }
    return false;
}

status plot3d_words_parse(const char *text, plot3d_words *out) {
    *out = (plot3d_words){0};
    for (const char *at = text; at && *at;) {
        const size_t length = strcspn(at, ",");
        if (!take_word(at, length, out))
            return status_describe(
                ST_USAGE,
                "PLOT3D layout \"%.80s\": \"%.*s\", expected once each: binary or records, big or "
                "little, f32 or f64, or text; no-blanks or blanks, single or multi, whole or "
                "planes",
                text, length < 40 ? (int)length : 40, at);
        at += length;
        at += *at == ',';
    }
    return ST_OK;
}

/* The bits that files of a content may have. */
static unsigned bits_of(plot3d_content content) {
    return content == PLOT3D_GRID ? PLOT3D_LAYOUTS - 1
                                  : (PLOT3D_LAYOUTS - 1) & ~(PLOT3D_BLANKS | PLOT3D_FLAT);
}

const char *plot3d_layout_print(plot3d_content content, unsigned layout,
                                char text[PLOT3D_LAYOUT_TEXT]) {
    const unsigned bits =
        layout & PLOT3D_TEXT ? bits_of(content) & ~(unsigned)BYTES : bits_of(content);
    size_t length = layout & PLOT3D_TEXT ? (size_t)snprintf(text, PLOT3D_LAYOUT_TEXT, "text") : 0;
    for (unsigned i = 0; i < WORDS; i++)
        if (bits & 1U << i)
            length += (size_t)snprintf(text + length, PLOT3D_LAYOUT_TEXT - length, "%s%s",
                                       length ? "," : "", words[i][layout >> i & 1]);
    return text;
}

/* ---- heads ---- */

/* The file's first bytes, and how far they are read. */
typedef struct reading {
    const uint8_t *start;
    size_t size, at;
    unsigned layout;
} reading;

static uint32_t whole_at(const uint8_t *at, unsigned layout) {
    return (uint32_t)binary_unsigned(at, 4, !(layout & PLOT3D_LITTLE));
}

/* Move on by a record of so many bytes; returns its first byte. NULL: there is no such record. */
static const uint8_t *next_record(reading *r, size_t bytes) {
    const size_t mark = plot3d_layout_mark(r->layout);
    if (r->size - r->at < bytes + 2 * mark)
        return NULL;
    const uint8_t *body = r->start + r->at + mark;
    if (mark &&
        (whole_at(body - mark, r->layout) != bytes || whole_at(body + bytes, r->layout) != bytes))
        return NULL;
    r->at += bytes + 2 * mark;
    return body;
}

/* Whether a record's length stands at a byte of the file, as far as can be seen. */
static bool is_length(const reading *r, uint64_t at, uint64_t bytes) {
    return !(r->layout & PLOT3D_RECORDS) || at + 4 > r->size ||
           whole_at(r->start + at, r->layout) == bytes;
}

/* Whole numbers of a zone: along each axis, and of the functions. */
static uint32_t axes_of(const plot3d_head *h) {
    return h->layout & PLOT3D_FLAT ? 2 : 3;
}

static uint32_t wholes_of(const plot3d_head *h) {
    return axes_of(h) + (h->content == PLOT3D_FUNCTIONS);
}

static uint32_t zone_whole(const plot3d_head *h, uint32_t zone, uint32_t i) {
    return whole_at(h->nodes + 4 * (size_t)(zone * wholes_of(h) + i), h->layout);
}

void plot3d_head_nodes(const plot3d_head *h, uint32_t zone, uint32_t nodes[3]) {
    for (uint32_t a = 0; a < 3; a++)
        nodes[a] = a < axes_of(h) ? zone_whole(h, zone, a) : 1;
}

uint32_t plot3d_head_numbers(const plot3d_head *h, uint32_t zone) {
    return h->content == PLOT3D_FUNCTIONS  ? zone_whole(h, zone, axes_of(h))
           : h->content == PLOT3D_SOLUTION ? 5
                                           : axes_of(h);
}

/* Records hold up to 2^31 - 9 bytes: longer ones are cut in several, which is not read. */
enum { RECORD_MAX = INT32_MAX - 8 };

uint64_t plot3d_head_block(const plot3d_head *h, uint32_t zone, uint64_t at, plot3d_block *out) {
    const uint64_t mark = plot3d_layout_mark(h->layout), width = plot3d_layout_width(h->layout);
    uint32_t nodes[3];
    plot3d_head_nodes(h, zone, nodes);
    *out = (plot3d_block){.pieces = h->layout & PLOT3D_PLANES ? nodes[2] : 1};
    if (h->content == PLOT3D_SOLUTION)
        at += PLOT3D_CONDITIONS * width + 2 * mark;
    out->at = at;
    const uint64_t each = plot3d_head_numbers(h, zone) * width +
                          (h->layout & PLOT3D_BLANKS ? plot3d_layout_blank(h->layout) : 0);
    uint64_t all;
    if (__builtin_mul_overflow((uint64_t)nodes[0] * nodes[1], nodes[2] / out->pieces,
                               &out->nodes) ||
        __builtin_mul_overflow(out->nodes, each, &out->bytes) ||
        (mark && out->bytes > RECORD_MAX) ||
        __builtin_mul_overflow(out->bytes + 2 * mark, out->pieces, &all) ||
        __builtin_add_overflow(at, all, &at))
        return UINT64_MAX;
    return at;
}

/* Whole numbers must be 1 or more, as an int of 4 bytes. Planes differ from the whole only where
 * some zone has several. */
static bool are_counts(const plot3d_head *h) {
    bool several = !(h->layout & PLOT3D_PLANES);
    for (uint32_t z = 0; z < h->zones; z++) {
        for (uint32_t i = 0; i < wholes_of(h); i++)
            if (zone_whole(h, z, i) - 1 >= INT32_MAX)
                return false;
        several = several || zone_whole(h, z, 2) > 1;
    }
    return several;
}

bool plot3d_head_read(plot3d_content content, unsigned layout, const uint8_t *start, size_t size,
                      plot3d_head *out) {
    reading r = {.start = start, .size = size, .layout = layout};
    *out = (plot3d_head){.layout = layout, .content = content, .zones = 1};
    if (layout & PLOT3D_MULTI) {
        const uint8_t *zones = next_record(&r, 4);
        out->zones = zones ? whole_at(zones, layout) : 0;
        if (out->zones < 1 || out->zones > PLOT3D_ZONES_MAX)
            return false;
    }
    out->nodes = next_record(&r, 4 * (size_t)wholes_of(out) * out->zones);
    if (!out->nodes || !are_counts(out))
        return false;
    out->length = out->bytes = (uint32_t)(layout & PLOT3D_TEXT ? r.at / 4 : r.at);
    plot3d_block block;
    for (uint32_t z = 0; z < out->zones && out->length < UINT64_MAX; z++) {
        out->length = plot3d_head_block(out, z, out->length, &block);
        if (z == 0 && !is_length(&r, block.at, block.bytes))
            return false;
    }
    return true;
}

/* Lengths of records that agree are no accident. Without them the same file may be C binary of 12
 * nodes along i, as the first length is 12. */
static uint32_t prefer_records(plot3d_head *heads, uint32_t found) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < found; i++)
        if (heads[i].layout & PLOT3D_RECORDS)
            heads[kept++] = heads[i];
    return kept ? kept : found;
}

uint32_t plot3d_head_find(plot3d_content content, const plot3d_words *said, unsigned text,
                          const uint8_t *start, size_t size, uint64_t bytes, uint64_t behind,
                          plot3d_head *heads) {
    uint32_t found = 0;
    for (unsigned layout = 0; layout < PLOT3D_LAYOUTS; layout++) {
        const unsigned kind = layout & (PLOT3D_RECORDS | PLOT3D_PLANES | PLOT3D_FLAT);
        const bool hidden = kind == PLOT3D_PLANES && !(said->said & PLOT3D_PLANES);
        if (layout & ~bits_of(content) || (layout ^ said->layout) & said->said & bits_of(content) ||
            hidden || (kind & PLOT3D_PLANES && kind & PLOT3D_FLAT) || (text && layout & BYTES))
            continue;
        if (plot3d_head_read(content, layout | text, start, size, &heads[found]) &&
            heads[found].length <= bytes && bytes - heads[found].length <= behind)
            found++;
    }
    return prefer_records(heads, found);
}
