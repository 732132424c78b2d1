#include "formats/grid/vtk_grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/name_list.h"
#include "formats/base/text.h"
#include "formats/grid/sample_place.h"
#include "formats/grid/vtk_grid_points.h"

enum { CHUNK_BYTES = 1 << 16 };

/* ---- extents and frames ---- */

static uint64_t along(const vtk_extent *e, int a) {
    return (uint64_t)(e->hi[a] - e->lo[a] + 1);
}

/* Returns the number of nodes; UINT64_MAX when there are more. */
static uint64_t volume_of(const vtk_extent *e) {
    uint64_t area, all;
    return __builtin_mul_overflow(along(e, 0), along(e, 1), &area) ||
                   __builtin_mul_overflow(area, along(e, 2), &all)
               ? UINT64_MAX
               : all;
}

/* Returns the samples of a field among these nodes. Cells are one fewer along each axis, so a flat
 * piece has none. */
static vtk_extent samples_of(vtk_owner owner, const vtk_extent *nodes) {
    vtk_extent e = *nodes;
    for (int a = 0; a < 3 && owner == VTK_OF_CELLS; a++)
        e.hi[a]--;
    return e;
}

static bool has_samples(const vtk_grid *g, const vtk_grid_piece *p) {
    const vtk_extent e = samples_of(g->owner, &p->extent);
    return !vtk_extent_is_empty(&e);
}

void vtk_frame_init(vtk_frame *f) {
    *f = (vtk_frame){.whole = {{0, 0, 0}, {-1, -1, -1}}, .spacing = {1, 1, 1}};
    for (int a = 0; a < 3; a++)
        f->direction[a][a] = 1;
}

/* ---- making a grid ---- */

status vtk_grid_create(mem *m, vtk_grid **out) {
    vtk_grid *g = mem_zalloc(m, sizeof *g);
    if (!g)
        return ST_NOMEM;
    g->m = m;
    vtk_frame_init(&g->frame);
    *out = g;
    return ST_OK;
}

void vtk_grid_close(vtk_grid *g) {
    if (!g)
        return;
    for (size_t i = 0; i < g->count; i++) {
        vtk_cursor_close(g->pieces[i].samples);
        vtk_fields_release(&g->pieces[i].fields, g->m);
    }
    for (size_t i = 0; i < g->path_count; i++)
        mem_free(g->m, g->paths[i]);
    mem_free(g->m, g->paths);
    vtk_parts_release(&g->parts, g->m);
    mem_free(g->m, g->pieces);
    mem_free(g->m, g->order);
    mem_free(g->m, g->active);
    mem_free(g->m, g->seen);
    mem_free(g->m, g->chunk);
    mem_free(g->m, g);
}

status vtk_grid_add_path(vtk_grid *g, const char *path, const char **out) {
    status st = mem_grow(g->m, &g->paths, sizeof *g->paths, g->path_count, 4, &g->path_room);
    char *kept = st == ST_OK ? mem_copy_text(g->m, path) : NULL;
    if (!kept)
        return ST_NOMEM;
    *out = g->paths[g->path_count++] = kept;
    return ST_OK;
}

status vtk_grid_add_piece(vtk_grid *g, vtk_grid_piece **out) {
    status st = mem_grow(g->m, &g->pieces, sizeof *g->pieces, g->count, 4, &g->room);
    if (st == ST_OK)
        *out = &g->pieces[g->count++];
    return st;
}

/* ---- the field ---- */

static status no_field(const vtk_grid *g, const char *name) {
    name_list names[VTK_OWNERS] = {0};
    for (size_t i = 0; i < g->count; i++)
        for (int o = 0; o < VTK_OWNERS; o++)
            for (size_t k = 0; k < g->pieces[i].fields.count[o]; k++)
                if (vtk_array_width(g->pieces[i].fields.items[o][k].type) > 0)
                    name_list_add(&names[o], g->pieces[i].fields.items[o][k].name);
    const char *quote = name ? "\"" : "";
    return status_describe(
        name ? ST_USAGE : ST_UNSUPPORTED, "%s: no array %s%s%s; the points have %s, the cells %s",
        g->paths[0], quote, name ? name : "of numbers", quote,
        name_list_print(&names[VTK_OF_POINTS]), name_list_print(&names[VTK_OF_CELLS]));
}

