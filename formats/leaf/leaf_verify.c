#include "formats/leaf/leaf_verify.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/base/pool.h"
#include "formats/leaf/deviation_verify.h"
#include "formats/leaf/grid_codes.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_histogram.h"
#include "formats/leaf/leaf_order.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/quantize.h"

enum {
    BLOCK = 1 << LEAF_BLOCK_LOG2,
    PROGRESS_STEP = 64,
    SLICE_MAX = ((1 << LEAF_CELLS_LOG2_MAX) + 3) * 3 * 4
};

/* Neighbours share samples. These are hashes, per axis, of the samples that a treelet shares with
 * the one before and the one behind it. */
typedef struct shared {
    uint64_t before[3], behind[3];
} shared;

typedef struct verification {
    leaf_file *f;
    const progress *p;
    uint32_t set;         /* grid: the set being checked */
    shared *edges;        /* per treelet of this set */
    uint64_t *non_finite; /* per treelet of level 0: of samples at nodes that no treelet behind it
                             has, in all sets; mesh: of all its vertices' values */
    /* Per thread. payloads: what the row's room() says; of a grid, grid_room. */
    char **payloads;
    leaf_unpacker **unpackers;
    /* For histograms; cells is NULL where the file has none. */
    histogram_draw draw;
    histogram_space space;
    size_t count;          /* cells of a set, at most */
    histogram_cell *cells; /* set after set */
} verification;

/* Where a thread's room for a grid has what lies behind the payload. */
typedef struct grid_room {
    size_t codes, scratch, deviations, bytes;
} grid_room;

static grid_room grid_room_of(const leaf_file *f) {
    const leaf_layout *l = &f->layout;
    grid_room r = {.codes = leaf_layout_aligned(leaf_layout_payload_max(l), LEAF_ALIGN_LOG2)};
    r.scratch =
        leaf_layout_aligned(r.codes + leaf_layout_payload(l, 0).samples_at, LEAF_ALIGN_LOG2);
    r.deviations = leaf_layout_aligned(r.scratch + grid_codes_scratch_bytes(leaf_node_levels(l)),
                                       LEAF_ALIGN_LOG2);
    r.bytes = r.deviations + (f->deviations ? deviation_verify_bytes(l) : 0);
    return r;
}

/* One treelet while it is checked. */
typedef struct subject {
    const leaf_file *f;
    uint32_t t, element; /* element: its payload, and its element of OWN and FLAGS */
    leaf_payload p;
    uint8_t *bytes;
    const void *samples;
    sample_type type;
    uint32_t halo;
} subject;

__attribute__((format(printf, 3, 4))) static status wrong(const subject *s, uint64_t at,
                                                          const char *fmt, ...) {
    char text[STATUS_TEXT_MAX / 2];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    const char *path = file_path(s->f->source);
    if (leaf_file_is_raw(s->f, s->element))
        return status_describe(ST_CORRUPT, "%s: byte %llu: treelet %u: %s", path,
                               (unsigned long long)(s->f->offsets[s->element] + at), s->t, text);
    return status_describe(ST_CORRUPT, "%s: treelet %u: byte %llu of its payload: %s", path, s->t,
                           (unsigned long long)at, text);
}

/* ---- one treelet ---- */

static status check_zero(const subject *s, uint32_t from, uint32_t to) {
    for (uint32_t i = from; i < to; i++)
        if (s->bytes[i])
            return wrong(s, i, "expected 0 as padding, found %u", s->bytes[i]);
    return ST_OK;
}

static size_t sample_index(const subject *s, uint32_t x, uint32_t y, uint32_t z) {
    return x + (size_t)s->p.samples[0] * (y + (size_t)s->p.samples[1] * z);
}

/* Set range[] to the least and the greatest finite sample at the treelet's own nodes, without the
 * halo, from first to last, both included. range[0] > range[1]: there is none. Sets *non_finite if
 * any sample is not finite. */
static void range_of(const subject *s, const uint32_t first[3], const uint32_t last[3],
                     float range[2], bool *non_finite) {
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (uint32_t z = first[2]; z <= last[2]; z++)
        for (uint32_t y = first[1]; y <= last[1]; y++)
            for (uint32_t x = first[0]; x <= last[0]; x++) {
                float v = sample_get(s->type, s->samples,
                                     sample_index(s, x + s->halo, y + s->halo, z + s->halo));
                if (!isfinite(v)) {
                    *non_finite = true;
                    continue;
                }
                range[0] = v < range[0] ? v : range[0];
                range[1] = v > range[1] ? v : range[1];
            }
}

