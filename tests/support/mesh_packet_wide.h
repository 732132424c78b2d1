/* mesh_packet_wide.h - packets through meshes as AVX-512 traces them, on any CPU. */
#ifndef TESTS_SUPPORT_MESH_PACKET_WIDE_H
#define TESTS_SUPPORT_MESH_PACKET_WIDE_H

#include "render/experiments/mesh_packet.h"

/* mesh_packet_wide() - as every tile_fn. */
void mesh_packet_wide(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                      tile_outcome *out, ray_counters *counters);

#endif
