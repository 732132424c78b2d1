/* curvilinear_stream_writer.c - writes a curvilinear stream. */
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/out_stream.h"
#include "formats/curvilinear/curvilinear_stream.h"
#include "formats/curvilinear/curvilinear_stream_lines.h"

struct curvilinear_stream_writer {
    mem *m;
    out_stream *out;
    uint64_t places, blanks, values; /* still to come */
};

static status write_line(curvilinear_stream_writer *w, const char *key, const char *value) {
    char text[CURVILINEAR_NAME_MAX + 64];
    snprintf(text, sizeof text, "%s%s\n", key, value);
    return out_stream_text(w->out, text);
}

static status write_zone(curvilinear_stream_writer *w, const uint32_t nodes[3]) {
    char text[64];
    snprintf(text, sizeof text, "%u %u %u", nodes[0], nodes[1], nodes[2]);
    return write_line(w, CURVILINEAR_LINE_ZONE, text);
}

static status write_header(curvilinear_stream_writer *w, const curvilinear_stream_header *h) {
    status st = write_line(w, CURVILINEAR_LINE_MAGIC, "1");
    if (st == ST_OK && h->name[0])
        st = write_line(w, CURVILINEAR_LINE_NAME, h->name);
    for (uint32_t i = 0; i < h->field_count && st == ST_OK; i++)
        st = write_line(w, CURVILINEAR_LINE_FIELD, h->fields[i]);
    for (uint32_t z = 0; z < h->zones && st == ST_OK; z++)
        st = write_zone(w, h->nodes[z]);
    if (st == ST_OK && h->blanked)
        st = write_line(w, CURVILINEAR_LINE_BLANKED, "yes");
    return st == ST_OK ? out_stream_text(w->out, "\n") : st;
}

status curvilinear_stream_create(mem *m, const char *path, bool force,
                                 const curvilinear_stream_header *h,
                                 curvilinear_stream_writer **out) {
    assert(h->zones > 0 && h->field_count <= CURVILINEAR_STREAM_FIELDS_MAX);
    curvilinear_stream_writer *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return ST_NOMEM;
    w->m = m;
    for (uint32_t z = 0; z < h->zones; z++)
        w->places += (uint64_t)h->nodes[z][0] * h->nodes[z][1] * h->nodes[z][2];
    w->blanks = h->blanked ? w->places : 0;
    w->values = w->places * h->field_count;
    status st = out_stream_create(m, path, force, false, &w->out);
    if (st == ST_OK)
        st = write_header(w, h);
    if (st != ST_OK) {
        curvilinear_stream_discard(w);
        return st;
    }
    *out = w;
    return ST_OK;
}

status curvilinear_stream_places(curvilinear_stream_writer *w, size_t count, const float (*p)[3]) {
    assert(count <= w->places);
    w->places -= count;
    return out_stream_samples(w->out, SAMPLE_F32, p, 3 * count);
}

status curvilinear_stream_blanks(curvilinear_stream_writer *w, size_t count,
                                 const uint8_t *is_node) {
    assert(w->places == 0 && count <= w->blanks);
    w->blanks -= count;
    return out_stream_write(w->out, is_node, count);
}

status curvilinear_stream_values(curvilinear_stream_writer *w, size_t count, const float *values) {
    assert(w->places == 0 && w->blanks == 0 && count <= w->values);
    w->values -= count;
    return out_stream_samples(w->out, SAMPLE_F32, values, count);
}

status curvilinear_stream_commit(curvilinear_stream_writer *w) {
    assert(w->places == 0 && w->blanks == 0 && w->values == 0);
    const status st = out_stream_commit(w->out);
    w->out = NULL;
    curvilinear_stream_discard(w);
    return st;
}

void curvilinear_stream_discard(curvilinear_stream_writer *w) {
    if (!w)
        return;
    out_stream_discard(w->out);
    mem_free(w->m, w);
}
