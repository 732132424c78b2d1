#include "prep/export/tiff_head.h"

#include <endian.h>
#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "prep/export/head_text.h"

enum { SHORT = 3, LONG = 4, RATIONAL = 5, LONG8 = 16, ASCII = 2 };
enum { ENTRIES = 13, ALIGNED = 64, NO_UNIT = 1, BLACK_IS_ZERO = 1 };

/* Offsets of all parts: header, resolutions, description, pages, samples. */
typedef struct plan {
    bool big; /* BigTIFF */
    uint64_t slice;
    uint64_t resolutions, text, pages, samples; /* offsets */
    uint64_t text_bytes;                        /* with its NUL */
} plan;

status tiff_head_check(const grid *g) {
    if (!grid_is_rectilinear(g))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "a TIFF has samples at equal distances; this grid's axes are uneven, "
                           "which .vtr and .nrrd can hold");
}

const char *tiff_head_loses(const grid *g) {
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            if (column == row ? g->to_world[row][column] < 0 : g->to_world[row][column] != 0)
                return "other programs find in a TIFF how far samples are apart, not where they "
                       "lie nor how they are turned; .nrrd, .nii and .vti tell them";
    return NULL;
}

/* ---- numbers ---- */

static void add16(head_text *h, uint64_t value) {
    const uint16_t little = htole16((uint16_t)value);
    head_text_bytes(h, &little, sizeof little);
}

static void add32(head_text *h, uint64_t value) {
    const uint32_t little = htole32((uint32_t)value);
    head_text_bytes(h, &little, sizeof little);
}

/* Add 4 bytes, or 8 in a BigTIFF. */
static void add_word(head_text *h, const plan *p, uint64_t value) {
    add32(h, value);
    if (p->big)
        add32(h, value >> 32);
}

static void pad(head_text *h, uint64_t to) {
    while (h->size < to && h->st == ST_OK)
        head_text_bytes(h, "", 1);
}

static double spacing(const grid *g, int a) {
    const double column[3] = {g->to_world[0][a], g->to_world[1][a], g->to_world[2][a]};
    return vec3_length(column);
}

/* Pixels per unit as a fraction, with as many digits as fit. */
static void add_resolution(head_text *h, double value) {
    double below = 1;
    while (below < 1e9 && value * below != floor(value * below) && value * below * 10 < UINT32_MAX)
        below *= 10;
    while (below > 1 && value * below > UINT32_MAX)
        below /= 10;
    add32(h, (uint64_t)fmax(1, fmin(rint(value * below), UINT32_MAX)));
    add32(h, (uint64_t)below);
}

/* ---- the description ---- */

static const char *ome_type(sample_type type) {
    switch (type) {
    case SAMPLE_U8: return "uint8";
    case SAMPLE_I8: return "int8";
    case SAMPLE_U16: return "uint16";
    case SAMPLE_I16: return "int16";
    default: return "float";
    }
}

static void describe(head_text *h, const grid *g) {
    head_text_add(h, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>"
                     "<OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\" "
                     "Creator=\"leafcast\"><Image ID=\"Image:0\" Name=\"");
    head_text_xml(h, g->name);
    head_text_add(h,
                  "\"><Pixels ID=\"Pixels:0\" DimensionOrder=\"XYZCT\" Type=\"%s\" SizeX=\"%u\" "
                  "SizeY=\"%u\" SizeZ=\"%u\" SizeC=\"1\" SizeT=\"1\"",
                  ome_type(g->type), g->dims[0], g->dims[1], g->dims[2]);
    for (int a = 0; a < 3; a++) {
        head_text_add(h, " PhysicalSize%c=\"", "XYZ"[a]);
        head_text_number(h, spacing(g, a));
        head_text_add(h, "\" PhysicalSize%cUnit=\"reference frame\"", "XYZ"[a]);
    }
    head_text_add(h,
                  "><Channel ID=\"Channel:0:0\" SamplesPerPixel=\"1\"/>"
                  "<TiffData IFD=\"0\" PlaneCount=\"%u\"/></Pixels>"
                  "<AnnotationRef ID=\"Annotation:0\"/></Image><StructuredAnnotations>"
                  "<MapAnnotation ID=\"Annotation:0\" Namespace=\"leafcast\"><Value>"
                  "<M K=\"to_world\">",
                  g->dims[2]);
    for (int i = 0; i < 12; i++) {
        head_text_add(h, i > 0 ? " " : "");
        head_text_number(h, g->to_world[i / 4][i % 4]);
    }
    head_text_add(h, "</M></Value></MapAnnotation></StructuredAnnotations></OME>");
    head_text_bytes(h, "", 1);
}

/* ---- pages ---- */

