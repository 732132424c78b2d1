#include "prep/export/vdb_writer.h"

#include <assert.h>
#include <endian.h>
#include <math.h>
#include <string.h>

#include "formats/base/out_stream.h"
#include "formats/base/pool.h"
#include "formats/base/vec3.h"
#include "formats/leaf/implied_payload.h"
#include "formats/leaf/leaf_unpacker.h"
#include "prep/export/head_text.h"
#include "prep/export/vdb_node.h"

/* Constants of the file format, from OpenVDB's io/Archive and io/Compression. */
enum {
    MAGIC = 0x56444220,
    FILE_VERSION = 224,
    LIBRARY_MAJOR = 10,
    ACTIVE_MASK = 2,
    UUID_LETTERS = 36,
    UPPER_SIDE_LOG2 = VDB_UPPER_LOG2 - VDB_NODE_LOG2,
    UPPER_SLOTS = 1 << 3 * UPPER_SIDE_LOG2,
    SPARE_BYTES = 64 << 10
};
static const double det_least = 3e-15; /* OpenVDB refuses a map with a smaller determinant */

/* State of a node of 128^3 voxels. */
typedef enum node_state { NODE_NOTHING, NODE_TILE, NODE_CHILD } node_state;

typedef struct bench {
    char *samples, *payload;
    leaf_unpacker *unpacker;
    bool *empty; /* of the node's slots */
    unsigned char *out;
    size_t size; /* bytes in `out` */
} bench;

typedef struct writer {
    mem *m;
    const sample_export *e;
    const leaf_layout *layout;
    out_stream *out;
    uint64_t at; /* bytes written */
    pool *workers;
    int threads;
    bench *benches; /* indexed by a node's place in the batch, and by worker */
    uint32_t set, background;
    uint64_t nodes_done; /* slots examined in this pass */
    double passes_done, passes;
    /* The current node of 4096^3 voxels: */
    uint32_t upper[3];
    uint8_t state[UPPER_SLOTS];
    uint32_t value[UPPER_SLOTS];    /* of tiles */
    uint16_t children[UPPER_SLOTS]; /* slots of its children, in order */
    uint32_t child_count;
    /* The current batch of its children: */
    uint32_t first;
    bool values; /* write their values, else their topology */
} writer;

status vdb_writer_check(const grid *g) {
    double column[3][3];
    if (grid_is_rectilinear(g))
        return status_describe(ST_UNSUPPORTED,
                               "OpenVDB has samples at equal distances; this grid's axes are "
                               "uneven, which .vtr and .nrrd can hold");
    for (int a = 0; a < 3; a++)
        for (int row = 0; row < 3; row++)
            column[a][row] = g->to_world[row][a];
    if (fabs(vec3_det(column[0], column[1], column[2])) >= det_least)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "voxels of less than %g cubic units: OpenVDB takes the map of such for "
                           "singular; .nrrd can hold it",
                           det_least);
}

/* ---- bytes ---- */

static status put(writer *w, const void *bytes, size_t size) {
    w->at += size;
    return out_stream_write(w->out, bytes, size);
}

static void add_u32(head_text *h, uint32_t value) {
    unsigned char bytes[4];
    vdb_put(bytes, value);
    head_text_bytes(h, bytes, sizeof bytes);
}

static void add_u64(head_text *h, uint64_t value) {
    const uint64_t little = htole64(value);
    head_text_bytes(h, &little, sizeof little);
}

static void add_double(head_text *h, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    add_u64(h, bits);
}

static void add_string(head_text *h, const char *text) {
    add_u32(h, (uint32_t)strlen(text));
    head_text_bytes(h, text, strlen(text));
}

static void add_meta(head_text *h, const char *name, const char *value) {
    add_string(h, name);
    add_string(h, "string");
    add_string(h, value);
}

static status put_text(writer *w, head_text *h) {
    status st = h->st == ST_OK ? put(w, h->text, h->size) : h->st;
    head_text_release(h);
    return st;
}

/* ---- nodes ---- */

static uint32_t implied_bits(const writer *w, uint32_t p) {
    const float *own = w->e->f->own[p];
    const float value = own[0] > own[1] ? NAN : own[0];
    const int32_t whole = w->layout->type == SAMPLE_F32 ? 0 : (int32_t)value;
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return w->layout->type == SAMPLE_F32 ? bits : (uint32_t)whole;
}

