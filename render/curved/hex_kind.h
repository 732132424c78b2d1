/* hex_kind.h - members of the row of a kind (ray/kind.h) that are the same for all whose cells are
 * hexahedra with bent faces.
 */
#ifndef RENDER_CURVED_HEX_KIND_H
#define RENDER_CURVED_HEX_KIND_H

#include "render/curved/hex_tile.h"
#include "render/curved/hex_walk.h"
#include "render/ray/kind.h"
#include "render/walk/cell_walks.h"

/* hex_kind_tolerance() - what the cubic of a piece may be off, of a tracer of such a kind. */
double hex_kind_tolerance(const tracer *tr);

status hex_kind_open(leafcast *v);
void hex_kind_close(leafcast *v);
void hex_kind_aim(leafcast *v, const leafcast_scene *scene, const struct camera *c, tracer *tr);
segments_error hex_kind_error(const tracer *tr, const ray *r, const double range[2]);
status hex_kind_project(leafcast *v, const struct camera *c, struct projection *out);
size_t hex_kind_projection_bytes(const leaf_layout *layout);

/* The kind adds: name, cell, describe, inside, gradient, cell_in, tiles, and what it tells of
 * cells. */
#define HEX_KIND_ROW                                                           \
    .open = hex_kind_open, .close = hex_kind_close, .check = cell_walks_check, \
    .aim = hex_kind_aim, .walks = &tree_walks, .degree = 3, .segments_error = hex_kind_error

/* Of its kind_tiles, the kind adds kernels. */
#define HEX_KIND_TILES                                                          \
    .side = HEX_TILE, .scratch = HEX_TILE_SCRATCH, .project = hex_kind_project, \
    .projection_bytes = hex_kind_projection_bytes

#endif
