#include "formats/mesh/mesh_vtk_parts.h"

#include <string.h>

#include "formats/mesh/mesh_vtu.h"
#include "formats/mesh/vtk_unstructured.h"
#include "formats/vtk/vtk_parts.h"
#include "formats/vtk/vtk_xml.h"

/* ---- refusing ---- */

/* Refuse a file that is no mesh we read. If several are named, advise to give one of them itself.
 * type: "" if the file states none. */
static status refuse(const vtk_parts *in, const char *by, uint32_t step, const char *path,
                     const char *type) {
    char names[VTK_PARTS_TEXT];
    const char *what = *type ? type : "nothing of VTK";
    if (in->first[step + 1] - in->first[step] == 1)
        return status_describe(ST_UNSUPPORTED,
                               "%s: names %s, which is %s: expected an unstructured grid (.vtu, "
                               ".pvtu)",
                               by, path, what);
    return status_describe(ST_UNSUPPORTED,
                           "%s: its files are no mesh together: %s is %s; give one of them "
                           "itself: %s",
                           by, path, what, vtk_parts_list(in, step, names));
}

/* Turn ST_CORRUPT for blocks and parts that differ into the advice to give one of them itself. */
static status tell_parts(const vtk_unstructured *g, uint32_t step, status st) {
    char names[VTK_PARTS_TEXT];
    const vtk_parts *p = &g->parts;
    if (st != ST_CORRUPT || p->kind == VTK_PARTS_PIECES || p->first[step + 1] - p->first[step] == 1)
        return st;
    return status_describe(ST_UNSUPPORTED,
                           "%s: its files are no mesh together: %s; give one of them itself: %s",
                           g->source->path, status_text(), vtk_parts_list(p, step, names));
}

/* ---- opening ---- */

/* A list may name lists of a lower kind alone: collections name blocks and pieces, blocks name
 * pieces. So no file can lead back to itself. */
static bool may_name(vtk_parts_kind by, vtk_parts_kind named) {
    return named != VTK_PARTS_NONE && named < by;
}

static status scan_parts(vtk_unstructured *g, const vtk_parts *in, const char *by, uint32_t step);

static status scan_nested(vtk_unstructured *g, const char *path, byte_stream *data) {
    vtk_parts nested;
    status st = vtk_parts_read(g->m, path, data, g->source->hints.trust.follow_links, &nested);
    if (st == ST_OK)
        st = scan_parts(g, &nested, path, 0);
    vtk_parts_release(&nested, g->m);
    return st;
}

/* Scan one of the files that `by` names for a step. */
static status scan_stream(vtk_unstructured *g, const vtk_parts *in, const char *by, uint32_t step,
                          const char *path, byte_stream *data) {
    const uint8_t *start;
    size_t size;
    char type[VTK_XML_TYPE_MAX];
    status st = vtk_array_check_file(path);
    if (st == ST_OK)
        st = byte_stream_peek(data, MESH_READER_PEEK, &start, &size);
    if (st != ST_OK)
        return st;
    vtk_xml_type(start, size, type);
    if (strcmp(type, "UnstructuredGrid") == 0)
        return mesh_vtu_scan(g, path, data);
    if (*type && may_name(in->kind, vtk_parts_find_kind(path, start, size)))
        return scan_nested(g, path, data);
    return refuse(in, by, step, path, type);
}

static status scan_part(vtk_unstructured *g, const vtk_parts *in, const char *by, uint32_t step,
                        size_t i) {
    const char *path;
    byte_stream *data = NULL;
    status st = vtk_unstructured_add_path(g, in->items[i].path, &path);
    if (st == ST_OK)
        st = byte_stream_open(g->m, path, &data);
    if (st == ST_OK)
        st = scan_stream(g, in, by, step, path, data);
    byte_stream_close(data);
    return st;
}

static status scan_parts(vtk_unstructured *g, const vtk_parts *in, const char *by, uint32_t step) {
    status st = ST_OK;
    for (size_t i = in->first[step]; st == ST_OK && i < in->first[step + 1]; i++)
        st = scan_part(g, in, by, step, i);
    return st;
}

static status scan_file(vtk_unstructured *g, byte_stream *data) {
    const mesh_source *s = g->source;
    status st = vtk_parts_read(g->m, s->path, data, s->hints.trust.follow_links, &g->parts);
    if (st == ST_OK)
        st = vtk_parts_check_step(&g->parts, s->path, s->hints.step);
    return st == ST_OK ? scan_parts(g, &g->parts, s->path, s->hints.step) : st;
}

/* ---- the reader ---- */

/* Lists of grids are left to the grids' reader. */
static bool known(const char *path, const uint8_t *start, size_t size) {
    return vtk_parts_find_kind(path, start, size) != VTK_PARTS_NONE &&
           !vtk_parts_are_grids(start, size);
}

static status open_file(mesh_source *source, void **state) {
    return vtk_unstructured_open(source, scan_file, state);
}

static status take_fields(void *state, const char *const *names, uint32_t count) {
    const vtk_unstructured *g = state;
    status st = vtk_unstructured_take(state, names, count);
    return st == ST_OK ? st : tell_parts(g, g->source->hints.step, st);
}

static uint32_t tell_steps(const void *state, const double **times) {
    const vtk_unstructured *g = state;
    const bool timed = g->parts.kind == VTK_PARTS_COLLECTION;
    *times = timed ? g->parts.times : NULL;
    return g->parts.steps;
}

static const char *tell_file(const void *state) {
    const vtk_unstructured *g = state;
    return g->parts.kind == VTK_PARTS_COLLECTION
               ? g->parts.items[g->parts.first[g->source->hints.step]].path
               : g->source->path;
}

const mesh_reader mesh_vtk_parts_reader = {
    .format = "VTK mesh in files",
    .known = known,
    .open = open_file,
    .read = vtk_unstructured_read,
    .close = vtk_unstructured_close,
    .take = take_fields,
    .fields = vtk_unstructured_fields,
    .steps = tell_steps,
    .file = tell_file,
};