/* The exported part of a node. Returns false if it is empty. */
static bool node_box(const writer *w, const uint32_t origin[3], grid_box *b) {
    *b = grid_box_of(w->e->part);
    for (int a = 0; a < 3; a++) {
        const uint32_t end = origin[a] + (1u << VDB_NODE_LOG2);
        b->lo[a] = origin[a] > b->lo[a] ? origin[a] : b->lo[a];
        b->end[a] = end < b->end[a] ? end : b->end[a];
        if (b->lo[a] >= b->end[a])
            return false;
    }
    return true;
}

static bool holds(const grid_box *b, const uint32_t node[3]) {
    return b->lo[0] <= node[0] && node[0] < b->end[0] && b->lo[1] <= node[1] &&
           node[1] < b->end[1] && b->lo[2] <= node[2] && node[2] < b->end[2];
}

static void corners_of(const writer *w, uint32_t corner[2][3]) {
    for (int a = 0; a < 3; a++) {
        corner[0][a] = w->e->part->lo[a];
        corner[1][a] = w->e->part->end[a] - 1;
    }
}

/* Returns whether the directory says that the whole box has one value. */
static bool is_constant(const writer *w, const grid_box *b, uint32_t *bits) {
    uint32_t from[3], count[3];
    grid_box_treelets(b, w->layout, from, count);
    for (uint32_t i = 0; i < count[0] * count[1] * count[2]; i++) {
        const uint32_t place[3] = {from[0] + i % count[0], from[1] + i / count[0] % count[1],
                                   from[2] + i / count[0] / count[1]};
        const uint32_t p =
            leaf_layout_samples(w->layout, w->set, leaf_layout_find(w->layout, b->level, place));
        if (!leaf_file_is_implied(w->e->f, p) || (i > 0 && implied_bits(w, p) != *bits))
            return false;
        *bits = implied_bits(w, p);
    }
    return true;
}

static node_state state_of(const writer *w, const uint32_t origin[3], uint32_t *bits) {
    uint32_t corner[2][3];
    grid_box b;
    bool whole = true;
    if (!node_box(w, origin, &b))
        return NODE_NOTHING;
    if (!is_constant(w, &b, bits))
        return NODE_CHILD;
    corners_of(w, corner);
    for (int a = 0; a < 3; a++)
        whole &= b.end[a] - b.lo[a] == 1u << VDB_NODE_LOG2;
    if (*bits != w->background)
        return whole ? NODE_TILE : NODE_CHILD;
    return holds(&b, corner[0]) || holds(&b, corner[1]) ? NODE_CHILD : NODE_NOTHING;
}

static void slot_origin(const writer *w, uint32_t slot, uint32_t origin[3]) {
    for (int a = 0; a < 3; a++)
        origin[a] =
            w->upper[a] +
            ((slot >> (2 - a) * UPPER_SIDE_LOG2 & ((1u << UPPER_SIDE_LOG2) - 1)) << VDB_NODE_LOG2);
}

/* Classify the slots of the node of 4096^3 voxels at w->upper. Returns false if all are empty. */
static bool look(writer *w) {
    bool any = false;
    w->child_count = 0;
    for (uint32_t slot = 0; slot < UPPER_SLOTS; slot++) {
        uint32_t origin[3];
        slot_origin(w, slot, origin);
        w->value[slot] = 0;
        w->state[slot] = (uint8_t)state_of(w, origin, &w->value[slot]);
        any |= w->state[slot] != NODE_NOTHING;
        if (w->state[slot] == NODE_CHILD)
            w->children[w->child_count++] = (uint16_t)slot;
    }
    return any;
}

/* ---- children ---- */

/* The part of a box whose nodes belong to the treelet at a place. */
static grid_box own_part(const writer *w, const grid_box *b, const uint32_t place[3]) {
    grid_box own = *b;
    for (int a = 0; a < 3; a++) {
        const uint32_t first = place[a] << w->layout->cells_log2;
        const uint32_t end = grid_box_end(w->layout, b->level, a, place[a]);
        own.lo[a] = first > b->lo[a] ? first : b->lo[a];
        own.end[a] = end < b->end[a] ? end : b->end[a];
    }
    return own;
}

/* Mark the slots of these nodes as empty. No two treelets share a slot. */
static void mark_empty(const grid_box *own, bool *empty) {
    const uint32_t log2 = VDB_NODE_LOG2 - VDB_LEAF_LOG2, most = (1u << log2) - 1;
    uint32_t first[3], last[3];
    for (int a = 0; a < 3; a++) {
        first[a] = own->lo[a] >> VDB_LEAF_LOG2 & most;
        last[a] = (own->end[a] - 1) >> VDB_LEAF_LOG2 & most;
    }
    for (uint32_t x = first[0]; x <= last[0]; x++)
        for (uint32_t y = first[1]; y <= last[1]; y++)
            for (uint32_t z = first[2]; z <= last[2]; z++)
                empty[(x << log2 | y) << log2 | z] = true;
}

