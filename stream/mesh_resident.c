#include "stream/mesh_resident.h"

#include <string.h>

#include "formats/leaf/leaf_between.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/mesh/mesh_leaf_check.h"
#include "formats/mesh/mesh_refit.h"

/* ---- sizes ---- */

static uint32_t step_of(const resident_store *s, uint32_t set) {
    return leaf_layout_step(&s->file->layout, set);
}

static bool moves(const resident_store *s) {
    return leaf_layout_moves(&s->file->layout);
}

/* The box of treelet t at the step of a set. */
static const float *bounds_of(const resident_store *s, uint32_t set, uint32_t t) {
    return s->file->mesh->bounds[leaf_layout_bounds(&s->file->layout, step_of(s, set), t)];
}

/* One block holds a treelet, its masks, its nodes if vertices move, and derived data. */
enum { HEAD = (sizeof(resident_mesh) + 63) / 64 * 64 };

static size_t nodes_at(const mesh_shape *shape) {
    return HEAD + (mesh_active_bytes(shape) + 63) / 64 * 64;
}

static size_t derived_at(const resident_store *s, const mesh_shape *shape) {
    return nodes_at(shape) + (moves(s) ? shape->nodes * sizeof(mesh_node) : 0);
}

static size_t block_bytes(const resident_store *s, const mesh_shape *shape) {
    return derived_at(s, shape) + (s->derived.bytes ? s->derived.bytes(shape) : 0);
}

static size_t topology_bytes(const resident_store *s, uint32_t t) {
    const mesh_shape shape = mesh_leaf_shape(s->file->mesh->counts[t]);
    return shape.topology_bytes + source_overhead_bytes(s->source);
}

static size_t values_bytes(const resident_store *s, const mesh_shape *shape) {
    return shape->values_bytes + source_overhead_bytes(s->source);
}

static size_t moved_bytes(const resident_store *s, const mesh_shape *shape) {
    return shape->positions_bytes + source_overhead_bytes(s->source);
}

static size_t gradients_bytes(const resident_store *s, const mesh_shape *shape) {
    return s->gradients ? shape->gradients_bytes + source_overhead_bytes(s->source) : 0;
}

static size_t most_bytes(const resident_store *s, uint32_t t) {
    const mesh_shape shape = mesh_leaf_shape(s->file->mesh->counts[t]);
    return topology_bytes(s, t) + block_bytes(s, &shape) + values_bytes(s, &shape) +
           (moves(s) ? moved_bytes(s, &shape) : 0) + gradients_bytes(s, &shape) + 256;
}

/* List the payloads that treelet t is made of: those of the file that stores them. */
static uint32_t ahead(const resident_store *s, uint32_t set, uint32_t t,
                      uint32_t payloads[RESIDENT_PAYLOADS]) {
    const leaf_file *f = s->file;
    uint32_t parts[LEAF_PARTS_MAX + 1], count = 0;
    int n = f->geometry->parts(&f->layout, set, t, parts);
    if (s->gradients)
        parts[n++] = leaf_layout_gradients(&f->layout, set, t);
    for (int i = 0; i < n; i++) {
        const leaf_blend needs = f->below ? leaf_between_needs(f, parts[i])
                                          : (leaf_blend){{parts[i], LEAF_NO_TREELET}, 0.0};
        for (int k = 0; k < LEAF_BETWEEN_PARTS; k++)
            if (needs.of[k] != LEAF_NO_TREELET)
                payloads[count++] = needs.of[k];
    }
    return count;
}

static uint64_t stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family) {
    (void)family;
    const leaf_file *f = leaf_file_stores(s->file);
    uint32_t payloads[RESIDENT_PAYLOADS];
    uint64_t bytes = 0;
    for (uint32_t i = ahead(s, set, t, payloads); i-- > 0;)
        bytes += f->sizes[payloads[i]];
    return bytes;
}

/* Returns the scratch bytes that refitting any treelet needs. */
static size_t scratch_bytes(const resident_store *s) {
    size_t most = 0;
    for (uint32_t t = 0; s->schema == MESH_REFIT && t < s->file->layout.treelets; t++) {
        const mesh_shape shape = mesh_leaf_shape(s->file->mesh->counts[t]);
        const size_t bytes = mesh_refit_scratch(&shape);
        most = bytes > most ? bytes : most;
    }
    return most;
}

