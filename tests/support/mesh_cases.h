/* mesh_cases.h - small meshes in memory for tests of the way to a treelet file, and the way itself.
 */
#ifndef TESTS_SUPPORT_MESH_CASES_H
#define TESTS_SUPPORT_MESH_CASES_H

#include <stddef.h>
#include <stdint.h>

#include "prep/mesh/mesh_convert.h"

typedef struct mesh_case {
    size_t point_count, tet_count;
    float (*points)[3];
    float *values;
    uint32_t (*tets)[4];
    mesh_options options; /* force; 1 GiB, 2 threads */
} mesh_case;

/* mesh_cases_kuhn() - n[0] x n[1] x n[2] cells of 6 tets each, a wavy field; mesh_cases_soup() -
 * tets of random vertices, of which some are NaN or inf, some tets flat, some points the same.
 * mesh_cases_shuffle() - renumber the points and mix the tets, their vertices too.
 * mesh_cases_free() gives back what these allocate. */
mesh_case mesh_cases_kuhn(uint32_t nx, uint32_t ny, uint32_t nz);
mesh_case mesh_cases_soup(size_t points, size_t tets, uint64_t seed);
void mesh_cases_shuffle(mesh_case *c, uint64_t seed);
void mesh_cases_free(mesh_case *c);

/* mesh_cases_convert() - c to the scratch file of this name, within the budget of its options, in
 * chunks of odd sizes; tets first where `tets_first`. */
status mesh_cases_convert(mem *m, const mesh_case *c, const char *name, int tets_first,
                          mesh_result *result);

#endif
