#include "formats/leaf/histogram.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* ---- edges ---- */

enum { QUANTILE_DRAWS = 2048 };

/* A bound of edges: values are floats, and edges lie just beyond them. */
static const double EDGE_MAX = 0x1p128;

static int compare_floats(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static bool changes(const histogram_cell *c, const double within[2]) {
    return c->lo < c->hi && (double)c->lo >= within[0] && (double)c->hi <= within[1];
}

/* Set bulk[] to the values that nearly all cells have, without the outermost 0.2 % at either end.
 * Count only cells inside `within` whose value changes. Sort a regular selection of them, for
 * speed. Returns false if there are none, or bulk[] is empty. */
static bool bulk_of(const histogram_cell *cells, uint32_t count, const double within[2],
                    double bulk[2]) {
    float ends[2][QUANTILE_DRAWS];
    uint32_t changing = 0, seen = 0, n = 0;
    for (uint32_t i = 0; i < count; i++)
        changing += changes(&cells[i], within);
    const uint32_t every = changing / QUANTILE_DRAWS + 1;
    for (uint32_t i = 0; i < count; i++)
        if (changes(&cells[i], within) && seen++ % every == 0) {
            ends[0][n] = cells[i].lo;
            ends[1][n++] = cells[i].hi;
        }
    if (n == 0)
        return false;
    for (int side = 0; side < 2; side++)
        qsort(ends[side], n, sizeof(float), compare_floats);
    const uint32_t tail = n / 500;
    bulk[0] = (double)ends[0][tail];
    bulk[1] = (double)ends[1][n - 1 - tail];
    return bulk[0] < bulk[1];
}

static bool whole(sample_type type) {
    return type != SAMPLE_F32;
}

/* Append bins of equal width from a to b. */
static void add_bins(histogram *h, double a, double b, uint32_t bins, bool integers) {
    double step = (b - a) / bins;
    if (integers) {
        step = ceil(step);
        bins = (uint32_t)ceil((b - a) / step);
    }
    for (uint32_t i = 0; i < bins; i++)
        h->edges[h->bins++] = a + i * step;
    h->edges[h->bins] = b;
}

/* Make the edges for the values in a range. most: the number of bins allowed. */
static void make_edges(histogram *h, const histogram_cell *cells, uint32_t count, sample_type type,
                       const double range[2], uint32_t most) {
    const bool integers = whole(type);
    const double lo = integers ? range[0] - 0.5 : range[0];
    const double hi = integers ? range[1] + 0.5 : nextafter(range[1], (double)INFINITY);
    double bulk[2], width;
    if ((integers && hi - lo <= most) || !bulk_of(cells, count, range, bulk) ||
        hi - lo <= 4 * (width = bulk[1] - bulk[0])) {
        const uint32_t bins = range[0] < range[1] ? most : 1;
        add_bins(h, lo, hi, integers && hi - lo < bins ? (uint32_t)(hi - lo) : bins, integers);
        return;
    }
    double a = bulk[0] - width / 16, b = bulk[1] + width / 16;
    if (integers) {
        a = floor(a) - 0.5;
        b = floor(b) + 0.5;
    }
    a = a > lo ? a : lo;
    b = b < hi ? b : hi;
    if (a > lo)
        h->edges[h->bins++] = lo;
    add_bins(h, a, b, most - 2, integers);
    if (b < hi)
        h->edges[++h->bins] = hi;
}

/* Add the marker's bin, which holds nothing else, and the gap beside it, at the left or right
 * end. */
static void add_marker(histogram *h, double value, sample_type type) {
    const double own[2] = {whole(type) ? value - 0.5 : value,
                           whole(type) ? value + 0.5 : nextafter(value, (double)INFINITY)};
    const bool left = value < h->edges[0];
    if (left)
        memmove(h->edges + 2, h->edges, (h->bins + 1) * sizeof *h->edges);
    memcpy(h->edges + (left ? 0 : h->bins + 1), own, sizeof own);
    h->bins += 2;
}

/* ---- counting ---- */

/* Guesses the bin of a value: bins have equal width, except one or two at the ends. */
typedef struct ruler {
    double origin, per;
    const double *edges;
    int32_t bins;
} ruler;

static ruler ruler_of(const histogram *h) {
    ruler r = {.edges = h->edges, .bins = (int32_t)h->bins};
    const uint32_t i = h->bins / 2;
    r.origin = h->edges[i] - i * (h->edges[i + 1] - h->edges[i]);
    r.per = 1 / (h->edges[i + 1] - h->edges[i]);
    return r;
}

/* The index of the last edge at or below v, up to `bins`; -1: there is none. */
static int32_t last_edge(const ruler *r, float value) {
    const double v = (double)value, guess = (v - r->origin) * r->per;
    int32_t i = !(guess > 0) ? 0 : guess < r->bins ? (int32_t)guess : r->bins;
    while (i >= 0 && r->edges[i] > v)
        i--;
    while (i < r->bins && r->edges[i + 1] <= v)
        i++;
    return i;
}

static void widen(uint8_t box[6], const uint8_t position[3], bool first) {
    for (int a = 0; a < 3; a++) {
        box[a] = first || position[a] < box[a] ? position[a] : box[a];
        box[3 + a] = first || position[a] > box[3 + a] ? position[a] : box[3 + a];
    }
}

void histogram_count(histogram *h, const histogram_cell *cells, uint32_t count, uint64_t total) {
    double slope[HISTOGRAM_BINS] = {0}, area[HISTOGRAM_BINS] = {0};
    h->drawn = h->cells = 0;
    h->total = total;
    memset(h->samples, 0, sizeof h->samples);
    memset(h->active, 0, sizeof h->active);
    memset(h->gradient, 0, sizeof h->gradient);
    memset(h->area, 0, sizeof h->area);
    memset(h->box, 0, sizeof h->box);
    if (h->bins == 0)
        return;
    const ruler r = ruler_of(h);
    for (uint32_t i = 0; i < count; i++) {
        const histogram_cell *c = &cells[i];
        const int32_t bin = isnan(c->value) ? -1 : last_edge(&r, c->value);
        if (bin >= 0 && bin < r.bins) {
            h->samples[bin]++;
            h->drawn++;
        }
        if (c->lo > c->hi)
            continue;
        h->cells++;
        const int32_t from = last_edge(&r, c->lo) + 1, to = last_edge(&r, c->hi);
        for (int32_t k = from; k <= to && k < r.bins; k++) {
            widen(h->box[k], c->position, h->active[k]++ == 0);
            slope[k] += (double)c->slope;
            area[k] += (double)c->area;
        }
    }
    for (uint32_t k = 0; k < h->bins; k++)
        if (h->active[k]) {
            h->gradient[k] = histogram_limited(slope[k] / h->active[k]);
            h->area[k] = histogram_limited(area[k] * ((double)total / count));
        }
}

void histogram_build(histogram *h, const histogram_cell *cells, uint32_t count, sample_type type,
                     const double range[2], uint64_t total) {
    histogram_marker marker;
    memset(h, 0, sizeof *h);
    if (histogram_find_marker(cells, count, range, &marker)) {
        const bool low = marker.value == range[0];
        const double others[2] = {low ? marker.others[0] : range[0],
                                  low ? range[1] : marker.others[1]};
        make_edges(h, cells, count, type, others, HISTOGRAM_BINS - 2);
        add_marker(h, marker.value, type);
    } else if (range[0] <= range[1])
        make_edges(h, cells, count, type, range, HISTOGRAM_BINS);
    histogram_count(h, cells, count, total);
}

static const char *edges_fault(const histogram *h) {
    const uint32_t used = h->bins > 0 ? h->bins + 1 : 0;
    for (uint32_t i = 0; i <= HISTOGRAM_BINS; i++) {
        if (i < used && !(fabs(h->edges[i]) <= EDGE_MAX))
            return "edges that are no values";
        if (i < h->bins && !(h->edges[i] < h->edges[i + 1]))
            return "edges that do not ascend";
        if (i >= used && h->edges[i] != 0)
            return "edges behind the last bin";
    }
    return NULL;
}

const char *histogram_fault(const histogram *h) {
    if (h->bins > HISTOGRAM_BINS)
        return "more bins than 256";
    const char *fault = edges_fault(h);
    if (fault)
        return fault;
    uint64_t drawn = 0;
    for (uint32_t i = 0; i < HISTOGRAM_BINS; i++) {
        const bool used = i < h->bins;
        drawn += h->samples[i];
        if (h->active[i] > h->cells || !(h->gradient[i] >= 0) || !(h->area[i] >= 0) ||
            isinf(h->gradient[i]) || isinf(h->area[i]))
            return "a bin that cannot be";
        if ((!used && (h->samples[i] || h->active[i])) ||
            (!h->active[i] && (h->gradient[i] != 0 || h->area[i] != 0)))
            return "something in a bin that is empty";
        for (int a = 0; a < 3; a++)
            if (h->box[i][a] > h->box[i][a + 3])
                return "a box that ends before it begins";
        for (int a = 0; a < 6 && !h->active[i]; a++)
            if (h->box[i][a])
                return "a box without cells";
    }
    if (h->reserved0 || h->reserved[0] || h->reserved[1] || h->reserved[2])
        return "reserved bytes that are not 0";
    return drawn == h->drawn ? NULL : "counts that do not add up";
}

/* ---- what is worth a look ---- */

/* The rule "sharp and large". The score of an isovalue is the mean gradient g at its surface times
 * the surface's size. The size is a length: the fifth root of A V, where A is the surface's area
 * and V the volume of the smaller of its two sides. Boundaries of things score high. Noise has a
 * large area but a small gradient; bright specks have a large gradient but hardly any size. Area
 * alone (g A) chose the noise in 6 of 27 scans and simulations, volume alone (g cbrt V) the rim in
 * one; this rule in none.
 *
 * g^5 A V gives the same order and needs no root. g and A are relative to their greatest values,
 * and averaged over some bins, with greater weights for nearer ones. Between two materials,
 * isovalues are nearly equally good: the middle one is taken. Further suggestions are other
 * peaks. */

enum { SMOOTHING = 2, PEAK_WIDTH = HISTOGRAM_BINS / 16 };

static void smooth(const float *from, int bins, double to[HISTOGRAM_BINS]) {
    double most = 0;
    for (int k = 0; k < bins; k++) {
        double sum = 0, weights = 0;
        for (int d = -SMOOTHING; d <= SMOOTHING; d++)
            if (k + d >= 0 && k + d < bins) {
                const double weight = SMOOTHING + 1 - abs(d);
                sum += (double)from[k + d] * weight;
                weights += weight;
            }
        to[k] = sum / weights;
        most = fmax(most, to[k]);
    }
    for (int k = 0; k < bins && most > 0; k++)
        to[k] /= most;
}

/* A mesh is material throughout: no air, no noise. Where its gradient is greatest there are often
 * only corners and notches, which says nothing of the rest. So there area and volume count alone,
 * g A V, and at least one sample in TAIL lies beyond an isovalue, on either side. */
enum { TAIL = 100 };

static bool is_mesh(const histogram *h) {
    static const uint8_t none[6];
    for (uint32_t k = 0; k < h->bins; k++)
        if (memcmp(h->box[k], none, sizeof none) != 0)
            return false;
    return h->bins > 0;
}

/* Whether enough lies beyond the bins at both sides of an edge: what is suggested may be half a bin
 * from it. */
static bool in_bulk(const histogram *h, int k, uint64_t below) {
    const uint64_t before = k > 0 ? h->samples[k - 1] : 0, behind = h->samples[k];
    return (below - before) * TAIL >= h->drawn && (h->drawn - below - behind) * TAIL >= h->drawn;
}

/* Returns whether any isovalue has a score. tails: take those of a mesh that have hardly anything
 * beyond, too. */
static bool scores_of(const histogram *h, bool tails, double score[HISTOGRAM_BINS]) {
    const int bins = (int)h->bins;
    const bool mesh = is_mesh(h);
    double gradient[HISTOGRAM_BINS], area[HISTOGRAM_BINS];
    uint64_t below = 0;
    bool any = false;
    smooth(h->gradient, bins, gradient);
    smooth(h->area, bins, area);
    for (int k = 0; k < bins; k++) {
        const uint64_t above = h->drawn - below;
        const double g = gradient[k], volume = (double)(below < above ? below : above);
        const double sharp = mesh ? g : g * g * g * g * g;
        const bool taken = h->active[k] && (!mesh || tails || in_bulk(h, k, below));
        score[k] = taken ? sharp * area[k] * volume : 0;
        any = any || score[k] > 0;
        below += h->samples[k];
    }
    return any;
}

/* The shortest decimal within half a bin of an edge; the edge itself if the bin is one
 * integer's. */
static double shortened(const histogram *h, int k) {
    const double edge = h->edges[k];
    const double width = fmin(h->edges[k + 1] - edge, k > 0 ? edge - h->edges[k - 1] : INFINITY);
    double unit = 1;
    if (width == 1 && edge != floor(edge))
        return edge;
    if (width >= 1) {
        while (unit * 10 <= width)
            unit *= 10;
        return unit * nearbyint(edge / unit);
    }
    while (unit * width < 1 && unit < 1e22)
        unit *= 10;
    return unit < 1e22 ? nearbyint(edge * unit) / unit : edge;
}

/* The middle of the bins on the right of bin k that are nearly as good as k. */
static int middle(const double *score, int bins, int k) {
    int end = k;
    while (end + 1 < bins && score[end + 1] >= 0.999 * score[k])
        end++;
    return (k + end) / 2;
}

static double middle_of(const double *edges, uint32_t bin) {
    return 0.5 * edges[bin] + 0.5 * edges[bin + 1];
}

uint32_t histogram_parting(const double *edges, const uint32_t *samples, uint32_t from,
                           uint32_t to) {
    double count = 0.0, sum = 0.0, below = 0.0, sum_below = 0.0, best = 0.0;
    uint32_t found = from;
    /* Relative to the first middle, so that far from 0 no digits are lost. */
    const double origin = middle_of(edges, from);
    for (uint32_t i = from; i < to; i++) {
        count += samples[i];
        sum += samples[i] * (middle_of(edges, i) - origin);
    }
    for (uint32_t i = from; i + 1 < to; i++) {
        below += samples[i];
        sum_below += samples[i] * (middle_of(edges, i) - origin);
        if (!(below > 0.0 && below < count))
            continue;
        const double apart = sum_below / below - (sum - sum_below) / (count - below);
        /* Divide first: values may be as large as floats can be. */
        const double parted = below / count * (1.0 - below / count) * apart * apart;
        if (parted > best) {
            best = parted;
            found = i + 1;
        }
    }
    return found;
}

/* Beside a marker gradients say nothing: in the cells between it and the data they are far larger
 * than the data's own, at every isovalue. So suggest where the data split into two, then where the
 * upper part does, then the lower. */
static int suggest_partings(const histogram *h, const uint32_t bins[2], double *isovalues,
                            int most) {
    const uint32_t first = histogram_parting(h->edges, h->samples, bins[0], bins[1]);
    const uint32_t parts[3][2] = {{bins[0], bins[1]}, {first, bins[1]}, {bins[0], first}};
    int count = 0;
    for (int i = 0; i < 3 && count < most; i++) {
        const uint32_t k = histogram_parting(h->edges, h->samples, parts[i][0], parts[i][1]);
        if (k > parts[i][0])
            isovalues[count++] = shortened(h, (int)k);
    }
    return count;
}

int histogram_suggest(const histogram *h, double *isovalues, int most) {
    const int bins = (int)h->bins;
    uint32_t data[2];
    histogram_marker marker;
    if (histogram_data(h, data, &marker))
        return suggest_partings(h, data, isovalues, most);
    double score[HISTOGRAM_BINS];
    bool peak[HISTOGRAM_BINS];
    int count = 0;
    if (!scores_of(h, false, score)) /* nearly all have the same value */
        (void)scores_of(h, true, score);
    for (int k = 0; k < bins; k++) {
        peak[k] = score[k] > 0;
        for (int i = k - PEAK_WIDTH; i <= k + PEAK_WIDTH; i++)
            if (i >= 0 && i < bins && (i < k ? score[i] >= score[k] : score[i] > score[k]))
                peak[k] = false;
    }
    for (; count < most; count++) {
        int best = -1;
        for (int k = 0; k < bins; k++)
            if (peak[k] && (best < 0 || score[k] > score[best]))
                best = k;
        if (best < 0)
            break;
        peak[best] = false;
        isovalues[count] = shortened(h, middle(score, bins, best));
    }
    return count;
}

/* ---- missing data ---- */

static const double MARKER_SHARE = 1e-3, MARKER_TIMES = 10.0;

static bool is_marker(const histogram_cell *cells, uint32_t count, double value,
                      histogram_marker *found) {
    uint32_t at = 0, seen = 0;
    double lo = (double)INFINITY, hi = -lo;
    for (uint32_t i = 0; i < count; i++) {
        const double v = (double)cells[i].value;
        if (isnan(v))
            continue;
        seen++;
        at += v == value;
        lo = v == value ? lo : fmin(lo, v);
        hi = v == value ? hi : fmax(hi, v);
    }
    *found = (histogram_marker){value, (double)at / seen, {lo, hi}};
    return lo < hi && found->share >= MARKER_SHARE &&
           fabs(value) > MARKER_TIMES * fmax(fabs(lo), fabs(hi));
}

bool histogram_find_marker(const histogram_cell *cells, uint32_t count, const double range[2],
                           histogram_marker *out) {
    for (int side = 0; side < 2; side++) {
        histogram_marker found;
        if (!is_marker(cells, count, range[side], &found))
            continue;
        *out = found;
        return true;
    }
    return false;
}

/* Whether a bin can hold only one value, and which. */
static bool alone(const histogram *h, uint32_t bin, double *value) {
    const double lo = h->edges[bin], hi = h->edges[bin + 1];
    const bool integer = hi - lo == 1 && lo - floor(lo) == 0.5;
    *value = integer ? lo + 0.5 : lo;
    return integer || hi == nextafter(lo, (double)INFINITY);
}

bool histogram_data(const histogram *h, uint32_t bins[2], histogram_marker *out) {
    bins[0] = 0;
    bins[1] = h->bins;
    for (int side = 0; side < 2 && h->bins >= 3; side++) {
        const uint32_t own = side ? h->bins - 1 : 0, gap = side ? own - 1 : 1;
        const uint32_t first = side ? 0 : 2, end = side ? gap : h->bins;
        const double share = (double)h->samples[own] / (double)h->drawn;
        const double others[2] = {h->edges[first], h->edges[end]};
        double value;
        if (!alone(h, own, &value) || h->samples[gap] || !(share >= MARKER_SHARE) ||
            !(h->edges[gap + 1] - h->edges[gap] > others[1] - others[0]))
            continue;
        *out = (histogram_marker){value, share, {others[0], others[1]}};
        bins[0] = first;
        bins[1] = end;
        return true;
    }
    return false;
}
