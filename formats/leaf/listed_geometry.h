/* listed_geometry.h - members of the row of a kind (leaf_geometry.h) whose treelets list their
 * cells as rows of nodes: mixed meshes, triangles.
 *
 * Blocks of payloads are those of a mesh without gradients (leaf.h): topologies, values of each
 * set, positions of each later step. BOUNDS and COUNTS are sections as of a mesh. Of the header:
 * tets: cells; vertices: nodes of the whole mesh, each once; treelet_tets: cells in a treelet at
 * most. leaf_geometry.noded says what a treelet can have.
 */
#ifndef FORMATS_LEAF_LISTED_GEOMETRY_H
#define FORMATS_LEAF_LISTED_GEOMETRY_H

#include "formats/leaf/leaf_cells.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_layout.h"

status listed_check_parameters(const char *path, const leaf_header *h);
uint64_t listed_payloads(const leaf_header *h);
status listed_check_values(const char *path, const leaf_header *h);
status listed_check_rest(const char *path, const leaf_header *h);
status listed_check_layout(const char *path, const leaf_header *h, leaf_layout *l);
uint64_t listed_section_bytes(const leaf_header *h, uint32_t kind);
status listed_lay_out(leaf_file *f, leaf_directory *d);
status listed_check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                              const leaf_directory *d);
const char *listed_payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]);
int listed_parts(const leaf_layout *l, uint32_t set, uint32_t treelet,
                 uint32_t payloads[LEAF_PARTS_MAX]);
extern const leaf_growth listed_growth;

/* The kind adds: noded, coder, verifier, and coarse if it may have coarse grids. hex_blending
 * serves kinds without hexahedra, too: their places have no codes to be made anew. */
#define LISTED_GEOMETRY                                                                            \
    .blending = &hex_blending, .growth = &listed_growth,                                           \
    .check_parameters = listed_check_parameters, .check_values = listed_check_values,              \
    .check_rest = listed_check_rest, .check_layout = listed_check_layout, .sets = leaf_cells_sets, \
    .payloads = listed_payloads, .labels = leaf_cells_labels,                                      \
    .section_bytes = listed_section_bytes, .allocate = leaf_cells_allocate,                        \
    .section = leaf_cells_section, .release = leaf_cells_release, .lay_out = listed_lay_out,       \
    .check_directory = listed_check_directory, .payload_bytes = hex_treelet_payload_bytes,         \
    .begins_run = leaf_cells_begins_run, .series = leaf_layout_block_series,                       \
    .payload_name = listed_payload_name, .parts = listed_parts

#endif