static const vtk_array *find_field(vtk_grid *g, const char *name) {
    const vtk_array *a = NULL;
    for (int o = 0; !a && o < VTK_OWNERS; o++) {
        g->owner = (vtk_owner)o;
        for (size_t i = 0; !a && i < g->count; i++)
            a = vtk_fields_find(&g->pieces[i].fields, g->owner, name);
    }
    return a;
}

/* Tell the fields that have the owner of the chosen one, from the first piece: all pieces have the
 * same. */
static status tell_fields(void *ctx, const slice_fields *to) {
    const vtk_grid *g = ctx;
    const vtk_fields *f = &g->pieces[0].fields;
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < f->count[g->owner]; i++) {
        const vtk_array *a = &f->items[g->owner][i];
        slice_field one = {.name = a->name, .steps = 1, .components = a->components};
        if (g->parts.kind == VTK_PARTS_COLLECTION) {
            one.steps = g->parts.steps;
            one.times = g->parts.times;
        }
        one.taken = text_same_name(a->name, g->chosen, VTK_NAME_MAX);
        if (one.taken)
            stored_samples_tell(&g->stored, &one);
        if (vtk_fields_is_one(a))
            st = to->take(to->ctx, &one);
    }
    return st;
}

/* Find and check the chosen array in a piece. */
static status choose_in_piece(const vtk_grid *g, vtk_grid_piece *p, const vtk_array *chosen) {
    if (!has_samples(g, p))
        return ST_OK;
    p->field = vtk_fields_find(&p->fields, g->owner, chosen->name);
    if (!p->field)
        return status_describe(ST_CORRUPT, "%s: a piece has no array \"%s\", unlike others",
                               p->path, chosen->name);
    if (p->field->type != chosen->type || p->field->components != chosen->components)
        return vtk_array_fault(p->field, ST_CORRUPT,
                               "another type or number of components than in the first piece");
    return ST_OK;
}

static status choose_field(vtk_grid *g, const volume_hints *hints, grid *to) {
    const vtk_array *chosen = find_field(g, hints->field);
    if (!chosen)
        return no_field(g, hints->field);
    if (vtk_array_width(chosen->type) == 0)
        return vtk_array_fault(chosen, ST_UNSUPPORTED, "strings and packed bits are no samples");
    /* As in VTK, three or four bytes are a colour. */
    const bool colours =
        chosen->type == VTK_U8 && chosen->components >= 3 && chosen->components <= 4;
    g->chosen = chosen->name;
    g->samples = samples_of(g->owner, &g->frame.whole);
    g->stored = (stored_samples){.type = vtk_array_samples(chosen->type),
                                 .components = chosen->components,
                                 .colours = colours};
    status st = stored_samples_choose(&g->stored, g->paths[0], hints, to);
    for (size_t i = 0; st == ST_OK && i < g->count; i++)
        st = choose_in_piece(g, &g->pieces[i], chosen);
    return st;
}

/* ---- where it lies ---- */

/* Check that pieces lie within the whole, and have enough nodes. A sample that no piece has is
 * found when it is read. */
static status check_extents(const vtk_grid *g) {
    uint64_t all = 0;
    for (size_t i = 0; i < g->count; i++) {
        const vtk_grid_piece *p = &g->pieces[i];
        if (!vtk_extent_holds(&g->frame.whole, &p->extent))
            return status_describe(ST_CORRUPT, "%s: a piece reaches out of the whole extent",
                                   p->path);
        all = __builtin_add_overflow(all, volume_of(&p->extent), &all) ? UINT64_MAX : all;
    }
    if (g->count == 0 || all < volume_of(&g->frame.whole))
        return status_describe(ST_CORRUPT, "%s: its pieces do not fill the whole extent",
                               g->paths[0]);
    return ST_OK;
}