/* ---- one treelet ---- */

static status create(const resident_store *s, uint32_t t, resident_mesh **out) {
    const leaf_file *f = s->file;
    const mesh_shape shape = mesh_leaf_shape(f->mesh->counts[t]);
    resident_mesh *tr = mem_zalloc(s->m, block_bytes(s, &shape));
    if (!tr)
        return ST_NOMEM;
    tr->head.id = t;
    tr->head.set = TREELET_NO_SET;
    tr->mesh = shape;
    tr->active = mesh_active_init((char *)tr + HEAD, &shape);
    if (s->derived.bytes)
        tr->derived = (char *)tr + derived_at(s, &shape);
    tr->first_tet = f->mesh->first_tet[t];
    tr->head.bytes = block_bytes(s, &shape) + 128;
    *out = tr;
    return ST_OK;
}

/* Give a payload back: to the source, or free it if the memory is our own. */
static void give_back(const resident_store *s, const resident_mesh *tr, uint32_t p,
                      const void *payload) {
    if (payload && tr->refit)
        mem_free(s->m, (void *)(uintptr_t)payload);
    else if (payload)
        source_evict(s->source, p, payload);
}

static void strip_mesh(const resident_store *s, resident_mesh *tr) {
    const leaf_layout *l = &s->file->layout;
    if (tr->head.set == TREELET_NO_SET)
        return;
    give_back(s, tr, leaf_layout_values(l, tr->head.set, tr->head.id), tr->values);
    if (tr->moved)
        give_back(s, tr, leaf_layout_positions(l, step_of(s, tr->head.set), tr->head.id),
                  tr->moved);
    if (tr->gradients)
        source_evict(s->source, leaf_layout_gradients(l, tr->head.set, tr->head.id), tr->gradients);
    tr->values = tr->moved = NULL;
    tr->gradients = NULL;
    tr->head.set = TREELET_NO_SET;
    tr->head.bytes = block_bytes(s, &tr->mesh) + 128;
    atomic_store_explicit(&tr->head.masked, 0, memory_order_relaxed);
}

static void strip(const resident_store *s, treelet *tr) {
    strip_mesh(s, (resident_mesh *)tr);
}

static void destroy(const resident_store *s, treelet *tr) {
    if (!tr)
        return;
    strip(s, tr);
    mem_free(s->m, tr);
}

/* ---- reading ---- */

/* Load payload p. from: that of another set, of a file between steps; or NULL. */
static status load_payload(const resident_store *s, uint32_t p, const void *from,
                           resident_scratch *scratch, const void **payload, uint64_t *read) {
    const status st = from ? source_load_after(s->source, p, scratch->unpacker, p, from, payload)
                           : source_load(s->source, p, scratch->unpacker, payload);
    if (st == ST_OK)
        *read += s->file->sizes[p] + leaf_unpacker_take(scratch->unpacker);
    return st;
}

static status load_topology(const resident_store *s, resident_mesh *tr, resident_scratch *scratch,
                            uint64_t *read) {
    if (tr->head.payload)
        return ST_OK;
    const void *topology;
    status st = load_payload(s, tr->head.id, NULL, scratch, &topology, read);
    if (st != ST_OK)
        return st;
    st = mesh_leaf_check_loaded(leaf_file_stores(s->file), tr->head.id, topology);
    if (st == ST_OK)
        tr->head.payload = topology;
    else
        source_evict(s->source, tr->head.id, topology);
    return st;
}

/* Read payload p into our own memory: a raw one from byte `from` on, else all of it (*whole). */
static status read_own(const resident_store *s, uint32_t p, uint32_t from,
                       resident_scratch *scratch, char **payload, bool *whole, uint64_t *read) {
    const leaf_file *f = s->file;
    const uint32_t bytes = leaf_layout_payload_bytes(&f->layout, p);
    *whole = !leaf_file_is_raw(f, p);
    *payload = mem_alloc(s->m, bytes);
    if (!*payload)
        return ST_NOMEM;
    status st = *whole ? source_load_into(s->source, p, scratch->unpacker, *payload)
                       : source_read(s->source, p, from, bytes - from, *payload + from);
    if (st == ST_OK)
        *read += *whole ? f->sizes[p] : bytes - from;
    return st;
}

