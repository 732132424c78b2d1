#include "render/kernels.h"

#include <string.h>

/* The same pictures, slower: other walks below blocks (E1); smaller packets, and no ray-cells of
 * several cells together (E4), with the best ISA there is. */
static const struct {
    const char *name;
    walk_fn walk; /* NULL: tiles */
    uint8_t packet;
    bool by_cell;
} alternatives[] = {{"scalar-groups", walk_treelet_groups, 0, false},
                    {"scalar-corners", walk_treelet_corners, 0, false},
                    {"packets-4x4", NULL, 4, false},
                    {"packets-8x8", NULL, 8, false},
                    {"packets-16x16", NULL, 16, false},
                    {"packets-4x4-by-cell", NULL, 4, true},
                    {"tiles-by-cell", NULL, GRID_TILE, true}};

static kernels kernels_of(cpu_isa isa) {
    return (kernels){.name = cpu_isa_name(isa),
                     .isa = isa,
                     .grid_walk = walk_treelet,
                     .cells = cell_batch_for(isa),
                     .roots = cell_roots_for(isa),
                     .grid_tile = grid_tile_for(isa),
                     .grid_batch = grid_batch_for(isa),
                     .grid_pieces = grid_pieces_for(isa),
                     .grid_peaks = grid_peaks_for(isa),
                     .mesh_tile = mesh_tile_for(isa),
                     .mesh_packet = mesh_packet_for(isa),
                     .tets = tet_batch_for(isa),
                     .mesh_batch = mesh_batch_for(isa),
                     .medium = medium_batch_for(isa),
                     .stepping = stepping_batch_for(isa),
                     .packet = GRID_TILE};
}

bool kernels_for(const char *name, kernels *out) {
    cpu_isa isa;
    for (size_t i = 0; name && i < sizeof alternatives / sizeof *alternatives; i++) {
        if (strcmp(name, alternatives[i].name) != 0)
            continue;
        *out = kernels_of(alternatives[i].walk ? CPU_SCALAR : cpu_best());
        out->name = alternatives[i].name;
        out->packet = alternatives[i].packet;
        out->by_cell = alternatives[i].by_cell;
        if (alternatives[i].walk)
            out->grid_walk = alternatives[i].walk;
        return alternatives[i].walk || out->grid_tile;
    }
    if (!cpu_isa_find(name, &isa))
        return false;
    *out = kernels_of(isa);
    return true;
}
