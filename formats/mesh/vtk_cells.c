#include "formats/mesh/vtk_cells.h"

#include <string.h>

#include "formats/mesh/mesh_split.h"
#include "formats/vtk/vtk_cursor.h"
#include "formats/vtk/vtk_fields.h"

struct vtk_cells {
    mem *m;
    const vtk_cells_source *source;
    vtk_cursor *types, *offsets, *ids, *ghosts;
    uint64_t cell; /* number of the next cell */
    uint64_t end;  /* where the ids of the cell before ended */
    vtk_faces *faces;
    uint64_t *stream; /* faces of a polyhedron, from among the ids */
    size_t room;
};

/* ---- opening ---- */

/* Where a polyhedron's faces stand in the place of its points. */
static bool is_legacy(const vtk_cells_source *s) {
    return s->lists.offsets.type == VTK_ABSENT || s->lists.from_zero;
}

static status check_array(const vtk_array *a, const char *what) {
    if (a->type == VTK_ABSENT)
        return status_describe(ST_CORRUPT, "%s: expected the %s of its cells", a->path, what);
    if (!vtk_array_whole(a->type))
        return vtk_array_fault(a, ST_CORRUPT, "expected whole numbers");
    return ST_OK;
}

static status open_cursors(vtk_cells *c) {
    const vtk_cells_source *s = c->source;
    bool counted = s->lists.offsets.type == VTK_ABSENT;
    status st = check_array(&s->types, "types");
    if (st == ST_OK)
        st = check_array(&s->lists.ids, "points");
    if (st == ST_OK && !counted)
        st = check_array(&s->lists.offsets, "offsets");
    if (st == ST_OK)
        st = vtk_cursor_open(c->m, &s->types, s->lists.count, &c->types);
    if (st == ST_OK)
        st = vtk_cursor_open(c->m, &s->lists.ids, s->lists.ids_size, &c->ids);
    if (st == ST_OK && !counted)
        st = vtk_cursor_open(c->m, &s->lists.offsets, s->lists.count + s->lists.from_zero,
                             &c->offsets);
    if (st == ST_OK && s->ghosts && !vtk_array_whole(s->ghosts->type))
        st = vtk_array_fault(s->ghosts, ST_CORRUPT, "expected whole numbers");
    if (st == ST_OK && s->ghosts)
        st = vtk_cursor_open(c->m, s->ghosts, s->lists.count * s->ghosts->components, &c->ghosts);
    if (st == ST_OK && vtk_faces_there(&s->faces))
        st = vtk_faces_open(c->m, &s->faces, s->lists.count, &c->faces);
    return st;
}

status vtk_cells_open(mem *m, const vtk_cells_source *source, vtk_cells **out) {
    vtk_cells *c = mem_zalloc(m, sizeof *c);
    if (!c)
        return ST_NOMEM;
    c->m = m;
    c->source = source;
    status st = open_cursors(c);
    if (st == ST_OK && source->lists.from_zero) {
        st = vtk_cursor_whole(c->offsets, 1, &c->end);
        if (st == ST_OK && c->end != 0)
            st = vtk_array_fault(&source->lists.offsets, ST_CORRUPT, "starts with %llu, expected 0",
                                 (unsigned long long)c->end);
    }
    if (st != ST_OK) {
        vtk_cells_close(c);
        return st;
    }
    *out = c;
    return ST_OK;
}

void vtk_cells_close(vtk_cells *c) {
    if (!c)
        return;
    vtk_cursor_close(c->types);
    vtk_cursor_close(c->offsets);
    vtk_cursor_close(c->ids);
    vtk_cursor_close(c->ghosts);
    vtk_faces_close(c->faces);
    mem_free(c->m, c->stream);
    mem_free(c->m, c);
}

/* ---- types, by VTK's numbers ---- */

enum {
    TETRA = 10,
    VOXEL,
    HEXAHEDRON,
    WEDGE,
    PYRAMID,
    QUADRATIC_TETRA = 24,
    POLYHEDRON = 42,
    TYPES_MAX = 96
};