/* Check a completed payload by the file's checksum. */
static status check_own(const resident_store *s, uint32_t p, const void *payload) {
    return leaf_file_check(s->file, p, payload);
}

static status refit_values(const resident_store *s, resident_mesh *tr, uint32_t set,
                           resident_scratch *scratch, uint64_t *read) {
    const leaf_file *f = s->file;
    const size_t element = (size_t)set * f->layout.treelets + tr->head.id;
    const uint32_t p = leaf_layout_values(&f->layout, set, tr->head.id);
    char *payload = NULL;
    bool whole;
    status st = read_own(s, p, tr->mesh.values_at, scratch, &payload, &whole, read);
    tr->values = payload;
    if (st != ST_OK || whole)
        return st;
    mesh_refit_values(&tr->mesh, tr->head.payload, f->own[element],
                      !(f->flags[element] & LEAF_FLAG_NON_FINITE), payload, scratch->room);
    return check_own(s, p, payload);
}

static status refit_moved(const resident_store *s, resident_mesh *tr, uint32_t step,
                          resident_scratch *scratch, uint64_t *read) {
    const leaf_layout *l = &s->file->layout;
    const uint32_t p = leaf_layout_positions(l, step, tr->head.id);
    char *payload = NULL;
    bool whole;
    status st = read_own(s, p, tr->mesh.moved_at, scratch, &payload, &whole, read);
    tr->moved = payload;
    if (st == ST_OK)
        st = mesh_leaf_check_moved(s->file, step, tr->head.id, payload);
    if (st != ST_OK || whole)
        return st;
    mesh_refit_boxes(&tr->mesh, tr->head.payload, tr->bounds, payload, scratch->room);
    return check_own(s, p, payload);
}

static status load_values(const resident_store *s, resident_mesh *tr, uint32_t set,
                          const resident_mesh *earlier, resident_scratch *scratch, uint64_t *read) {
    const uint32_t p = leaf_layout_values(&s->file->layout, set, tr->head.id);
    return load_payload(s, p, earlier ? earlier->values : NULL, scratch, &tr->values, read);
}

static status load_gradients(const resident_store *s, resident_mesh *tr, uint32_t set,
                             const resident_mesh *earlier, resident_scratch *scratch,
                             uint64_t *read) {
    const uint32_t p = leaf_layout_gradients(&s->file->layout, set, tr->head.id);
    const void *payload;
    const status st =
        load_payload(s, p, earlier ? earlier->gradients : NULL, scratch, &payload, read);
    if (st == ST_OK)
        tr->gradients = mesh_leaf_gradients(payload);
    return st;
}

/* Check the positions that payload p is to be made of. */
static status check_parts(const resident_store *s, uint32_t t, uint32_t p, const void *payload) {
    const leaf_file *below = s->file->below;
    const leaf_blend needs = leaf_between_needs(s->file, p);
    status st = ST_OK;
    for (int i = 0; i < LEAF_BETWEEN_PARTS && st == ST_OK; i++) {
        uint32_t step;
        if (needs.of[i] == LEAF_NO_TREELET)
            continue;
        (void)leaf_layout_block_of(&below->layout, needs.of[i], &step);
        st = mesh_leaf_check_moved(below, step, t, leaf_between_part_of(s->file, p, payload, i));
    }
    return st;
}

static status load_moved(const resident_store *s, resident_mesh *tr, uint32_t step,
                         const resident_mesh *earlier, resident_scratch *scratch, uint64_t *read) {
    const uint32_t p = leaf_layout_positions(&s->file->layout, step, tr->head.id);
    const status st =
        load_payload(s, p, earlier ? earlier->moved : NULL, scratch, &tr->moved, read);
    if (st != ST_OK)
        return st;
    return s->file->below ? check_parts(s, tr->head.id, p, tr->moved)
                          : mesh_leaf_check_moved(s->file, step, tr->head.id, tr->moved);
}

/* ---- boxes and vertices ---- */

