#include "formats/mesh/vtk_faces.h"

#include "formats/vtk/vtk_cursor.h"

enum { SIZE_MAX_OF_CELL = 1 << 20 }; /* numbers of a polyhedron's stream */

struct vtk_faces {
    mem *m;
    const vtk_faces_source *source;
    vtk_cursor *faces, *faceoffsets, *ids, *ends, *cell_faces, *cell_ends;
    uint64_t cell;           /* number of the next one */
    uint64_t end;            /* where the faces of the one before ended */
    uint64_t face, face_end; /* number of the next face; where the one before ended */
    uint64_t *stream;
    size_t size, room;
};

bool vtk_faces_there(const vtk_faces_source *s) {
    return s->faces.type != VTK_ABSENT || s->ids.type != VTK_ABSENT;
}

static status open_one(vtk_faces *f, const vtk_array *a, uint64_t count, vtk_cursor **out) {
    if (a->type == VTK_ABSENT)
        return vtk_array_fault(f->source->faces.type != VTK_ABSENT ? &f->source->faces
                                                                   : &f->source->ids,
                               ST_CORRUPT, "expected the other arrays of polyhedra's faces, too");
    if (!vtk_array_whole(a->type))
        return vtk_array_fault(a, ST_CORRUPT, "expected whole numbers");
    return vtk_cursor_open(f->m, a, count, out);
}

static status open_all(vtk_faces *f, uint64_t cells) {
    const vtk_faces_source *s = f->source;
    if (s->faces.type != VTK_ABSENT) {
        status st = open_one(f, &s->faces, VTK_CURSOR_ANY, &f->faces);
        return st == ST_OK ? open_one(f, &s->faceoffsets, cells, &f->faceoffsets) : st;
    }
    status st = open_one(f, &s->ids, VTK_CURSOR_ANY, &f->ids);
    if (st == ST_OK)
        st = open_one(f, &s->ends, VTK_CURSOR_ANY, &f->ends);
    if (st == ST_OK)
        st = open_one(f, &s->cell_faces, VTK_CURSOR_ANY, &f->cell_faces);
    return st == ST_OK ? open_one(f, &s->cell_ends, cells, &f->cell_ends) : st;
}

status vtk_faces_open(mem *m, const vtk_faces_source *source, uint64_t cells, vtk_faces **out) {
    vtk_faces *f = mem_zalloc(m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    f->m = m;
    f->source = source;
    const status st = open_all(f, cells);
    if (st != ST_OK) {
        vtk_faces_close(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

void vtk_faces_close(vtk_faces *f) {
    if (!f)
        return;
    vtk_cursor *const all[] = {f->faces, f->faceoffsets, f->ids,
                               f->ends,  f->cell_faces,  f->cell_ends};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        vtk_cursor_close(all[i]);
    mem_free(f->m, f->stream);
    mem_free(f->m, f);
}

/* ---- a cell ---- */

static status fault(const vtk_faces *f, const vtk_array *a, const char *what) {
    return vtk_array_fault(a, ST_CORRUPT, "cell %llu (counted from 0) %s",
                           (unsigned long long)f->cell, what);
}

/* Make room for so many numbers more. */
static status reserve(vtk_faces *f, const vtk_array *a, uint64_t count) {
    if (count > SIZE_MAX_OF_CELL - f->size)
        return vtk_array_fault(a, ST_UNSUPPORTED,
                               "cell %llu (counted from 0) has faces of more than %d numbers",
                               (unsigned long long)f->cell, SIZE_MAX_OF_CELL);
    status st = ST_OK;
    while (st == ST_OK && f->room < f->size + count)
        st = mem_grow(f->m, &f->stream, sizeof *f->stream, f->room, 256, &f->room);
    return st;
}

/* Where something ends that begins where the last one ended. */
static status next_end(const vtk_faces *f, const vtk_array *a, vtk_cursor *c, uint64_t begin,
                       uint64_t *end) {
    *end = 0;
    const status st = vtk_cursor_whole(c, 1, end);
    const bool negative = *end == UINT64_MAX;
    return st == ST_OK && (*end < begin || negative) ? fault(f, a, "ends before it begins") : st;
}

static status read_stream(vtk_faces *f, bool polyhedron, mesh_polyhedron *p) {
    const vtk_array *a = &f->source->faces;
    uint64_t end, faces = 0;
    status st = vtk_cursor_whole(f->faceoffsets, 1, &end);
    if (st != ST_OK || !polyhedron)
        return st;
    if (end <= f->end || end == UINT64_MAX)
        return fault(f, &f->source->faceoffsets, "is a polyhedron without faces");
    st = reserve(f, a, end - f->end - 1);
    if (st == ST_OK)
        st = vtk_cursor_whole(f->faces, 1, &faces);
    f->size = (size_t)(end - f->end - 1);
    f->end = end;
    p->faces = (size_t)faces;
    return st == ST_OK ? vtk_cursor_whole(f->faces, f->size, f->stream) : st;
}

static status read_face(vtk_faces *f) {
    uint64_t number, end = 0;
    status st = vtk_cursor_whole(f->cell_faces, 1, &number);
    if (st == ST_OK && number != f->face)
        return vtk_array_fault(&f->source->cell_faces, ST_UNSUPPORTED,
                               "cell %llu (counted from 0) has face %lld, expected %llu: faces in "
                               "another order than the cells'",
                               (unsigned long long)f->cell, (long long)number,
                               (unsigned long long)f->face);
    if (st == ST_OK)
        st = next_end(f, &f->source->ends, f->ends, f->face_end, &end);
    if (st == ST_OK)
        st = reserve(f, &f->source->ids, 1 + end - f->face_end);
    if (st != ST_OK)
        return st;
    const size_t count = (size_t)(end - f->face_end);
    f->stream[f->size++] = count;
    st = vtk_cursor_whole(f->ids, count, f->stream + f->size);
    f->size += count;
    f->face_end = end;
    f->face++;
    return st;
}

static status read_faces(vtk_faces *f, bool polyhedron, mesh_polyhedron *p) {
    uint64_t end;
    status st = next_end(f, &f->source->cell_ends, f->cell_ends, f->end, &end);
    if (st == ST_OK && (end > f->end) != polyhedron)
        return fault(f, &f->source->cell_ends,
                     polyhedron ? "is a polyhedron without faces" : "has faces, but is none");
    for (; st == ST_OK && f->end < end; f->end++) {
        st = read_face(f);
        p->faces++;
    }
    return st;
}

status vtk_faces_next(vtk_faces *f, bool polyhedron, mesh_polyhedron *p) {
    *p = (mesh_polyhedron){.faces = 0};
    f->size = 0;
    const status st = (f->faces ? read_stream : read_faces)(f, polyhedron, p);
    if (st != ST_OK)
        return st;
    p->stream = f->stream;
    p->size = f->size;
    const char *what = polyhedron ? mesh_polyhedron_fault(p) : NULL;
    if (what)
        return fault(f, f->faces ? &f->source->faces : &f->source->ids, what);
    f->cell++;
    return ST_OK;
}

status vtk_faces_finish(vtk_faces *f) {
    vtk_cursor *const all[] = {f->faces, f->faceoffsets, f->ids,
                               f->ends,  f->cell_faces,  f->cell_ends};
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < sizeof all / sizeof *all; i++)
        if (all[i])
            st = vtk_cursor_finish(all[i]);
    return st;
}
