/* grid_pieces_template.h - grid_pieces.h for the ISA of the translation unit that includes it. */
#ifndef RENDER_GRID_GRID_PIECES_TEMPLATE_H
#define RENDER_GRID_GRID_PIECES_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <math.h>
#include <string.h>

#include "render/grid/block_way.h"
#include "render/grid/cell_visit_template.h"
#include "render/grid/grid_pieces.h"
#include "render/grid/grid_way.h"

void SIMD_NAME(grid_pieces)(const tracer *tr, segment_batch *b, void *scratch,
                            ray_counters *counters);

enum {
    SIDE_MAX = 1 << LEAF_CELLS_LOG2_MAX,
    /* Planes of an axis, and room for searches and vectors that reach beyond. */
    PLANES_MAX = (SIDE_MAX + 1 + SIDE_MAX / 2 + 7) / 8 * 8,
    SLOTS_MAX = 3 * SIDE_MAX + 2 * 8,
    /* Rays under way at a time. A round of them gives pieces for about one flush, and they share a
     * small cache. */
    RIDERS = 8,
    /* Pieces of a ray at a time: behind opaque ones no more are wanted. */
    PIECES_A_TURN = 16
};

/* ---- Cells as numbers ---- */

/* A cell is a 64-bit number: its place on each axis, and the axis of the crossing where the ray
 * enters it. A piece also has the axis of the crossing where the ray leaves it. NO_AXIS: no
 * crossing. */
enum { FIELD_BITS = 21, AXIS_AT = 62, NEXT_AXIS_AT = 56, NO_AXIS = 3 };

SIMD vl cell_axis(vl cell) {
    return cell >> AXIS_AT;
}

SIMD vl cell_next_axis(vl cell) {
    return cell >> NEXT_AXIS_AT & 3u;
}

SIMD vl cell_place(vl cell, int a) {
    return cell >> (FIELD_BITS * a) & 127u;
}

static uint64_t in_every_field(uint64_t bits) {
    return bits | bits << FIELD_BITS | bits << 2 * FIELD_BITS;
}

/* Returns the cell's number among the treelet's cells in Morton order. */
SIMD vl cell_morton(vl cell) {
    cell &= l_set(in_every_field(0x7f));
    cell = (cell | cell << 8) & l_set(in_every_field(0x700f));
    cell = (cell | cell << 4) & l_set(in_every_field(0x430c3));
    cell = (cell | cell << 2) & l_set(in_every_field(0x49249));
    return (cell | cell >> (FIELD_BITS - 1) | cell >> (2 * FIELD_BITS - 2)) &
           ((1u << FIELD_BITS) - 1u);
}

/* ---- A ray ---- */

/* The crossings of one axis' planes in a treelet, in the ray's order. */
typedef struct slab {
    _Alignas(64) double t[PLANES_MAX]; /* of plane 0, 1, ...; INFINITY behind the last; NaN: the ray
                                          never crosses them */
    uint32_t first, last;              /* the ray's cells at the passage's start and end */
    double per_step;                   /* cells per unit of t between them */
} slab;

typedef struct rider {
    unsigned number; /* in the batch */
    bool riding;
    const resident_grid *at;   /* treelet of the slabs; NULL: none yet */
    const active_masks *masks; /* masks that the treelet is walked by */
    bool bounded;              /* grid_way.bounded for this treelet */
    uint64_t flips;            /* XORed to cells: down an axis, slabs count cells from its end */
    grid_way way;
    bool by_blocks; /* the ray is in a treelet with nodes that are taken whole: */
    block_way blocks;
    slab slabs[3];
    /* One passage: t where each cell begins, cell after cell, and where the last one ends; */
    unsigned slots;
    _Alignas(64) double t[SLOTS_MAX];
    uint64_t cell[SLOTS_MAX];
    /* then the pieces, packed to the front, with their ends. `given` of them have been given. */
    unsigned pieces, given;
    double t_out[SLOTS_MAX];
} rider;

