#include "formats/leaf/curvilinear_facts.h"

#include "formats/leaf/curvilinear_geometry.h"

enum { ZONES_TOLD = 8 };

static uint64_t nodes_of(const uint32_t zone[4]) {
    return (uint64_t)zone[0] * zone[1] * zone[2];
}

/* Bytes before compression: positions and values of the nodes. */
static double raw_bytes(const leaf_file *f, uint64_t nodes) {
    return (double)nodes * (12 * (double)f->layout.places + 4 * (double)f->layout.sets);
}

static void tell_zones(const leaf_file *f, const fact_sheet *to, uint64_t cells, uint64_t nodes) {
    const curvilinear_directory *d = curvilinear_directory_of(f);
    const uint32_t zones = f->header.zones;
    fact_sheet_line(to, "curvilinear", "%llu cells, %llu nodes, %u zones",
                    (unsigned long long)cells, (unsigned long long)nodes, zones);
    for (uint32_t z = 0; z < zones && z < ZONES_TOLD; z++)
        fact_sheet_line(to, z ? "" : "zones", "%u x %u x %u nodes", d->zones[z][0], d->zones[z][1],
                        d->zones[z][2]);
    if (zones > ZONES_TOLD)
        fact_sheet_line(to, "", "and %u more", zones - ZONES_TOLD);
    fact_sheet_whole(to, "cells", cells);
    fact_sheet_whole(to, "nodes", nodes);
    if (!to->values)
        return;
    json_t *list = json_array();
    for (uint32_t z = 0; z < zones; z++)
        json_array_append_new(list,
                              json_pack("[I, I, I]", (json_int_t)d->zones[z][0],
                                        (json_int_t)d->zones[z][1], (json_int_t)d->zones[z][2]));
    fact_sheet_json(to, "zones", list);
}

static void tell(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    const curvilinear_directory *d = curvilinear_directory_of(f);
    const uint64_t cells = d->first[f->layout.treelets];
    uint64_t nodes = 0;
    for (uint32_t z = 0; z < h->zones; z++)
        nodes += nodes_of(d->zones[z]);
    const double raw = raw_bytes(f, nodes), each = (double)h->file_bytes / (double)cells;
    leaf_tell_begin(f, to);
    tell_zones(f, to, cells, nodes);
    leaf_tell_print_fields(f, to);
    leaf_tell_values(f, to, "values", 1);
    leaf_tell_print_steps(f, to);
    leaf_tell_coarse(f, to);
    leaf_tell_bounds(f, to);
    fact_sheet_line(to, "treelets", "%llu of up to %d^3 cells, runs at %u, %s",
                    (unsigned long long)h->treelets, CURVILINEAR_SIDE, 1U << h->run_align_log2,
                    leaf_tell_codec(f));
    fact_sheet_line(to, "file", "%llu bytes, %.2f a cell, %.3f of the nodes",
                    (unsigned long long)h->file_bytes, each, (double)h->file_bytes / raw);
    leaf_tell_bytes(f, to, raw);
    fact_sheet_real(to, "bytes_per_cell", each);
    fact_sheet_flag(to, "moving", h->moving);
    leaf_tell_set_fields(f, to);
}

const leaf_teller curvilinear_facts = {
    .name = "curvilinear grid", .cells = "cells", .drawn = "cells", .tell = tell};
