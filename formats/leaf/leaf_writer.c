#include "formats/leaf/leaf_writer.h"
#include "formats/leaf/implied_payload.h"

#include <assert.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/hash.h"
#include "formats/leaf/deviation.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_head.h"
#include "formats/mesh/mesh_leaf.h"

struct leaf_writer {
    mem *m;
    leaf_parameters p;
    leaf_layout layout;
    leaf_header header;
    leaf_section table[LEAF_SECTION_LAST + LEAF_ANCILLARY_LAST];
    /* The sections of the directory, see leaf_section_kind. */
    float (*ranges)[2];
    float (*own)[2];
    uint8_t *flags;
    uint64_t *offsets, *sizes, *checksums;
    double *axes; /* rectilinear: all three, one behind the other */
    float (*bounds)[6];
    uint32_t (*counts)[4];
    char (*names)[64]; /* or NULL; so are times */
    double *times;
    leaf_part *parts;      /* coarse grids; or NULL */
    histogram *histograms; /* per set; or NULL */
    uint16_t *deviations;  /* codes of coarse treelets' bricks; or NULL */
    world_frame frame;
    bool settled;
    out_file *out;
    /* Compressed payloads, and a mesh's, wait here until all sizes are known. NULL: sizes are known
     * from the start. */
    out_file *scratch;
    uint64_t *scratch_at; /* per payload; or NOT_THERE */
    void *copy_buffer;
    /* Guarded by the lock: */
    pthread_mutex_t lock;
    uint64_t scratch_end;
    uint32_t placed;   /* how many payloads have a place: all before them have been put */
    leaf_placing next; /* where the next payload goes */
    bool implied;      /* some payloads have no bytes */
};

#define NOT_THERE UINT64_MAX
#define UNKNOWN   UINT64_MAX /* of a size */

/* Memory per treelet of the layout, per range, and per payload of the directory. */
enum {
    LAYOUT_BYTES = 3 * sizeof(uint32_t) + sizeof(uint32_t) + 1,
    RANGE_BYTES = 2 * sizeof(float[2]) + 1,
    PAYLOAD_BYTES = 3 * sizeof(uint64_t),
    MESH_BYTES = sizeof(float[6]) + sizeof(uint32_t[4])
};

uint64_t leaf_writer_memory(const leaf_layout *l, leaf_codec codec) {
    uint64_t each = RANGE_BYTES + PAYLOAD_BYTES;
    uint64_t bytes = sizeof(leaf_writer) + sizeof(histogram) + 4096;
    if (codec != LEAF_CODEC_RAW) {
        each += sizeof(uint64_t);
        bytes += leaf_layout_payload_max(l);
    }
    for (int a = 0; a < 3; a++)
        bytes += l->level[0].dims[a] * sizeof(double);
    if (l->sets > 1)
        bytes += l->sets * (sizeof(histogram) + sizeof(char[64]) + sizeof(double));
    return bytes + l->treelets * (uint64_t)LAYOUT_BYTES + l->payloads * each;
}

static leaf_blocks blocks_of(const leaf_mesh *mesh) {
    return (leaf_blocks){.treelets = mesh->treelets,
                         .fields = mesh->fields,
                         .steps = mesh->steps,
                         .gradients = mesh->gradients,
                         .moving = mesh->moving};
}

uint64_t leaf_writer_mesh_memory(const leaf_mesh *mesh, size_t payload_max) {
    const leaf_blocks blocks = blocks_of(mesh);
    const uint64_t sets = (uint64_t)mesh->fields * mesh->steps;
    const uint64_t each = LAYOUT_BYTES + MESH_BYTES + sets * RANGE_BYTES +
                          (mesh->moving ? mesh->steps - 1 : 0) * sizeof(float[6]);
    return sizeof(leaf_writer) + 4096 + payload_max + mesh->treelets * each +
           mesh->fields * sizeof(char[64]) + mesh->steps * sizeof(double) +
           (mesh->coarse ? sets * sizeof(leaf_part) : 0) +
           (sets <= LEAF_HISTOGRAMS_MAX ? sets * sizeof(histogram) : 0) +
           leaf_blocks_payloads(&blocks) * (PAYLOAD_BYTES + sizeof(uint64_t));
}

