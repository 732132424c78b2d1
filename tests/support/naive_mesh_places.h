/* naive_mesh_places.h - how large the payloads of a mesh are, where they lie, and which have
 * another's bytes, from sections 6 of formats/FORMAT.md and 2 and 4 of formats/SERIES.md alone. */
#ifndef TESTS_SUPPORT_NAIVE_MESH_PLACES_H
#define TESTS_SUPPORT_NAIVE_MESH_PLACES_H

#include "tests/support/naive_mesh.h"

/* naive_mesh_payloads() - how many there are. naive_mesh_gradients(), naive_mesh_positions() - the
 * first one of a set, of a step from 1 on. naive_mesh_payload_bytes() - bytes of payload p. */
long naive_mesh_payloads(const naive_mesh *mesh);
long naive_mesh_gradients(const naive_mesh *mesh, long set);
long naive_mesh_positions(const naive_mesh *mesh, long step);
uint64_t naive_mesh_payload_bytes(const naive_mesh *mesh, long p);

/* naive_mesh_parts() - where a topology's leaf_first, tets, positions lie, and its end.
 * naive_mesh_values_at(), naive_mesh_moved_at() - where values lie in their payload, and positions
 * of a later step. */
void naive_mesh_parts(const naive_part *t, uint64_t at[4]);
uint64_t naive_mesh_values_at(const naive_part *t);
uint64_t naive_mesh_moved_at(const naive_part *t);

/* naive_mesh_place() - check that payloads fill the file, and coarse grids. False: mesh->why.
 * naive_mesh_stored() - payload p's bytes as they are stored, once all is checked. */
bool naive_mesh_place(naive_mesh *mesh);
const unsigned char *naive_mesh_stored(const naive_mesh *mesh, long p, uint64_t *size);

#endif