static status check_own_range(const subject *s) {
    static const uint32_t origin[3] = {0, 0, 0};
    float range[2];
    bool non_finite = false;
    range_of(s, origin, s->p.cells, range, &non_finite);
    const float *own = s->f->own[s->element];
    if (range[0] != own[0] || range[1] != own[1])
        return wrong(s, s->p.samples_at, "expected samples in exactly %g .. %g, found %g .. %g",
                     (double)own[0], (double)own[1], (double)range[0], (double)range[1]);
    if (non_finite != ((s->f->flags[s->element] & LEAF_FLAG_NON_FINITE) != 0))
        return wrong(s, s->p.samples_at, "expected %s non-finite samples, as its flags say",
                     non_finite ? "no" : "some");
    return ST_OK;
}

static status check_code(const subject *s, uint32_t at, const char *what, unsigned expected) {
    if (s->bytes[at] == expected)
        return ST_OK;
    return wrong(s, at, "expected the %s code %u, found %u", what, expected, s->bytes[at]);
}

/* Check block m of the last tree level: its codes follow from its samples. */
static status check_block(const subject *s, const quantizer *q, uint32_t m) {
    uint32_t first[3] = {0, 0, 0}, last[3];
    for (unsigned bit = 0; bit < s->p.node_levels; bit++)
        for (unsigned a = 0; a < 3; a++)
            first[a] |= (m >> (3 * bit + a) & 1) << (bit + LEAF_BLOCK_LOG2);
    float range[2] = {INFINITY, -INFINITY};
    bool inside = true, non_finite = false;
    for (unsigned a = 0; a < 3; a++) {
        inside &= first[a] < s->p.cells[a];
        last[a] = first[a] + BLOCK < s->p.cells[a] ? first[a] + BLOCK : s->p.cells[a];
    }
    if (inside)
        range_of(s, first, last, range, &non_finite);
    bool empty = range[0] > range[1];
    uint32_t at = leaf_codes_at(s->p.node_levels) + m, blocks = 1u << (3 * s->p.node_levels);
    status st = check_code(s, at, "lowest", empty ? 255 : quantizer_floor(q, (double)range[0]));
    return st == ST_OK ? check_code(s, at + blocks, "highest",
                                    empty ? 0 : quantizer_ceil(q, (double)range[1]))
                       : st;
}

/* Check node m of tree level k: it has the smallest and largest code of its eight children. */
static status check_node(const subject *s, uint32_t k, uint32_t m) {
    uint32_t nodes = 1u << (3 * k);
    const uint8_t *lo = s->bytes + leaf_codes_at(k + 1) + 8 * m, *hi = lo + 8 * nodes;
    unsigned least = 255, most = 0;
    for (int c = 0; c < 8; c++) {
        least = lo[c] < least ? lo[c] : least;
        most = hi[c] > most ? hi[c] : most;
    }
    status st = check_code(s, leaf_codes_at(k) + m, "lowest", least);
    return st == ST_OK ? check_code(s, leaf_codes_at(k) + nodes + m, "highest", most) : st;
}

/* Look whether samples, own range, flags and codes are as they would be made: then there is nothing
 * to find in them. This is much faster than one by one. */
static bool is_remade(const subject *s, char *codes, void *scratch) {
    const float *own = s->f->own[s->element];
    memcpy(codes, s->bytes, s->p.samples_at);
    const grid_summary g = grid_codes_make(&s->f->layout, s->t, scratch, s->bytes);
    const bool same = memcmp(codes, s->bytes, s->p.samples_at) == 0;
    memcpy(s->bytes, codes, s->p.samples_at);
    return same && g.own[0] == own[0] && g.own[1] == own[1] && g.flags == s->f->flags[s->element];
}

static status check_codes(const subject *s) {
    const float *own = s->f->own[s->element];
    quantizer q = quantizer_of(own[0], own[1], s->type);
    for (uint32_t m = 0; m < 1u << (3 * s->p.node_levels); m++) {
        status st = check_block(s, &q, m);
        if (st != ST_OK)
            return st;
    }
    for (uint32_t k = s->p.node_levels - 1; k >= 1; k--)
        for (uint32_t m = 0; m < 1u << (3 * k); m++) {
            status st = check_node(s, k, m);
            if (st != ST_OK)
                return st;
        }
    return ST_OK;
}

