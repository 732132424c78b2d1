#include "stream/moving_surface.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "formats/leaf/leaf_place.h"
#include "stream/moving_file.h"

/* ---- Memory ---- */

/* What a surface of so many treelets' vertices takes, and at most meanwhile: rather more. */
static size_t memory_of(const moving_source *src, size_t vertices) {
    const size_t triangles = src->triangles, treelets = triangles / MOVING_TRIANGLES + 1;
    const size_t fields = (src->values != NULL) + (src->colours != NULL);
    const uint32_t most[4] = {MOVING_TRIANGLES, 1};
    const triangle_shape shape = triangle_shape_of(most);
    const size_t kept =
        triangles * (2 * sizeof(uint32_t) + sizeof(uint16_t[3])) +
        vertices * (sizeof(uint32_t) + MOVING_STEPS * sizeof(float[3]) +
                    (fields ? fields : 1) * sizeof(float)) +
        treelets * (sizeof(moving_treelet) + MOVING_STEPS * (triangle_blocks_bytes(&shape) + 512) +
                    MOVING_FIELDS_MAX * MOVING_STEPS * 128 + 512);
    const size_t sorting = moving_order_memory(src->triangles),
                 numbering = src->vertices * sizeof(uint32_t);
    const size_t smooth = src->smooth ? vertices * MOVING_STEPS * sizeof(uint32_t) +
                                            vertex_normals_memory(src->vertices)
                                      : 0;
    return kept + smooth + (sorting > numbering ? sorting : numbering) + (1 << 20);
}

static status refuse(const mem *m, const moving_source *src, size_t vertices) {
    return status_describe(ST_NOMEM,
                           "the memory budget of %zu bytes is too small for %u triangles of %u "
                           "vertices: %zu bytes would do to open them",
                           m->limit, src->triangles, src->vertices,
                           mem_used(m) + memory_of(src, vertices));
}

/* ---- Positions ---- */

/* Positions are looked at by so many. */
enum { SOME = 1 << 15 };

static size_t parts_of(uint32_t vertices) {
    return ((size_t)vertices + SOME - 1) / SOME;
}

/* Positions on their way. */
typedef struct putting {
    moving_surface *s;
    uint32_t step;
    const float (*positions)[3];
} putting;

/* 1: it is not finite. Without a branch, so that compilers take many at a time. */
static inline uint32_t is_bad(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (bits & 0x7f800000u) == 0x7f800000u;
}

static status check_some(void *ctx, size_t index, int worker) {
    const putting *p = ctx;
    const size_t begin = index * SOME, left = p->s->vertices - begin;
    const size_t end = begin + (left < SOME ? left : SOME);
    uint32_t bad = 0;
    (void)worker;
    for (size_t v = begin; v < end; v++)
        for (int a = 0; a < 3; a++)
            bad |= is_bad(p->positions[v][a]);
    for (size_t v = begin; v < end && bad; v++) {
        const float *x = p->positions[v];
        if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]))
            return status_describe(ST_USAGE, "vertex %zu is at %g, %g, %g: expected finite numbers",
                                   v, (double)x[0], (double)x[1], (double)x[2]);
    }
    return ST_OK;
}

static status check_positions(putting *p) {
    return pool_run(p->s->threads, parts_of(p->s->vertices), check_some, p);
}

/* ---- Making ---- */

static uint32_t treelets_of(const moving_source *src) {
    return (src->triangles + MOVING_TRIANGLES - 1) / MOVING_TRIANGLES;
}

static uint32_t triangles_in(const moving_source *src, uint32_t t) {
    const uint32_t left = src->triangles - t * MOVING_TRIANGLES;
    return left < MOVING_TRIANGLES ? left : MOVING_TRIANGLES;
}

/* Of what triangles there are: a vertex that none has may be anywhere. */
static void bounds_of(const moving_source *src, float bounds[6]) {
    for (int a = 0; a < 3; a++)
        bounds[a] = bounds[a + 3] = src->positions[src->rows[0][0]][a];
    for (uint32_t i = 0; i < src->triangles; i++)
        for (int k = 0; k < TRIANGLE_CORNERS; k++)
            for (int a = 0; a < 3; a++) {
                const float x = src->positions[src->rows[i][k]][a];
                bounds[a] = fminf(bounds[a], x);
                bounds[a + 3] = fmaxf(bounds[a + 3], x);
            }
}

static status sort(moving_surface *s, const moving_source *src) {
    float bounds[6];
    bounds_of(src, bounds);
    s->numbers = mem_array(s->m, src->triangles, sizeof *s->numbers);
    s->order = mem_array(s->m, src->triangles, sizeof *s->order);
    status st = s->numbers && s->order ? ST_OK : ST_NOMEM;
    if (st == ST_OK)
        st = moving_order_sort(s->m, src, bounds, s->numbers);
    for (uint32_t i = 0; st == ST_OK && i < src->triangles; i++)
        s->order[s->numbers[i]] = i;
    return st;
}