/* ---- creating ---- */

static uint64_t sections_end(const leaf_writer *w) {
    const leaf_section *last = &w->table[w->header.sections - 1];
    return last->offset + last->bytes;
}

/* Whether the file has a section of this kind. */
static bool has_section(const leaf_writer *w, uint32_t kind) {
    if (!leaf_section_bytes(&w->header, kind))
        return false;
    return kind == LEAF_SECTION_FIELDS       ? w->names != NULL
           : kind == LEAF_SECTION_TIMES      ? w->times != NULL
           : kind == LEAF_SECTION_COARSE     ? w->parts != NULL
           : kind == LEAF_SECTION_HISTOGRAMS ? w->histograms != NULL
           : kind == LEAF_SECTION_DEVIATIONS ? w->deviations != NULL
           : kind == LEAF_SECTION_WORLD      ? world_frame_is_told(&w->frame)
                                             : true;
}

static void add_section(leaf_writer *w, uint32_t kind) {
    leaf_header *h = &w->header;
    if (has_section(w, kind))
        w->table[h->sections++] =
            (leaf_section){.kind = kind, .version = 1, .bytes = leaf_section_bytes(h, kind)};
}

static void place_sections(leaf_writer *w) {
    leaf_header *h = &w->header;
    for (uint32_t kind = 1; kind <= LEAF_SECTION_LAST; kind++)
        add_section(w, kind);
    for (uint32_t i = 1; i <= LEAF_ANCILLARY_LAST; i++)
        add_section(w, LEAF_SECTION_ANCILLARY | i);
    uint64_t end = LEAF_HEADER_BYTES + h->sections * sizeof *w->table;
    for (uint32_t i = 0; i < h->sections; i++) {
        w->table[i].offset = leaf_layout_aligned(end, LEAF_ALIGN_LOG2);
        end = w->table[i].offset + w->table[i].bytes;
    }
    w->next = (leaf_placing){.end = end};
}

/* Place the payloads, once all sizes are known. */
static void place_payloads(leaf_writer *w) {
    leaf_placing next = {.end = sections_end(w)};
    w->header.payload_bytes = 0;
    for (uint32_t p = 0; p < w->layout.payloads; p++) {
        w->offsets[p] = leaf_placing_next(&next, &w->layout, p, w->sizes[p], w->p.run_align_log2);
        w->header.payload_bytes += w->sizes[p];
    }
    w->header.file_bytes = leaf_layout_aligned(next.end, w->p.run_align_log2);
}

static status allocate_histograms(leaf_writer *w) {
    const uint32_t sets = w->layout.sets;
    if (!w->p.histograms || sets > LEAF_HISTOGRAMS_MAX)
        return ST_OK;
    w->histograms = mem_array(w->m, sets, sizeof *w->histograms);
    return w->histograms ? ST_OK : ST_NOMEM;
}

/* Allocate the directory. ranges: elements of RANGES, OWN and FLAGS. */
static status allocate(leaf_writer *w, size_t ranges) {
    const size_t payloads = w->layout.payloads;
    w->ranges = mem_array(w->m, ranges, sizeof *w->ranges);
    w->own = mem_array(w->m, ranges, sizeof *w->own);
    w->flags = mem_array(w->m, ranges, sizeof *w->flags);
    w->offsets = mem_array(w->m, payloads, sizeof *w->offsets);
    w->sizes = mem_array(w->m, payloads, sizeof *w->sizes);
    w->checksums = mem_array(w->m, payloads, sizeof *w->checksums);
    if (!w->ranges || !w->own || !w->flags || !w->offsets || !w->sizes || !w->checksums)
        return ST_NOMEM;
    return allocate_histograms(w);
}

/* Allocate the deviations, all zero. */
static status allocate_deviations(leaf_writer *w) {
    const size_t bricks = deviation_count(&w->layout);
    if (!w->p.deviations || bricks == 0)
        return ST_OK;
    w->deviations = mem_array(w->m, bricks, sizeof *w->deviations);
    return w->deviations ? ST_OK : ST_NOMEM;
}