typedef struct pieces_walk {
    const tracer *tr;
    segment_batch *b;
    ray_counters *counters;
    rider riders[RIDERS];
} pieces_walk;
_Static_assert(sizeof(pieces_walk) <= GRID_PIECES_SCRATCH, "a walk has room in its scratch");

SIMD const ray *ray_of(const pieces_walk *w, const rider *q) {
    return &w->b->rays[q->number];
}

SIMD const level_planes *planes_of(const pieces_walk *w, const resident_grid *at) {
    const walk_scene *scene = w->tr->own;
    return &scene->levels[at->level];
}

/* Look up planes of cells, or numbers that belong to them, along an axis of a treelet. */
SIMD vd of_planes(const double *from, vl place, uint32_t side) {
    return side == D_TABLE ? d_look_up(from, place) : d_gather(from, place);
}

/* ---- Slabs ---- */

/* Compute t of all planes from `first` on, with cell_visit_of()'s division. */
static void slab_cross(slab *s, const double *first, uint32_t side, double o, double d) {
    const vd from = d_set(o), per = d_set(d);
    for (uint32_t k = 0; k < side; k += VD_N) {
        const vd up = d_load(first + k);
        if (d > 0.0)
            d_store(s->t + k, (up - from) / per);
        else
            d_store(s->t + side - VD_N - k, (d_reverse(d_load(first + k + 1)) - from) / per);
    }
    s->t[side] = (first[d > 0.0 ? side : 0] - o) / d;
    for (uint32_t k = side + 1; k < side + 1 + side / 2; k++)
        s->t[k] = INFINITY;
}

/* Find the layer of cells that owns a ray parallel to the planes of an axis. */
static void slab_stay(slab *s, const double *first, uint32_t side, double held) {
    s->first = 0;
    while (s->first + 1 < side && held >= first[s->first + 1])
        s->first++;
    s->last = s->first;
    s->t[s->first] = s->t[s->first + 1] = (double)NAN;
}

static void rider_enter(const pieces_walk *w, rider *q, const resident_grid *at) {
    const level_planes *planes = planes_of(w, at);
    const ray *r = ray_of(w, q);
    const uint32_t side = 1u << w->tr->layout->cells_log2;
    for (int a = 0; a < 3; a++) {
        const double *first = planes->at[a] + at->first_cell[a];
        if (q->at && q->at->level == at->level && q->at->first_cell[a] == at->first_cell[a])
            continue;
        if (r->d[a] == 0.0)
            slab_stay(&q->slabs[a], first, side, r->held[a]);
        else
            slab_cross(&q->slabs[a], first, side, r->o[a], r->d[a]);
    }
    q->at = at;
}

/* Cut [*t_in, *t_out] to the layers of active blocks along an axis. */
static void slab_narrow(const slab *s, const active_masks *masks, const int a, uint32_t side,
                        bool back, double *t_in, double *t_out) {
    const uint32_t first = (uint32_t)masks->first[a] << LEAF_BLOCK_LOG2;
    const uint32_t end = (uint32_t)masks->end[a] << LEAF_BLOCK_LOG2;
    const uint32_t in = back ? side - end : first, out = back ? side - first : end;
    if (in > 0 && s->t[in] > *t_in)
        *t_in = s->t[in];
    if (out < side && s->t[out] < *t_out)
        *t_out = s->t[out];
}

/* Find the cells at both ends of a passage. A plane at t_in counts as crossed, a plane at t_out
 * does not. */
static void slab_clip(slab *s, uint32_t side, double t_in, double t_out) {
    unsigned behind = 0, met = 0;
    for (uint32_t k = 0; k <= side; k += VD_N) {
        const vd t = d_load(s->t + k);
        behind += (unsigned)__builtin_popcount(md_bits(d_le(t, d_set(t_in))));
        met += (unsigned)__builtin_popcount(md_bits(d_lt(t, d_set(t_out))));
    }
    s->first = behind > 0 ? behind - 1 : 0;
    s->last = met > s->first + 1 ? met - 1 : s->first;
    s->last = s->last < side ? s->last : side - 1;
    s->per_step = (s->last + 1 - s->first) / (s->t[s->last + 1] - s->t[s->first]);
}