static void place_regular(const vtk_grid *g, grid *to) {
    const vtk_frame *f = &g->frame;
    for (int row = 0; row < 3; row++) {
        to->to_world[row][3] = f->origin[row];
        for (int a = 0; a < 3; a++) {
            const double step = f->direction[row][a] * f->spacing[a];
            const double first = (double)f->whole.lo[a] + (g->owner == VTK_OF_CELLS ? 0.5 : 0);
            to->to_world[row][a] = step;
            to->to_world[row][3] += step * first;
        }
    }
}

/* Read a piece's coordinates of the nodes along an axis, to their place in the whole axis. */
static status read_piece_axis(const vtk_grid *g, const vtk_grid_piece *p, int a, double *axis) {
    const uint64_t count = along(&p->extent, a);
    const vtk_array *from = &p->axis[a];
    if (from->type == VTK_ABSENT)
        return status_describe(ST_CORRUPT, "%s: expected the %c coordinates of a piece", p->path,
                               "xyz"[a]);
    if (from->components != 1)
        return vtk_array_fault(from, ST_CORRUPT, "%u components, expected 1", from->components);
    vtk_cursor *c = NULL;
    status st = vtk_cursor_open(g->m, from, count, &c);
    if (st == ST_OK)
        st = vtk_cursor_doubles(c, (size_t)count, axis + (p->extent.lo[a] - g->frame.whole.lo[a]));
    if (st == ST_OK)
        st = vtk_cursor_finish(c);
    vtk_cursor_close(c);
    return st;
}

/* Set an axis. Samples of cells lie in the middle between nodes. */
static status set_axis(const vtk_grid *g, int a, double *nodes, grid *to) {
    for (uint32_t i = 0; g->owner == VTK_OF_CELLS && i < to->dims[a]; i++)
        nodes[i] += (nodes[i + 1] - nodes[i]) / 2;
    return grid_set_axis(to, g->m, g->paths[0], a, nodes);
}

static status place_axis(const vtk_grid *g, int a, grid *to) {
    const size_t count = (size_t)along(&g->frame.whole, a);
    double *nodes = mem_array(g->m, count, sizeof *nodes);
    if (!nodes)
        return ST_NOMEM;
    for (size_t i = 0; i < count; i++)
        nodes[i] = NAN; /* to find nodes that no piece has */
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < g->count; i++)
        st = read_piece_axis(g, &g->pieces[i], a, nodes);
    if (st == ST_OK)
        st = set_axis(g, a, nodes, to);
    mem_free(g->m, nodes);
    return st;
}

static status place(const vtk_grid *g, grid *to) {
    status st = ST_OK;
    if (g->geometry == VTK_REGULAR)
        place_regular(g, to);
    if (g->geometry == VTK_STRUCTURED)
        st = vtk_grid_place_points(g, to);
    for (int a = 0; st == ST_OK && a < 3 && g->geometry == VTK_RECTILINEAR; a++)
        st = place_axis(g, a, to);
    return st == ST_OK ? grid_check(to, g->paths[0]) : st;
}

/* ---- slices ---- */

static status open_samples(vtk_grid *g, vtk_grid_piece *p) {
    const vtk_extent e = samples_of(g->owner, &p->extent);
    uint64_t count;
    if (__builtin_mul_overflow(volume_of(&e), p->field->components, &count))
        count = UINT64_MAX - 1;
    return vtk_cursor_open(g->m, p->field, count, &p->samples);
}

static status close_samples(vtk_grid_piece *p) {
    status st = vtk_cursor_finish(p->samples);
    vtk_cursor_close(p->samples);
    p->samples = NULL;
    return st;
}

/* Mark the samples of the slice that active pieces have. A sample that none has is a fault. */
static status check_filled(vtk_grid *g, int64_t z) {
    const vtk_extent *all = &g->samples;
    const size_t width = (size_t)along(all, 0), height = (size_t)along(all, 1);
    memset(g->seen, 0, width * height);
    for (size_t i = 0; i < g->actives; i++) {
        const vtk_extent e = samples_of(g->owner, &g->pieces[g->active[i]].extent);
        for (int64_t y = e.lo[1]; y <= e.hi[1]; y++)
            memset(g->seen + (size_t)(y - all->lo[1]) * width + (e.lo[0] - all->lo[0]), 1,
                   (size_t)along(&e, 0));
    }
    const uint8_t *hole = memchr(g->seen, 0, width * height);
    if (!hole)
        return ST_OK;
    const size_t at = (size_t)(hole - g->seen);
    return status_describe(ST_CORRUPT, "%s: no piece has the sample at %lld %lld %lld", g->paths[0],
                           (long long)(all->lo[0] + (int64_t)(at % width)),
                           (long long)(all->lo[1] + (int64_t)(at / width)), (long long)z);
}