static status allocate_axes(leaf_writer *w, const grid *g) {
    if (!grid_is_rectilinear(g))
        return ST_OK;
    size_t nodes = (size_t)g->dims[0] + g->dims[1] + g->dims[2];
    w->axes = mem_array(w->m, nodes, sizeof *w->axes);
    if (!w->axes)
        return ST_NOMEM;
    double *to = w->axes;
    for (int a = 0; a < 3; to += g->dims[a++])
        memcpy(to, g->axis[a], g->dims[a] * sizeof *to);
    return ST_OK;
}

static status allocate_mesh(leaf_writer *w) {
    const size_t steps = 1 + w->layout.moved_steps;
    w->bounds = mem_array(w->m, w->layout.treelets * steps, sizeof *w->bounds);
    w->counts = mem_array(w->m, w->layout.treelets, sizeof *w->counts);
    return w->bounds && w->counts ? ST_OK : ST_NOMEM;
}

static status copy_labels(leaf_writer *w, const leaf_sets *sets) {
    if (sets->names) {
        w->names = mem_array(w->m, sets->fields, sizeof *w->names);
        if (!w->names)
            return ST_NOMEM;
        for (uint32_t i = 0; i < sets->fields; i++)
            leaf_head_text(w->names[i], sizeof w->names[i], sets->names[i]);
    }
    if (sets->times && sets->steps > 1) {
        w->times = mem_array(w->m, sets->steps, sizeof *w->times);
        if (!w->times)
            return ST_NOMEM;
        memcpy(w->times, sets->times, sets->steps * sizeof *w->times);
    }
    return ST_OK;
}

static status allocate_parts(leaf_writer *w, const leaf_mesh *mesh) {
    if (mesh->coarse) {
        w->parts = mem_array(w->m, w->layout.sets, sizeof *w->parts);
        if (!w->parts)
            return ST_NOMEM;
    }
    return ST_OK;
}

/* Create the scratch file for payloads whose places are known only in the end. */
static status create_scratch(leaf_writer *w, const char *path) {
    w->scratch_at = mem_array(w->m, w->layout.payloads, sizeof *w->scratch_at);
    for (uint32_t p = 0; p < w->layout.payloads; p++)
        w->sizes[p] = UNKNOWN;
    return w->scratch_at ? out_file_scratch(w->m, path, &w->scratch) : ST_NOMEM;
}

/* Allocate the buffer for copying; for a mesh not before its counts are known. */
static status allocate_copy(leaf_writer *w) {
    w->copy_buffer = mem_alloc(w->m, leaf_layout_payload_max(&w->layout));
    return w->copy_buffer ? ST_OK : ST_NOMEM;
}

static leaf_writer *new_writer(mem *m, const leaf_parameters *p) {
    leaf_writer *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return NULL;
    w->m = m;
    w->p = *p;
    (void)pthread_mutex_init(&w->lock, NULL); /* cannot fail on Linux */
    return w;
}

static status lay_out_grid(leaf_writer *w, const grid *g, const leaf_sets *sets) {
    status st = leaf_layout_init(&w->layout, w->m, g->dims, w->p.cells_log2, w->p.halo,
                                 sample_stored(g->type));
    if (st == ST_OK && !leaf_layout_repeat(&w->layout, sets->fields, sets->steps))
        st = status_describe(ST_UNSUPPORTED, "more than 2^32 - 2 payloads; use larger treelets");
    return st;
}