/* Point to the vertices and nodes of its step: the topology's, or moved ones. */
static void point_to_geometry(resident_mesh *tr) {
    const char *own_nodes = (const char *)tr + nodes_at(&tr->mesh);
    tr->nodes = tr->moved ? (const mesh_node *)own_nodes : mesh_leaf_nodes(tr->head.payload);
    tr->positions = tr->moved ? mesh_leaf_moved(&tr->mesh, tr->moved)
                              : mesh_leaf_positions(&tr->mesh, tr->head.payload);
}

/* Make the nodes of moved vertices, and what the codes of boxes mean. */
static void make_nodes(resident_mesh *tr) {
    tr->planes = mesh_leaf_frame(tr->bounds);
    if (!tr->moved)
        return;
    const mesh_boxes *boxes = mesh_leaf_moved_boxes(tr->moved);
    const mesh_node *from = mesh_leaf_nodes(tr->head.payload);
    mesh_node *nodes = (mesh_node *)((char *)tr + nodes_at(&tr->mesh));
    for (uint32_t n = 0; n < tr->mesh.nodes; n++) {
        memcpy(nodes[n].lo, boxes[n].lo, sizeof nodes[n].lo);
        memcpy(nodes[n].hi, boxes[n].hi, sizeof nodes[n].hi);
        memcpy(nodes[n].child, from[n].child, sizeof nodes[n].child);
    }
}

static status read_set(const resident_store *s, resident_mesh *tr, uint32_t set,
                       const resident_mesh *earlier, resident_scratch *scratch, uint64_t *read) {
    const uint32_t step = step_of(s, set);
    const bool moved = moves(s) && step > 0;
    status st = tr->refit ? refit_values(s, tr, set, scratch, read)
                          : load_values(s, tr, set, earlier, scratch, read);
    if (st == ST_OK && moved)
        st = tr->refit ? refit_moved(s, tr, step, scratch, read)
                       : load_moved(s, tr, step, earlier, scratch, read);
    if (st == ST_OK && s->gradients)
        st = load_gradients(s, tr, set, earlier, scratch, read);
    return st;
}

static status load_set(const resident_store *s, resident_mesh *tr, uint32_t set,
                       const resident_mesh *earlier, resident_scratch *scratch, uint64_t *read) {
    tr->head.set = set;
    tr->refit = s->schema == MESH_REFIT;
    tr->bounds = bounds_of(s, set, tr->head.id);
    const status st = read_set(s, tr, set, earlier, scratch, read);
    if (st != ST_OK) {
        strip_mesh(s, tr);
        return st;
    }
    tr->head.bytes += values_bytes(s, &tr->mesh) + (tr->moved ? moved_bytes(s, &tr->mesh) : 0) +
                      gradients_bytes(s, &tr->mesh);
    point_to_geometry(tr);
    if (!s->file->below)
        make_nodes(tr);
    return ST_OK;
}

static status load(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   const treelet *earlier, resident_scratch *scratch, treelet **out,
                   uint64_t *read) {
    resident_mesh *tr = (resident_mesh *)*out;
    status st = tr ? ST_OK : create(s, t, &tr);
    if (st != ST_OK)
        return st;
    *out = &tr->head;
    if (!tr->head.payload)
        tr->head.payload = shared;
    st = load_topology(s, tr, scratch, read);
    return st == ST_OK ? load_set(s, tr, set, resident_mesh_of(earlier), scratch, read) : st;
}

/* ---- between steps ---- */

/* The payloads of a set that a treelet has, and where they lie. */
typedef struct set_payloads {
    uint32_t p[3];
    const void *at[3];
    int count;
} set_payloads;

static set_payloads payloads_of(const resident_store *s, const resident_mesh *tr, uint32_t set) {
    const leaf_layout *l = &s->file->layout;
    const uint32_t t = tr->head.id;
    set_payloads all = {{leaf_layout_values(l, set, t)}, {tr->values}, 1};
    if (tr->moved) {
        all.p[all.count] = leaf_layout_positions(l, step_of(s, set), t);
        all.at[all.count++] = tr->moved;
    }
    if (tr->gradients) {
        all.p[all.count] = leaf_layout_gradients(l, set, t);
        all.at[all.count++] = tr->gradients;
    }
    return all;
}