/* Update the active pieces for a slice. *changed: whether they are others than before. */
static status begin_slice(vtk_grid *g, int64_t z, bool *changed) {
    size_t kept = 0;
    *changed = z == g->samples.lo[2];
    for (size_t i = 0; i < g->actives; i++) {
        vtk_grid_piece *p = &g->pieces[g->active[i]];
        if (p->samples)
            g->active[kept++] = g->active[i];
        else
            *changed = true;
    }
    g->actives = kept;
    for (; g->begun < g->ordered && g->pieces[g->order[g->begun]].extent.lo[2] == z; g->begun++) {
        status st = open_samples(g, &g->pieces[g->order[g->begun]]);
        if (st != ST_OK)
            return st;
        g->active[g->actives++] = g->order[g->begun];
        *changed = true;
    }
    return ST_OK;
}

/* Read the next samples of a piece. */
static status read_samples(vtk_grid *g, vtk_grid_piece *p, size_t count, char *to) {
    if (!g->chunk)
        return vtk_cursor_raw(p->samples, count, to);
    const size_t most = CHUNK_BYTES / stored_samples_bytes(&g->stored);
    for (size_t done = 0, n; done < count; done += n) {
        n = count - done < most ? count - done : most;
        status st = vtk_cursor_raw(p->samples, n * g->stored.components, g->chunk);
        if (st != ST_OK)
            return st;
        if (stored_samples_take(&g->stored, g->chunk, g->type, to + done * sample_size(g->type),
                                n) < n)
            return vtk_array_fault(p->field, ST_UNSUPPORTED,
                                   "has whole numbers beyond 2^53, which no f64 holds exactly");
    }
    return ST_OK;
}

/* Read a piece's part of a slice: row by row, or at once where its rows are whole. */
static status read_part(vtk_grid *g, vtk_grid_piece *p, int64_t z, char *slice) {
    const vtk_extent e = samples_of(g->owner, &p->extent), *all = &g->samples;
    const size_t width = (size_t)along(all, 0), size = sample_size(g->type);
    size_t run = (size_t)along(&e, 0), rows = (size_t)along(&e, 1);
    char *to = slice + ((size_t)(e.lo[1] - all->lo[1]) * width + (e.lo[0] - all->lo[0])) * size;
    if (run == width) {
        run *= rows;
        rows = 1;
    }
    status st = ST_OK;
    for (size_t y = 0; st == ST_OK && y < rows; y++, to += width * size)
        st = read_samples(g, p, run, to);
    return st == ST_OK && z == e.hi[2] ? close_samples(p) : st;
}

static status read_slice(vtk_grid *g, int64_t z, char *slice) {
    bool changed;
    status st = begin_slice(g, z, &changed);
    if (st == ST_OK && changed && g->seen)
        st = check_filled(g, z);
    for (size_t i = 0; st == ST_OK && i < g->actives; i++)
        st = read_part(g, &g->pieces[g->active[i]], z, slice);
    return st;
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    vtk_grid *g = ctx;
    const size_t bytes =
        (size_t)(along(&g->samples, 0) * along(&g->samples, 1)) * sample_size(g->type);
    status st = ST_OK;
    for (uint32_t k = 0; st == ST_OK && k < count; k++)
        st = read_slice(g, g->samples.lo[2] + first + k, (char *)slices + k * bytes);
    return st;
}

/* Bytes as they are in a single piece: of an XML file behind a number that counts them. */
static bool find_place(void *ctx, sample_place *out) {
    const vtk_grid *g = ctx;
    const vtk_array *a = g->pieces[0].field;
    if (g->count != 1 || !a || a->packing != VTK_PLAIN ||
        (a->coding != VTK_RAW && a->coding != VTK_BARE))
        return false;
    const uint64_t head = a->coding == VTK_BARE ? 0 : a->head64 ? 8 : 4;
    *out = (sample_place){
        .path = a->path, .offset = a->at + head, .big_endian = a->big_endian, .stored = g->stored};
    out->stored.rounding = NULL;
    return true;
}

