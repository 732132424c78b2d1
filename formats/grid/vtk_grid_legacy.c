#include "formats/grid/vtk_grid_legacy.h"

#include <strings.h>

#include "formats/grid/vtk_grid.h"
#include "formats/input/text_number.h"
#include "formats/vtk/vtk_legacy.h"

typedef struct scan {
    vtk_grid *g;
    vtk_grid_piece *p; /* the only one */
    bool sized;        /* DIMENSIONS or EXTENT was there */
} scan;

/* ---- keywords ---- */

/* Set the extent, and with it the numbers of points and cells. A flat grid has cells, too. */
static void set_extent(vtk_legacy *v, const vtk_extent *e) {
    scan *s = v->user;
    uint64_t points = 1, cells = 1;
    for (int a = 0; a < 3; a++) {
        const uint64_t steps = (uint64_t)(e->hi[a] - e->lo[a]);
        points *= steps + 1;
        cells *= steps ? steps : 1;
    }
    s->g->frame.whole = s->p->extent = *e;
    v->tuples_there[VTK_OF_POINTS] = points;
    v->tuples_there[VTK_OF_CELLS] = cells;
}

static status bad_word(const vtk_legacy *v, int word, const char *expected) {
    return vtk_legacy_fault(v, ST_CORRUPT, "%s: \"%.40s\", expected %s", v->word[0], v->word[word],
                            expected);
}

static status on_dimensions(vtk_legacy *v) {
    scan *s = v->user;
    vtk_extent e = {0};
    status st = vtk_legacy_need_words(v, 4, "DIMENSIONS nx ny nz");
    if (st == ST_OK)
        st = vtk_legacy_once(v, &s->sized);
    for (int a = 0; st == ST_OK && a < 3; a++)
        if (text_number_int(v->word[1 + a], 1, GRID_DIM_MAX, &e.hi[a]))
            e.hi[a]--;
        else
            st = bad_word(v, 1 + a, "the nodes along an axis");
    if (st == ST_OK)
        set_extent(v, &e);
    return st;
}

/* Read the first and the last node along x, y, z. */
static status on_extent(vtk_legacy *v) {
    scan *s = v->user;
    vtk_extent e = {0};
    status st = vtk_legacy_need_words(v, 7, "EXTENT x0 x1 y0 y1 z0 z1");
    if (st == ST_OK)
        st = vtk_legacy_once(v, &s->sized);
    for (int i = 0; st == ST_OK && i < 6; i++) {
        int64_t *to = i % 2 ? &e.hi[i / 2] : &e.lo[i / 2];
        const int64_t least = i % 2 ? e.lo[i / 2] : -VTK_EXTENT_MAX;
        const int64_t most = i % 2 ? least + GRID_DIM_MAX - 1 : VTK_EXTENT_MAX;
        if (!text_number_int(v->word[1 + i], least, most, to))
            st = bad_word(v, 1 + i, "the index of a node");
    }
    if (st == ST_OK)
        set_extent(v, &e);
    return st;
}

static status read_numbers(const vtk_legacy *v, double out[3]) {
    status st = vtk_legacy_need_words(v, 4, "SPACING dx dy dz");
    for (int a = 0; st == ST_OK && a < 3; a++)
        if (!text_number_double(v->word[1 + a], &out[a]))
            st = bad_word(v, 1 + a, "a number");
    return st;
}

static status on_origin(vtk_legacy *v) {
    return read_numbers(v, ((scan *)v->user)->g->frame.origin);
}

static status on_spacing(vtk_legacy *v) {
    return read_numbers(v, ((scan *)v->user)->g->frame.spacing);
}

/* Read "X_COORDINATES n type" and the numbers. */
static status on_coordinates(vtk_legacy *v) {
    static const char *const roles[] = {"X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"};
    scan *s = v->user;
    const int a = (v->word[0][0] | 0x20) - 'x';
    const vtk_extent *e = &s->p->extent;
    vtk_type type = VTK_ABSENT;
    uint64_t count = 0;
    bool before = s->p->axis[a].type != VTK_ABSENT;
    status st = vtk_legacy_need_words(v, 3, "X_COORDINATES n type");
    if (st == ST_OK)
        st = vtk_legacy_once(v, &before);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 1, &count);
    if (st == ST_OK && (!s->sized || count != (uint64_t)(e->hi[a] - e->lo[a] + 1)))
        st = bad_word(v, 1, "as many as there are nodes along this axis, told before");
    if (st == ST_OK)
        st = vtk_legacy_type(v, 2, &type);
    return st == ST_OK ? vtk_legacy_array(v, type, roles[a], count, &s->p->axis[a]) : st;
}

