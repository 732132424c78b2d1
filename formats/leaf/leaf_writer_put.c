/* leaf_writer_put.c - putting the payloads of a mesh, or a curvilinear grid, into a treelet file,
 * from many threads. */
#include <assert.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/implied_payload.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_writer_private.h"
#include "formats/mesh/mesh_leaf.h"

/* Decide where a payload of this size goes. Returns true for offsets[p], as all before it have been
 * put; false for scratch_at[p]. Places become known in order. The place of a payload in the scratch
 * file is needed now only to place those behind it. One that is the same as another goes nowhere.
 */
static bool place_put(leaf_writer *w, uint32_t p, size_t size) {
    pthread_mutex_lock(&w->lock);
    const bool direct = p == w->order.p, waits = !direct && !leaf_writer_is_same(w, p);
    w->sizes[p] = size;
    w->scratch_at[p] = waits && size ? w->scratch_end : NOT_THERE;
    if (waits)
        w->scratch_end += size;
    while (w->order.p < w->layout.payloads && w->sizes[w->order.p] != UNKNOWN_SIZE) {
        leaf_writer_place(w, w->order.p);
        leaf_order_next(&w->order, &w->layout);
    }
    pthread_mutex_unlock(&w->lock);
    return direct;
}

/* Whether payload q, which was put before, has these bytes. */
static status has_bytes(leaf_writer *w, uint32_t q, const void *bytes, bool *same) {
    const bool waits = w->scratch_at[q] != NOT_THERE;
    return leaf_writer_compare(NULL, waits ? w->scratch : w->out,
                               waits ? w->scratch_at[q] : w->offsets[q], bytes, w->sizes[q], same);
}

/* Set same[p] if the set before has the same bytes: a treelet's are put in the order of sets. */
static status find_own(leaf_writer *w, uint32_t p, const void *stored, size_t size) {
    const leaf_series s = leaf_layout_series(&w->layout, p);
    const leaf_links links = leaf_writer_links(w);
    bool same = false;
    if (!w->same || s.at == 0)
        return ST_OK;
    const uint32_t last = leaf_series_payload(&s, s.at - 1);
    if (w->sizes[last] != size || w->checksums[last] != w->checksums[p])
        return ST_OK;
    if (w->same[last] & LEAF_LINK_BEFORE)
        return ST_OK; /* found there, too */
    const uint32_t q = leaf_layout_home(&w->layout, &links, last);
    const status st = has_bytes(w, q, stored, &same);
    w->same[p] = same ? leaf_layout_series(&w->layout, q).at + 1 : 0;
    return st;
}

/* The same, in all sets, of the file that is added to, too. */
static status find_same(leaf_writer *w, uint32_t p, const void *stored, size_t size) {
    status st = find_own(w, p, stored, size);
    if (st != ST_OK || !w->before || w->same[p])
        return st;
    return leaf_writer_find_stored(w, p, stored, size);
}

static size_t pack_payload(const leaf_writer *w, leaf_packer *k, uint32_t p, const void *payload,
                           void *pack, const void **stored) {
    uint32_t index;
    const uint32_t t = p % w->layout.treelets;
    return leaf_packer_pack_streams(k, leaf_layout_block_of(&w->layout, p, &index), w->counts[t],
                                    w->bounds[t], payload, pack, stored);
}

static status put_payload(leaf_writer *w, leaf_packer *k, uint32_t p, const void *payload,
                          void *pack) {
    const void *stored = payload;
    size_t size = leaf_layout_payload_bytes(&w->layout, p);
    if (k)
        size = pack_payload(w, k, p, payload, pack, &stored);
    w->checksums[p] = hash_bytes(stored, size);
    const status st = find_same(w, p, stored, size);
    if (st != ST_OK)
        return st;
    const bool direct = place_put(w, p, size);
    if (leaf_writer_is_same(w, p))
        return ST_OK;
    if (direct)
        return out_file_write_at(w->out, w->offsets[p], stored, size);
    return out_file_write_at(w->scratch, w->scratch_at[p], stored, size);
}

/* Copy floats; -0 becomes +0, as readers may compare bytes. */
static void copy_floats(float *to, const float *from, int count) {
    for (int i = 0; i < count; i++)
        to[i] = from[i] + 0.0F;
}

status leaf_writer_put_topology(leaf_writer *w, leaf_packer *k, uint32_t t, const float bounds[6],
                                const uint32_t counts[4], const void *payload, void *pack) {
    assert(t < w->layout.treelets && w->counts);
    assert(!(w->header.leaf_tets
                 ? mesh_leaf_counts_fault(counts, w->header.treelet_tets, w->header.leaf_tets)
                 : w->layout.geometry->noded->counts_fault(counts, w->header.treelet_tets)));
    copy_floats(w->bounds[t], bounds, 6);
    memcpy(w->counts[t], counts, sizeof w->counts[t]);
    return put_payload(w, k, t, payload, pack);
}

void leaf_writer_keep_topology(leaf_writer *w, uint32_t t) {
    const leaf_file *f = w->before;
    assert(t < w->layout.treelets && f);
    const float(*bounds)[6] = f->geometry->section(f, LEAF_SECTION_BOUNDS);
    memcpy(w->bounds[t], bounds[t], sizeof w->bounds[t]);
    memcpy(w->counts[t], f->layout.counts[t], sizeof w->counts[t]);
    w->checksums[t] = f->checksums[t];
    w->same[t] = LEAF_LINK_BEFORE;
    (void)place_put(w, t, (size_t)f->sizes[t]);
}

status leaf_writer_put_values(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                              const leaf_entry *entry, const void *payload, void *pack) {
    assert(t < w->layout.treelets && set < w->layout.sets && w->counts[t][0]);
    const size_t element = (size_t)set * w->layout.treelets + t;
    copy_floats(w->own[element], entry->own, 2);
    w->flags[element] = entry->flags;
    return put_payload(w, k, leaf_layout_values(&w->layout, set, t), payload, pack);
}

status leaf_writer_put_gradients(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                                 const void *payload, void *pack) {
    assert(t < w->layout.treelets && set < w->layout.gradient_sets && w->counts[t][0]);
    return put_payload(w, k, leaf_layout_gradients(&w->layout, set, t), payload, pack);
}

status leaf_writer_put_positions(leaf_writer *w, leaf_packer *k, uint32_t step, uint32_t t,
                                 const float bounds[6], const void *payload, void *pack) {
    assert(t < w->layout.treelets && step < w->layout.places);
    assert(w->counts[t][0] && (step > 0 || w->zones));
    copy_floats(w->bounds[leaf_layout_bounds(&w->layout, step, t)], bounds, 6);
    const uint32_t p = step ? leaf_layout_positions(&w->layout, step, t) : t;
    return put_payload(w, k, p, payload, pack);
}