/* ---- Crossings in order ---- */

/* Returns whether crossings of a slab come before another axis' crossings at t. At equal t, the
 * axis named first comes first. */
SIMD md comes_before(vd crossing, vd t, bool named_first) {
    return named_first ? d_le(crossing, t) : d_lt(crossing, t);
}

/* Find the cells of a slab at these t by halving, for planes at any distances. */
static __attribute__((noinline)) vl slab_search(const slab *s, vd t, bool named_first) {
    vl at = l_set(s->first);
    unsigned step = 1;
    while (2 * step <= s->last - s->first)
        step *= 2;
    for (; step > 0; step /= 2) {
        const vl next = at + step;
        at = (vl)d_select(comes_before(d_gather(s->t, next), t, named_first), (vd)next, (vd)at);
    }
    return at;
}

/* Find the cells of a slab at these t, which lie in the passage. Guess them as if all cells had one
 * width, which is mostly right. Search if the guess is wrong in any of `lanes`. */
SIMD vl slab_cells(const slab *s, uint32_t side, vd t, bool named_first, unsigned lanes) {
    const vd whole = d_set(0x1p52);
    if (s->first == s->last)
        return l_set(s->first);
    const vd steps = (t - d_set(s->t[s->first])) * d_set(s->per_step) - d_set(0.5);
    const vd most = d_set(s->last - s->first);
    const vl guess =
        (vl)(d_min(most, d_max(steps, d_set(0.0))) + whole) - (vl)whole + (uint64_t)s->first;
    const md begun = comes_before(of_planes(s->t, guess, side), t, named_first);
    const md over = comes_before(of_planes(s->t + 1, guess, side), t, named_first);
    const bool right = (md_bits(md_and_not(begun, over)) & lanes) == lanes;
    return right ? guess : slab_search(s, t, named_first);
}

/* Put the crossings of axis a into their places, each with the cell behind it. A crossing's place
 * is the number of crossings of all axes up to it. */
SIMD void put_crossings(rider *q, const int a, uint32_t side) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const slab *s = &q->slabs[a], *sb = &q->slabs[b], *sc = &q->slabs[c];
    const uint64_t before = (uint64_t)s->first + sb->first + sc->first;
    static const uint64_t counting[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    for (uint32_t k = s->first + 1; k <= s->last; k += VD_N) {
        const unsigned left = s->last + 1 - k, count = left < VD_N ? left : VD_N;
        const vd t = d_load(s->t + k);
        const vl own = l_load(counting) + (uint64_t)k;
        const vl at_b = slab_cells(sb, side, t, b < a, (1u << count) - 1u);
        const vl at_c = slab_cells(sc, side, t, c < a, (1u << count) - 1u);
        const vl cell =
            (own << (FIELD_BITS * a) | at_b << (FIELD_BITS * b) | at_c << (FIELD_BITS * c)) ^
            (q->flips | (uint64_t)a << AXIS_AT);
        uint64_t place[VD_N], cells[VD_N];
        l_store(place, own + at_b + at_c - before);
        l_store(cells, cell);
        for (unsigned i = 0; i < count; i++) {
            q->t[place[i]] = s->t[k + i];
            q->cell[place[i]] = cells[i];
        }
    }
}

/* Put the first cell, and the end of the last one. If planes of several axes are crossed at t_in,
 * the last axis counts as the entry. At t_out, the first axis counts as the exit. Take t from the
 * crossing, to keep the sign of zero. */
