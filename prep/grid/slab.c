#include "prep/grid/slab.h"

#include <assert.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/grid/slice_tiles.h"

/* Sizes of one level's slabs and columns. */
typedef struct shape {
    const leaf_layout *l;
    const leaf_level *level;
    uint32_t families[3];
    size_t size;         /* bytes of a sample */
    uint32_t step;       /* cells of a family along an axis: 2B */
    uint32_t depth;      /* most slices in a slab */
    uint32_t columns[2]; /* spilled: columns along x and y */
    uint32_t width;      /* most samples of a column's row */
    uint32_t height;     /* most rows of a column */
    uint32_t across;     /* families across a column */
    uint64_t column_slice_bytes, column_bytes, area_bytes;
} shape;

struct slab {
    mem *m;
    shape shape;
    bool spilled;
    uint32_t next_z;  /* the next slice */
    uint32_t current; /* the slab that is filling or complete */
    const char **slices;
    char *samples;   /* if spilled: one column */
    size_t tiles;    /* bytes of a slice's map */
    uint8_t *busy;   /* if spilled: maps of `depth` slices; slice z has map z % depth */
    slice_ring ring; /* in memory: at least `depth` slices; if spilled: those read ahead */
    const uint8_t **maps;
    uint8_t quiet[SLICE_SAMPLE_MAX];
    /* If spilled: */
    out_file *file;
    char *staging; /* per thread: one column's part of a slice */
};

static uint32_t least(uint64_t a, uint32_t b) {
    return a < b ? (uint32_t)a : b;
}

uint32_t slab_families(const leaf_layout *l, uint32_t level, int axis) {
    return (l->level[level].treelets[axis] + 1) / 2;
}

static shape shape_of(const leaf_layout *l, uint32_t level, const slab_plan *plan) {
    const leaf_level *v = &l->level[level];
    shape s = {.l = l, .level = v, .size = sample_size(l->type), .step = 2u << l->cells_log2};
    uint32_t reach = 1 + 2 * l->halo;
    for (int a = 0; a < 3; a++)
        s.families[a] = slab_families(l, level, a);
    s.depth = least((uint64_t)s.step + reach, v->dims[2]);
    if (!plan->spilled)
        return s;
    s.across = plan->column_families < s.families[0] ? plan->column_families : s.families[0];
    s.columns[0] = (s.families[0] + s.across - 1) / s.across;
    s.columns[1] = s.families[1];
    s.width = least((uint64_t)s.across * s.step + reach, v->dims[0]);
    s.height = least((uint64_t)s.step + reach, v->dims[1]);
    s.column_slice_bytes = (uint64_t)s.width * s.height * s.size;
    s.column_bytes = s.column_slice_bytes * s.depth;
    s.area_bytes = s.column_bytes * s.columns[0] * s.columns[1];
    return s;
}

static uint64_t slice_bytes(const shape *s) {
    return (uint64_t)s->level->dims[0] * s->level->dims[1] * s->size;
}

static uint32_t slots_of(const shape *s, const slab_plan *plan) {
    return least((uint64_t)plan->ahead + (plan->spilled ? 0 : s->depth), s->level->dims[2]);
}

uint64_t slab_memory(const leaf_layout *l, uint32_t level, const slab_plan *plan) {
    shape s = shape_of(l, level, plan);
    const uint64_t tiles = slice_tiles_count(s.level->dims);
    uint64_t bytes = (slice_bytes(&s) + tiles) * slots_of(&s, plan);
    if (plan->spilled)
        bytes += s.column_bytes + s.column_slice_bytes * (uint64_t)plan->threads + tiles * s.depth;
    return bytes + 2 * s.depth * sizeof(char *) + sizeof(slab) + 4096;
}

uint32_t slab_slots(const leaf_layout *l, uint32_t level, const slab_plan *plan) {
    const shape s = shape_of(l, level, plan);
    return slots_of(&s, plan);
}

uint64_t slab_spill_bytes(const leaf_layout *l, uint32_t level, const slab_plan *plan) {
    return plan->spilled ? 2 * shape_of(l, level, plan).area_bytes : 0;
}

