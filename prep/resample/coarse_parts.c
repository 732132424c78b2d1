#include "prep/resample/coarse_parts.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/file_guard.h"

void coarse_parts_remove(const char *path) {
    file_guard_forget(path);
    (void)unlink(path);
}

static status embed_sets(mem *m, leaf_writer *w, const char *path, const coarse_maker *maker,
                         const progress *p) {
    leaf_file *f = NULL;
    status st = leaf_file_open(m, leaf_writer_path(w), &f);
    for (uint32_t set = 0; st == ST_OK && set < f->layout.sets; set++) {
        const double sets = f->layout.sets;
        progress_part part = {p, set / sets, (set + 1) / sets};
        const progress of_set = progress_of_part(&part);
        bool made = true;
        st = maker->make(maker->ctx, m, f, set, path, &of_set, &made);
        if (st == ST_OK && made)
            st = leaf_writer_embed(w, set, path);
        coarse_parts_remove(path);
    }
    leaf_file_close(f);
    return st;
}

status coarse_parts_embed(mem *m, leaf_writer *w, const char *output, const coarse_maker *maker,
                          const progress *p) {
    const size_t size = strlen(output) + COARSE_PARTS_SUFFIX;
    char *path = mem_alloc(m, size);
    if (!path)
        return ST_NOMEM;
    snprintf(path, size, "%s.coarse-%ld.leaf", output, (long)getpid());
    const status st = embed_sets(m, w, path, maker, p);
    mem_free(m, path);
    return st;
}