static void put_ends(rider *q, double t_in, double t_out) {
    uint64_t first = 0, in = NO_AXIS, out = NO_AXIS;
    q->slots = 1;
    for (int a = 0; a < 3; a++) {
        const slab *s = &q->slabs[a];
        first |= (uint64_t)s->first << FIELD_BITS * a;
        q->slots += s->last - s->first;
        if (s->t[s->first] == t_in) {
            t_in = s->t[s->first];
            in = (uint64_t)a;
        }
        if (s->t[s->last + 1] == t_out && out == NO_AXIS) {
            t_out = s->t[s->last + 1];
            out = (uint64_t)a;
        }
    }
    q->t[0] = t_in;
    q->cell[0] = (first ^ q->flips) | in << AXIS_AT;
    q->t[q->slots] = t_out;
    for (unsigned i = 0; i < VD_N; i++) /* vectors reach beyond the last cell */
        q->cell[q->slots + i] = 0;
    q->cell[q->slots] = out << AXIS_AT;
}

/* ---- Pieces ---- */

/* Pack the cells that are active and have a length to the front, in place: writing never overtakes
 * reading. */
static void find_pieces(rider *q, const active_masks *masks) {
    q->pieces = q->given = 0;
    for (unsigned p = 0; p < q->slots; p += VD_N) {
        const vl cell = l_load(q->cell + p), next = l_load(q->cell + p + 1);
        const vd t_in = d_load(q->t + p), t_out = d_load(q->t + p + 1);
        const vl number = cell_morton(cell);
        const vl block = l_gather(masks->cells, number >> 6 << 3);
        unsigned found = l_odd(block >> (number & 63u)) & md_bits(d_lt(t_in, t_out));
        if (q->slots - p < VD_N)
            found &= (1u << (q->slots - p)) - 1u;
        d_pack(q->t + q->pieces, t_in, found);
        d_pack(q->t_out + q->pieces, t_out, found);
        l_pack(q->cell + q->pieces, cell | cell_axis(next) << NEXT_AXIS_AT, found);
        q->pieces += (unsigned)__builtin_popcount(found);
    }
    l_store(q->cell + q->pieces, l_set(0)); /* vectors reach beyond the last cell */
}

/* How samples lie in a treelet. Two neighbours of a row are read together, as the last bytes of a
 * word. */
typedef struct sample_words {
    const char *base;
    uint64_t size, row, slice, halo;
    uint64_t bits, sign; /* of an integer: all its bits, its sign bit */
    bool real;
} sample_words;

static sample_words words_of(const walk_scene *scene, const resident_grid *at) {
    const uint64_t size = sample_size(scene->type), bits = size < 8 ? (1ull << 8 * size) - 1 : 0;
    const bool is_signed = scene->type == SAMPLE_I8 || scene->type == SAMPLE_I16;
    const uint64_t row = size * at->shape.samples[0];
    return (sample_words){.base = (const char *)at->samples - (8 - 2 * size),
                          .size = size,
                          .row = row,
                          .slice = row * at->shape.samples[1],
                          .halo = scene->halo,
                          .bits = bits,
                          .sign = is_signed ? bits / 2 + 1 : 0,
                          .real = scene->type == SAMPLE_F32};
}

/* Convert integers of up to 52 bits to double. sign: the sign bit, or 0. */
SIMD vd whole_number(vl bits, uint64_t sign) {
    const double whole = 0x1p52;
    return (vd)((bits ^ sign) | (vl)d_set(whole)) - d_set(whole + (double)sign);
}

/* Read two neighbours along a row. */
SIMD void sample_pair(const sample_words *s, vl at, vd f[2]) {
    const vl word = l_gather(s->base, at);
    if (s->real) {
        f[0] = d_of_low_floats(word);
        f[1] = d_of_low_floats(word >> 32);
        return;
    }
    f[0] = whole_number(word >> (64 - 16 * s->size) & s->bits, s->sign);
    f[1] = whole_number(word >> (64 - 8 * s->size), s->sign);
}

