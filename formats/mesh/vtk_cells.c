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
};

/* ---- opening ---- */

static status check_array(const vtk_array *a, const char *what) {
    if (a->type == VTK_ABSENT)
        return status_describe(ST_CORRUPT, "%s: expected the %s of its cells", a->path, what);
    if (!vtk_array_whole(a->type))
        return vtk_array_fault(a, ST_CORRUPT, "expected whole numbers");
    return ST_OK;
}

static status open_cursors(vtk_cells *c) {
    const vtk_cells_source *s = c->source;
    bool counted = s->offsets.type == VTK_ABSENT;
    status st = check_array(&s->types, "types");
    if (st == ST_OK)
        st = check_array(&s->ids, "points");
    if (st == ST_OK && !counted)
        st = check_array(&s->offsets, "offsets");
    if (st == ST_OK)
        st = vtk_cursor_open(c->m, &s->types, s->count, &c->types);
    if (st == ST_OK)
        st = vtk_cursor_open(c->m, &s->ids, s->ids_size, &c->ids);
    if (st == ST_OK && !counted)
        st = vtk_cursor_open(c->m, &s->offsets, s->count + s->from_zero, &c->offsets);
    if (st == ST_OK && s->ghosts && !vtk_array_whole(s->ghosts->type))
        st = vtk_array_fault(s->ghosts, ST_CORRUPT, "expected whole numbers");
    if (st == ST_OK && s->ghosts)
        st = vtk_cursor_open(c->m, s->ghosts, s->count * s->ghosts->components, &c->ghosts);
    return st;
}

status vtk_cells_open(mem *m, const vtk_cells_source *source, vtk_cells **out) {
    vtk_cells *c = mem_zalloc(m, sizeof *c);
    if (!c)
        return ST_NOMEM;
    c->m = m;
    c->source = source;
    status st = open_cursors(c);
    if (st == ST_OK && source->from_zero) {
        st = vtk_cursor_whole(c->offsets, 1, &c->end);
        if (st == ST_OK && c->end != 0)
            st = vtk_array_fault(&source->offsets, ST_CORRUPT, "starts with %llu, expected 0",
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
    mem_free(c->m, c);
}

/* ---- types, by VTK's numbers ---- */

enum { TETRA = 10, VOXEL, HEXAHEDRON, WEDGE, PYRAMID, TYPES_MAX = 96 };

static const struct {
    const char *name; /* for messages; NULL: no such type */
    bool passed_over; /* vertices, lines, surfaces */
} types[TYPES_MAX] = {
    [0] = {"empty", true},
    [1] = {"vertex", true},
    [2] = {"poly-vertex", true},
    [3] = {"line", true},
    [4] = {"poly-line", true},
    [5] = {"triangle", true},
    [6] = {"triangle strip", true},
    [7] = {"polygon", true},
    [8] = {"pixel", true},
    [9] = {"quad", true},
    [15] = {"pentagonal prism", false},
    [16] = {"hexagonal prism", false},
    [21] = {"quadratic edge", true},
    [22] = {"quadratic triangle", true},
    [23] = {"quadratic quad", true},
    [24] = {"quadratic tetrahedron", false},
    [25] = {"quadratic hexahedron", false},
    [26] = {"quadratic wedge", false},
    [27] = {"quadratic pyramid", false},
    [28] = {"biquadratic quad", true},
    [29] = {"triquadratic hexahedron", false},
    [30] = {"quadratic-linear quad", true},
    [31] = {"quadratic-linear wedge", false},
    [32] = {"biquadratic-quadratic wedge", false},
    [33] = {"biquadratic-quadratic hexahedron", false},
    [34] = {"biquadratic triangle", true},
    [35] = {"cubic line", true},
    [36] = {"quadratic polygon", true},
    [37] = {"triquadratic pyramid", false},
    [41] = {"convex point set", false},
    [42] = {"polyhedron", false},
    [51] = {"parametric curve", true},
    [52] = {"parametric surface", true},
    [60] = {"higher-order edge", true},
    [61] = {"higher-order triangle", true},
    [62] = {"higher-order quad", true},
    [63] = {"higher-order polygon", true},
    [64] = {"higher-order tetrahedron", false},
    [65] = {"higher-order wedge", false},
    [66] = {"higher-order pyramid", false},
    [67] = {"higher-order hexahedron", false},
    [68] = {"Lagrange curve", true},
    [69] = {"Lagrange triangle", true},
    [70] = {"Lagrange quad", true},
    [71] = {"Lagrange tetrahedron", false},
    [72] = {"Lagrange hexahedron", false},
    [73] = {"Lagrange wedge", false},
    [74] = {"Lagrange pyramid", false},
    [75] = {"Bezier curve", true},
    [76] = {"Bezier triangle", true},
    [77] = {"Bezier quad", true},
    [78] = {"Bezier tetrahedron", false},
    [79] = {"Bezier hexahedron", false},
    [80] = {"Bezier wedge", false},
    [81] = {"Bezier pyramid", false},
};

static bool volume_kind(uint64_t type, cell_shape *kind) {
    switch (type) {
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
                               "wedges, pyramids and voxels are supported",
                               (unsigned long long)c->cell, types[type].name);
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
        return vtk_array_fault(&c->source->offsets, ST_CORRUPT,
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

status vtk_cells_next(vtk_cells *c, vtk_cell *cell) {
    uint64_t type, size;
    status st = next_ghost(c, cell);
    if (st == ST_OK)
        st = vtk_cursor_whole(c->types, 1, &type);
    if (st == ST_OK)
        st = next_size(c, &size);
    if (st != ST_OK)
        return st;
    cell->volume = volume_kind(type, &cell->kind);
    cell->count = cell->volume ? cell_shape_vertices(cell->kind) : 0;
    if (!cell->volume)
        st = check_passed_over(c, type);
    else if (size != (uint64_t)cell->count)
        st = vtk_array_fault(&c->source->types, ST_CORRUPT,
                             "cell %llu (counted from 0) of type %llu has %lld points, expected %d",
                             (unsigned long long)c->cell, (unsigned long long)type, (long long)size,
                             cell->count);
    if (st != ST_OK)
        return st;
    c->cell++;
    return cell->volume ? vtk_cursor_whole(c->ids, (size_t)cell->count, cell->ids)
                        : pass_over(c, size);
}

status vtk_cells_finish(vtk_cells *c) {
    status st = vtk_cursor_finish(c->types);
    if (st == ST_OK && c->offsets)
        st = vtk_cursor_finish(c->offsets);
    if (st == ST_OK && c->ghosts)
        st = vtk_cursor_finish(c->ghosts);
    return st == ST_OK ? vtk_cursor_finish(c->ids) : st;
}
