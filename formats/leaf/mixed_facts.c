#include "formats/leaf/mixed_facts.h"

#include "formats/base/quadratic_tet.h"
#include "formats/leaf/mixed_geometry.h"

static uint64_t count_quadratic(const leaf_file *f) {
    const leaf_cells_directory *d = mixed_directory_of(f);
    uint64_t sum = 0;
    for (uint32_t t = 0; t < f->layout.treelets; t++)
        sum += d->counts[t][2];
    return sum;
}

/* Bytes before compression: positions and values of the nodes, nodes of the cells. */
static double raw_bytes(const leaf_file *f) {
    const leaf_header *h = &f->header;
    return (double)h->vertices * (12 * (double)f->layout.places + 4 * (double)f->layout.sets) +
           4 * (HEX_CORNERS * (double)h->tets +
                (QUADRATIC_NODES - HEX_CORNERS) * (double)count_quadratic(f));
}

static void tell_cells(const leaf_header *h, uint64_t quadratic, const fact_sheet *to) {
    fact_sheet_line(to, "mixed mesh", "%llu cells, %llu nodes", (unsigned long long)h->tets,
                    (unsigned long long)h->vertices);
    if (quadratic)
        fact_sheet_line(to, "quadratic tets", "%llu of the cells", (unsigned long long)quadratic);
    if (h->flat)
        fact_sheet_line(to, "cells", "%llu folded", (unsigned long long)h->flat);
    if (h->repeated || h->bad)
        fact_sheet_line(to, "left out",
                        "%llu cells of less than four nodes, %llu with one that is none",
                        (unsigned long long)h->repeated, (unsigned long long)h->bad);
    fact_sheet_whole(to, "cells", h->tets);
    fact_sheet_whole(to, "nodes", h->vertices);
    fact_sheet_whole(to, "quadratic", quadratic);
    fact_sheet_whole(to, "folded", h->flat);
    fact_sheet_whole(to, "repeated", h->repeated);
    fact_sheet_whole(to, "bad", h->bad);
}

static void tell(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    const double raw = raw_bytes(f), each = (double)h->file_bytes / (double)h->tets;
    leaf_tell_begin(f, to);
    tell_cells(h, count_quadratic(f), to);
    leaf_tell_print_fields(f, to);
    leaf_tell_values(f, to, "values", 1);
    leaf_tell_print_steps(f, to);
    leaf_tell_coarse(f, to);
    leaf_tell_bounds(f, to);
    fact_sheet_line(to, "treelets", "%llu of up to %u cells, runs at %u, %s",
                    (unsigned long long)h->treelets, h->treelet_tets, 1U << h->run_align_log2,
                    leaf_tell_codec(f));
    fact_sheet_line(to, "file", "%llu bytes, %.2f a cell, %.3f of the mesh",
                    (unsigned long long)h->file_bytes, each, (double)h->file_bytes / raw);
    leaf_tell_bytes(f, to, raw);
    fact_sheet_real(to, "bytes_per_cell", each);
    fact_sheet_flag(to, "moving", h->moving);
    leaf_tell_set_fields(f, to);
}

const leaf_teller mixed_facts = {
    .name = "mixed mesh", .cells = "cells", .drawn = "cells", .tell = tell};
