/* leaf_writer_family.c - putting the payloads of a grid into a treelet file, from many threads.
 *
 * A thread puts a family together in memory, which fixes its size. Its place is known as soon as
 * all families before it have one. If they have not, it waits in a list, and its thread goes on
 * with a spare one; without any, the thread waits. Whoever gives a place to a family does so for
 * those behind it in the list, too.
 */
#include <assert.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/leaf/implied_payload.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_writer_private.h"
#include "formats/leaf/outside_samples.h"

/* ---- rooms ---- */

/* The most bytes of a family; packing one payload may take more room for a while. */
static size_t family_room(const leaf_layout *l) {
    enum { CHILDREN = 8 };
    const size_t side = ((size_t)2 << l->cells_log2) + 1 + 2 * l->halo;
    if (!l->coded)
        return (size_t)CHILDREN * l->payload_max;
    return side * side * side * sample_size(l->type) + (CHILDREN + 1) * (size_t)LEAF_CODE_BYTES +
           leaf_layout_stored_max(l);
}

/* Rooms beside one for each thread. A thread alone never waits. */
static int spare_rooms(int threads) {
    return threads > 1 ? (threads + 1) / 2 : 0;
}

static int rooms_of(int threads) {
    return threads + spare_rooms(threads);
}

/* The bytes of a payload, or of a shell's samples. */
static size_t earlier_room(const leaf_layout *l) {
    const size_t shell = l->shells ? leaf_layout_shell_max(l) * sample_size(l->type) : 0;
    const size_t payload = leaf_layout_payload_max(l);
    return payload > shell ? payload : shell;
}

uint64_t leaf_writer_families_memory(const leaf_layout *l, int threads, bool in_series) {
    const size_t series =
        in_series ? earlier_room(l) + leaf_layout_stored_max(l) + 2 * (size_t)128 : 0;
    return (uint64_t)rooms_of(threads) * (family_room(l) + series + sizeof(leaf_family) + 128);
}

