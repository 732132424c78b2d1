#include "prep/export/export_pieces.h"

#include "formats/base/file.h"
#include "prep/export/piece_export.h"

enum { PIECE_BYTES = 1 << 20 };

int export_pieces_threads(const export_request *a, const mem *m, uint64_t each) {
    int threads = a->common.threads;
    while (m->limit && threads > 1 &&
           2 * (uint64_t)threads * (each + PIECE_BYTES) > m->limit - mem_used(m))
        threads--;
    return threads;
}

status export_pieces_write(export_request *a, mem *m, const piece_source *source, int threads,
                           piece_info *info) {
    char *beside = NULL;
    status st = out_file_scratch_path(m, a->common.output, "leafcast-export", &beside);
    const piece_export e = {.source = source,
                            .format = a->pieces,
                            .path = a->common.output,
                            .beside = beside,
                            .force = a->common.force,
                            .threads = threads,
                            .p = cli_progress(&a->common)};
    info->floats |= a->floats || a->pieces->loose;
    if (st == ST_OK)
        st = piece_export_run(m, &e, info);
    mem_free(m, beside);
    return st;
}