/* The index, along one axis, of the nearest sample that lies in the volume. */
static uint32_t nearest_inside(const subject *s, int axis, uint32_t i) {
    const leaf_level *v = &s->f->layout.level[s->f->layout.level_of[s->t]];
    int64_t first = ((int64_t)s->f->layout.place[s->t][axis] << s->f->layout.cells_log2) - s->halo;
    int64_t node = first + i;
    node = node < 0 ? 0 : node >= v->dims[axis] ? v->dims[axis] - 1 : node;
    return (uint32_t)(node - first);
}

/* Whether the halo reaches out of the volume. */
static bool is_at_border(const subject *s) {
    bool at = false;
    for (int a = 0; a < 3; a++)
        at |= nearest_inside(s, a, 0) != 0 ||
              nearest_inside(s, a, s->p.samples[a] - 1) != s->p.samples[a] - 1;
    return at;
}

/* Check that samples outside the volume are copies of the nearest one inside. */
static status check_border(const subject *s) {
    if (!is_at_border(s))
        return ST_OK;
    const size_t size = sample_size(s->type);
    const char *samples = s->samples;
    for (uint32_t z = 0; z < s->p.samples[2]; z++)
        for (uint32_t y = 0; y < s->p.samples[1]; y++) {
            uint32_t inner_y = nearest_inside(s, 1, y), inner_z = nearest_inside(s, 2, z);
            bool outside = inner_y != y || inner_z != z;
            /* In a row that lies inside, only the ends can be outside. */
            uint32_t step = outside || s->p.samples[0] < 2 ? 1 : s->p.samples[0] - 1;
            for (uint32_t x = 0; x < s->p.samples[0]; x += step) {
                size_t here = sample_index(s, x, y, z);
                size_t there = sample_index(s, nearest_inside(s, 0, x), inner_y, inner_z);
                if (memcmp(samples + here * size, samples + there * size, size) != 0)
                    return wrong(s, s->p.samples_at + here * size,
                                 "expected a copy of the sample at the volume's border");
            }
        }
    return ST_OK;
}

/* ---- what treelets share ---- */

/* Hash the samples at positions [from, from + 1 + 2h) along an axis. Both neighbours on that axis
 * have them. */
static uint64_t hash_shared(const subject *s, int axis, uint32_t from) {
    const size_t size = sample_size(s->type);
    uint32_t first[3] = {0, 0, 0},
             last[3] = {s->p.samples[0] - 1, s->p.samples[1] - 1, s->p.samples[2] - 1};
    first[axis] = from;
    last[axis] = from + 2 * s->halo;
    uint64_t sums[2] = {0, 0};
    char slice[SLICE_MAX]; /* of what is shared along x or y; along z, a row */
    const size_t row = (last[0] - first[0] + 1) * size;
    for (uint32_t z = first[2]; z <= last[2]; z++) {
        size_t filled = 0;
        for (uint32_t y = first[1]; y <= last[1]; y++) {
            memcpy(slice + filled,
                   (const char *)s->samples + sample_index(s, first[0], y, z) * size, row);
            filled += row;
            if (filled + row <= sizeof slice && y < last[1])
                continue;
            sums[1] = hash_bytes(slice, filled);
            sums[0] = hash_bytes(sums, sizeof sums);
            filled = 0;
        }
    }
    return sums[0];
}

static void note_shared(const subject *s, shared *edges) {
    for (int a = 0; a < 3; a++) {
        edges->before[a] = hash_shared(s, a, 0);
        edges->behind[a] = hash_shared(s, a, s->p.samples[a] - 1 - 2 * s->halo);
    }
}

/* Count non-finite samples at nodes that no treelet behind has: all but those on the far faces,
 * which only the last treelet counts. */
static uint32_t count_non_finite(const subject *s) {
    const leaf_layout *l = &s->f->layout;
    uint32_t nodes[3], count = 0;
    for (int a = 0; a < 3; a++)
        nodes[a] = s->p.cells[a] + (l->place[s->t][a] + 1 == l->level[0].treelets[a]);
    for (uint32_t z = 0; z < nodes[2]; z++)
        for (uint32_t y = 0; y < nodes[1]; y++)
            for (uint32_t x = 0; x < nodes[0]; x++)
                count += !isfinite(sample_get(
                    s->type, s->samples, sample_index(s, x + s->halo, y + s->halo, z + s->halo)));
    return count;
}