static status load_treelet(const writer *w, const bench *b, const vdb_node *n,
                           const uint32_t place[3]) {
    const uint32_t t = leaf_layout_find(w->layout, n->box.level, place);
    const uint32_t p = leaf_layout_samples(w->layout, w->set, t);
    const grid_box own = own_part(w, &n->box, place);
    if (leaf_file_is_implied(w->e->f, p) && implied_bits(w, p) == w->background &&
        !holds(&own, n->corner[0]) && !holds(&own, n->corner[1])) {
        mark_empty(&own, b->empty);
        return ST_OK;
    }
    const status st = leaf_file_load(w->e->f, p, b->unpacker, b->payload);
    if (st == ST_OK)
        grid_box_copy(&n->box, w->layout, place, b->payload);
    return st;
}

static status load(const writer *w, const bench *b, const vdb_node *n) {
    uint32_t from[3], count[3];
    status st = ST_OK;
    memset(b->empty, 0, VDB_SLOTS * sizeof *b->empty);
    grid_box_treelets(&n->box, w->layout, from, count);
    for (uint32_t i = 0; i < count[0] * count[1] * count[2] && st == ST_OK; i++) {
        const uint32_t place[3] = {from[0] + i % count[0], from[1] + i / count[0] % count[1],
                                   from[2] + i / count[0] / count[1]};
        st = load_treelet(w, b, n, place);
    }
    return st;
}

static status make_child(void *ctx, size_t index, int worker) {
    writer *w = ctx;
    bench *mine = &w->benches[worker], *its = &w->benches[index];
    vdb_node n = {.type = w->layout->type, .background = w->background, .empty = mine->empty};
    uint32_t origin[3];
    slot_origin(w, w->children[w->first + index], origin);
    const bool there = node_box(w, origin, &n.box);
    assert(there);
    (void)there;
    n.box.samples = mine->samples;
    corners_of(w, n.corner);
    const status st = load(w, mine, &n);
    if (st == ST_OK)
        its->size = w->values ? vdb_node_values(&n, its->out) : vdb_node_topology(&n, its->out);
    return st;
}

static status step(const writer *w, uint32_t children_done) {
    const uint32_t *dims = w->layout->level[w->e->part->level].dims;
    double uppers = 1;
    for (int a = 0; a < 3; a++)
        uppers *= ceil(ldexp(dims[a], -VDB_UPPER_LOG2));
    const double share = ((double)w->nodes_done + (double)children_done / w->child_count) / uppers;
    return progress_step(w->e->p, "export", fmin(1, (w->passes_done + share) / w->passes));
}

static status put_children(writer *w) {
    status st = ST_OK;
    for (w->first = 0; w->first < w->child_count && st == ST_OK;) {
        const uint32_t left = w->child_count - w->first;
        const uint32_t count = left < (uint32_t)w->threads ? left : (uint32_t)w->threads;
        st = pool_run(w->workers, count, make_child, w);
        for (uint32_t i = 0; i < count && st == ST_OK; i++)
            st = put(w, w->benches[i].out, w->benches[i].size);
        w->first += count;
        if (st == ST_OK)
            st = step(w, w->first);
    }
    return st;
}

/* ---- the tree ---- */

/* Call each() for every node of 4096^3 voxels that is not empty, in order of x, then y, then z. */
static status for_uppers(writer *w, status (*each)(writer *w)) {
    const grid_part *p = w->e->part;
    status st = ST_OK;
    uint32_t first[3], *at = w->upper;
    for (int a = 0; a < 3; a++)
        first[a] = p->lo[a] >> VDB_UPPER_LOG2 << VDB_UPPER_LOG2;
    w->nodes_done = 0;
    for (at[0] = first[0]; at[0] < p->end[0]; at[0] += 1 << VDB_UPPER_LOG2)
        for (at[1] = first[1]; at[1] < p->end[1]; at[1] += 1 << VDB_UPPER_LOG2)
            for (at[2] = first[2]; at[2] < p->end[2] && st == ST_OK; at[2] += 1 << VDB_UPPER_LOG2) {
                if (look(w))
                    st = each(w);
                w->nodes_done++;
            }
    return st;
}

static status count_upper(writer *w) {
    w->first++;
    return ST_OK;
}

static void add_mask(head_text *h, const uint8_t *state, node_state which) {
    for (int i = 0; i < UPPER_SLOTS; i += 8) {
        unsigned char byte = 0;
        for (int bit = 0; bit < 8; bit++)
            byte |= (unsigned char)((state[i + bit] == which) << bit);
        head_text_bytes(h, &byte, 1);
    }
}