/* Number the vertices of a treelet in the order of their first use. seen: per vertex of the host,
 * behind its last number among all treelets'. Returns how many there are. */
static uint32_t number_vertices(moving_surface *s, const moving_source *src, uint32_t t,
                                uint32_t first, uint32_t seen[]) {
    const uint32_t begin = t * MOVING_TRIANGLES, end = begin + triangles_in(src, t);
    uint32_t count = 0;
    for (uint32_t i = begin; i < end; i++)
        for (int k = 0; k < TRIANGLE_CORNERS; k++) {
            uint32_t *at = &seen[src->rows[s->numbers[i]][k]];
            if (*at <= first)
                *at = first + ++count;
            s->rows[i][k] = (uint16_t)(*at - 1 - first);
        }
    return count;
}

/* Find which vertices each treelet has. *count: of all of them. */
static status number(moving_surface *s, const moving_source *src, uint32_t *count) {
    uint32_t *seen = mem_array(s->m, src->vertices, sizeof *seen);
    s->rows = mem_array(s->m, src->triangles, sizeof *s->rows);
    s->treelets = mem_array(s->m, s->treelet_count, sizeof *s->treelets);
    const bool whole = seen && s->rows && s->treelets;
    *count = 0;
    for (uint32_t t = 0; whole && t < s->treelet_count; t++) {
        moving_treelet *at = &s->treelets[t];
        at->first = *count;
        at->at[0].shape = (triangle_shape){
            .triangles = triangles_in(src, t),
            .vertices = number_vertices(s, src, t, *count, seen),
        };
        *count += at->at[0].shape.vertices;
    }
    mem_free(s->m, seen);
    return whole ? ST_OK : ST_NOMEM;
}

static void list_vertices(moving_surface *s, const moving_source *src, uint32_t t) {
    const uint32_t begin = t * MOVING_TRIANGLES, end = begin + triangles_in(src, t);
    uint32_t *ids = s->ids + s->treelets[t].first, count = 0;
    for (uint32_t i = begin; i < end; i++)
        for (int k = 0; k < TRIANGLE_CORNERS; k++)
            if (s->rows[i][k] == count)
                ids[count++] = src->rows[s->numbers[i]][k];
}

static status make_treelet(moving_surface *s, const moving_source *src, uint32_t t) {
    moving_treelet *at = &s->treelets[t];
    const uint32_t begin = t * MOVING_TRIANGLES,
                   counts[4] = {at->at[0].shape.triangles, at->at[0].shape.vertices};
    const triangle_shape shape = triangle_shape_of(counts);
    status st = ST_OK;
    list_vertices(s, src, t);
    for (int i = 0; i < MOVING_STEPS && st == ST_OK; i++) {
        st = triangle_blocks_init(&at->at[i], s->m, &shape, (const uint16_t(*)[3])(s->rows + begin),
                                  s->places[i] + TRIANGLE_CORNERS * at->first);
        at->at[i].numbers = s->numbers + begin;
        at->at[i].normals = s->normals[i] ? s->normals[i] + at->first : NULL;
    }
    return st;
}

/* Values as floats, colours as a file's field of colours has them; zeros without either. */
static status take_values(moving_surface *s, const moving_source *src, size_t count) {
    int fields = 0;
    const bool some[MOVING_FIELDS_MAX] = {src->values || !src->colours, src->colours};
    for (int f = 0; f < MOVING_FIELDS_MAX; f++) {
        if (!some[f])
            continue;
        float *to = s->values[fields++] = mem_array(s->m, count, sizeof *to);
        for (size_t i = 0; to && i < count; i++)
            to[i] = f             ? (float)(src->colours[s->ids[i]] & 0xffffff)
                    : src->values ? src->values[s->ids[i]]
                                  : 0.0f;
        if (!to)
            return ST_NOMEM;
    }
    return ST_OK;
}

static status allocate(moving_surface *s, bool smooth, size_t count) {
    bool whole = (s->ids = mem_array(s->m, count, sizeof *s->ids)) != NULL;
    for (int i = 0; i < MOVING_STEPS; i++) {
        whole = (s->places[i] = mem_array(s->m, count, sizeof(float[3]))) != NULL && whole;
        if (smooth)
            whole = (s->normals[i] = mem_array(s->m, count, sizeof(uint32_t))) != NULL && whole;
    }
    if (!whole)
        return ST_NOMEM;
    return smooth ? vertex_normals_init(&s->sums, s->m, s->vertices) : ST_OK;
}