static const struct {
    const char *name; /* for messages; NULL: no such type */
    bool passed_over; /* vertices, lines, surfaces */
    int corners;      /* of higher order: the cell_shape of its corners, which come first, + 1 */
} types[TYPES_MAX] = {
    [0] = {"empty", true, 0},
    [1] = {"vertex", true, 0},
    [2] = {"poly-vertex", true, 0},
    [3] = {"line", true, 0},
    [4] = {"poly-line", true, 0},
    [5] = {"triangle", true, 0},
    [6] = {"triangle strip", true, 0},
    [7] = {"polygon", true, 0},
    [8] = {"pixel", true, 0},
    [9] = {"quad", true, 0},
    [15] = {"pentagonal prism", false, 0},
    [16] = {"hexagonal prism", false, 0},
    [21] = {"quadratic edge", true, 0},
    [22] = {"quadratic triangle", true, 0},
    [23] = {"quadratic quad", true, 0},
    [24] = {"quadratic tetrahedron", false, 1 + CELL_TET},
    [25] = {"quadratic hexahedron", false, 1 + CELL_HEXAHEDRON},
    [26] = {"quadratic wedge", false, 1 + CELL_WEDGE},
    [27] = {"quadratic pyramid", false, 1 + CELL_PYRAMID},
    [28] = {"biquadratic quad", true, 0},
    [29] = {"triquadratic hexahedron", false, 1 + CELL_HEXAHEDRON},
    [30] = {"quadratic-linear quad", true, 0},
    [31] = {"quadratic-linear wedge", false, 1 + CELL_WEDGE},
    [32] = {"biquadratic-quadratic wedge", false, 1 + CELL_WEDGE},
    [33] = {"biquadratic-quadratic hexahedron", false, 1 + CELL_HEXAHEDRON},
    [34] = {"biquadratic triangle", true, 0},
    [35] = {"cubic line", true, 0},
    [36] = {"quadratic polygon", true, 0},
    [37] = {"triquadratic pyramid", false, 1 + CELL_PYRAMID},
    [41] = {"convex point set", false, 0},
    [51] = {"parametric curve", true, 0},
    [52] = {"parametric surface", true, 0},
    [60] = {"higher-order edge", true, 0},
    [61] = {"higher-order triangle", true, 0},
    [62] = {"higher-order quad", true, 0},
    [63] = {"higher-order polygon", true, 0},
    [64] = {"higher-order tetrahedron", false, 0},
    [65] = {"higher-order wedge", false, 0},
    [66] = {"higher-order pyramid", false, 0},
    [67] = {"higher-order hexahedron", false, 0},
    [68] = {"Lagrange curve", true, 0},
    [69] = {"Lagrange triangle", true, 0},
    [70] = {"Lagrange quad", true, 0},
    [71] = {"Lagrange tetrahedron", false, 1 + CELL_TET},
    [72] = {"Lagrange hexahedron", false, 1 + CELL_HEXAHEDRON},
    [73] = {"Lagrange wedge", false, 1 + CELL_WEDGE},
    [74] = {"Lagrange pyramid", false, 1 + CELL_PYRAMID},
    [75] = {"Bezier curve", true, 0},
    [76] = {"Bezier triangle", true, 0},
    [77] = {"Bezier quad", true, 0},
    [78] = {"Bezier tetrahedron", false, 1 + CELL_TET},
    [79] = {"Bezier hexahedron", false, 1 + CELL_HEXAHEDRON},
    [80] = {"Bezier wedge", false, 1 + CELL_WEDGE},
    [81] = {"Bezier pyramid", false, 1 + CELL_PYRAMID},
};

static bool volume_kind(const vtk_cells *c, uint64_t type, cell_shape *kind) {
    switch (type) {
    case QUADRATIC_TETRA:
        *kind = CELL_QUADRATIC_TET;
        return c->source->quadratic && !c->source->by_corners;
    case TETRA: *kind = CELL_TET; return true;
    case VOXEL: *kind = CELL_VOXEL; return true;
    case HEXAHEDRON: *kind = CELL_HEXAHEDRON; return true;
    case WEDGE: *kind = CELL_WEDGE; return true;
    case PYRAMID: *kind = CELL_PYRAMID; return true;
    default: return false;
    }
}

