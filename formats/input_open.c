#include "formats/input_open.h"

status input_open(mem *m, const char *path, const volume_hints *of_grids,
                  const mesh_hints *of_meshes, input *out) {
    byte_stream *s = NULL;
    bool is_mesh = false;
    *out = (input){0};
    if (volume_is_folder(path))
        return volume_open(m, path, of_grids, &out->v);
    status st = byte_stream_open(m, path, &s);
    if (st == ST_OK)
        st = mesh_input_recognise(s, &is_mesh);
    if (st != ST_OK) {
        byte_stream_close(s);
        return st;
    }
    return is_mesh ? mesh_input_open_stream(m, s, of_meshes, &out->x)
                   : volume_open_stream(m, s, of_grids, &out->v);
}

void input_close(input *in) {
    mesh_input_close(in->x);
    volume_close(in->v);
}
