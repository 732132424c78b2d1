#include "formats/grid/vtk_grid_parts.h"

#include "formats/grid/volume.h"
#include "formats/grid/vtk_grid_xml.h"
#include "formats/vtk/vtk_array.h"
#include "formats/vtk/vtk_parts.h"

static bool known(const char *path, const uint8_t *start, size_t size) {
    return vtk_parts_find_kind(path, start, size) != VTK_PARTS_NONE &&
           vtk_parts_are_grids(start, size);
}

/* Put the step's file in the place of l's. */
static status open_part(volume_layout *l, const vtk_parts *p, uint32_t step) {
    char names[VTK_PARTS_TEXT];
    const uint8_t *start;
    size_t size;
    const char *by = l->path, *path = p->items[p->first[step]].path;
    if (p->first[step + 1] - p->first[step] > 1)
        return status_describe(ST_UNSUPPORTED, "%s: several grids %s: give one of them itself: %s",
                               by, p->kind == VTK_PARTS_BLOCKS ? "as blocks" : "at one time",
                               vtk_parts_list(p, step, names));
    byte_stream *data;
    status st = byte_stream_open(l->m, path, &data);
    if (st != ST_OK)
        return st;
    byte_stream_close(l->data);
    l->data = data;
    st = byte_stream_peek(data, GRID_READER_PEEK, &start, &size);
    if (st == ST_OK && !vtk_grid_xml_reader.known(byte_stream_kind(data), start, size))
        return status_describe(ST_UNSUPPORTED,
                               "%s: names %s, expected a grid of VTK (.vti, .vtr, .vts, .pvti, "
                               ".pvtr, .pvts)",
                               by, path);
    char *copy = st == ST_OK ? mem_copy_text(l->m, path) : NULL;
    if (!copy)
        return st == ST_OK ? ST_NOMEM : st;
    mem_free(l->m, l->path);
    l->path = copy;
    return ST_OK;
}

static status open_slices(volume_layout *l, const volume_hints *hints, slice_source *out) {
    vtk_parts parts = {0};
    status st = vtk_array_check_file(l->path);
    if (st == ST_OK)
        st = vtk_parts_read(l->m, l->path, l->data, hints->trust.follow_links, &parts);
    if (st == ST_OK)
        st = vtk_parts_check_step(&parts, l->path, hints->step);
    if (st == ST_OK)
        st = open_part(l, &parts, hints->step);
    const bool collection = parts.kind == VTK_PARTS_COLLECTION;
    if (st == ST_OK)
        st = vtk_grid_xml_open(l, hints, &parts, out);
    vtk_parts_release(&parts, l->m);
    if (st == ST_OK && collection)
        out->format = VOLUME_COLLECTION;
    return st;
}

const grid_reader vtk_grid_parts_reader = {
    .format = VOLUME_COLLECTION, .known = known, .slices = open_slices};
