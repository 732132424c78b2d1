#include "render/app/transfer_preset.h"

#include <math.h>
#include <string.h>

#include "formats/leaf/histogram.h"
#include "render/app/colour_map.h"

enum { ROWS_MAX = 6 };

/* A point at a percentile of the samples above a threshold. */
typedef struct row {
    int above;     /* threshold: 0 of the foreground, 1 of its dense part */
    double share;  /* share of these samples that are below, 0 .. 1 */
    double rgb[3]; /* linear */
    double weight;
} row;

/* depth: the average optical depth along the length of the diagonal. */
static const struct preset {
    const char *name, *map; /* map: its colour map; NULL: the colours of its rows */
    double depth;
    int count;
    row rows[ROWS_MAX];
} PRESETS[] = {
    {"auto", "viridis", 2.0, 3, {{0, 0.0, {0}, 0.0}, {0, 0.5, {0}, 0.3}, {0, 0.99, {0}, 1.0}}},
    {"ct",
     NULL,
     4.0,
     5,
     {{0, 0.0, {0.40, 0.10, 0.05}, 0.0},
      {0, 0.2, {0.60, 0.22, 0.12}, 0.04},
      {1, 0.0, {0.80, 0.42, 0.25}, 0.06},
      {1, 0.4, {0.95, 0.85, 0.68}, 0.7},
      {1, 0.95, {1.0, 0.98, 0.93}, 1.0}}},
    {"mr",
     NULL,
     3.0,
     4,
     {{0, 0.0, {0.10, 0.04, 0.03}, 0.0},
      {0, 0.5, {0.45, 0.25, 0.18}, 0.12},
      {0, 0.9, {0.85, 0.70, 0.55}, 0.5},
      {0, 0.99, {1.0, 0.97, 0.90}, 1.0}}}};

enum { PRESETS_COUNT = sizeof PRESETS / sizeof *PRESETS };

static const struct preset *find(const char *name) {
    for (int i = 0; i < PRESETS_COUNT; i++)
        if (strcmp(name, PRESETS[i].name) == 0)
            return &PRESETS[i];
    return NULL;
}

bool transfer_preset_is(const char *name) {
    return find(name) != NULL;
}

const char *transfer_preset_names(void) {
    return "auto|ct|mr";
}

/* ---- The histogram ---- */

static double middle_of(const leafcast_histogram *h, uint32_t bin) {
    return 0.5 * h->edges[bin] + 0.5 * h->edges[bin + 1];
}

/* Returns the value below which this share of the samples lies, of the bins from `first` on. */
static double percentile(const leafcast_histogram *h, uint32_t first, double share) {
    double count = 0.0;
    for (uint32_t i = first; i < h->end; i++)
        count += h->samples[i];
    double left = share * count;
    for (uint32_t i = first; i < h->end; i++) {
        const double here = h->samples[i];
        if (left <= here && here > 0.0)
            return h->edges[i] + left / here * (h->edges[i + 1] - h->edges[i]);
        left -= here;
    }
    return h->edges[h->end];
}

/* ---- The function ---- */

/* Add a point for each row, with its weight as extinction. */
static status weigh(const struct preset *p, const leafcast_histogram *h, transfer_list *colours,
                    transfer_list *extinctions) {
    uint32_t first[2];
    double before = -INFINITY;
    status st = ST_OK;
    first[0] = histogram_parting(h->edges, h->samples, h->first, h->end);
    first[1] = histogram_parting(h->edges, h->samples, first[0], h->end);
    for (int i = 0; i < p->count && st == ST_OK; i++) {
        const row *r = &p->rows[i];
        leafcast_transfer_point point = {.value = percentile(h, first[r->above], r->share),
                                         .extinction = r->weight};
        /* Make points that are too close a step, as in a field of one value. */
        if (!(point.value - before >= LEAFCAST_TRANSFER_NARROWEST))
            point.value = before;
        memcpy(point.rgb, r->rgb, sizeof point.rgb);
        before = point.value;
        st = transfer_list_add(extinctions, point);
        if (st == ST_OK && !p->map)
            st = transfer_list_add(colours, point);
    }
    return st;
}

static double mean_weight(const leafcast_histogram *h, const transfer_list *t) {
    double sum = 0.0, count = 0.0;
    for (uint32_t i = h->first; i < h->end; i++) {
        sum += h->samples[i] * transfer_list_at(t, middle_of(h, i), true).extinction;
        count += h->samples[i];
    }
    return count > 0.0 ? sum / count : 0.0;
}

/* Scale extinctions to the wanted average depth of the diagonal. The limit for very sparse volumes
 * is an optical depth of 5 over a 500th of the diagonal. */
static void scale(transfer_list *t, double depth, double mean, double length) {
    enum { STRONGEST = 2500 };
    const double factor =
        length > 0.0 ? fmin(mean > 0.0 ? depth / mean : 0.0, STRONGEST) / length : 0.0;
    for (size_t i = 0; i < t->count; i++)
        t->points[i].extinction *= isfinite(factor) ? factor : 0.0;
}

status transfer_preset_make(const char *name, const leafcast_histogram *h, double length,
                            transfer_list *colours, transfer_list *extinctions) {
    const struct preset *p = find(name);
    status st = ST_OK;
    if (h->bins == 0) {
        st = transfer_list_add(colours, (leafcast_transfer_point){0});
        return st == ST_OK ? transfer_list_add(extinctions, (leafcast_transfer_point){0}) : st;
    }
    st = weigh(p, h, colours, extinctions);
    if (st == ST_OK && p->map)
        st = colour_map_named(p->map, colours);
    if (st != ST_OK)
        return st;
    if (p->map)
        transfer_list_stretch(colours, (const double[2]){0.0, 1.0},
                              (const double[2]){extinctions->points[0].value,
                                                extinctions->points[extinctions->count - 1].value});
    scale(extinctions, p->depth, mean_weight(h, extinctions), length);
    return ST_OK;
}
