#include "prep/convert_append.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_grow.h"
#include "prep/further_step.h"

/* ---- how the file is made ---- */

static status other(const convert_request *a, const char *option, const char *what) {
    return status_describe(ST_USAGE, "%s has %s: --%s asks for something else", a->common.output,
                           what, option);
}

/* Take the parameters of the file; those that are given must be these. Those of other kinds of
 * inputs are left alone: options for them are refused by what they are given with. */
static status take_parameters(convert_request *a, const leaf_file *f) {
    const leaf_header *h = &f->header;
    leaf_parameters *p = &a->file;
    char cells[64], tets[64], leaf_tets[64];
    snprintf(cells, sizeof cells, "treelets of %u cells", 1u << h->cells_log2);
    snprintf(tets, sizeof tets, "treelets of %u tets", h->treelet_tets);
    snprintf(leaf_tets, sizeof leaf_tets, "leaves of %u tets", h->leaf_tets);
    const uint32_t bare = p->bare, gradients = a->gradients;
    const struct {
        bool given;
        uint32_t own, its;
        const char *option, *what;
    } rows[] = {
        {a->treelet_is_given && h->cells_log2, p->cells_log2, h->cells_log2, "treelet", cells},
        {a->halo_is_given && h->cells_log2, p->halo, h->halo, "halo",
         h->halo ? "a halo" : "no halo"},
        {a->levels_are_given, bare, h->bare, "levels",
         h->bare ? "no coarse levels" : "coarse levels"},
        {a->treelet_tets_is_given && h->treelet_tets, a->treelet_tets, h->treelet_tets,
         "treelet-tets", tets},
        {a->leaf_tets_is_given && h->leaf_tets, a->leaf_tets, h->leaf_tets, "leaf-tets", leaf_tets},
        {a->gradients && h->treelet_tets, gradients, h->gradients, "gradients", "no gradients"},
        {a->whole && h->leaf_tets, true, false, "whole-cells", "tets"},
        {a->codec_is_given, p->codec, h->codec, "compress",
         h->codec ? "compressed samples" : "samples as they are"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].given && rows[i].own != rows[i].its)
            return other(a, rows[i].option, rows[i].what);
    p->cells_log2 = h->cells_log2;
    p->halo = h->halo;
    p->bare = h->bare;
    a->treelet_tets = h->treelet_tets;
    a->leaf_tets = h->leaf_tets;
    a->gradients = h->gradients;
    const leaf_noded *noded = leaf_geometry_of(h->kind)->noded;
    a->whole |= h->treelet_tets && noded && noded->hexahedra;
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
    struct stat info;
    if (lstat(a->common.output, &info) != 0)
        return ST_OK;
    if (access(a->common.output, F_OK) != 0)
        return status_describe(ST_EXISTS,
                               "%s: a symbolic link that leads nowhere: no file to add to",
                               a->common.output);
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

size_t convert_append_memory(const convert_request *a, const mem *m) {
    return a->grow_bytes < m->limit ? a->grow_bytes : m->limit - 1;
}

status convert_append_check(const convert_request *a, leaf_sets *sets) {
    if (!a->grow)
        return ST_OK;
    const bool timed = sets->times != NULL;
    const status st = further_step_check(leaf_grow_before(a->grow), a->common.input, sets);
    if (st == ST_OK && timed && !sets->times)
        cli_note(&a->common, 1, "%s: its steps are numbered: times are left out", a->common.output);
    return st;
}

uint64_t convert_append_bytes(const convert_request *a, uint64_t added) {
    return added + (a->grow ? leaf_grow_before(a->grow)->header.file_bytes : 0);
}

void convert_append_note(const convert_request *a, const leaf_sets *sets) {
    if (a->append)
        cli_note(&a->common, 1, "%s: %u step%s added, %u now", a->common.output, sets->steps,
                 sets->steps > 1 ? "s" : "",
                 sets->steps + (a->grow ? leaf_grow_before(a->grow)->header.steps : 0));
}