static bool helps(const resident_store *s, const treelet *tr, uint32_t set) {
    const set_payloads all = payloads_of(s, resident_mesh_of(tr), set);
    bool any = false;
    for (int i = 0; s->file->below && i < all.count; i++)
        any |= leaf_between_helps(s->file, all.p[i], all.at[i]);
    return any;
}

/* Another moment between the same two steps needs no reading: masks are made anew, and vertices
 * before them. */
static bool keep(const resident_store *s, treelet *tr) {
    const set_payloads all = payloads_of(s, resident_mesh_of(tr), tr->set);
    for (int i = 0; i < all.count; i++)
        for (int part = 0; part < LEAF_BETWEEN_PARTS; part++)
            if (leaf_between_lacks(s->file, all.p[i], all.at[i], part))
                return false;
    atomic_store_explicit(&tr->masked, 0, memory_order_relaxed);
    return true;
}

/* Nobody looks at values, vertices and boxes before the masks are there. */
static void make_between(const resident_store *s, resident_mesh *tr) {
    const set_payloads all = payloads_of(s, tr, tr->head.set);
    for (int i = 0; i < all.count; i++)
        leaf_between_make(s->file, all.p[i], tr->head.payload, (void *)(uintptr_t)all.at[i]);
    make_nodes(tr);
}

/* ---- other sets ---- */

/* Whether payload i of a set, which a treelet has, is that of another set. */
static bool same_payload(const resident_store *s, const set_payloads *own, uint32_t q, int i) {
    return s->file->below && leaf_between_is_made_of(s->file, q)
               ? leaf_between_is_made(s->file, q, own->at[i])
               : leaf_file_same(s->file, own->p[i], q);
}

/* Whether values, positions and gradients are those of another set. */
static bool same(const resident_store *s, const treelet *head, uint32_t set) {
    const resident_mesh *tr = resident_mesh_of(head);
    const set_payloads own = payloads_of(s, tr, head->set), other = payloads_of(s, tr, set);
    const bool moved = moves(s) && step_of(s, set) > 0;
    bool alike = moved == (tr->moved != NULL) && s->gradients == (tr->gradients != NULL);
    for (int i = 0; i < own.count && alike; i++)
        alike = same_payload(s, &own, other.p[i], i);
    return alike;
}

static void adopt(const resident_store *s, treelet *head, uint32_t set) {
    resident_mesh *tr = (resident_mesh *)head;
    head->set = set;
    tr->bounds = bounds_of(s, set, head->id);
}

/* ---- the row ---- */

/* What is resident of a mesh was copied: it lies where it lay. */
static void renumber(const resident_store *s, treelet *tr, uint32_t set, const void *payload) {
    (void)s;
    (void)payload;
    tr->set = set;
}

static bool shares(const leaf_file *f) {
    (void)f;
    return true;
}

static const treelet_bounds *boxes(const leaf_file *f, uint32_t set) {
    return (const treelet_bounds *)f->mesh->bounds +
           leaf_layout_bounds(&f->layout, leaf_layout_step(&f->layout, set), 0);
}

static void mask(const resident_store *s, treelet *head, const interest *in) {
    resident_mesh *tr = (resident_mesh *)head;
    const size_t element = (size_t)tr->head.set * s->file->layout.treelets + tr->head.id;
    const float *own = s->file->own[element];
    const bool non_finite = s->file->flags[element] & LEAF_FLAG_NON_FINITE;
    if (s->file->below)
        make_between(s, tr);
    mesh_active_compute(tr->active, &tr->mesh, own, non_finite, tr->head.payload, tr->values, in);
    if (tr->derived)
        s->derived.make(tr, in);
}

const resident_kind mesh_resident = {.shares = shares,
                                     .boxes = boxes,
                                     .scratch = scratch_bytes,
                                     .bytes = most_bytes,
                                     .shared_bytes = topology_bytes,
                                     .stored = stored,
                                     .ahead = ahead,
                                     .helps = helps,
                                     .load = load,
                                     .same = same,
                                     .adopt = adopt,
                                     .renumber = renumber,
                                     .keep = keep,
                                     .strip = strip,
                                     .destroy = destroy,
                                     .mask = mask};