static status make(moving_surface *s, const moving_source *src, int threads, uint32_t *count) {
    putting first = {s, 0, src->positions};
    const size_t parts =
        parts_of(s->vertices) > s->treelet_count ? parts_of(s->vertices) : s->treelet_count;
    status st = pool_create(s->m, parts < (size_t)threads ? (int)parts : threads, &s->threads);
    if (st == ST_OK)
        st = check_positions(&first);
    if (st == ST_OK)
        st = sort(s, src);
    if (st == ST_OK)
        st = number(s, src, count);
    if (st == ST_OK)
        st = allocate(s, src->smooth, *count);
    for (uint32_t t = 0; st == ST_OK && t < s->treelet_count; t++)
        st = make_treelet(s, src, t);
    if (st == ST_OK)
        st = take_values(s, src, *count);
    if (st == ST_OK)
        st = moving_file_make(s, src);
    for (uint32_t i = 0; st == ST_OK && i < MOVING_STEPS; i++)
        st = moving_surface_put(s, i, src->positions);
    return st;
}

status moving_surface_create(mem *m, const moving_source *src, int threads, moving_surface **out) {
    uint32_t count = 0;
    moving_surface *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->vertices = src->vertices;
    s->treelet_count = treelets_of(src);
    const status st = make(s, src, threads, &count);
    if (st != ST_OK) {
        leaf_file_close(s->file);
        moving_surface_destroy(s);
        const size_t vertices = count ? count : 3 * (size_t)src->triangles;
        const bool full = m->limit && mem_used(m) + memory_of(src, vertices) > m->limit;
        return st == ST_NOMEM && full ? refuse(m, src, vertices) : st;
    }
    *out = s;
    return ST_OK;
}

void moving_surface_destroy(moving_surface *s) {
    if (!s)
        return;
    pool_destroy(s->threads);
    for (uint32_t t = 0; s->treelets && t < s->treelet_count; t++)
        for (int i = 0; i < MOVING_STEPS; i++)
            triangle_blocks_release(&s->treelets[t].at[i]);
    for (int f = 0; f < MOVING_FIELDS_MAX; f++)
        mem_free(s->m, s->values[f]);
    for (int i = 0; i < MOVING_STEPS; i++)
        mem_free(s->m, s->places[i]);
    for (int i = 0; i < MOVING_STEPS; i++)
        mem_free(s->m, s->normals[i]);
    if (s->sums.m)
        vertex_normals_release(&s->sums);
    mem_free(s->m, s->treelets);
    mem_free(s->m, s->ids);
    mem_free(s->m, s->rows);
    mem_free(s->m, s->order);
    mem_free(s->m, s->numbers);
    mem_free(s->m, s);
}

uint32_t moving_surface_find(const moving_surface *s, uint64_t number, uint32_t *local) {
    const uint32_t at = s->order[number];
    *local = at % MOVING_TRIANGLES;
    return at / MOVING_TRIANGLES;
}

/* ---- Moving ---- */

/* Add up the triangles around each vertex: in the host's order, so that the bits do not depend on
 * where they were at first. */
static void sum_normals(putting *p) {
    moving_surface *s = p->s;
    const uint32_t count = (uint32_t)s->file->header.tets;
    vertex_normals_begin(&s->sums);
    for (uint32_t v = 0; v < s->vertices; v++)
        vertex_normals_put(&s->sums, p->positions[v]);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t at = s->order[i];
        const uint32_t *ids = s->ids + s->treelets[at / MOVING_TRIANGLES].first;
        float corner[3][3];
        size_t numbers[3];
        for (int k = 0; k < TRIANGLE_CORNERS; k++) {
            numbers[k] = ids[s->rows[at][k]];
            memcpy(corner[k], p->positions[numbers[k]], sizeof corner[k]);
        }
        vertex_normals_add(&s->sums, (const float(*)[3])corner, numbers);
    }
}

/* Copy positions to where a treelet has them, and make its boxes anew. */
static status refit(void *ctx, size_t index, int worker) {
    const putting *p = ctx;
    const moving_treelet *t = &p->s->treelets[index];
    triangle_blocks *b = &p->s->treelets[index].at[p->step];
    const uint32_t *ids = p->s->ids + t->first, count = b->shape.vertices;
    float *to = p->s->places[p->step] + TRIANGLE_CORNERS * t->first;
    (void)worker;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t a = 0; a < 3; a++)
            to[a * count + i] = p->positions[ids[i]][a];
    for (uint32_t i = 0; i < count && p->s->normals[p->step]; i++)
        p->s->normals[p->step][t->first + i] = vertex_normals_code(&p->s->sums, ids[i]);
    triangle_blocks_move(b);
    moving_file_set_bounds(p->s->file, p->step, (uint32_t)index,
                           b->tree.bounds[b->tree.levels - 1][0]);
    return ST_OK;
}

status moving_surface_put(moving_surface *s, uint32_t step, const float (*positions)[3]) {
    putting p = {s, step, positions};
    char why[LEAF_PLACE_TEXT];
    status st = check_positions(&p);
    if (st == ST_OK && s->normals[step])
        sum_normals(&p);
    if (st == ST_OK)
        st = pool_run(s->threads, s->treelet_count, refit, &p);
    if (st == ST_OK && !leaf_place_mesh(moving_file_merge_bounds(s->file, step), why))
        st = status_describe(ST_USAGE, "%s", why);
    return st;
}