static status create_ring(slab *s, uint32_t slots) {
    s->ring.slots = slots;
    if (slots == 0)
        return ST_OK;
    s->ring.samples = mem_alloc(s->m, (size_t)slice_bytes(&s->shape) * slots);
    s->ring.busy = mem_alloc(s->m, slots * s->tiles);
    if (!s->ring.samples || !s->ring.busy)
        return ST_NOMEM;
    memset(s->ring.busy, 1, slots * s->tiles);
    return ST_OK;
}

static status create_column(slab *s, const slab_plan *plan, const char *beside) {
    const shape *sh = &s->shape;
    s->samples = mem_alloc(s->m, (size_t)sh->column_bytes);
    s->staging = mem_alloc(s->m, (size_t)sh->column_slice_bytes * (size_t)plan->threads);
    s->busy = mem_alloc(s->m, sh->depth * s->tiles);
    if (!s->samples || !s->staging || !s->busy)
        return ST_NOMEM;
    memset(s->busy, 1, sh->depth * s->tiles);
    return out_file_scratch(s->m, beside, &s->file);
}

status slab_create(mem *m, const leaf_layout *l, uint32_t level, const slab_plan *plan,
                   const char *beside, slab **out) {
    slab *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->shape = shape_of(l, level, plan);
    s->spilled = plan->spilled;
    status st = ST_NOMEM;
    s->tiles = slice_tiles_count(s->shape.level->dims);
    s->slices = mem_array(m, s->shape.depth, sizeof *s->slices);
    s->maps = mem_array(m, s->shape.depth, sizeof *s->maps);
    if (!s->slices || !s->maps)
        goto fail;
    st = create_ring(s, slots_of(&s->shape, plan));
    if (st == ST_OK && s->spilled)
        st = create_column(s, plan, beside);
    if (st != ST_OK)
        goto fail;
    *out = s;
    return ST_OK;
fail:
    slab_destroy(s);
    return st;
}

void slab_destroy(slab *s) {
    if (!s)
        return;
    out_file_discard(s->file);
    mem_free(s->m, s->slices);
    mem_free(s->m, s->samples);
    mem_free(s->m, s->busy);
    mem_free(s->m, s->ring.samples);
    mem_free(s->m, s->ring.busy);
    mem_free(s->m, s->maps);
    mem_free(s->m, s->staging);
    mem_free(s->m, s);
}

void slab_quiet(slab *s, const void *sample) {
    memcpy(s->quiet, sample, s->shape.size);
}

static uint8_t *map_of(const slab *s, uint32_t z) {
    return s->spilled ? s->busy + z % s->shape.depth * s->tiles
                      : s->ring.busy + z % s->ring.slots * s->tiles;
}

/* Where a slice is held, in memory. */
static char *slot_of(const slab *s, uint32_t z) {
    return s->ring.samples + z % s->ring.slots * slice_bytes(&s->shape);
}

slice_ring slab_ring(const slab *s) {
    return s->ring;
}

/* ---- nodes of families and columns ---- */

/* Nodes [first, last] that `count` families from family f on need along an axis, with halo. */
static void span(const shape *s, int axis, uint32_t f, uint32_t count, uint32_t *first,
                 uint32_t *last) {
    uint64_t from = (uint64_t)f * s->step, to = from + (uint64_t)count * s->step + s->l->halo;
    *first = from < s->l->halo ? 0 : (uint32_t)(from - s->l->halo);
    *last = least(to, s->level->dims[axis] - 1);
}

bool slab_complete(const slab *s) {
    return s->current < s->shape.families[2] && slab_room(s) == 0;
}

uint32_t slab_room(const slab *s) {
    if (s->current == s->shape.families[2])
        return 0;
    uint32_t first, last;
    span(&s->shape, 2, s->current, 1, &first, &last);
    return last + 1 > s->next_z ? last + 1 - s->next_z : 0;
}

/* The first slice that the current slab needs, or the one behind the last. */
static uint32_t first_needed(const slab *s) {
    uint32_t first, last;
    if (s->current == s->shape.families[2])
        return s->shape.level->dims[2];
    span(&s->shape, 2, s->current, 1, &first, &last);
    return first;
}

