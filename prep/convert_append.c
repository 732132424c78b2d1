#include "prep/convert_append.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/leaf/leaf_grow.h"

/* ---- how the file is made ---- */

static status other(const convert_request *a, const char *option, const char *what) {
    return status_describe(ST_USAGE, "%s has %s: --%s asks for something else", a->common.output,
                           what, option);
}

/* Take the parameters of the file; those that are given must be these. */
static status take_parameters(convert_request *a, const leaf_file *f) {
    const leaf_header *h = &f->header;
    leaf_parameters *p = &a->file;
    char what[64];
    snprintf(what, sizeof what, "treelets of %u cells", 1u << h->cells_log2);
    if (p->cells_log2 != h->cells_log2 && a->treelet_is_given)
        return other(a, "treelet", what);
    if (p->halo != h->halo && a->halo_is_given)
        return other(a, "halo", h->halo ? "a halo" : "no halo");
    if (p->bare != h->bare && a->levels_are_given)
        return other(a, "levels", h->bare ? "no coarse levels" : "coarse levels");
    if (p->codec != h->codec && a->codec_is_given)
        return other(a, "compress", h->codec ? "compressed samples" : "samples as they are");
    p->cells_log2 = h->cells_log2;
    p->halo = h->halo;
    p->bare = h->bare;
    p->histograms = f->histograms != NULL;
    p->deviations = f->deviations != NULL;
    if (p->codec != h->codec && h->codec == LEAF_CODEC_ZSTD)
        leaf_parameters_compress(p, 1);
    p->codec = h->codec;
    p->run_align_log2 = h->run_align_log2;
    return ST_OK;
}

status convert_append_open(convert_request *a, mem *m) {
    const size_t used = m->used;
    if (access(a->common.output, F_OK) != 0)
        return ST_OK;
    status st = leaf_grow_open(m, a->common.output, &a->grow);
    if (st == ST_OK)
        st = take_parameters(a, leaf_grow_before(a->grow));
    a->grow_bytes = m->used - used;
    return st;
}

void convert_append_close(convert_request *a) {
    leaf_grow_close(a->grow);
    a->grow = NULL;
}

void convert_append_note(const convert_request *a, const leaf_sets *sets) {
    if (a->append)
        cli_note(&a->common, 1, "%s: %u step%s added, %u now", a->common.output, sets->steps,
                 sets->steps > 1 ? "s" : "",
                 sets->steps + (a->grow ? leaf_grow_before(a->grow)->header.steps : 0));
}
