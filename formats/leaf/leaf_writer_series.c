/* leaf_writer_series.c - payloads of several sets: those that an earlier set has, and, of a grid,
 * those that differ little from the step before.
 *
 * What an earlier set has is read back from the output, so that it takes no memory. All of that set
 * is there: sets are put one after the other. Where a file is added to, the first new step looks at
 * the last step there, and what is stored whole is looked for in all.
 */
#include <string.h>

#include "formats/base/hash.h"
#include "formats/leaf/grid_coding.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_writer_private.h"

/* Payload p of the file that is written; or of the one that it is added to, which has no others
 * than the output in its place. */
typedef struct origin {
    leaf_file *in; /* NULL: of what is written */
    uint32_t p;
} origin;

/* ---- where earlier payloads are ---- */

/* What payload p of a set holds, in a set of the file that is added to. */
static uint32_t payload_before(const leaf_writer *w, uint32_t p, uint32_t set) {
    const leaf_growth *growth = w->layout.geometry->growth;
    leaf_row own[LEAF_ROWS_MAX], before[LEAF_ROWS_MAX];
    int i = growth->rows(&w->layout, own) - 1;
    (void)growth->rows(&w->before->layout, before);
    while (p < own[i].first)
        i--;
    return before[i].first + set * before[i].width + (p - own[i].first) % own[i].width;
}

/* Where an entry of SAME or BASES leads to from payload p. */
static origin led_to(const leaf_writer *w, uint32_t p, uint32_t entry) {
    const leaf_series s = leaf_layout_series(&w->layout, p);
    if (!(entry & LEAF_LINK_BEFORE))
        return (origin){NULL, leaf_series_payload(&s, entry - 1)};
    const uint32_t set = leaf_file_numbered(w->before, entry ^ LEAF_LINK_BEFORE);
    return (origin){w->before, payload_before(w, p, set)};
}

/* The entry that leads to a payload. */
static uint32_t entry_of(const leaf_writer *w, origin q) {
    const leaf_layout *l = q.in ? &q.in->layout : &w->layout;
    const uint32_t set = leaf_layout_series(l, q.p).at;
    return q.in ? LEAF_LINK_BEFORE | leaf_file_number(q.in, set) : set + 1;
}

static uint64_t size_of(const leaf_writer *w, origin q) {
    return q.in ? q.in->sizes[q.p] : w->sizes[q.p];
}

/* The payload whose bytes p of the output has. */
static origin home_of(const leaf_writer *w, uint32_t p) {
    return w->same[p] ? led_to(w, p, w->same[p]) : (origin){NULL, p};
}

/* The payloads whose codes are needed for that of a home, as leaf_layout_chain(). */
static int chain_of(const leaf_writer *w, origin q, origin chain[LEAF_CHAIN_MAX]) {
    int count = 0;
    for (chain[count++] = q; !q.in && w->bases[q.p]; chain[count++] = q)
        q = led_to(w, q.p, w->bases[q.p]);
    if (!q.in)
        return count;
    uint32_t before[LEAF_CHAIN_MAX];
    const int more = leaf_file_chain(q.in, q.p, before);
    for (int i = 1; i < more; i++)
        chain[count++] = (origin){q.in, before[i]};
    return count;
}

/* ---- reading them ---- */

static status fetch(leaf_writer *w, origin q, void *to) {
    return q.in ? leaf_file_fetch(q.in, q.p, to)
                : out_file_read_at(w->out, w->offsets[q.p], to, (size_t)w->sizes[q.p]);
}

/* Decode a payload for p, over f->earlier where it holds differences. */
static status read_code(leaf_writer *w, const leaf_family *f, box_coder *boxes, uint32_t p,
                        origin q, bool difference) {
    const status st = fetch(w, q, f->stored);
    if (st != ST_OK)
        return st;
    if (grid_coding_unpack(&w->layout, p, boxes, f->stored, (size_t)size_of(w, q), difference,
                           f->earlier))
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: what was written before has changed", w->path);
}

/* Read what payload p has in an earlier set into f->earlier. */
static status read_earlier(leaf_writer *w, const leaf_family *f, leaf_packer *k, uint32_t p,
                           origin q) {
    origin chain[LEAF_CHAIN_MAX];
    if (!k)
        return fetch(w, q, f->earlier);
    const int count = chain_of(w, q, chain);
    status st = ST_OK;
    for (int i = count; i-- > 0 && st == ST_OK;)
        st = read_code(w, f, leaf_packer_boxes(k), p, chain[i], i + 1 < count);
    return st;
}

/* ---- the same, and differences ---- */

/* Code payload p, given f->earlier. Returns its bytes; 0: all samples are the same. */
static size_t pack_from(const leaf_writer *w, const leaf_family *f, leaf_packer *k, uint32_t p,
                        const void *payload, void *to) {
    const size_t bytes = leaf_layout_payload_bytes(&w->layout, p);
    if (k)
        return grid_coding_pack_from(&w->layout, p, leaf_packer_boxes(k), payload, f->earlier, to);
    return memcmp(payload, f->earlier, bytes) == 0 ? 0 : bytes;
}

