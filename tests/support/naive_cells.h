/* naive_cells.h - a second decoder of coded payloads of curvilinear grids, of mixed meshes and of
 * surfaces, written from formats/CURVILINEAR.md, formats/MIXED.md and formats/TRIANGLES.md alone:
 * slow and plain.
 */
#ifndef TESTS_SUPPORT_NAIVE_CELLS_H
#define TESTS_SUPPORT_NAIVE_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* naive_cells_curvilinear() - places: or values. counts: cells along i, j, k.
 * naive_cells_mixed() - block: 0 topology, 1 values, 3 positions at a step. counts: cells, nodes.
 * naive_cells_triangles() - the same of a surface. counts: triangles, vertices, normals.
 *
 * in: the streams. payload: out, all of it, zeros before. Return false if the bytes break a rule.
 */
bool naive_cells_curvilinear(bool places, const uint32_t counts[4], const unsigned char *in,
                             size_t bytes, unsigned char *payload, size_t payload_bytes);
bool naive_cells_mixed(int block, const uint32_t counts[4], const unsigned char *in, size_t bytes,
                       unsigned char *payload, size_t payload_bytes);
bool naive_cells_triangles(int block, const uint32_t counts[4], const unsigned char *in,
                           size_t bytes, unsigned char *payload, size_t payload_bytes);

#endif