uint32_t slab_needed(const slab *s) {
    return s->spilled ? s->next_z : first_needed(s);
}

/* ---- storing ---- */

typedef struct storing {
    slab *s;
    const char *slices;
    const uint8_t *busy;
} storing;

/* A column's part of a slice: rows [y0, y1], samples [x0, x1]. */
typedef struct column {
    uint32_t x0, x1, y0, y1;
    uint32_t fx, fy, across; /* its families: the first in x and y, and how many across */
} column;

static column column_of(const shape *s, uint32_t index) {
    column c = {.fx = index % s->columns[0] * s->across, .fy = index / s->columns[0]};
    uint32_t families = s->families[0];
    c.across = families - c.fx < s->across ? families - c.fx : s->across;
    span(s, 0, c.fx, c.across, &c.x0, &c.x1);
    span(s, 1, c.fy, 1, &c.y0, &c.y1);
    return c;
}

/* Whether a column's part of a slice has a busy tile. */
static bool column_busy(const shape *s, const column *c, const uint8_t *busy) {
    const uint32_t across = slice_tiles_along(s->level->dims[0]);
    const uint32_t first = c->x0 / SLICE_TILE, count = c->x1 / SLICE_TILE - first + 1;
    bool any = false;
    for (uint32_t y = c->y0 / SLICE_TILE; y <= c->y1 / SLICE_TILE; y++)
        any |= memchr(busy + (size_t)y * across + first, 1, count) != NULL;
    return any;
}