/* NULL: of a grid, whose sets are checked one after the other. */
static const leaf_verifier *verifier_of(const leaf_file *f) {
    return f->geometry->verifier;
}

static status report(const verification *v, uint32_t t) {
    const leaf_layout *l = &v->f->layout;
    const double done = verifier_of(v->f) ? t : (double)v->set * l->treelets + t;
    const double all = verifier_of(v->f) ? l->treelets : (double)l->treelets * l->sets;
    return t % PROGRESS_STEP ? ST_OK : progress_step(v->p, "verify", done / all);
}

static status verify_treelet(void *ctx, size_t index, int worker) {
    const verification *v = ctx;
    leaf_file *f = v->f;
    const uint32_t t = (uint32_t)index, p = leaf_layout_samples(&f->layout, v->set, t);
    if (leaf_layout_is_bare(&f->layout, t))
        return report(v, t);
    status st = leaf_file_load(f, p, v->unpackers[worker], v->payloads[worker]);
    if (st == ST_OK)
        st = report(v, t);
    if (st != ST_OK)
        return st;
    subject s = {.f = f,
                 .t = t,
                 .element = p,
                 .p = leaf_layout_payload(&f->layout, t),
                 .type = f->layout.type,
                 .halo = f->layout.halo};
    const grid_room room = grid_room_of(f);
    s.bytes = (uint8_t *)v->payloads[worker];
    s.samples = s.bytes + s.p.samples_at;
    uint32_t end =
        s.p.samples_at + (uint32_t)(sample_index(&s, 0, 0, s.p.samples[2]) * sample_size(s.type));
    st = check_zero(&s, leaf_codes_at(s.p.node_levels + 1), s.p.samples_at);
    if (st == ST_OK)
        st = check_zero(&s, end, s.p.bytes);
    const bool remade = st == ST_OK && is_remade(&s, v->payloads[worker] + room.codes,
                                                 v->payloads[worker] + room.scratch);
    if (st == ST_OK && !remade)
        st = check_own_range(&s);
    if (st == ST_OK && !remade)
        st = check_codes(&s);
    if (st == ST_OK)
        st = check_border(&s);
    if (st == ST_OK)
        st = leaf_file_check_implied(f, p, v->unpackers[worker], v->payloads[worker]);
    if (st != ST_OK)
        return st;
    note_shared(&s, &v->edges[t]);
    if (f->deviations && f->layout.level_of[t] > 0)
        st = deviation_verify(f, v->set, t, s.bytes, v->unpackers[worker],
                              v->payloads[worker] + room.deviations);
    if (v->cells && f->layout.level_of[t] == 0)
        leaf_histogram_take(&f->layout, &v->draw, &v->space, t, s.bytes,
                            v->cells + v->set * v->count);
    if (f->layout.level_of[t] == 0 && (f->flags[p] & LEAF_FLAG_NON_FINITE))
        v->non_finite[t] += count_non_finite(&s);
    return st;
}

/* ---- a treelet of any other kind ---- */

static status load_payload(const leaf_verifying *v, uint32_t p, void *payload) {
    return leaf_file_load(v->f, p, v->unpacker, payload);
}

static status verify_by_row(void *ctx, size_t index, int worker) {
    const verification *v = ctx;
    const leaf_verifying one = {.f = v->f,
                                .room = v->payloads[worker],
                                .cells = v->cells,
                                .count = v->count,
                                .unpacker = v->unpackers[worker],
                                .load = load_payload};
    const status st = verifier_of(v->f)->treelet(&one, (uint32_t)index, &v->non_finite[index]);
    return st == ST_OK ? report(v, (uint32_t)index) : st;
}

/* ---- the whole file ---- */

/* Check that neighbouring treelets hold the same samples where they overlap. Corners follow from
 * faces, which are compared with their halos. */
static status check_neighbours(const verification *v) {
    const leaf_layout *l = &v->f->layout;
    for (uint32_t t = 0; t < l->treelets; t++)
        for (int a = 0; a < 3; a++) {
            const leaf_level *level = &l->level[l->level_of[t]];
            uint32_t place[3] = {l->place[t][0], l->place[t][1], l->place[t][2]};
            if (++place[a] == level->treelets[a])
                continue;
            uint32_t other = leaf_layout_find(l, l->level_of[t], place);
            if (v->edges[t].behind[a] != v->edges[other].before[a])
                return status_describe(
                    ST_CORRUPT,
                    "%s: byte %llu: treelets %u and %u differ in samples that both hold, along %c",
                    file_path(v->f->source),
                    (unsigned long long)v->f->offsets[leaf_layout_samples(l, v->set, other)], t,
                    other, "xyz"[a]);
        }
    return ST_OK;
}