status leaf_writer_create(mem *m, const char *path, bool force, const grid *g,
                          const leaf_sets *sets, const leaf_parameters *p, leaf_writer **out) {
    static const leaf_sets one = {.fields = 1, .steps = 1};
    leaf_writer *w = new_writer(m, p);
    if (!w)
        return ST_NOMEM;
    sets = sets ? sets : &one;
    assert(sets->fields > 0 && sets->steps > 0);
    assert((uint64_t)sets->fields * sets->steps <= LEAF_SETS_MAX);
    status st = lay_out_grid(w, g, sets);
    if (st == ST_OK)
        st = allocate(w, w->layout.payloads);
    if (st == ST_OK && w->layout.sets > 1)
        st = copy_labels(w, sets);
    if (st == ST_OK)
        st = allocate_deviations(w);
    if (st == ST_OK)
        st = allocate_axes(w, g);
    if (st == ST_OK)
        st = out_file_create(m, path, force, &w->out);
    if (st == ST_OK && p->codec != LEAF_CODEC_RAW)
        st = create_scratch(w, path);
    if (st == ST_OK && w->scratch)
        st = allocate_copy(w);
    if (st != ST_OK) {
        leaf_writer_discard(w);
        return st;
    }
    leaf_head_grid(&w->header, &w->layout, p, g, sets);
    w->frame = g->frame;
    if (sets->time_unit)
        world_frame_set_time_unit(&w->frame, sets->time_unit);
    place_sections(w);
    if (!w->scratch) {
        for (uint32_t i = 0; i < w->layout.payloads; i++)
            w->sizes[i] = leaf_layout_payload_bytes(&w->layout, i);
        place_payloads(w);
    }
    *out = w;
    return ST_OK;
}

status leaf_writer_create_mesh(mem *m, const char *path, bool force, const leaf_mesh *mesh,
                               const leaf_parameters *p, leaf_writer **out) {
    const uint64_t sets = (uint64_t)mesh->fields * mesh->steps;
    const leaf_blocks blocks = blocks_of(mesh);
    assert(mesh->treelets > 0 && sets > 0 && sets <= LEAF_SETS_MAX);
    assert(!mesh->names || strncmp(mesh->names[0], mesh->field, sizeof(char[63])) == 0);
    assert(mesh->treelet_tets > 0 && mesh->treelet_tets <= LEAF_TREELET_TETS_MAX);
    assert(mesh->leaf_tets > 0 && mesh->leaf_tets <= LEAF_LEAF_TETS_MAX);
    if (leaf_blocks_payloads(&blocks) >= LEAF_NO_TREELET)
        return status_describe(ST_UNSUPPORTED, "more than 2^32 - 2 payloads; use larger treelets");
    leaf_writer *w = new_writer(m, p);
    if (!w)
        return ST_NOMEM;
    status st = leaf_layout_init_mesh(&w->layout, m, &blocks);
    if (st == ST_OK)
        st = allocate(w, mesh->treelets * sets);
    if (st == ST_OK)
        st = allocate_mesh(w);
    if (st == ST_OK)
        st =
            copy_labels(w, &(leaf_sets){mesh->fields, mesh->steps, mesh->names, mesh->times, NULL});
    if (st == ST_OK)
        st = allocate_parts(w, mesh);
    if (st == ST_OK)
        st = out_file_create(m, path, force, &w->out);
    if (st == ST_OK)
        st = create_scratch(w, path);
    if (st != ST_OK) {
        leaf_writer_discard(w);
        return st;
    }
    leaf_head_mesh(&w->header, &w->layout, p, mesh);
    place_sections(w);
    *out = w;
    return ST_OK;
}

void leaf_writer_discard(leaf_writer *w) {
    if (!w)
        return;
    out_file_discard(w->out);
    out_file_discard(w->scratch);
    leaf_layout_release(&w->layout);
    mem_free(w->m, w->ranges);
    mem_free(w->m, w->own);
    mem_free(w->m, w->flags);
    mem_free(w->m, w->offsets);
    mem_free(w->m, w->sizes);
    mem_free(w->m, w->checksums);
    mem_free(w->m, w->scratch_at);
    mem_free(w->m, w->copy_buffer);
    mem_free(w->m, w->axes);
    mem_free(w->m, w->bounds);
    mem_free(w->m, w->counts);
    mem_free(w->m, w->names);
    mem_free(w->m, w->times);
    mem_free(w->m, w->parts);
    mem_free(w->m, w->histograms);
    mem_free(w->m, w->deviations);
    (void)pthread_mutex_destroy(&w->lock);
    mem_free(w->m, w);
}

const leaf_layout *leaf_writer_layout(const leaf_writer *w) {
    return &w->layout;
}

histogram *leaf_writer_histograms(leaf_writer *w) {
    return w->histograms;
}

uint16_t *leaf_writer_deviations(leaf_writer *w) {
    return w->deviations;
}