static status check_passed_over(const vtk_cells *c, uint64_t type) {
    if (type < TYPES_MAX && types[type].passed_over)
        return ST_OK;
    if (type < TYPES_MAX && types[type].name)
        return vtk_array_fault(&c->source->types, ST_UNSUPPORTED,
                               "cell %llu (counted from 0) is a %s; linear tetrahedra, hexahedra, "
                               "wedges, pyramids, voxels and polyhedra are supported%s",
                               (unsigned long long)c->cell, types[type].name,
                               type == QUADRATIC_TETRA
                                   ? " (--whole-cells takes it as it is, --by-corners as a linear "
                                     "one)"
                               : types[type].corners ? " (--by-corners takes it as a linear one)"
                                                     : "");
    return vtk_array_fault(
        &c->source->types, ST_CORRUPT,
        "cell %llu (counted from 0) is of type %lld, expected a cell type of VTK",
        (unsigned long long)c->cell, (long long)type);
}

/* ---- reading ---- */

/* Read how many points the next cell has. */
static status next_size(vtk_cells *c, uint64_t *size) {
    if (!c->offsets)
        return vtk_cursor_whole(c->ids, 1, size);
    uint64_t end;
    status st = vtk_cursor_whole(c->offsets, 1, &end);
    if (st != ST_OK)
        return st;
    if (end < c->end || end == UINT64_MAX)
        return vtk_array_fault(&c->source->lists.offsets, ST_CORRUPT,
                               "cell %llu (counted from 0) ends at %lld, expected %llu or more",
                               (unsigned long long)c->cell, (long long)end,
                               (unsigned long long)c->end);
    *size = end - c->end;
    c->end = end;
    return ST_OK;
}

static status pass_over(vtk_cells *c, uint64_t count) {
    uint64_t passed[64];
    status st = ST_OK;
    while (st == ST_OK && count > 0) {
        size_t part = count < 64 ? (size_t)count : 64;
        st = vtk_cursor_whole(c->ids, part, passed);
        count -= part;
    }
    return st;
}

/* Read the next cell's ghost word. vtkGhostType holds bits; vtkGhostLevels holds the cell's
 * distance from its own part. */
static status next_ghost(vtk_cells *c, vtk_cell *cell) {
    enum { DUPLICATE = 1, REFINED = 8, HIDDEN = 32 };
    uint64_t word = 0;
    cell->copied = cell->hidden = false;
    if (!c->ghosts)
        return ST_OK;
    const bool levels = strcmp(c->source->ghosts->name, VTK_GHOST_LEVELS) == 0;
    status st = ST_OK;
    for (uint32_t i = 0; st == ST_OK && i < c->source->ghosts->components; i++) {
        uint64_t next;
        st = vtk_cursor_whole(c->ghosts, 1, &next);
        word = i == 0 ? next : word;
    }
    cell->copied = levels ? word > 0 : (word & DUPLICATE) != 0;
    cell->hidden = !levels && (word & (REFINED | HIDDEN)) != 0;
    return st;
}

/* A legacy file has a polyhedron's faces in the place of its points. */
static status read_polyhedron(vtk_cells *c, uint64_t size, mesh_polyhedron *p) {
    enum { NUMBERS_MAX = 1 << 20 };
    uint64_t faces = 0;
    if (size < 1 || size > NUMBERS_MAX)
        return vtk_array_fault(&c->source->lists.ids, ST_UNSUPPORTED,
                               "cell %llu (counted from 0) is a polyhedron of %llu numbers, at "
                               "most %d are supported",
                               (unsigned long long)c->cell, (unsigned long long)size, NUMBERS_MAX);
    status st = vtk_cursor_whole(c->ids, 1, &faces);
    while (st == ST_OK && c->room < size)
        st = mem_grow(c->m, &c->stream, sizeof *c->stream, c->room, 256, &c->room);
    if (st == ST_OK)
        st = vtk_cursor_whole(c->ids, (size_t)size - 1, c->stream);
    *p = (mesh_polyhedron){.faces = (size_t)faces, .stream = c->stream, .size = (size_t)size - 1};
    const char *what = st == ST_OK ? mesh_polyhedron_fault(p) : NULL;
    return what
               ? vtk_array_fault(&c->source->lists.ids, ST_CORRUPT, "cell %llu (counted from 0) %s",
                                 (unsigned long long)c->cell, what)
               : st;
}