/* Write one slice's part of all columns of slab n. What is quiet the map tells. */
static status spill_slice(slab *s, const char *slice, uint32_t z, uint32_t n, char *staging) {
    const shape *sh = &s->shape;
    const size_t row_bytes = sh->level->dims[0] * sh->size;
    uint32_t z0, z1;
    span(sh, 2, n, 1, &z0, &z1);
    for (uint32_t i = 0; i < sh->columns[0] * sh->columns[1]; i++) {
        column c = column_of(sh, i);
        if (!column_busy(sh, &c, map_of(s, z)))
            continue;
        size_t width = (c.x1 - c.x0 + 1) * sh->size, rows = c.y1 - c.y0 + 1;
        const char *from = slice + c.y0 * row_bytes + c.x0 * sh->size;
        if (width < row_bytes) {
            for (size_t y = 0; y < rows; y++)
                memcpy(staging + y * width, from + y * row_bytes, width);
            from = staging;
        }
        uint64_t at =
            n % 2 * sh->area_bytes + i * sh->column_bytes + (z - z0) * sh->column_slice_bytes;
        status st = out_file_write_at(s->file, at, from, rows * width);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static status store_slice(void *ctx, size_t index, int worker) {
    const storing *job = ctx;
    slab *s = job->s;
    const shape *sh = &s->shape;
    uint32_t z = s->next_z + (uint32_t)index;
    const char *slice = job->slices + index * slice_bytes(sh);
    if (!s->spilled && job->busy) {
        slice_tiles_copy(sh->level->dims, sh->size, slice, job->busy + index * s->tiles,
                         slot_of(s, z), map_of(s, z));
        return ST_OK;
    }
    if (job->busy)
        memcpy(map_of(s, z), job->busy + index * s->tiles, s->tiles);
    else
        memset(map_of(s, z), 1, s->tiles);
    if (!s->spilled) {
        memcpy(slot_of(s, z), slice, slice_bytes(sh));
        return ST_OK;
    }
    /* A slice near the border of two slabs belongs to both. */
    uint32_t slabs = sh->families[2];
    char *staging = s->staging + (size_t)worker * sh->column_slice_bytes;
    for (uint32_t n = s->current; n < slabs && n < s->current + 2; n++) {
        uint32_t z0, z1;
        span(sh, 2, n, 1, &z0, &z1);
        if (z < z0 || z > z1)
            continue;
        status st = spill_slice(s, slice, z, n, staging);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

status slab_store(slab *s, pool *workers, const void *slices, const uint8_t *busy, uint32_t count) {
    assert(count <= slab_room(s));
    storing job = {.s = s, .slices = slices, .busy = busy};
    const bool there = !s->spilled && slices == slot_of(s, s->next_z);
    status st = there ? ST_OK : pool_run(workers, count, store_slice, &job);
    if (st == ST_OK)
        s->next_z += count;
    return st;
}

/* ---- taking ---- */

uint32_t slab_boxes(const slab *s) {
    return s->spilled ? s->shape.columns[0] * s->shape.columns[1] : 1;
}

static void take_whole(slab *s, slab_box *out) {
    const shape *sh = &s->shape;
    for (uint32_t i = 0; i < out->samples.size[2]; i++)
        s->slices[i] = slot_of(s, out->samples.origin[2] + i);
    out->samples.size[0] = sh->level->dims[0];
    out->samples.size[1] = sh->level->dims[1];
    out->samples.row_bytes = sh->level->dims[0] * sh->size;
    for (int a = 0; a < 2; a++)
        out->count[a] = sh->families[a];
}

/* Fill a column's part of a slice with the quiet value. */
static void fill_quiet(const slab *s, char *part, size_t samples) {
    const size_t bytes = samples * s->shape.size;
    memcpy(part, s->quiet, s->shape.size);
    for (size_t done = s->shape.size; done < bytes; done *= 2)
        memcpy(part + done, part, done < bytes - done ? done : bytes - done);
}

/* Read a column's parts of the slices [from, to), counted from the slab's first. */
static status read_parts(slab *s, uint32_t index, const slab_box *of, uint32_t from, uint32_t to) {
    const shape *sh = &s->shape;
    /* The last slice's part may be shorter than column_slice_bytes, and the file may end behind
     * it. */
    const uint64_t at =
        s->current % 2 * sh->area_bytes + index * sh->column_bytes + from * sh->column_slice_bytes;
    const size_t bytes = (size_t)sh->column_slice_bytes * (to - from - 1) +
                         of->samples.row_bytes * of->samples.size[1];
    return out_file_read_at(s->file, at, s->samples + from * sh->column_slice_bytes, bytes);
}

/* Load a column: the parts that were written, and what the maps tell of the others. Of a column
 * that is all quiet nobody looks at the samples. */
static status load_column(slab *s, uint32_t index, const column *c, const slab_box *of) {
    const shape *sh = &s->shape;
    const uint32_t count = of->samples.size[2];
    status st = ST_OK;
    bool any = false;
    for (uint32_t i = 0; i < count && !any; i++)
        any = column_busy(sh, c, s->maps[i]);
    if (!any)
        return ST_OK;
    for (uint32_t i = 0, end; i < count && st == ST_OK; i = end) {
        end = i;
        while (end < count && column_busy(sh, c, s->maps[end]))
            end++;
        if (end > i)
            st = read_parts(s, index, of, i, end);
        for (; end < count && !column_busy(sh, c, s->maps[end]); end++)
            fill_quiet(s, s->samples + end * sh->column_slice_bytes,
                       (size_t)of->samples.size[0] * of->samples.size[1]);
    }
    return st;
}

static status take_column(slab *s, uint32_t index, slab_box *out) {
    const shape *sh = &s->shape;
    column c = column_of(sh, index);
    for (uint32_t i = 0; i < out->samples.size[2]; i++)
        s->slices[i] = s->samples + i * sh->column_slice_bytes;
    out->samples.origin[0] = c.x0;
    out->samples.origin[1] = c.y0;
    out->samples.size[0] = c.x1 - c.x0 + 1;
    out->samples.size[1] = c.y1 - c.y0 + 1;
    out->samples.row_bytes = out->samples.size[0] * sh->size;
    out->first[0] = c.fx;
    out->first[1] = c.fy;
    out->count[0] = c.across;
    out->count[1] = 1;
    return load_column(s, index, &c, out);
}

status slab_take(slab *s, uint32_t index, slab_box *out) {
    assert(slab_complete(s) && index < slab_boxes(s));
    memset(out, 0, sizeof *out);
    uint32_t z0, z1;
    span(&s->shape, 2, s->current, 1, &z0, &z1);
    out->first[2] = s->current;
    out->count[2] = 1;
    out->samples.slices = s->slices;
    out->samples.origin[2] = z0;
    out->samples.size[2] = z1 - z0 + 1;
    for (uint32_t i = 0; i < out->samples.size[2]; i++)
        s->maps[i] = map_of(s, z0 + i);
    out->samples.busy = s->maps;
    if (s->spilled)
        return take_column(s, index, out);
    take_whole(s, out);
    return ST_OK;
}

void slab_next(slab *s) {
    s->current++;
}

/* ---- keeping ---- */

/* Save a row of a spilled slice, column by column. */
static status save_row(slab *s, state_io *io, uint32_t z, uint32_t y) {
    const shape *sh = &s->shape;
    const uint32_t of = y / sh->step, last = sh->columns[1] - 1, fy = of < last ? of : last;
    status st = ST_OK;
    uint32_t first, end;
    span(sh, 2, s->current, 1, &first, &end);
    for (uint32_t i = 0; i < sh->columns[0] && st == ST_OK; i++) {
        const uint32_t index = fy * sh->columns[0] + i;
        const column c = column_of(sh, index);
        const uint32_t from = c.fx * sh->step;
        const uint32_t to =
            i + 1 < sh->columns[0] ? (c.fx + c.across) * sh->step : sh->level->dims[0];
        const size_t row = (size_t)(y - c.y0) * (c.x1 - c.x0 + 1) + (from - c.x0);
        const uint64_t at = s->current % 2 * sh->area_bytes + index * sh->column_bytes +
                            (z - first) * sh->column_slice_bytes + row * sh->size;
        if (column_busy(sh, &c, map_of(s, z)))
            st = out_file_read_at(s->file, at, s->staging, (to - from) * sh->size);
        else
            fill_quiet(s, s->staging, to - from);
        if (st == ST_OK)
            st = state_io_bytes(io, s->staging, (to - from) * sh->size);
    }
    return st;
}

static status save_slice(slab *s, state_io *io, uint32_t z) {
    const shape *sh = &s->shape;
    status st = ST_OK;
    if (!s->spilled)
        return state_io_bytes(io, slot_of(s, z), (size_t)slice_bytes(sh));
    for (uint32_t y = 0; y < sh->level->dims[1] && st == ST_OK; y++)
        st = save_row(s, io, z, y);
    return st;
}

/* Load the next slice to its place, or through a buffer, to be spilled as ever. */
static status load_slice(slab *s, state_io *io, char *buffer) {
    const size_t bytes = (size_t)slice_bytes(&s->shape);
    char *slice = buffer ? buffer : slot_of(s, s->next_z);
    storing job = {.s = s, .slices = slice};
    status st = state_io_bytes(io, slice, bytes);
    memset(map_of(s, s->next_z), 1, s->tiles);
    if (st == ST_OK && buffer)
        st = store_slice(&job, 0, 0);
    s->next_z++;
    return st;
}

static status load_slices(slab *s, state_io *io, uint32_t end) {
    char *buffer = s->spilled ? mem_alloc(s->m, (size_t)slice_bytes(&s->shape)) : NULL;
    status st = buffer || !s->spilled ? ST_OK : ST_NOMEM;
    while (st == ST_OK && s->next_z < end)
        st = load_slice(s, io, buffer);
    mem_free(s->m, buffer);
    return st;
}

status slab_keep(slab *s, state_io *io) {
    uint32_t end = s->next_z;
    assert(!slab_complete(s));
    status st = STATE_IO(io, s->current);
    if (st == ST_OK)
        st = STATE_IO(io, end);
    if (st != ST_OK)
        return st;
    if (s->current > s->shape.families[2] || end > s->shape.level->dims[2])
        return state_io_fault(io);
    const uint32_t first = first_needed(s);
    if (state_io_loads(io)) {
        s->next_z = first < end ? first : end;
        return end > s->next_z + slab_room(s) ? state_io_fault(io) : load_slices(s, io, end);
    }
    for (uint32_t z = first; z < end && st == ST_OK; z++)
        st = save_slice(s, io, z);
    return st;
}
