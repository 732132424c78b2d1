#include "stream/mesh_resident.h"

#include <string.h>

#include "formats/leaf/leaf_geometry.h"
#include "formats/mesh/mesh_leaf_check.h"
#include "stream/mesh_refit.h"

/* ---- sizes ---- */

static uint32_t step_of(const resident_store *s, uint32_t set) {
    return leaf_layout_step(&s->file->layout, set);
}

static bool moves(const resident_store *s) {
    return leaf_layout_moves(&s->file->layout);
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

static uint64_t stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family) {
    (void)family;
    const leaf_file *f = s->file;
    uint32_t parts[LEAF_PARTS_MAX];
    uint64_t bytes = s->gradients ? f->sizes[leaf_layout_gradients(&f->layout, set, t)] : 0;
    for (int i = f->geometry->parts(&f->layout, set, t, parts); i-- > 0;)
        bytes += f->sizes[parts[i]];
    return bytes;
}

static uint32_t ahead(const resident_store *s, uint32_t set, uint32_t t,
                      uint32_t payloads[RESIDENT_PAYLOADS]) {
    payloads[0] = t;
    payloads[1] = leaf_layout_values(&s->file->layout, set, t);
    return 2;
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

static status load_topology(const resident_store *s, resident_mesh *tr, resident_scratch *scratch,
                            uint64_t *read) {
    if (tr->head.payload)
        return ST_OK;
    const void *topology;
    status st = source_load(s->source, tr->head.id, scratch->unpacker, &topology);
    if (st != ST_OK)
        return st;
    *read += s->file->sizes[tr->head.id];
    st = mesh_leaf_check_loaded(s->file, tr->head.id, topology);
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
                          resident_scratch *scratch, uint64_t *read) {
    const uint32_t p = leaf_layout_values(&s->file->layout, set, tr->head.id);
    status st = source_load(s->source, p, scratch->unpacker, &tr->values);
    *read += st == ST_OK ? s->file->sizes[p] : 0;
    return st;
}

static status load_gradients(const resident_store *s, resident_mesh *tr, uint32_t set,
                             resident_scratch *scratch, uint64_t *read) {
    const uint32_t p = leaf_layout_gradients(&s->file->layout, set, tr->head.id);
    const void *payload;
    status st = source_load(s->source, p, scratch->unpacker, &payload);
    if (st != ST_OK)
        return st;
    tr->gradients = mesh_leaf_gradients(payload);
    *read += s->file->sizes[p];
    return ST_OK;
}

static status load_moved(const resident_store *s, resident_mesh *tr, uint32_t step,
                         resident_scratch *scratch, uint64_t *read) {
    const uint32_t p = leaf_layout_positions(&s->file->layout, step, tr->head.id);
    status st = source_load(s->source, p, scratch->unpacker, &tr->moved);
    if (st != ST_OK)
        return st;
    *read += s->file->sizes[p];
    return mesh_leaf_check_moved(s->file, step, tr->head.id, tr->moved);
}

/* Point to the vertices and boxes of its step: the topology's, or moved ones. */
static void point_to_geometry(resident_mesh *tr) {
    tr->nodes = mesh_leaf_nodes(tr->head.payload);
    tr->positions = mesh_leaf_positions(&tr->mesh, tr->head.payload);
    if (!tr->moved)
        return;
    const mesh_boxes *boxes = mesh_leaf_moved_boxes(tr->moved);
    mesh_node *nodes = (mesh_node *)((char *)tr + nodes_at(&tr->mesh));
    for (uint32_t n = 0; n < tr->mesh.nodes; n++) {
        memcpy(nodes[n].lo, boxes[n].lo, sizeof nodes[n].lo);
        memcpy(nodes[n].hi, boxes[n].hi, sizeof nodes[n].hi);
        memcpy(nodes[n].child, tr->nodes[n].child, sizeof nodes[n].child);
    }
    tr->nodes = nodes;
    tr->positions = mesh_leaf_moved(&tr->mesh, tr->moved);
}

static status load_set(const resident_store *s, resident_mesh *tr, uint32_t set,
                       resident_scratch *scratch, uint64_t *read) {
    const uint32_t step = step_of(s, set);
    tr->head.set = set;
    tr->refit = s->schema == MESH_REFIT;
    tr->bounds = s->file->mesh->bounds[leaf_layout_bounds(&s->file->layout, step, tr->head.id)];
    tr->planes = mesh_leaf_frame(tr->bounds);
    status st = (tr->refit ? refit_values : load_values)(s, tr, set, scratch, read);
    if (st == ST_OK && moves(s) && step > 0)
        st = (tr->refit ? refit_moved : load_moved)(s, tr, step, scratch, read);
    if (st == ST_OK && s->gradients)
        st = load_gradients(s, tr, set, scratch, read);
    if (st != ST_OK) {
        strip_mesh(s, tr);
        return st;
    }
    tr->head.bytes += values_bytes(s, &tr->mesh) + (tr->moved ? moved_bytes(s, &tr->mesh) : 0) +
                      gradients_bytes(s, &tr->mesh);
    point_to_geometry(tr);
    return ST_OK;
}

static status load(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   const treelet *earlier, resident_scratch *scratch, treelet **out,
                   uint64_t *read) {
    (void)earlier;
    resident_mesh *tr = (resident_mesh *)*out;
    status st = tr ? ST_OK : create(s, t, &tr);
    if (st != ST_OK)
        return st;
    *out = &tr->head;
    if (!tr->head.payload)
        tr->head.payload = shared;
    st = load_topology(s, tr, scratch, read);
    return st == ST_OK ? load_set(s, tr, set, scratch, read) : st;
}

/* ---- the row ---- */

/* What is resident of a mesh was copied: it lies where it lay. */
static void renumber(const resident_store *s, treelet *tr, uint32_t set, const void *payload) {
    (void)s;
    (void)payload;
    tr->set = set;
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
    mesh_active_compute(tr->active, &tr->mesh, own, non_finite, tr->head.payload, tr->values, in);
    if (tr->derived)
        s->derived.make(tr, in);
}

const resident_kind mesh_resident = {.shares = true,
                                     .boxes = boxes,
                                     .scratch = scratch_bytes,
                                     .bytes = most_bytes,
                                     .shared_bytes = topology_bytes,
                                     .stored = stored,
                                     .ahead = ahead,
                                     .load = load,
                                     .renumber = renumber,
                                     .strip = strip,
                                     .destroy = destroy,
                                     .mask = mask};