static void close_slices(void *ctx) {
    vtk_grid_close(ctx);
}

/* ---- opening ---- */

static int by_first_slice(const void *a, const void *b, void *pieces) {
    const size_t i = *(const size_t *)a, k = *(const size_t *)b;
    const int64_t first = ((const vtk_grid_piece *)pieces)[i].extent.lo[2];
    const int64_t second = ((const vtk_grid_piece *)pieces)[k].extent.lo[2];
    return first != second ? (first > second) - (first < second) : (i > k) - (i < k);
}

/* Check that each piece has as many numbers as its extent needs, and that its file has room for
 * them. */
static status check_pieces(vtk_grid *g) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < g->count; i++) {
        if (!has_samples(g, &g->pieces[i]))
            continue;
        st = open_samples(g, &g->pieces[i]);
        vtk_cursor_close(g->pieces[i].samples);
        g->pieces[i].samples = NULL;
    }
    return st;
}

static status make_order(vtk_grid *g) {
    g->order = mem_array(g->m, g->count, sizeof *g->order);
    g->active = mem_array(g->m, g->count, sizeof *g->active);
    if (!g->order || !g->active)
        return ST_NOMEM;
    for (size_t i = 0; i < g->count; i++)
        if (has_samples(g, &g->pieces[i]))
            g->order[g->ordered++] = i;
    qsort_r(g->order, g->ordered, sizeof *g->order, by_first_slice, g->pieces);
    if (g->count == 1)
        return ST_OK;
    g->seen = mem_array(g->m, (size_t)along(&g->samples, 0), (size_t)along(&g->samples, 1));
    return g->seen ? ST_OK : ST_NOMEM;
}

static status check_step(const vtk_grid *g, const volume_hints *hints) {
    return hints->step == 0 || g->parts.steps > 0 /* then the step has been checked */
               ? ST_OK
               : status_describe(ST_USAGE, "%s: no step %u: there is 1, counted from 0",
                                 g->paths[0], hints->step);
}

/* Describe the grid. Sizes come first: grid_check() checks their limits. */
static status describe(vtk_grid *g, const volume_hints *hints, grid *to) {
    if (vtk_extent_is_empty(&g->frame.whole))
        return status_describe(ST_CORRUPT, "%s: its whole extent is empty", g->paths[0]);
    status st = check_step(g, hints);
    if (st == ST_OK)
        st = check_extents(g);
    if (st == ST_OK)
        st = choose_field(g, hints, to);
    if (st != ST_OK)
        return st;
    const sample_type type = to->type, source = to->source;
    uint32_t dims[3];
    for (int a = 0; a < 3; a++) {
        dims[a] = (uint32_t)along(&g->samples, a);
        dims[a] += dims[a] == 0; /* flat, which grid_check() refuses */
    }
    grid_init(to, dims, type);
    to->source = source;
    g->type = type;
    st = grid_check(to, g->paths[0]);
    if (st == ST_OK)
        st = check_pieces(g);
    return st == ST_OK ? place(g, to) : st;
}

status vtk_grid_open(vtk_grid *g, const volume_hints *hints, slice_source *out) {
    grid to = {0};
    status st = describe(g, hints, &to);
    if (st == ST_OK)
        st = make_order(g);
    if (st == ST_OK && !stored_samples_plain(&g->stored) &&
        !(g->chunk = mem_alloc(g->m, CHUNK_BYTES)))
        st = ST_NOMEM;
    if (st != ST_OK) {
        grid_release(&to, g->m);
        return st;
    }
    g->stored.rounding = &g->rounding;
    *out = (slice_source){.name = g->paths[0],
                          .has_fields = true,
                          .m = g->m,
                          .g = to,
                          .read = read_slices,
                          .place = find_place,
                          .place_ctx = g,
                          .close = close_slices,
                          .ctx = g,
                          .rounding = &g->rounding,
                          .fields = tell_fields,
                          .fields_ctx = g};
    return ST_OK;
}
