#include "formats/surface/surface_readers.h"

#include "formats/surface/surface_gltf.h"
#include "formats/surface/surface_obj.h"
#include "formats/surface/surface_off.h"
#include "formats/surface/surface_ply.h"
#include "formats/surface/surface_stl.h"
#include "formats/surface/surface_vtk.h"
#include "formats/surface/surface_vtp.h"

static const mesh_reader *const items[] = {
    &surface_ply_reader, &surface_stl_reader, &surface_off_reader,  &surface_vtk_reader,
    &surface_vtp_reader, &surface_glb_reader, &surface_gltf_reader, &surface_obj_reader};

const mesh_readers surface_readers = {
    items, sizeof items / sizeof *items,
    "expected a surface: PLY, STL, OBJ, OFF, VTK (.vtp, .vtk) or glTF (.glb, .gltf)"};

status surface_input_open(mem *m, const char *path, const mesh_hints *hints, mesh_input **out) {
    byte_stream *s;
    status st = byte_stream_open(m, path, &s);
    return st == ST_OK ? mesh_input_open_by(m, &surface_readers, s, hints, out) : st;
}
