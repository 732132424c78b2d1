#include "prep/convert_input.h"

leaf_parameters convert_parameters_default(void) {
    leaf_parameters p = leaf_parameters_default();
    p.histograms = true;
    return p;
}

status convert_input_open(mem *m, const char *path, const volume_hints *of_grids,
                          const mesh_hints *of_meshes, convert_input *out) {
    byte_stream *s = NULL;
    bool is_mesh = false;
    *out = (convert_input){0};
    status st = byte_stream_open(m, path, &s);
    if (st == ST_OK)
        st = mesh_input_recognise_stream(s, &is_mesh);
    if (st != ST_OK) {
        byte_stream_close(s);
        return st;
    }
    return is_mesh ? mesh_input_open_stream(m, s, of_meshes, &out->x)
                   : volume_open_stream(m, s, of_grids, &out->v);
}

void convert_input_close(convert_input *in) {
    mesh_input_close(in->x);
    volume_close(in->v);
}
