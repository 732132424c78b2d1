#include "prep/export/npy_head.h"

#include <stdio.h>
#include <string.h>

enum { HEAD_BYTES = 128, WORDS_AT = 10 };

const char *npy_head_loses(const grid *g) {
    bool plain = !grid_is_rectilinear(g);
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            plain = plain && g->to_world[row][column] == (row == column);
    return plain ? NULL : "a NumPy array does not tell where its samples lie; .nrrd does";
}

static const char *type_name(sample_type type) {
    switch (type) {
    case SAMPLE_U8: return "|u1";
    case SAMPLE_I8: return "|i1";
    case SAMPLE_U16: return "<u2";
    case SAMPLE_I16: return "<i2";
    default: return "<f4";
    }
}

status npy_head(mem *m, out_stream *out, const grid *g) {
    char head[HEAD_BYTES + 1];
    (void)m;
    memset(head, ' ', sizeof head);
    memcpy(head, "\x93NUMPY\1\0", 8);
    head[8] = HEAD_BYTES - WORDS_AT;
    head[9] = 0;
    const int words = snprintf(head + WORDS_AT, sizeof head - WORDS_AT,
                               "{'descr': '%s', 'fortran_order': False, 'shape': (%u, %u, %u), }",
                               type_name(g->type), g->dims[2], g->dims[1], g->dims[0]);
    head[WORDS_AT + words] = ' ';
    head[HEAD_BYTES - 1] = '\n';
    return out_stream_write(out, head, HEAD_BYTES);
}
