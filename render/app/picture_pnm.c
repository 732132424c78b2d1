#include "render/app/picture_pnm.h"

#include <stdio.h>
#include <string.h>

#include "render/look/picture_bytes.h"

typedef void (*row_fn)(const picture *p, const byte_table *t, uint32_t y, void *row);

static void ppm_row(const picture *p, const byte_table *t, uint32_t y, void *row) {
    picture_bytes_rgb(t, p->image, (size_t)y * p->width, p->width, row);
}

static void pfm_row(const picture *p, const byte_table *t, uint32_t y, void *row) {
    (void)t;
    const size_t first = (size_t)(p->height - 1 - y) * p->width;
    float *out = row;
    for (size_t i = first; i < first + p->width; i++, out += 3) {
        out[0] = p->image->r[i];
        out[1] = p->image->g[i];
        out[2] = p->image->b[i];
    }
}

static status write_rows(mem *m, const picture *p, const byte_sink *to, const char *head,
                         size_t pixel_bytes, row_fn make) {
    byte_table table;
    void *row = mem_array(m, p->width, pixel_bytes);
    if (!row)
        return ST_NOMEM;
    picture_bytes_init(&table);
    status st = to->put(to->ctx, head, strlen(head));
    for (uint32_t y = 0; y < p->height && st == ST_OK; y++) {
        make(p, &table, y, row);
        st = to->put(to->ctx, row, p->width * pixel_bytes);
    }
    mem_free(m, row);
    return st;
}

status picture_ppm_write(mem *m, pool *threads, const picture *p, const byte_sink *to) {
    char head[64];
    (void)threads;
    snprintf(head, sizeof head, "P6\n%u %u\n255\n", p->width, p->height);
    return write_rows(m, p, to, head, 3, ppm_row);
}

status picture_pfm_write(mem *m, pool *threads, const picture *p, const byte_sink *to) {
    char head[64];
    (void)threads;
    /* A negative scale means little endian. */
    snprintf(head, sizeof head, "PF\n%u %u\n-1.0\n", p->width, p->height);
    return write_rows(m, p, to, head, 3 * sizeof(float), pfm_row);
}