/* Check the header's count. A grid's treelets count each sample once; those of others may share
 * vertices. */
static status check_count(const verification *v) {
    const uint64_t count = v->f->header.non_finite;
    uint64_t most = 0, least = 0;
    for (uint32_t t = 0; t < v->f->layout.treelets; t++) {
        most += v->non_finite[t];
        least = v->non_finite[t] > least ? v->non_finite[t] : least;
    }
    if (!verifier_of(v->f))
        least = most;
    if (count >= least && count <= most)
        return ST_OK;
    return status_describe(
        ST_CORRUPT, "%s: byte %zu: expected %llu to %llu non-finite samples, found %llu",
        file_path(v->f->source), offsetof(leaf_header, non_finite), (unsigned long long)least,
        (unsigned long long)most, (unsigned long long)count);
}

/* Check that bytes between two places are 0. behind: what lies before them. */
static status check_gap(const leaf_file *f, uint64_t at, uint64_t end, const char *behind) {
    char bytes[512];
    while (at < end) {
        size_t size = end - at < sizeof bytes ? (size_t)(end - at) : sizeof bytes;
        status st = file_read_at(f->source, at, bytes, size);
        if (st != ST_OK)
            return st;
        for (size_t i = 0; i < size; i++)
            if (bytes[i])
                return status_describe(ST_CORRUPT, "%s: byte %llu: expected 0 behind %s",
                                       file_path(f->source), (unsigned long long)(at + i), behind);
        at += size;
    }
    return ST_OK;
}

static status check_gaps_of(const leaf_file *f) {
    char behind[LEAF_NAME_MAX] = "the header";
    const uint64_t table = f->header.directory;
    uint64_t at = leaf_payloads_at(&f->header, f->directory_end);
    status st = ST_OK;
    for (leaf_order o = leaf_order_begin(&f->layout); o.p < f->layout.payloads && st == ST_OK;
         leaf_order_next(&o, &f->layout)) {
        if (!leaf_file_is_home(f, o.p))
            continue;
        st = check_gap(f, at, f->offsets[o.p], behind);
        at = f->offsets[o.p] + f->sizes[o.p];
        leaf_layout_payload_name(&f->layout, o.p, behind);
    }
    if (st == ST_OK)
        st = check_gap(f, at, table ? table : f->payloads_end, behind);
    return st == ST_OK && table ? check_gap(f, f->directory_end, f->payloads_end, "the directory")
                                : st;
}

/* Check the bytes between payloads, segment by segment where the file has some. */
static status check_gaps(const verification *v) {
    const leaf_file *f = v->f;
    status st = ST_OK;
    if (f->header.segments < 2)
        return check_gaps_of(f);
    for (uint32_t i = 0; i < f->header.segments && st == ST_OK; i++) {
        leaf_file *part = NULL;
        st = leaf_file_open_segment(f->m, f, &f->segments[i], &part);
        if (st == ST_OK)
            st = check_gaps_of(part);
        leaf_file_close(part);
    }
    return st;
}

/* Whether the bins hold every value of a range; for an empty range, whether there are no bins. */
static bool holds(const histogram *h, const double range[2]) {
    if (h->bins == 0)
        return range[0] > range[1];
    return h->edges[0] <= range[0] && range[0] <= range[1] && range[1] < h->edges[h->bins];
}

/* Count the same cells into the same bins again: equal sums, as floats are added in the same
 * order. */
static status check_histograms(const verification *v) {
    const leaf_file *f = v->f;
    const uint32_t sets = v->cells ? f->layout.sets : 0;
    const uint64_t total =
        verifier_of(f) ? verifier_of(f)->cells(f)
                       : (uint64_t)f->header.dims[0] * f->header.dims[1] * f->header.dims[2];
    for (uint32_t set = 0; set < sets; set++) {
        double range[2];
        leaf_histogram_range(f, set, range);
        if (!holds(&f->histograms[set], range))
            return status_describe(ST_CORRUPT,
                                   "%s: the bins of histogram %u do not hold the values %g .. %g",
                                   file_path(f->source), set, range[0], range[1]);
        histogram again = f->histograms[set];
        const uint32_t count =
            verifier_of(f) ? leaf_histogram_run(f, set, total).count : v->draw.count;
        histogram_count(&again, v->cells + set * v->count, count, total);
        if (memcmp(&again, &f->histograms[set], sizeof again) != 0)
            return status_describe(ST_CORRUPT, "%s: histogram %u differs from what its %s give",
                                   file_path(f->source), set,
                                   verifier_of(f) ? verifier_of(f)->drawn : "samples");
    }
    return ST_OK;
}