SIMD void cell_samples(const sample_words *s, vl cell, vd f[8]) {
    vl at = l_mul(cell_place(cell, 0) + s->halo, l_set(s->size));
    at += l_mul(cell_place(cell, 1) + s->halo, l_set(s->row));
    at += l_mul(cell_place(cell, 2) + s->halo, l_set(s->slice));
    sample_pair(s, at, f);
    sample_pair(s, at + s->row, f + 2);
    sample_pair(s, at + s->slice, f + 4);
    sample_pair(s, at + (s->row + s->slice), f + 6);
}

/* Compute the cell coordinates at which the ray enters and leaves cells. */
SIMD void piece_visits(const pieces_walk *w, const rider *q, vl cell, visits *v) {
    const uint32_t side = 1u << w->tr->layout->cells_log2;
    const level_planes *planes = planes_of(w, q->at);
    const ray *r = ray_of(w, q);
    for (int a = 0; a < 3; a++) {
        const double *first = planes->at[a] + q->at->first_cell[a];
        const double *inverse = planes->inverse[a] + q->at->first_cell[a];
        const vl place = cell_place(cell, a);
        const vd d = d_set(r->d[a]), lo = of_planes(first, place, side) - d_set(r->o[a]);
        const vd inv = of_planes(inverse, place, side);
        const double enters_at = r->d[a] < 0.0 ? 1.0 : 0.0;
        v->in[a] = d_select(l_eq(cell_axis(cell), l_set((uint64_t)a)), d_set(enters_at),
                            cell_coordinate(v->t_in, d, lo, inv));
        v->out[a] = d_select(l_eq(cell_next_axis(cell), l_set((uint64_t)a)), d_set(1.0 - enters_at),
                             cell_coordinate(v->t_out, d, lo, inv));
    }
}

/* These pieces are guesses from a coarser treelet. Set their spread to a bound of their error. */
static void put_deviations(const pieces_walk *w, const rider *q, const uint64_t *cell,
                           unsigned count, double *spread) {
    for (unsigned i = 0; i < count; i++) {
        uint32_t at[3];
        for (int a = 0; a < 3; a++)
            at[a] = q->at->first_cell[a] + (uint32_t)(cell[i] >> (FIELD_BITS * a) & 127u);
        spread[i] = resident_grid_deviation(q->at, w->tr->layout, at);
    }
}

/* Write the pieces from i on to the columns, as many as a vector holds. */
SIMD void put_pieces(pieces_walk *w, const rider *q, const sample_words *s, unsigned i) {
    segment_columns *c = &w->b->columns;
    const unsigned left = q->pieces - i, count = left < VD_N ? left : VD_N, to = c->count;
    const vl cell = l_load(q->cell + i);
    visits v = {.t_in = d_load(q->t + i), .t_out = d_load(q->t_out + i)};
    vd f[8], b[4];
    piece_visits(w, q, cell, &v);
    cell_samples(s, cell, f);
    for (int k = 0; k < 8 && w->tr->above != 0.0; k++)
        f[k] = f[k] - d_set(w->tr->above);
    cubic(&v, f, b);
    md even = d_eq(f[1], f[0]);
    for (int k = 2; k < 8; k++)
        even = md_and(even, d_eq(f[k], f[0]));
    if (!q->bounded)
        for (int k = 1; k < 3; k++)
            b[k] = d_select(even, f[0], b[k]);
    d_store(c->t0 + to, v.t_in);
    d_store(c->t1 + to, v.t_out);
    for (int k = 0; k < 4; k++)
        d_store(c->b[k] + to, b[k]);
    d_store(c->spread + to, d_select(even, d_set(SEGMENT_EVEN), d_set(0.0)));
    if (q->bounded)
        put_deviations(w, q, q->cell + i, count, c->spread + to);
    for (unsigned k = 0; k < VD_N; k++) {
        c->treelet[to + k] = q->at->head.id;
        c->ray[to + k] = (uint8_t)q->number;
    }
    c->count += count;
}