static status make_room(leaf_writer *w, leaf_family **out) {
    leaf_family *f = mem_zalloc(w->m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    f->all = w->families;
    w->families = f;
    f->bytes = mem_alloc(w->m, family_room(&w->layout));
    *out = f;
    if (!f->bytes || !w->same)
        return f->bytes ? ST_OK : ST_NOMEM;
    f->earlier = mem_alloc(w->m, earlier_room(&w->layout));
    f->stored = mem_alloc(w->m, leaf_layout_stored_max(&w->layout));
    return f->earlier && f->stored ? ST_OK : ST_NOMEM;
}

status leaf_writer_make_families(leaf_writer *w, int threads) {
    for (int i = 0; i < rooms_of(threads); i++) {
        leaf_family *f = NULL;
        status st = make_room(w, &f);
        if (st != ST_OK)
            return st;
        f->next = w->spare;
        w->spare = f;
    }
    return ST_OK;
}

leaf_family *leaf_writer_take_family(leaf_writer *w) {
    leaf_family *f = w->spare;
    w->spare = f->next;
    return f;
}

void leaf_writer_free_families(leaf_writer *w) {
    while (w->families) {
        leaf_family *f = w->families;
        w->families = f->all;
        mem_free(w->m, f->bytes);
        mem_free(w->m, f->earlier);
        mem_free(w->m, f->stored);
        mem_free(w->m, f);
    }
}

/* ---- putting one together ---- */

void leaf_family_begin(leaf_family *f, uint32_t set, const leaf_slab *slab, uint32_t index) {
    f->set = set;
    f->slab = *slab;
    f->index = index;
    f->used = 0;
    f->implied = true;
}

void *leaf_family_room(const leaf_family *f) {
    return f->bytes + f->used;
}

bool leaf_family_is_implied(const leaf_family *f) {
    return f->implied;
}

static size_t make_payload(const leaf_writer *w, leaf_packer *k, uint32_t p, const void *payload,
                           void *to) {
    const size_t size = leaf_layout_payload_bytes(&w->layout, p);
    if (k)
        return leaf_packer_pack(k, p, payload, to);
    if (payload != to)
        memcpy(to, payload, size);
    return size;
}

static status put_payload(leaf_writer *w, leaf_family *f, leaf_packer *k, uint32_t p,
                          const void *payload) {
    char *to = leaf_family_room(f);
    size_t size = 0;
    status st = w->same ? leaf_writer_put_in_series(w, f, k, p, payload, to, &size) : ST_OK;
    f->implied = false;
    if (leaf_writer_is_same(w, p) || st != ST_OK)
        return st;
    if (!size)
        size = make_payload(w, k, p, payload, to);
    w->sizes[p] = size;
    w->checksums[p] = hash_bytes(to, size);
    if (w->before && !w->bases[p])
        st = leaf_writer_find_stored(w, p, to, size);
    if (!leaf_writer_is_same(w, p))
        f->used += size;
    return st;
}

static uint32_t put_entry(leaf_writer *w, const leaf_family *f, uint32_t t,
                          const leaf_entry *entry) {
    const uint32_t p = leaf_layout_samples(&w->layout, f->set, t);
    assert(t < w->layout.treelets && !w->counts);
    memcpy(w->own[p], entry->own, sizeof entry->own);
    w->flags[p] = entry->flags;
    w->sizes[p] = w->checksums[p] = 0;
    return p;
}

static uint64_t sum_samples(const leaf_layout *l, uint32_t t, const void *payload) {
    const leaf_payload shape = leaf_layout_payload(l, t);
    return outside_samples_sum((const char *)payload + shape.samples_at,
                               leaf_payload_sample_bytes(&shape, l->type));
}

status leaf_writer_put(leaf_writer *w, leaf_family *f, leaf_packer *k, uint32_t t,
                       const leaf_entry *entry, const void *payload) {
    const uint32_t p = put_entry(w, f, t, entry);
    if (w->layout.geometry->implies(&w->layout, t, entry->own, entry->flags, payload))
        return ST_OK;
    if (!leaf_layout_is_outside(&w->layout, p))
        return put_payload(w, f, k, p, payload);
    w->checksums[p] = sum_samples(&w->layout, t, payload);
    return ST_OK;
}

void leaf_writer_put_implied(leaf_writer *w, leaf_family *f, uint32_t t, const leaf_entry *entry) {
    assert(implied_payload_may(entry->own, entry->flags));
    (void)put_entry(w, f, t, entry);
}

status leaf_writer_put_shell(leaf_writer *w, leaf_family *f, leaf_packer *k, uint32_t parent,
                             const void *samples) {
    const uint32_t p = leaf_layout_shell(&w->layout, f->set, parent);
    assert(parent < w->layout.shells);
    w->sizes[p] = w->checksums[p] = 0;
    return samples ? put_payload(w, f, k, p, samples) : ST_OK;
}

/* ---- writing it ---- */

/* Whether a family is the next one without a place. Call it with the lock held. */
static bool is_next(const leaf_writer *w, const leaf_family *f) {
    const leaf_order *o = &w->order;
    return f->set == o->set && f->index == o->family && f->slab.level == o->slabs.at.level &&
           f->slab.z == o->slabs.at.z && o->p < w->layout.payloads;
}

/* Whether the next payload is of a treelet without samples, or of the shell below one's parent:
 * nobody puts these. Call it with the lock held. */
static bool next_is_bare(const leaf_writer *w) {
    const leaf_layout *l = &w->layout;
    return w->order.slabs.at.level >= l->sampled;
}

/* Give places to the payloads of the next family, and of those without samples behind it. Returns
 * that of its first byte. */
static uint64_t place_next(leaf_writer *w) {
    const leaf_order first = w->order;
    uint64_t at = 0;
    bool found = false;
    do {
        const uint32_t p = w->order.p;
        const bool bytes = leaf_writer_place(w, p) > 0;
        if (!found && bytes)
            at = w->offsets[p];
        found |= bytes;
        leaf_order_next(&w->order, &w->layout);
    } while (w->order.p < w->layout.payloads &&
             (leaf_order_same_family(&w->order, &first) || next_is_bare(w)));
    return at;
}

/* Take the next family out of the list. Returns NULL if it is not there. */
static leaf_family *take_waiting(leaf_writer *w) {
    leaf_family **at = &w->waiting;
    while (*at && !is_next(w, *at))
        at = &(*at)->next;
    leaf_family *f = *at;
    if (f)
        *at = f->next;
    return f;
}

/* Write a family that is next, and those behind it that wait. Called with the lock held, which is
 * open while it writes. */
static status write_next(leaf_writer *w, leaf_family *own) {
    status st = ST_OK;
    for (leaf_family *f = own; f && st == ST_OK && !w->given_up; f = take_waiting(w)) {
        const uint64_t at = place_next(w);
        pthread_mutex_unlock(&w->lock);
        if (f->used)
            st = out_file_write_at(w->out, at, f->bytes, f->used);
        pthread_mutex_lock(&w->lock);
        if (f != own) {
            f->next = w->spare;
            w->spare = f;
        }
        pthread_cond_broadcast(&w->changed);
    }
    return st;
}

status leaf_writer_end_family(leaf_writer *w, leaf_family **f) {
    leaf_family *own = *f;
    status st = ST_OK;
    pthread_mutex_lock(&w->lock);
    while (!is_next(w, own) && !w->spare && !w->given_up)
        pthread_cond_wait(&w->changed, &w->lock);
    if (w->given_up) {
        /* The job fails, and says why elsewhere. */
    } else if (is_next(w, own)) {
        st = write_next(w, own);
    } else {
        own->next = w->waiting;
        w->waiting = own;
        *f = w->spare;
        w->spare = w->spare->next;
    }
    pthread_mutex_unlock(&w->lock);
    return st;
}

void leaf_writer_give_up(leaf_writer *w) {
    pthread_mutex_lock(&w->lock);
    w->given_up = true;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
}
