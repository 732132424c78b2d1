#include "formats/leaf/coarse_pair.h"

#include <string.h>

#include "formats/base/file.h"

bool coarse_pair_has(const leaf_file *f, uint32_t set) {
    return leaf_file_has_coarse(f, set) && leaf_file_has_coarse(f, set + 1);
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

/* Let *array have what another one has behind its own bytes. */
static bool append(mem *m, void **array, const void *more, size_t bytes) {
    char *both = mem_alloc(m, 2 * bytes);
    if (!both)
        return false;
    memcpy(both, *array, bytes);
    memcpy(both + bytes, more, bytes);
    mem_free(m, *array);
    *array = both;
    return true;
}

/* The payloads of both: a set's treelets, the other's, then the shells of both likewise. */
static void take_payloads(leaf_file *to, const uint64_t *a, const uint64_t *b, uint64_t *both) {
    const leaf_layout *l = &to->layout;
    const size_t n = l->treelets, shells = l->shells;
    memcpy(both, a, n * sizeof *both);
    memcpy(both + n, b, n * sizeof *both);
    memcpy(both + 2 * n, a + n, shells * sizeof *both);
    memcpy(both + 2 * n + shells, b + n, shells * sizeof *both);
}

static bool join_payloads(leaf_file *to, uint64_t **array, const uint64_t *more) {
    uint64_t *both = mem_array(to->m, to->layout.payloads, sizeof *both);
    if (!both)
        return false;
    take_payloads(to, *array, more, both);
    mem_free(to->m, *array);
    *array = both;
    return true;
}

static void move_offsets(leaf_file *f, uint64_t by) {
    for (uint32_t p = 0; p < f->layout.payloads; p++)
        f->offsets[p] += by;
}

/* Let a file of one set have the set of another one, too; both count bytes from the same one on. */
static status join(leaf_file *to, const leaf_file *more) {
    const size_t n = to->layout.treelets;
    static const double times[2] = {0, 1};
    mem *m = to->m;
    if (!leaf_layout_repeat(&to->layout, 1, 2, to->layout.shells > 0))
        return status_describe(ST_UNSUPPORTED, "%s: a coarse grid has too many treelets",
                               file_path(to->source));
    const bool whole = append(m, (void **)&to->ranges, more->ranges, n * sizeof *to->ranges) &&
                       append(m, (void **)&to->own, more->own, n * sizeof *to->own) &&
                       append(m, (void **)&to->flags, more->flags, n) &&
                       append(m, (void **)&to->times, times, sizeof *times) &&
                       join_payloads(to, &to->offsets, more->offsets) &&
                       join_payloads(to, &to->sizes, more->sizes) &&
                       join_payloads(to, &to->checksums, more->checksums);
    if (!whole)
        return ST_NOMEM;
    memcpy(to->times, times, sizeof times);
    mem_free(m, to->histograms);
    mem_free(m, to->deviations);
    to->histograms = NULL;
    to->deviations = NULL;
    to->header.steps = 2;
    return ST_OK;
}

/* Let a part of a file be that file: its bytes count from that one's start on. */
static status widen(leaf_file *part, const leaf_file *f, const leaf_part *where) {
    file *whole = NULL;
    const status st = file_open_part(part->m, f->source, 0, file_size(f->source), &whole);
    if (st != ST_OK)
        return st;
    file_close(part->source);
    part->source = whole;
    move_offsets(part, where->offset);
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
        st = widen(of[i], f, &f->mesh->coarse[set + i]);
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