void leaf_writer_range(const leaf_writer *w, uint32_t set, double range[2]) {
    const leaf_layout *l = &w->layout;
    const float(*own)[2] = (const float(*)[2])w->own + (size_t)set * l->treelets;
    range[0] = (double)INFINITY;
    range[1] = -(double)INFINITY;
    for (uint32_t t = 0; t < l->treelets; t++) {
        if (l->level_of[t] != 0)
            continue;
        range[0] = fmin(range[0], (double)own[t][0]);
        range[1] = fmax(range[1], (double)own[t][1]);
    }
}

/* ---- payloads ---- */

size_t leaf_writer_pack_bytes(const leaf_layout *l, leaf_codec codec) {
    return codec == LEAF_CODEC_RAW ? 0 : leaf_layout_payload_max(l);
}

/* Decide where a payload of this size goes. Returns true for offsets[p], as all before it have been
 * put; false for scratch_at[p]. Places become known in order. The place of a payload in the scratch
 * file is needed now only to place those behind it. */
static bool place_put(leaf_writer *w, uint32_t p, size_t size) {
    pthread_mutex_lock(&w->lock);
    const bool direct = p == w->placed;
    w->sizes[p] = size;
    w->scratch_at[p] = direct || !size ? NOT_THERE : w->scratch_end;
    if (!direct)
        w->scratch_end += size;
    for (uint32_t n = w->placed; n < w->layout.payloads && w->sizes[n] != UNKNOWN; n++) {
        w->offsets[n] =
            leaf_placing_next(&w->next, &w->layout, n, w->sizes[n], w->p.run_align_log2);
        w->placed = n + 1;
    }
    pthread_mutex_unlock(&w->lock);
    return direct;
}

static status put_payload(leaf_writer *w, leaf_packer *k, uint32_t p, const void *payload,
                          size_t size, void *pack) {
    const void *stored = payload;
    if (k)
        size = leaf_packer_pack(k, payload, size, pack, &stored);
    w->checksums[p] = hash_bytes(stored, size);
    if (!w->scratch)
        return out_file_write_at(w->out, w->offsets[p], stored, size);
    if (place_put(w, p, size))
        return out_file_write_at(w->out, w->offsets[p], stored, size);
    return out_file_write_at(w->scratch, w->scratch_at[p], stored, size);
}

/* Put a payload without bytes; the directory implies it. */
static void put_implied(leaf_writer *w, uint32_t p) {
    if (w->scratch)
        place_put(w, p, 0);
    pthread_mutex_lock(&w->lock);
    w->sizes[p] = w->checksums[p] = 0;
    w->implied = true;
    pthread_mutex_unlock(&w->lock);
}

status leaf_writer_put(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                       const leaf_entry *entry, const void *payload, void *pack) {
    const uint32_t p = leaf_layout_samples(&w->layout, set, t);
    assert(t < w->layout.treelets && set < w->layout.sets && !w->counts);
    memcpy(w->own[p], entry->own, sizeof entry->own);
    w->flags[p] = entry->flags;
    const leaf_geometry *g = w->layout.geometry;
    if (g->implies && g->implies(&w->layout, t, entry->own, entry->flags, payload)) {
        put_implied(w, p);
        return ST_OK;
    }
    return put_payload(w, k, p, payload, leaf_layout_payload_bytes(&w->layout, p), pack);
}

void leaf_writer_put_implied(leaf_writer *w, uint32_t set, uint32_t t, const leaf_entry *entry) {
    const uint32_t p = leaf_layout_samples(&w->layout, set, t);
    assert(w->layout.geometry->implies && implied_payload_may(entry->own, entry->flags));
    memcpy(w->own[p], entry->own, sizeof entry->own);
    w->flags[p] = entry->flags;
    put_implied(w, p);
}

/* Copy floats; -0 becomes +0, as readers may compare bytes. */
static void copy_floats(float *to, const float *from, int count) {
    for (int i = 0; i < count; i++)
        to[i] = from[i] + 0.0F;
}