static status put_upper(writer *w) {
    head_text h = {.m = w->m};
    for (int a = 0; a < 3; a++)
        add_u32(&h, w->upper[a]);
    add_mask(&h, w->state, NODE_CHILD);
    add_mask(&h, w->state, NODE_TILE);
    head_text_bytes(&h, "", 1); /* inactive values are the background */
    for (int i = 0; i < UPPER_SLOTS; i++)
        if (w->state[i] == NODE_TILE)
            add_u32(&h, w->value[i]);
    const status st = put_text(w, &h);
    return st == ST_OK ? put_children(w) : st;
}

static status put_topology(writer *w) {
    head_text h = {.m = w->m};
    w->first = 0;
    status st = for_uppers(w, count_upper);
    add_u32(&h, 1); /* buffers */
    add_u32(&h, w->background);
    add_u32(&h, 0); /* tiles of the root: none */
    add_u32(&h, w->first);
    w->values = false;
    if (st == ST_OK)
        st = put_text(w, &h);
    return st == ST_OK ? for_uppers(w, put_upper) : st;
}

static status put_values(writer *w) {
    w->values = true;
    return for_uppers(w, put_children);
}

/* ---- a grid ---- */

/* Choose as background the value that most treelets of one value have. Ties go to the lowest bits;
 * without such treelets it is 0. Only the first CANDIDATES different values are counted: a
 * background is not one of many. */
enum { CANDIDATES = 64 };

static void find_background(writer *w) {
    const leaf_file *f = w->e->f;
    uint32_t bits[CANDIDATES], counts[CANDIDATES], known = 0, best = 0;
    for (uint32_t t = 0; t < w->layout->treelets; t++) {
        const uint32_t p = leaf_layout_samples(w->layout, w->set, t);
        if (w->layout->level_of[t] != w->e->part->level ||
            !implied_payload_may(f->own[p], f->flags[p]))
            continue;
        const uint32_t value = implied_bits(w, p);
        uint32_t i = 0;
        while (i < known && bits[i] != value)
            i++;
        if (i == known && known < CANDIDATES) {
            bits[known] = value;
            counts[known++] = 0;
        }
        if (i < known)
            counts[i]++;
    }
    w->background = 0;
    for (uint32_t i = 0; i < known; i++)
        if (counts[i] > best || (counts[i] == best && bits[i] < w->background)) {
            best = counts[i];
            w->background = bits[i];
        }
}

/* OpenVDB multiplies row vectors by its maps: the axes are the matrix's first rows. */
static void add_map(const writer *w, head_text *h) {
    const double *map = w->e->f->header.to_world;
    const double apart = ldexp(1, (int)w->e->part->level);
    add_string(h, "AffineMap");
    for (int a = 0; a < 4; a++) {
        for (int row = 0; row < 3; row++)
            add_double(h, map[4 * row + a] * (a < 3 ? apart : 1));
        add_double(h, a == 3);
    }
}

static status put_grid_head(writer *w, const char *name) {
    const sample_type type = w->layout->type;
    const bool whole = type != SAMPLE_F32;
    head_text h = {.m = w->m};
    add_u32(&h, ACTIVE_MASK);
    add_u32(&h, whole ? 2 : 1);
    if (whole)
        add_meta(&h, "leafcast_type", sample_name(type));
    add_meta(&h, "name", name);
    add_map(w, &h);
    return put_text(w, &h);
}

static status put_offsets(writer *w, uint64_t at, const uint64_t offsets[3]) {
    head_text h = {.m = w->m};
    for (int i = 0; i < 3; i++)
        add_u64(&h, offsets[i]);
    status st = h.st;
    if (st == ST_OK && out_stream_is_file(w->out))
        st = out_stream_patch(w->out, at, h.text, h.size);
    head_text_release(&h);
    return st;
}

static status put_grid(writer *w, uint32_t index) {
    head_text h = {.m = w->m};
    uint64_t offsets[3] = {0};
    w->set = w->e->sets[index];
    find_background(w);
    add_string(&h, w->e->names[index]);
    add_string(&h, w->layout->type == SAMPLE_F32 ? "Tree_float_5_4_3" : "Tree_int32_5_4_3");
    add_string(&h, ""); /* shares no other grid's tree */
    head_text_bytes(&h, offsets, sizeof offsets);
    status st = put_text(w, &h);
    const uint64_t at = w->at - sizeof offsets;
    offsets[0] = w->at;
    if (st == ST_OK)
        st = put_grid_head(w, w->e->names[index]);
    if (st == ST_OK)
        st = put_topology(w);
    w->passes_done++;
    offsets[1] = w->at;
    if (st == ST_OK)
        st = put_values(w);
    w->passes_done++;
    offsets[2] = w->at;
    return st == ST_OK ? put_offsets(w, at, offsets) : st;
}

