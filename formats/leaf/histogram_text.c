#include "formats/leaf/histogram_text.h"

#include <math.h>
#include <string.h>

#include "formats/base/num.h"

enum { ROWS = 24, BAR = 40 };

/* A printed row of bins. Tails and a marker's bins, at the ends, have rows of their own. The others
 * have equally many bins each. */
typedef struct row {
    uint32_t first, end;
    uint64_t samples;
} row;

static bool is_tail(const histogram *h, uint32_t bin) {
    uint32_t data[2];
    histogram_marker marker;
    if (histogram_data(h, data, &marker) && (bin < data[0] || bin >= data[1]))
        return true;
    if (bin != data[0] && bin + 1 != data[1])
        return false;
    const uint32_t inner = data[1] - data[0] > 2 ? data[0] + 1 : data[0];
    const double width = h->edges[inner + 1] - h->edges[inner];
    return h->edges[bin + 1] - h->edges[bin] > 4 * width;
}

static int make_rows(const histogram *h, row rows[ROWS + 4]) {
    const uint32_t each = (h->bins + ROWS - 1) / ROWS;
    int count = 0;
    for (uint32_t k = 0; k < h->bins;) {
        row r = {.first = k, .end = k + each < h->bins ? k + each : h->bins};
        if (is_tail(h, k))
            r.end = k + 1;
        while (r.end > r.first + 1 && is_tail(h, r.end - 1))
            r.end--;
        for (; k < r.end; k++)
            r.samples += h->samples[k];
        rows[count++] = r;
    }
    return count;
}

static bool suggested(const histogram *h, const row *r, const double *isovalues, int count) {
    for (int i = 0; i < count; i++)
        if (isovalues[i] >= h->edges[r->first] && isovalues[i] < h->edges[r->end])
            return true;
    return false;
}

static int suggestions(const histogram *h, bool any, double isovalues[HISTOGRAM_ISOVALUES]) {
    return any ? histogram_suggest(h, isovalues, HISTOGRAM_ISOVALUES) : 0;
}

void histogram_print(FILE *to, const histogram *h, const char *what, bool isovalues) {
    row rows[ROWS + 4];
    double marked[HISTOGRAM_ISOVALUES], most = 0;
    if (h->bins == 0)
        return;
    const int count = make_rows(h, rows);
    const int marks = suggestions(h, isovalues, marked);
    const char *legend = isovalues ? ", * a suggested isovalue" : "";
    for (int i = 0; i < count; i++)
        most = fmax(most, cbrt((double)rows[i].samples));
    if (h->drawn == h->total)
        fprintf(to, "\nhistogram of %llu %s, bars by cube roots%s\n", (unsigned long long)h->total,
                what, legend);
    else
        fprintf(to, "\nhistogram of %llu of %llu %s, bars by cube roots%s\n",
                (unsigned long long)h->drawn, (unsigned long long)h->total, what, legend);
    for (int i = 0; i < count; i++) {
        const row *r = &rows[i];
        char bar[BAR + 1] = "";
        const double share = (double)r->samples / (double)(h->drawn ? h->drawn : 1);
        memset(bar, '#', (size_t)lround(BAR * cbrt((double)r->samples) / fmax(most, 1e-9)));
        fprintf(to, "%12.6g .. %-12.6g %c %7.3f %% %s\n", h->edges[r->first], h->edges[r->end],
                suggested(h, r, marked, marks) ? '*' : ' ', 100 * share, bar);
    }
}

void histogram_print_isovalues(FILE *to, const histogram *h, bool isovalues) {
    double best[HISTOGRAM_ISOVALUES];
    uint32_t data[2];
    histogram_marker marker;
    char value[NUM_TEXT_MAX];
    if (histogram_data(h, data, &marker))
        fprintf(to, "aside       %s, in %.3g %%: may stand for no data (convert --missing=%s)\n",
                num_print_float((float)marker.value, value), 100 * marker.share, value);
    const int count = suggestions(h, isovalues, best);
    char text[NUM_TEXT_MAX];
    for (int i = 0; i < count; i++)
        fprintf(to, "%s%s", i ? ", " : "isovalues   ", num_print(best[i], text));
    if (count)
        fprintf(to, " (suggested, best first)\n");
}

json_t *histogram_json(const histogram *h, bool isovalues) {
    double best[HISTOGRAM_ISOVALUES];
    const int count = suggestions(h, isovalues, best);
    json_t *edges = json_array(), *samples = json_array(), *active = json_array(),
           *gradient = json_array(), *area = json_array(), *suggestions = json_array();
    for (uint32_t k = 0; k < h->bins; k++) {
        json_array_append_new(edges, json_real(h->edges[k]));
        json_array_append_new(samples, json_integer(h->samples[k]));
        json_array_append_new(active, json_integer(h->active[k]));
        json_array_append_new(gradient, json_real((double)h->gradient[k]));
        json_array_append_new(area, json_real((double)h->area[k]));
    }
    if (h->bins)
        json_array_append_new(edges, json_real(h->edges[h->bins]));
    for (int i = 0; i < count; i++)
        json_array_append_new(suggestions, json_real(best[i]));
    uint32_t data[2];
    histogram_marker marker;
    json_t *aside = histogram_data(h, data, &marker) ? json_real(marker.value) : json_null();
    return json_pack("{s:I, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "total",
                     (json_int_t)h->total, "drawn", (json_int_t)h->drawn, "cells",
                     (json_int_t)h->cells, "edges", edges, "samples", samples, "active", active,
                     "gradient", gradient, "area", area, "suggested", suggestions, "aside", aside);
}