status leaf_writer_put_topology(leaf_writer *w, leaf_packer *k, uint32_t t, const float bounds[6],
                                const uint32_t counts[4], const void *payload, void *pack) {
    assert(t < w->layout.treelets && w->counts);
    assert(!mesh_leaf_counts_fault(counts, w->header.treelet_tets, w->header.leaf_tets));
    copy_floats(w->bounds[t], bounds, 6);
    memcpy(w->counts[t], counts, sizeof w->counts[t]);
    return put_payload(w, k, t, payload, mesh_leaf_shape(counts).topology_bytes, pack);
}

status leaf_writer_put_values(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                              const leaf_entry *entry, const void *payload, void *pack) {
    assert(t < w->layout.treelets && set < w->layout.sets && w->counts[t][0]);
    const size_t element = (size_t)set * w->layout.treelets + t;
    copy_floats(w->own[element], entry->own, 2);
    w->flags[element] = entry->flags;
    return put_payload(w, k, leaf_layout_values(&w->layout, set, t), payload,
                       mesh_leaf_shape(w->counts[t]).values_bytes, pack);
}

status leaf_writer_put_gradients(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                                 const void *payload, void *pack) {
    assert(t < w->layout.treelets && set < w->layout.gradient_sets && w->counts[t][0]);
    return put_payload(w, k, leaf_layout_gradients(&w->layout, set, t), payload,
                       mesh_leaf_shape(w->counts[t]).gradients_bytes, pack);
}

status leaf_writer_put_positions(leaf_writer *w, leaf_packer *k, uint32_t step, uint32_t t,
                                 const float bounds[6], const void *payload, void *pack) {
    assert(t < w->layout.treelets && step > 0 && step <= w->layout.moved_steps);
    assert(w->counts[t][0]);
    copy_floats(w->bounds[leaf_layout_bounds(&w->layout, step, t)], bounds, 6);
    return put_payload(w, k, leaf_layout_positions(&w->layout, step, t), payload,
                       mesh_leaf_shape(w->counts[t]).positions_bytes, pack);
}

/* ---- finishing ---- */