/* Read a structured grid's "POINTS n type" and the numbers. */
static status on_points(vtk_legacy *v) {
    scan *s = v->user;
    vtk_type type = VTK_ABSENT;
    uint64_t count = 0;
    bool before = s->p->points.type != VTK_ABSENT;
    status st = vtk_legacy_need_words(v, 3, "POINTS n type");
    if (st == ST_OK)
        st = vtk_legacy_once(v, &before);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 1, &count);
    if (st == ST_OK && (!s->sized || count != v->tuples_there[VTK_OF_POINTS]))
        st = bad_word(v, 1, "as many as there are nodes, told before");
    if (st == ST_OK)
        st = vtk_legacy_type(v, 2, &type);
    if (st != ST_OK)
        return st;
    st = vtk_legacy_array(v, type, "POINTS", 3 * count, &s->p->points);
    s->p->points.components = 3;
    return st;
}

static const vtk_legacy_keyword of_points[] = {
    {"DIMENSIONS", on_dimensions}, {"EXTENT", on_extent},        {"ORIGIN", on_origin},
    {"SPACING", on_spacing},       {"ASPECT_RATIO", on_spacing}, {NULL, NULL}};
static const vtk_legacy_keyword of_rectilinear[] = {
    {"DIMENSIONS", on_dimensions},     {"EXTENT", on_extent},
    {"X_COORDINATES", on_coordinates}, {"Y_COORDINATES", on_coordinates},
    {"Z_COORDINATES", on_coordinates}, {NULL, NULL}};
static const vtk_legacy_keyword of_structured[] = {
    {"DIMENSIONS", on_dimensions}, {"EXTENT", on_extent}, {"POINTS", on_points}, {NULL, NULL}};
static const vtk_legacy_dataset sets[] = {{"STRUCTURED_POINTS", of_points},
                                          {"RECTILINEAR_GRID", of_rectilinear},
                                          {"STRUCTURED_GRID", of_structured},
                                          {NULL, NULL}};

static vtk_geometry geometry_of(const vtk_legacy_dataset *d) {
    return d && d->keywords == of_rectilinear  ? VTK_RECTILINEAR
           : d && d->keywords == of_structured ? VTK_STRUCTURED
                                               : VTK_REGULAR;
}

/* ---- the reader ---- */

static bool known(const char *path, const uint8_t *start, size_t size) {
    char name[VTK_LEGACY_NAME_MAX];
    (void)path;
    if (!vtk_legacy_names(start, size, name))
        return false;
    for (const vtk_legacy_dataset *d = sets; d->name; d++)
        if (strcasecmp(d->name, name) == 0)
            return true;
    return false;
}

static status scan_file(vtk_grid *g, byte_stream *data) {
    scan s = {.g = g};
    status st = vtk_grid_add_piece(g, &s.p);
    if (st != ST_OK)
        return st;
    s.p->path = g->paths[0];
    vtk_legacy v = {.m = g->m, .path = g->paths[0], .s = data, .fields = &s.p->fields, .user = &s};
    st = vtk_legacy_scan(&v, sets);
    g->geometry = geometry_of(v.dataset);
    if (st == ST_OK && !s.sized)
        st = status_describe(ST_CORRUPT, "%s: ends at byte %llu without DIMENSIONS", g->paths[0],
                             (unsigned long long)byte_stream_position(data));
    return st;
}

static status open_grid(vtk_grid *g, volume_layout *l, const volume_hints *hints,
                        slice_source *out) {
    const char *path;
    status st = vtk_array_check_file(l->path);
    if (st == ST_OK)
        st = vtk_grid_add_path(g, l->path, &path);
    if (st == ST_OK)
        st = scan_file(g, l->data);
    return st == ST_OK ? vtk_grid_open(g, hints, out) : st;
}

static status open_slices(volume_layout *l, const volume_hints *hints, slice_source *out) {
    vtk_grid *g;
    status st = vtk_grid_create(l->m, &g);
    if (st != ST_OK)
        return st;
    st = open_grid(g, l, hints, out);
    if (st != ST_OK)
        vtk_grid_close(g);
    return st;
}

const grid_reader vtk_grid_legacy_reader = {
    .format = "legacy VTK grid", .known = known, .slices = open_slices};
