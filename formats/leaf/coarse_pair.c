#include "formats/leaf/coarse_pair.h"

#include <string.h>

#include "formats/base/file.h"

bool coarse_pair_has(const leaf_file *f, uint32_t set) {
    return leaf_layout_step(&f->layout, set) + 1 < f->layout.steps &&
           leaf_file_has_coarse(f, set) && leaf_file_has_coarse(f, set + 1);
}

static bool are_alike(const leaf_file *a, const leaf_file *b) {
    const leaf_header *g = &a->header, *h = &b->header;
    return a->layout.sets == 1 && b->layout.sets == 1 &&
           memcmp(g->dims, h->dims, sizeof g->dims) == 0 &&
           memcmp(g->to_world, h->to_world, sizeof g->to_world) == 0 &&
           g->cells_log2 == h->cells_log2 && g->halo == h->halo &&
           g->sample_type == h->sample_type && g->codec == h->codec && g->bare == h->bare &&
           !g->outside && !h->outside;
}

/* Returns an array with the bytes of one and of another behind them, in place of the first; or that
 * one, with *whole false. */
static void *append(mem *m, void *array, const void *more, size_t bytes, bool *whole) {
    char *both = mem_alloc(m, 2 * bytes);
    *whole = *whole && both;
    if (!both)
        return array;
    memcpy(both, array, bytes);
    memcpy(both + bytes, more, bytes);
    mem_free(m, array);
    return both;
}

/* The same of an element a payload: a set's treelets, the other's, then the shells of both
 * likewise.
 */
static uint64_t *append_payloads(const leaf_layout *l, mem *m, uint64_t *array,
                                 const uint64_t *more, bool *whole) {
    const size_t n = l->treelets, shells = l->shells;
    uint64_t *both = mem_array(m, l->payloads, sizeof *both);
    *whole = *whole && both;
    if (!both)
        return array;
    memcpy(both, array, n * sizeof *both);
    memcpy(both + n, more, n * sizeof *both);
    memcpy(both + 2 * n, array + n, shells * sizeof *both);
    memcpy(both + 2 * n + shells, more + n, shells * sizeof *both);
    mem_free(m, array);
    return both;
}

/* Let a file of one set have the set of another one, too; both count bytes from the same one on. */
static status join(leaf_file *to, const leaf_file *more) {
    leaf_layout *l = &to->layout;
    const size_t n = l->treelets;
    const double next = to->times[0] + 1;
    mem *m = to->m;
    bool whole = true;
    if (!leaf_layout_repeat(l, 1, 2, l->coded))
        return status_describe(ST_UNSUPPORTED, "%s: a coarse grid has too many treelets",
                               file_path(to->source));
    to->ranges = append(m, to->ranges, more->ranges, n * sizeof *to->ranges, &whole);
    to->own = append(m, to->own, more->own, n * sizeof *to->own, &whole);
    to->flags = append(m, to->flags, more->flags, n, &whole);
    to->times = append(m, to->times, &next, sizeof next, &whole);
    to->offsets = append_payloads(l, m, to->offsets, more->offsets, &whole);
    to->sizes = append_payloads(l, m, to->sizes, more->sizes, &whole);
    to->checksums = append_payloads(l, m, to->checksums, more->checksums, &whole);
    mem_free(m, to->histograms);
    mem_free(m, to->deviations);
    to->histograms = NULL;
    to->deviations = NULL;
    to->header.steps = 2;
    return whole ? ST_OK : ST_NOMEM;
}

/* Let a part of a file be that file: its bytes count from that one's start on. */
static status widen(leaf_file *part, const leaf_file *f, const leaf_part *where) {
    file *whole = NULL;
    const status st = file_open_part(part->m, f->source, 0, file_size(f->source), &whole);
    if (st != ST_OK)
        return st;
    file_close(part->source);
    part->source = whole;
    for (uint32_t p = 0; p < part->layout.payloads; p++)
        part->offsets[p] += where->offset;
    return ST_OK;
}

status coarse_pair_open(mem *m, const leaf_file *f, uint32_t set, leaf_file **out) {
    leaf_file *of[2] = {NULL, NULL};
    status st = ST_OK;
    for (uint32_t i = 0; i < 2 && st == ST_OK; i++)
        st = leaf_file_open_coarse(m, f, set + i, &of[i]);
    if (st == ST_OK && !are_alike(of[0], of[1]))
        st = status_describe(ST_CORRUPT, "%s: the coarse grids of sets %u and %u differ in kind",
                             file_path(f->source), set, set + 1);
    for (uint32_t i = 0; i < 2 && st == ST_OK; i++)
        st = widen(of[i], f, &f->coarse[set + i]);
    if (st == ST_OK)
        st = join(of[0], of[1]);
    leaf_file_close(of[1]);
    if (st != ST_OK) {
        leaf_file_close(of[0]);
        return st;
    }
    *out = of[0];
    return ST_OK;
}