/* ---- the file ---- */

/* Write the input's id in the form of a UUID, so that the same input gives the same bytes. */
static void add_uuid(const writer *w, head_text *h) {
    static const char hex[] = "0123456789abcdef";
    const uint64_t *id = w->e->f->header.id;
    for (int i = 0, digit = 0; i < UUID_LETTERS; i++) {
        const bool dash = i == 8 || i == 13 || i == 18 || i == 23;
        const char c = dash ? '-' : hex[id[digit / 16] >> 4 * (digit % 16) & 15];
        digit += !dash;
        head_text_bytes(h, &c, 1);
    }
}

static status put_head(writer *w) {
    head_text h = {.m = w->m};
    const char has_offsets = out_stream_is_file(w->out);
    add_u64(&h, MAGIC);
    add_u32(&h, FILE_VERSION);
    add_u32(&h, LIBRARY_MAJOR);
    add_u32(&h, 0);
    head_text_bytes(&h, &has_offsets, 1);
    add_uuid(w, &h);
    add_u32(&h, 1);
    add_meta(&h, "creator", "leafcast");
    add_u32(&h, w->e->count);
    return put_text(w, &h);
}

static status plan(writer *w, size_t *samples, size_t *payload) {
    *samples = ((size_t)1 << 3 * VDB_NODE_LOG2) * sample_size(w->layout->type);
    *payload = leaf_layout_aligned(leaf_layout_payload_max(w->layout), LEAF_ALIGN_LOG2);
    const uint64_t each = *samples + *payload + leaf_unpacker_memory(w->e->f) +
                          vdb_node_values_max() + VDB_SLOTS + 4 * LEAF_ALIGN;
    const uint64_t fixed = mem_used(w->m) + SPARE_BYTES + UPPER_SLOTS * VDB_WIDTH * 2;
    w->threads = w->e->threads;
    while (w->m->limit && w->threads > 1 && fixed + (uint64_t)w->threads * each > w->m->limit)
        w->threads--;
    if (!w->m->limit || fixed + each <= w->m->limit)
        return ST_OK;
    return status_describe(
        ST_NOMEM, "a memory budget of %llu KiB is too small: OpenVDB's nodes need %llu KiB",
        (unsigned long long)(w->m->limit >> 10), (unsigned long long)((fixed + each) >> 10) + 1);
}

static status allocate(writer *w) {
    size_t samples, payload;
    status st = plan(w, &samples, &payload);
    if (st != ST_OK)
        return st;
    w->benches = mem_array(w->m, (size_t)w->threads, sizeof *w->benches);
    if (!w->benches)
        return ST_NOMEM;
    for (int i = 0; i < w->threads; i++) {
        bench *b = &w->benches[i];
        b->samples = mem_alloc(w->m, samples);
        b->payload = mem_alloc(w->m, payload);
        b->out = mem_alloc(w->m, vdb_node_values_max());
        b->empty = mem_array(w->m, VDB_SLOTS, sizeof *b->empty);
        if (!b->samples || !b->payload || !b->out || !b->empty)
            return ST_NOMEM;
        st = leaf_unpacker_create(w->m, w->e->f, &b->unpacker);
        if (st != ST_OK)
            return st;
    }
    return pool_create(w->m, w->threads, &w->workers);
}

static void release(writer *w) {
    pool_destroy(w->workers);
    for (int i = 0; w->benches && i < w->threads; i++) {
        mem_free(w->m, w->benches[i].samples);
        mem_free(w->m, w->benches[i].payload);
        leaf_unpacker_destroy(w->benches[i].unpacker);
        mem_free(w->m, w->benches[i].out);
        mem_free(w->m, w->benches[i].empty);
    }
    mem_free(w->m, w->benches);
    mem_free(w->m, w);
}

status vdb_writer_run(mem *m, const sample_export *e) {
    writer *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return ST_NOMEM;
    w->m = m;
    w->e = e;
    w->layout = &e->f->layout;
    w->passes = 2.0 * e->count;
    status st = allocate(w);
    if (st == ST_OK)
        st = out_stream_create(m, e->path, e->force, false, &w->out);
    if (st == ST_OK)
        st = put_head(w);
    for (uint32_t i = 0; i < e->count && st == ST_OK; i++)
        st = put_grid(w, i);
    if (st == ST_OK)
        st = out_stream_commit(w->out);
    else
        out_stream_discard(w->out);
    release(w);
    return st;
}