/* Copy payloads from the scratch file to their places. */
static status copy_payloads(leaf_writer *w) {
    place_payloads(w);
    for (uint32_t p = 0; p < w->layout.payloads; p++) {
        size_t size = (size_t)w->sizes[p];
        if (w->scratch_at[p] == NOT_THERE)
            continue;
        status st = out_file_read_at(w->scratch, w->scratch_at[p], w->copy_buffer, size);
        if (st == ST_OK)
            st = out_file_write_at(w->out, w->offsets[p], w->copy_buffer, size);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static status write_zeros(leaf_writer *w, uint64_t from, uint64_t to) {
    static const char zeros[512];
    status st = ST_OK;
    for (uint64_t size; st == ST_OK && from < to; from += size) {
        size = to - from < sizeof zeros ? to - from : sizeof zeros;
        st = out_file_write_at(w->out, from, zeros, (size_t)size);
    }
    return st;
}

/* Move payload p from `from` to its place; zero the gap before it, which begins at `end`. */
static status move_payload(leaf_writer *w, uint32_t p, uint64_t from, uint64_t end) {
    status st = out_file_read_at(w->out, from, w->copy_buffer, (size_t)w->sizes[p]);
    if (st == ST_OK)
        st = write_zeros(w, end, w->offsets[p]);
    return st == ST_OK
               ? out_file_write_at(w->out, w->offsets[p], w->copy_buffer, (size_t)w->sizes[p])
               : st;
}

/* Remove the room of implied payloads: raw payloads lie where they would if none were implied. Move
 * them down in order, so that none is overwritten before it has moved. */
static status close_ranks(leaf_writer *w) {
    leaf_placing next = {.end = sections_end(w)};
    status st = allocate_copy(w);
    w->header.payload_bytes = 0;
    for (uint32_t p = 0; st == ST_OK && p < w->layout.payloads; p++) {
        const uint64_t from = w->offsets[p], end = next.end;
        w->offsets[p] = leaf_placing_next(&next, &w->layout, p, w->sizes[p], w->p.run_align_log2);
        w->header.payload_bytes += w->sizes[p];
        if (w->sizes[p] && w->offsets[p] != from)
            st = move_payload(w, p, from, end);
    }
    w->header.file_bytes = leaf_layout_aligned(next.end, w->p.run_align_log2);
    return st == ST_OK ? out_file_cut(w->out, w->header.file_bytes) : st;
}

/* Merge the ranges of a grid's set, last treelet first: children come behind their parents. */
static void merge_ranges(leaf_writer *w, uint32_t set) {
    const leaf_layout *l = &w->layout;
    const size_t first = leaf_layout_samples(l, set, 0);
    float(*ranges)[2] = w->ranges + first;
    for (uint32_t t = l->treelets; t-- > 0;) {
        float *merged = ranges[t];
        memcpy(merged, w->own[first + t], sizeof w->own[first + t]);
        uint32_t child = l->first_child[t];
        for (int n = __builtin_popcount(leaf_layout_children(l, t)); n > 0; n--, child++) {
            merged[0] = ranges[child][0] < merged[0] ? ranges[child][0] : merged[0];
            merged[1] = ranges[child][1] > merged[1] ? ranges[child][1] : merged[1];
        }
    }
}

/* Compute the header's values of a grid from its treelets. */
static void sum_up_grid(leaf_writer *w) {
    leaf_header *h = &w->header;
    h->value_min = (double)INFINITY;
    h->value_max = -(double)INFINITY;
    for (uint32_t set = 0; set < w->layout.sets; set++) {
        double range[2];
        merge_ranges(w, set);
        leaf_writer_range(w, set, range);
        h->value_min = fmin(h->value_min, range[0]);
        h->value_max = fmax(h->value_max, range[1]);
    }
}

/* Compute the header's values of a mesh from its treelets. */
static void sum_up_mesh(leaf_writer *w) {
    leaf_header *h = &w->header;
    double lo = (double)INFINITY, hi = -(double)INFINITY;
    memcpy(h->bounds, w->bounds[0], sizeof h->bounds);
    for (uint32_t t = 0; t < w->layout.treelets; t++)
        h->tets += w->counts[t][0];
    for (size_t i = 0; i < (size_t)w->layout.treelets * (1 + w->layout.moved_steps); i++)
        for (int a = 0; a < 3; a++) {
            h->bounds[a] = fminf(h->bounds[a], w->bounds[i][a]);
            h->bounds[a + 3] = fmaxf(h->bounds[a + 3], w->bounds[i][a + 3]);
        }
    for (size_t i = 0; i < (size_t)w->layout.treelets * w->layout.sets; i++) {
        memcpy(w->ranges[i], w->own[i], sizeof w->own[i]);
        lo = fmin(lo, (double)w->own[i][0]);
        hi = fmax(hi, (double)w->own[i][1]);
    }
    h->value_min = lo;
    h->value_max = hi;
}

static status write_sections(leaf_writer *w) {
    const void *arrays[LEAF_SECTION_LAST] = {w->ranges, w->own,       w->flags, w->offsets,
                                             w->sizes,  w->checksums, w->axes,  w->bounds,
                                             w->counts, w->names,     w->times, w->parts};
    const void *ancillary[LEAF_ANCILLARY_LAST] = {w->histograms, w->deviations, &w->frame};
    for (uint32_t i = 0; i < w->header.sections; i++) {
        leaf_section *s = &w->table[i];
        const void *bytes = leaf_section_ancillary(s->kind)
                                ? ancillary[s->kind - LEAF_SECTION_ANCILLARY - 1]
                                : arrays[s->kind - 1];
        s->checksum = hash_bytes(bytes, (size_t)s->bytes);
        status st = out_file_write_at(w->out, s->offset, bytes, (size_t)s->bytes);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* Write zeros between the last payload and the end. The gaps before are holes, which read as
 * zeros. */
static status write_end(leaf_writer *w) {
    const uint32_t last = w->layout.payloads - 1;
    return write_zeros(w, w->offsets[last] + w->sizes[last], w->header.file_bytes);
}

static void note_facts(leaf_writer *w, const leaf_facts *facts) {
    leaf_header *h = &w->header;
    h->non_finite = facts->non_finite;
    h->rounding_error = facts->rounding_error;
    h->vertices = facts->vertices;
    h->flat = facts->flat;
    h->inverted = facts->inverted;
    h->repeated = facts->repeated;
    h->bad = facts->bad;
    h->version = w->implied ? 2 : h->version;
    leaf_head_text(h->provenance, sizeof h->provenance, facts->provenance);
}

static status write_header(leaf_writer *w) {
    leaf_header *h = &w->header;
    hash_id id = leaf_header_id(h, w->table);
    h->id[0] = id.lo;
    h->id[1] = id.hi;
    h->checksum = leaf_header_checksum(h);
    status st =
        out_file_write_at(w->out, LEAF_HEADER_BYTES, w->table, h->sections * sizeof *w->table);
    return st == ST_OK ? out_file_write_at(w->out, 0, h, sizeof *h) : st;
}

static status write_all(leaf_writer *w, const leaf_facts *facts) {
    status st = ST_OK;
    if (w->counts) {
        leaf_layout_set_counts(&w->layout, (const uint32_t(*)[4])w->counts);
        st = allocate_copy(w);
    }
    if (st == ST_OK && w->scratch)
        st = copy_payloads(w);
    else if (st == ST_OK && w->implied)
        st = close_ranks(w);
    if (st != ST_OK)
        return st;
    if (w->counts)
        sum_up_mesh(w);
    else
        sum_up_grid(w);
    note_facts(w, facts);
    st = write_sections(w);
    if (st == ST_OK)
        st = write_end(w);
    return st == ST_OK ? write_header(w) : st;
}

status leaf_writer_settle(leaf_writer *w, const leaf_facts *facts) {
    assert(w->counts && !w->settled);
    w->settled = true;
    return write_all(w, facts);
}

const char *leaf_writer_path(const leaf_writer *w) {
    return out_file_temporary(w->out);
}

/* ---- coarse grids ---- */

enum { EMBED_BYTES = 64 << 10 };

static status copy_file(leaf_writer *w, file *from, uint64_t to) {
    const uint64_t size = file_size(from);
    char *buffer = mem_alloc(w->m, EMBED_BYTES);
    if (!buffer)
        return ST_NOMEM;
    status st = ST_OK;
    for (uint64_t at = 0; at < size && st == ST_OK; at += EMBED_BYTES) {
        const size_t step = size - at < EMBED_BYTES ? (size_t)(size - at) : EMBED_BYTES;
        st = file_read_at(from, at, buffer, step);
        if (st == ST_OK)
            st = out_file_write_at(w->out, to + at, buffer, step);
    }
    mem_free(w->m, buffer);
    return st;
}

status leaf_writer_embed(leaf_writer *w, uint32_t set, const char *path) {
    assert(w->settled && w->parts && set < w->layout.sets && !w->parts[set].bytes);
    leaf_header *h = &w->header;
    leaf_header own;
    file *from = NULL;
    status st = file_open(w->m, path, &from);
    if (st == ST_OK)
        st = file_read_at(from, 0, &own, sizeof own);
    if (st == ST_OK)
        st = leaf_check_header(path, &own, file_size(from));
    if (st == ST_OK)
        st = copy_file(w, from, h->file_bytes);
    if (st == ST_OK) {
        assert(own.kind == LEAF_KIND_GRID && own.run_align_log2 == h->run_align_log2);
        w->parts[set] = (leaf_part){
            .offset = h->file_bytes, .bytes = own.file_bytes, .id = {own.id[0], own.id[1]}};
        h->file_bytes += own.file_bytes;
    }
    file_close(from);
    return st;
}

/* Write the directory again, with the embedded coarse grids. */
static status write_parts(leaf_writer *w) {
    if (!w->parts)
        return ST_OK;
    status st = write_sections(w);
    return st == ST_OK ? write_header(w) : st;
}

status leaf_writer_finish(leaf_writer *w, const leaf_facts *facts, leaf_header *header) {
    status st = w->settled ? write_parts(w) : write_all(w, facts);
    if (st == ST_OK)
        st = leaf_file_prove(w->m, out_file_temporary(w->out));
    if (st == ST_OK) {
        if (header)
            *header = w->header;
        st = out_file_commit(w->out);
        w->out = NULL;
    }
    leaf_writer_discard(w);
    return st;
}
