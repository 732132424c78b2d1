/* leaf_writer_series.c - payloads of a grid of several sets: those that an earlier set has, and
 * those that differ little from the step before.
 *
 * What an earlier set has is read back from the output, so that it takes no memory. All of that set
 * is there: sets are put one after the other.
 */
#include <string.h>

#include "formats/base/hash.h"
#include "formats/leaf/grid_coding.h"
#include "formats/leaf/leaf_writer_private.h"

static status read_code(leaf_writer *w, const leaf_family *f, box_coder *boxes, uint32_t q,
                        bool difference) {
    const size_t size = (size_t)w->sizes[q];
    const status st = out_file_read_at(w->out, w->offsets[q], f->stored, size);
    if (st != ST_OK)
        return st;
    if (grid_coding_unpack(&w->layout, q, boxes, f->stored, size, difference, f->earlier))
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: what was written before has changed", w->path);
}

/* Read payload q of an earlier set into f->earlier. */
static status read_earlier(leaf_writer *w, const leaf_family *f, leaf_packer *k, uint32_t q) {
    const leaf_links links = leaf_writer_links(w);
    uint32_t chain[LEAF_CHAIN_MAX];
    if (!k)
        return out_file_read_at(w->out, w->offsets[q], f->earlier, (size_t)w->sizes[q]);
    const int count = leaf_layout_chain(&w->layout, &links, q, chain);
    status st = ST_OK;
    for (int i = count; i-- > 0 && st == ST_OK;)
        st = read_code(w, f, leaf_packer_boxes(k), chain[i], i + 1 < count);
    return st;
}

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

/* Find the payload p in an earlier set. A hash leads there, and the bytes decide. */
static status find_same(leaf_writer *w, const leaf_family *f, leaf_packer *k, uint32_t p,
                        const void *payload, void *to) {
    const leaf_series s = leaf_layout_series(&w->layout, p);
    uint64_t *hashes = hashes_of(w, &s);
    hashes[s.at] = hash_of(w, k, p, payload);
    for (uint32_t i = 0; i < s.at; i++) {
        const uint32_t q = leaf_series_payload(&s, i);
        if (hashes[i] != hashes[s.at] || !w->sizes[q] || w->same[q])
            continue;
        const status st = read_earlier(w, f, k, q);
        if (st != ST_OK)
            return st;
        if (pack_from(w, f, k, p, payload, to))
            continue;
        w->same[p] = i + 1;
        w->sizes[p] = w->sizes[q];
        w->offsets[p] = w->offsets[q];
        w->checksums[p] = w->checksums[q];
        return ST_OK;
    }
    return ST_OK;
}

/* The payload of the step before that p may be coded by: its home, if that has bytes and not too
 * many bases; else LEAF_NO_TREELET. */
static uint32_t base_of(const leaf_writer *w, uint32_t p) {
    const leaf_series s = leaf_layout_series(&w->layout, p);
    const leaf_links links = leaf_writer_links(w);
    uint32_t chain[LEAF_CHAIN_MAX];
    if (s.at % w->layout.steps == 0)
        return LEAF_NO_TREELET;
    const uint32_t q = leaf_layout_home(&w->layout, &links, leaf_series_payload(&s, s.at - 1));
    if (!w->sizes[q] || leaf_layout_chain(&w->layout, &links, q, chain) == LEAF_CHAIN_MAX)
        return LEAF_NO_TREELET;
    return q;
}

static status code_from_base(leaf_writer *w, const leaf_family *f, leaf_packer *k, uint32_t p,
                             const void *payload, void *to, size_t *bytes) {
    const uint32_t q = base_of(w, p);
    if (q == LEAF_NO_TREELET)
        return ST_OK;
    const status st = read_earlier(w, f, k, q);
    if (st != ST_OK)
        return st;
    *bytes = pack_from(w, f, k, p, payload, to);
    if (box_coder_is_difference(to))
        w->bases[p] = leaf_layout_series(&w->layout, q).at + 1;
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