static uint64_t hash_of(const leaf_writer *w, leaf_packer *k, uint32_t p, const void *payload) {
    return k ? grid_coding_hash(&w->layout, p, leaf_packer_boxes(k), payload)
             : hash_bytes(payload, leaf_layout_payload_bytes(&w->layout, p));
}

/* The hashes of the payloads of a series. */
static uint64_t *hashes_of(const leaf_writer *w, const leaf_series *s) {
    const leaf_layout *l = &w->layout;
    const uint32_t shells = l->sets * l->treelets;
    const size_t row = s->first < l->treelets ? s->first : s->first - shells + l->treelets;
    return w->hashes + row * l->sets;
}

static void note_same(leaf_writer *w, uint32_t p, origin q) {
    w->same[p] = entry_of(w, q);
    w->sizes[p] = size_of(w, q);
    w->offsets[p] = q.in ? 0 : w->offsets[q.p];
    w->checksums[p] = q.in ? q.in->checksums[q.p] : w->checksums[q.p];
}

/* Find the payload p in an earlier set. A hash leads there, and the bytes decide. */
static status find_same(leaf_writer *w, const leaf_family *f, leaf_packer *k, uint32_t p,
                        const void *payload, void *to) {
    const leaf_series s = leaf_layout_series(&w->layout, p);
    uint64_t *hashes = hashes_of(w, &s);
    hashes[s.at] = hash_of(w, k, p, payload);
    for (uint32_t i = 0; i < s.at; i++) {
        const uint32_t own = leaf_series_payload(&s, i);
        const origin q = home_of(w, own);
        if (hashes[i] != hashes[s.at] || !w->sizes[own] || (w->same[own] && !q.in))
            continue;
        const status st = read_earlier(w, f, k, p, q);
        if (st != ST_OK)
            return st;
        if (pack_from(w, f, k, p, payload, to))
            continue;
        note_same(w, p, q);
        return ST_OK;
    }
    return ST_OK;
}

/* The payload of the step before p's: its home, if that has bytes. False: there is none. */
static bool find_before(const leaf_writer *w, uint32_t p, origin *q) {
    const leaf_series s = leaf_layout_series(&w->layout, p);
    const uint32_t steps = w->layout.steps, field = s.at / steps;
    if (s.at % steps > 0) {
        *q = home_of(w, leaf_series_payload(&s, s.at - 1));
    } else if (w->before) {
        const uint32_t last = (field + 1) * w->before->layout.steps - 1;
        *q = (origin){w->before, leaf_file_home(w->before, payload_before(w, p, last))};
    } else {
        return false;
    }
    return size_of(w, *q) > 0;
}

/* Code payload p by the step before; or find that it is the same, where no hash tells that. */
static status code_from_base(leaf_writer *w, const leaf_family *f, leaf_packer *k, uint32_t p,
                             const void *payload, void *to, size_t *bytes) {
    origin q, chain[LEAF_CHAIN_MAX];
    if (!find_before(w, p, &q))
        return ST_OK;
    const bool may = chain_of(w, q, chain) < LEAF_CHAIN_MAX;
    if (!may && !q.in)
        return ST_OK;
    const status st = read_earlier(w, f, k, p, q);
    if (st != ST_OK)
        return st;
    const size_t packed = pack_from(w, f, k, p, payload, to);
    if (!packed)
        note_same(w, p, q);
    else if (may && box_coder_is_difference(to))
        w->bases[p] = entry_of(w, q);
    *bytes = may ? packed : 0;
    return ST_OK;
}

status leaf_writer_put_in_series(leaf_writer *w, const leaf_family *f, leaf_packer *k, uint32_t p,
                                 const void *payload, void *to, size_t *bytes) {
    *bytes = 0;
    w->same[p] = w->bases[p] = 0;
    const status st = find_same(w, f, k, p, payload, to);
    if (st != ST_OK || w->same[p] || !k)
        return st;
    return code_from_base(w, f, k, p, payload, to, bytes);
}

status leaf_writer_compare(file *in, out_file *out, uint64_t at, const void *bytes, uint64_t size,
                           bool *same) {
    char piece[4096];
    *same = true;
    for (uint64_t i = 0; i < size && *same; i += sizeof piece) {
        const size_t some = size - i < sizeof piece ? (size_t)(size - i) : sizeof piece;
        const status st =
            in ? file_read_at(in, at + i, piece, some) : out_file_read_at(out, at + i, piece, some);
        if (st != ST_OK)
            return st;
        *same = memcmp(piece, (const char *)bytes + i, some) == 0;
    }
    return ST_OK;
}

/* Codes of differences are marked as such: none has the bytes of a whole one. */
status leaf_writer_find_stored(leaf_writer *w, uint32_t p, const void *stored, size_t size) {
    const leaf_file *in = w->before;
    bool same = false;
    for (uint32_t set = in->layout.sets; set-- > 0;) {
        const origin q = {w->before, payload_before(w, p, set)};
        if (in->checksums[q.p] != w->checksums[p] || in->sizes[q.p] != size ||
            !leaf_file_is_home(in, q.p))
            continue;
        const status st =
            leaf_writer_compare(in->source, NULL, in->offsets[q.p], stored, size, &same);
        if (st == ST_OK && !same)
            continue;
        w->same[p] = st == ST_OK ? entry_of(w, q) : 0;
        return st;
    }
    return ST_OK;
}