/* Give some pieces of the passage to the columns, unless the ray wants no more. */
static void give_pieces(pieces_walk *w, rider *q) {
    const sample_words s = words_of(w->tr->own, q->at);
    const unsigned left = q->pieces - q->given;
    const unsigned end = q->given + (left < PIECES_A_TURN ? left : PIECES_A_TURN);
    w->b->columns.degree = 3;
    for (; q->given < end; q->given += VD_N) {
        if (w->b->columns.count > SEGMENT_COLUMNS - VD_N)
            segment_batch_flush(w->b);
        if (w->b->stop[q->number])
            return;
        put_pieces(w, q, &s, q->given);
    }
    q->given = end;
}

/* ---- Rays ---- */

static void give_whole(pieces_walk *w, const rider *q, const segment *piece) {
    w->counters->cells++;
    if (w->b->columns.count == SEGMENT_COLUMNS)
        segment_batch_flush(w->b);
    if (!w->b->stop[q->number])
        segment_batch_add(w->b, q->number, piece);
}

static void give_doubt(pieces_walk *w, const rider *q) {
    segments_state *s = w->b->state[q->number];
    give_whole(w, q, &q->way.doubt);
    s->doubted = q->way.doubt.treelet;
}

/* Find the pieces in cells between t_in and t_out, and give the first ones. */
static void pass_cells(pieces_walk *w, rider *q, double t_in, double t_out) {
    const uint32_t side = 1u << w->tr->layout->cells_log2;
    const ray *r = ray_of(w, q);
    for (int a = 0; a < 3; a++)
        if (r->d[a] != 0.0)
            slab_narrow(&q->slabs[a], q->masks, a, side, r->d[a] < 0.0, &t_in, &t_out);
    if (!(t_in < t_out))
        return;
    for (int a = 0; a < 3; a++)
        if (r->d[a] != 0.0)
            slab_clip(&q->slabs[a], side, t_in, t_out);
    put_ends(q, t_in, t_out);
    put_crossings(q, 0, side);
    put_crossings(q, 1, side);
    put_crossings(q, 2, side);
    find_pieces(q, q->masks);
    w->counters->cells += q->pieces;
    if (q->pieces > 0)
        give_pieces(w, q);
}

static block_axis_way axis_way(const slab *s, double d, uint32_t side, double t_in) {
    block_axis_way x = {.planes = s->t, .back = d < 0.0};
    x.at = d == 0.0 ? s->first >> LEAF_BLOCK_LOG2 : 0;
    if (d == 0.0)
        return x;
    x.leaves = 1u << LEAF_BLOCK_LOG2;
    while (x.leaves < side && s->t[x.leaves] <= t_in)
        x.leaves += 1u << LEAF_BLOCK_LOG2;
    x.left = (side - x.leaves) >> LEAF_BLOCK_LOG2;
    x.at = x.back ? x.left : (x.leaves >> LEAF_BLOCK_LOG2) - 1;
    return x;
}

/* Enter a treelet with nodes that are taken whole. */
static void enter_blocks(pieces_walk *w, rider *q, const grid_passage *passage) {
    const uint32_t side = 1u << w->tr->layout->cells_log2;
    q->blocks = (block_way){.t_in = passage->t_in, .t_out = passage->t_out};
    for (int a = 0; a < 3; a++)
        q->blocks.axis[a] = axis_way(&q->slabs[a], ray_of(w, q)->d[a], side, passage->t_in);
}

/* Go on through a treelet from enter_blocks(), until it ends or there are pieces of cells to give.
 */
static void pass_blocks(pieces_walk *w, rider *q) {
    block_stretch s;
    while (q->given == q->pieces && !w->b->stop[q->number]) {
        q->by_blocks = block_way_next(&q->blocks, q->masks, &s);
        if (!q->by_blocks)
            return;
        if (s.whole) {
            const segment piece = block_way_node(w->tr->treelets->file, w->tr->layout, q->at, &s);
            give_whole(w, q, &piece);
        } else if (s.active) {
            pass_cells(w, q, s.t_in, s.t_out);
        }
    }
}

