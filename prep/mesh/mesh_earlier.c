#include "prep/mesh/mesh_earlier.h"

#include <string.h>

#include "formats/mesh/mesh_leaf.h"
#include "prep/further_step.h"

#define OTHERWISE "its points lie elsewhere, or its tets join others"

status mesh_earlier_init(mesh_earlier *e, mem *m, leaf_file *f) {
    *e = (mesh_earlier){
        .m = m, .f = f, .topology = mem_alloc(m, leaf_layout_payload_max(&f->layout))};
    return e->topology ? leaf_unpacker_create(m, f, &e->unpacker) : ST_NOMEM;
}

void mesh_earlier_release(mesh_earlier *e) {
    leaf_unpacker_destroy(e->unpacker);
    if (e->topology)
        mem_free(e->m, e->topology);
}

uint64_t mesh_earlier_memory(const leaf_file *f) {
    return leaf_layout_payload_max(&f->layout) + leaf_unpacker_memory(f) + 256;
}

status mesh_earlier_check(const leaf_file *f, const char *input, const mesh_counts *own) {
    const leaf_header *h = &f->header;
    const struct {
        uint64_t found, expected;
        const char *what, *why;
    } counts[] = {{own->tets, h->tets, f->mesh ? "tets" : "cells", ""},
                  {own->vertices, h->vertices, f->mesh ? "vertices of tets" : "nodes of cells", ""},
                  {own->treelets, h->treelets, "treelets", ": " OTHERWISE}};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        if (counts[i].found != counts[i].expected)
            return further_step_refuse(f, input, "it has %llu %s, expected %llu%s",
                                       (unsigned long long)counts[i].found, counts[i].what,
                                       (unsigned long long)counts[i].expected, counts[i].why);
    return ST_OK;
}

/* Say how the topology of treelet t differs, which has as many tets and vertices. */
static status refuse_topology(const mesh_earlier *e, const char *input, uint32_t t,
                              const mesh_earlier_built *built) {
    if (!built->by)
        return further_step_refuse(e->f, input, "treelet %u comes out otherwise: " OTHERWISE "%s",
                                   t,
                                   e->f->header.kind == LEAF_KIND_TRIANGLES
                                       ? ", or --normals is not what the file was made with"
                                       : "");
    const mesh_shape s = mesh_leaf_shape(built->counts);
    const mesh_shape before = mesh_leaf_shape(e->f->mesh->counts[t]);
    const float(*own)[3] = mesh_leaf_positions(&s, built->topology);
    const float(*its)[3] = mesh_leaf_positions(&before, e->topology);
    for (uint32_t i = 0; i < s.vertices; i++)
        if (memcmp(own[i], its[i], sizeof own[i]) != 0)
            return further_step_refuse(
                e->f, input, "point %u lies at %g, %g, %g, expected %g, %g, %g: " OTHERWISE,
                mesh_treelet_point(built->by, i), (double)own[i][0], (double)own[i][1],
                (double)own[i][2], (double)its[i][0], (double)its[i][1], (double)its[i][2]);
    return further_step_refuse(e->f, input,
                               "treelet %u comes out otherwise: its tets join other points, or "
                               "--build is not what the file was made with",
                               t);
}

status mesh_earlier_compare(mesh_earlier *e, const char *input, uint32_t t,
                            const mesh_earlier_built *built) {
    const leaf_layout *l = &e->f->layout;
    const uint32_t *own = built->counts, *its = l->counts[t];
    if (own[0] != its[0] || own[1] != its[1])
        return further_step_refuse(e->f, input,
                                   "treelet %u has %u %s and %u vertices, expected %u and "
                                   "%u: " OTHERWISE,
                                   t, own[0], built->by ? "tets" : "cells", own[1], its[0], its[1]);
    const status st = leaf_file_load(e->f, t, e->unpacker, e->topology);
    if (st != ST_OK)
        return st;
    return memcmp(own, its, sizeof *l->counts) == 0 &&
                   memcmp(built->topology, e->topology, leaf_layout_payload_bytes(l, t)) == 0
               ? ST_OK
               : refuse_topology(e, input, t, built);
}