/* Check all sets of a grid. */
static status verify_sets(verification *v, pool *workers) {
    status st = ST_OK;
    for (v->set = 0; v->set < v->f->layout.sets && st == ST_OK; v->set++) {
        st = pool_run(workers, v->f->layout.treelets, verify_treelet, v);
        if (st == ST_OK)
            st = check_neighbours(v);
    }
    return st;
}

static status verify_all(verification *v, pool *workers) {
    status st = verifier_of(v->f) ? pool_run(workers, v->f->layout.treelets, verify_by_row, v)
                                  : verify_sets(v, workers);
    if (st == ST_OK)
        st = check_count(v);
    if (st == ST_OK)
        st = check_histograms(v);
    if (st == ST_OK)
        st = check_gaps(v);
    return st;
}

/* The room that a thread needs for what it decodes. */
static size_t thread_bytes(const leaf_file *f) {
    return verifier_of(f) ? verifier_of(f)->room(f) : grid_room_of(f).bytes;
}

static status allocate_histograms(verification *v, mem *m) {
    const leaf_file *f = v->f;
    if (!f->histograms)
        return ST_OK;
    if (verifier_of(f)) {
        for (uint32_t set = 0; set < f->layout.sets; set++) {
            const size_t count = leaf_histogram_run(f, set, verifier_of(f)->cells(f)).count;
            v->count = count > v->count ? count : v->count;
        }
    } else {
        v->draw = histogram_draw_grid(f->header.dims);
        v->space = histogram_space_of(f->header.to_world);
        for (int a = 0; a < 3 && f->header.rectilinear; a++)
            v->space.axis[a] = f->axis[a];
        v->count = v->draw.count;
    }
    v->cells = mem_array(m, v->count * f->layout.sets, sizeof *v->cells);
    return v->cells ? ST_OK : ST_NOMEM;
}

static status allocate(verification *v, mem *m, int threads) {
    const leaf_layout *l = &v->f->layout;
    v->edges = mem_array(m, verifier_of(v->f) ? 1 : l->treelets, sizeof *v->edges);
    v->non_finite = mem_array(m, l->treelets, sizeof *v->non_finite);
    v->payloads = mem_array(m, (size_t)threads, sizeof *v->payloads);
    if (!v->edges || !v->non_finite || !v->payloads)
        return ST_NOMEM;
    for (int i = 0; i < threads; i++) {
        v->payloads[i] = mem_alloc(m, thread_bytes(v->f));
        if (!v->payloads[i])
            return ST_NOMEM;
    }
    const status st = leaf_unpackers_create(m, v->f, threads, &v->unpackers);
    return st == ST_OK ? allocate_histograms(v, m) : st;
}

static void release(verification *v, mem *m, int threads) {
    for (int i = 0; v->payloads && i < threads; i++)
        mem_free(m, v->payloads[i]);
    mem_free(m, v->payloads);
    leaf_unpackers_destroy(m, v->unpackers, threads);
    mem_free(m, v->edges);
    mem_free(m, v->non_finite);
    mem_free(m, v->cells);
}

static status verify_file(mem *m, leaf_file *f, int threads, const progress *p) {
    verification v = {.f = f, .p = p};
    pool *workers = NULL;
    status st = pool_create(m, threads, &workers);
    if (st == ST_OK)
        st = allocate(&v, m, threads);
    if (st == ST_OK)
        st = verify_all(&v, workers);
    pool_destroy(workers);
    release(&v, m, threads);
    return st;
}

status leaf_verify(mem *m, leaf_file *f, int threads, const progress *p) {
    status st = verify_file(m, f, threads, p);
    for (uint32_t set = 0; f->coarse && set < f->layout.sets && st == ST_OK; set++) {
        leaf_file *coarse = NULL;
        if (!leaf_file_has_coarse(f, set))
            continue;
        st = leaf_file_open_coarse(m, f, set, &coarse);
        if (st == ST_OK)
            st = leaf_verify(m, coarse, threads, NULL);
        leaf_file_close(coarse);
    }
    return st;
}