/* The next cell's faces. polyhedron: it has some. size: its numbers among the ids. */
static status next_faces(vtk_cells *c, bool polyhedron, uint64_t size, vtk_cell *cell) {
    cell->polyhedron = (mesh_polyhedron){.faces = 0};
    if (polyhedron && !c->faces && !is_legacy(c->source))
        return vtk_array_fault(&c->source->types, ST_CORRUPT,
                               "cell %llu (counted from 0) is a polyhedron, expected an array of "
                               "faces",
                               (unsigned long long)c->cell);
    if (!c->faces)
        return polyhedron ? read_polyhedron(c, size, &cell->polyhedron) : ST_OK;
    const status st = vtk_faces_next(c->faces, polyhedron, &cell->polyhedron);
    return st == ST_OK && polyhedron ? pass_over(c, size) : st;
}

status vtk_cells_may_hold_polyhedra(mem *m, const vtk_cells_source *s, bool *out) {
    vtk_cursor *c = NULL;
    *out = vtk_faces_there(&s->faces);
    if (*out || s->lists.count == 0 || !is_legacy(s) || !vtk_array_whole(s->types.type))
        return ST_OK;
    status st = vtk_cursor_open(m, &s->types, s->lists.count, &c);
    for (uint64_t i = 0; st == ST_OK && i < s->lists.count && !*out; i++) {
        uint64_t type = 0;
        st = vtk_cursor_whole(c, 1, &type);
        *out = type == POLYHEDRON;
    }
    vtk_cursor_close(c);
    return st;
}

status vtk_cells_next(vtk_cells *c, vtk_cell *cell) {
    uint64_t type, size;
    status st = next_ghost(c, cell);
    if (st == ST_OK)
        st = vtk_cursor_whole(c->types, 1, &type);
    if (st == ST_OK)
        st = next_size(c, &size);
    if (st != ST_OK)
        return st;
    const bool polyhedron = type == POLYHEDRON;
    st = next_faces(c, polyhedron, size, cell);
    if (st != ST_OK)
        return st;
    const bool own = volume_kind(c, type, &cell->kind);
    cell->bent = !own && c->source->by_corners && type < TYPES_MAX && types[type].corners;
    if (cell->bent)
        cell->kind = (cell_shape)(types[type].corners - 1);
    const bool shaped = own || cell->bent;
    cell->volume = shaped || polyhedron;
    cell->count = shaped ? cell_shape_vertices(cell->kind) : 0;
    if (!cell->volume)
        st = check_passed_over(c, type);
    else if (shaped && (cell->bent ? size < (uint64_t)cell->count : size != (uint64_t)cell->count))
        st = vtk_array_fault(&c->source->types, ST_CORRUPT,
                             "cell %llu (counted from 0) of type %llu has %lld points, expected %d",
                             (unsigned long long)c->cell, (unsigned long long)type, (long long)size,
                             cell->count);
    if (st != ST_OK)
        return st;
    c->cell++;
    if (polyhedron)
        return ST_OK;
    if (shaped)
        st = vtk_cursor_whole(c->ids, (size_t)cell->count, cell->ids);
    return st == ST_OK ? pass_over(c, size - (uint64_t)cell->count) : st;
}

status vtk_cells_finish(vtk_cells *c) {
    status st = vtk_cursor_finish(c->types);
    if (st == ST_OK && c->offsets)
        st = vtk_cursor_finish(c->offsets);
    if (st == ST_OK && c->ghosts)
        st = vtk_cursor_finish(c->ghosts);
    if (st == ST_OK && c->faces)
        st = vtk_faces_finish(c->faces);
    return st == ST_OK ? vtk_cursor_finish(c->ids) : st;
}