static uint64_t page_bytes(const plan *p, bool first) {
    const uint64_t entries = ENTRIES + first;
    return p->big ? 8 + 20 * entries + 8 : 2 + 12 * entries + 4;
}

static void entry(head_text *h, const plan *p, int tag, int type, uint64_t count, uint64_t value) {
    add16(h, (uint64_t)tag);
    add16(h, (uint64_t)type);
    add_word(h, p, count);
    add_word(h, p, value);
}

/* A resolution is too long for an entry's value, except in a BigTIFF. */
static void add_resolutions(head_text *h, const plan *p, const grid *g) {
    for (int a = 0; a < 2; a++) {
        if (!p->big) {
            entry(h, p, 282 + a, RATIONAL, 1, p->resolutions + 8 * (uint64_t)a);
            continue;
        }
        add16(h, 282 + (uint64_t)a);
        add16(h, RATIONAL);
        add_word(h, p, 1);
        add_resolution(h, 1 / spacing(g, a));
    }
}

static void add_page(head_text *h, const plan *p, const grid *g, uint32_t z) {
    const bool first = z == 0, last = z + 1 == g->dims[2];
    const int word = p->big ? LONG8 : LONG;
    const uint64_t next = p->pages + page_bytes(p, true) + z * page_bytes(p, false);
    if (p->big)
        add_word(h, p, ENTRIES + first);
    else
        add16(h, ENTRIES + first);
    entry(h, p, 256, LONG, 1, g->dims[0]);
    entry(h, p, 257, LONG, 1, g->dims[1]);
    entry(h, p, 258, SHORT, 1, 8 * sample_size(g->type));
    entry(h, p, 259, SHORT, 1, 1); /* no compression */
    entry(h, p, 262, SHORT, 1, BLACK_IS_ZERO);
    if (first)
        entry(h, p, 270, ASCII, p->text_bytes, p->text);
    entry(h, p, 273, word, 1, p->samples + z * p->slice);
    entry(h, p, 277, SHORT, 1, 1); /* one sample per pixel */
    entry(h, p, 278, LONG, 1, g->dims[1]);
    entry(h, p, 279, word, 1, p->slice);
    add_resolutions(h, p, g);
    entry(h, p, 296, SHORT, 1, NO_UNIT);
    entry(h, p, 339, SHORT, 1,
          g->type == SAMPLE_F32                           ? 3
          : g->type == SAMPLE_I8 || g->type == SAMPLE_I16 ? 2
                                                          : 1);
    add_word(h, p, last ? 0 : next);
}

/* ---- all of it ---- */

static plan make_plan(const grid *g, uint64_t text_bytes, bool big) {
    plan p = {.big = big, .slice = grid_slice_bytes(g), .text_bytes = text_bytes};
    p.resolutions = big ? 16 : 8;
    p.text = p.resolutions + 16;
    p.pages = (p.text + text_bytes + 7) / 8 * 8;
    p.samples = p.pages + page_bytes(&p, true) + (g->dims[2] - 1) * page_bytes(&p, false);
    p.samples = (p.samples + ALIGNED - 1) / ALIGNED * ALIGNED;
    return p;
}

static void add_start(head_text *h, const plan *p, const grid *g, const head_text *text) {
    head_text_bytes(h, "II", 2);
    add16(h, p->big ? 43 : 42);
    if (p->big) {
        add16(h, 8);
        add16(h, 0);
    }
    add_word(h, p, p->pages);
    for (int a = 0; a < 2; a++)
        add_resolution(h, 1 / spacing(g, a));
    head_text_bytes(h, text->text, text->size);
    pad(h, p->pages);
}

/* Write out the contents of h, and empty it. */
static status flush(head_text *h, out_stream *out) {
    status st = h->st == ST_OK ? out_stream_write(out, h->text, h->size) : h->st;
    h->size = 0;
    return st;
}

static status put_pages(head_text *h, const plan *p, const grid *g, out_stream *out) {
    uint64_t at = p->pages;
    status st = flush(h, out);
    for (uint32_t z = 0; z < g->dims[2] && st == ST_OK; z++) {
        add_page(h, p, g, z);
        at += h->size;
        st = flush(h, out);
    }
    pad(h, p->samples - at);
    return st == ST_OK ? flush(h, out) : st;
}

status tiff_head(mem *m, out_stream *out, const grid *g) {
    head_text h = {.m = m}, text = {.m = m};
    describe(&text, g);
    plan p = make_plan(g, text.size, false);
    if (p.samples + g->dims[2] * p.slice > UINT32_MAX)
        p = make_plan(g, text.size, true);
    if (text.st == ST_OK)
        add_start(&h, &p, g, &text);
    status st = text.st == ST_OK ? put_pages(&h, &p, g, out) : text.st;
    head_text_release(&h);
    head_text_release(&text);
    return st;
}