static void pass_treelet(pieces_walk *w, rider *q, const resident_grid *at,
                         const grid_passage *passage) {
    if (q->way.doubted)
        give_doubt(w, q);
    if (!at && passage->t == LEAF_NO_TREELET)
        return;
    if (!at) {
        const segment piece = block_way_treelet(w->tr, passage->t, passage->t_in, passage->t_out);
        give_whole(w, q, &piece);
        return;
    }
    w->counters->nodes++;
    q->bounded = q->way.bounded;
    q->masks = q->bounded ? at->wide : at->masks;
    if (!q->masks->root)
        return;
    rider_enter(w, q, at);
    q->by_blocks = q->masks->some_whole;
    if (q->by_blocks)
        enter_blocks(w, q, passage);
    else
        pass_cells(w, q, passage->t_in, passage->t_out);
}

/* Advance the ray by some pieces or a treelet. Returns false when the ray is done. */
static bool ride(pieces_walk *w, rider *q) {
    const resident_grid *at;
    grid_passage passage;
    if (w->b->stop[q->number])
        return false;
    if (q->given < q->pieces) {
        give_pieces(w, q);
        return true;
    }
    if (q->by_blocks) {
        pass_blocks(w, q);
        return true;
    }
    const segments_result next = grid_way_next(&q->way, w->tr, ray_of(w, q), w->b->state[q->number],
                                               w->counters, &at, &passage);
    if (next == SEGMENTS_SOME)
        pass_treelet(w, q, at, &passage);
    else
        w->b->result[q->number] = next;
    return next == SEGMENTS_SOME;
}

/* Begin with ray i, where its state stopped. Returns false if there is no treelet on its way. */
static bool mount(pieces_walk *w, rider *q, unsigned i) {
    const uint64_t last = (1u << w->tr->layout->cells_log2) - 1u;
    const ray *r = &w->b->rays[i];
    w->b->result[i] = SEGMENTS_END;
    q->number = i;
    q->at = NULL;
    q->by_blocks = false;
    q->pieces = q->given = 0;
    q->flips = 0;
    for (int a = 0; a < 3; a++)
        q->flips |= (r->d[a] < 0.0 ? last : 0) << FIELD_BITS * a;
    return grid_way_begin(&q->way, w->tr, r, w->b->state[i]);
}

/* Begin with the next ray that has a treelet on its way. Returns false if there is none. Rays whose
 * state still holds pieces are walked one by one instead. */
static bool mount_next(pieces_walk *w, rider *q, unsigned *next) {
    while (*next < w->b->count) {
        const unsigned i = (*next)++;
        if (w->b->state[i]->count > 0)
            segment_batch_single(w->tr, w->b, i, w->counters);
        else if (mount(w, q, i))
            return true;
    }
    return false;
}

void SIMD_NAME(grid_pieces)(const tracer *tr, segment_batch *b, void *scratch,
                            ray_counters *counters) {
    pieces_walk *w = scratch;
    unsigned next = 0, riding = 0;
    w->tr = tr;
    w->b = b;
    w->counters = counters;
    for (unsigned i = 0; i < RIDERS; i++) {
        w->riders[i].riding = mount_next(w, &w->riders[i], &next);
        riding += w->riders[i].riding;
    }
    while (riding > 0) {
        for (unsigned i = 0; i < RIDERS; i++) {
            rider *q = &w->riders[i];
            if (!q->riding || ride(w, q))
                continue;
            q->riding = mount_next(w, q, &next);
            riding -= !q->riding;
        }
        /* Flush early, so that rays that want no more do not go far. */
        if (b->columns.count >= SEGMENT_COLUMNS / 4)
            segment_batch_flush(b);
    }
}

#endif
#endif
