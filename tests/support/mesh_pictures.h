/* mesh_pictures.h - what the tests of tiles and of packets through meshes have in common: meshes of
 * the lab, drawn by all kernels that the test opens. Trouble fails the running test.
 */
#ifndef TESTS_SUPPORT_MESH_PICTURES_H
#define TESTS_SUPPORT_MESH_PICTURES_H

#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"

/* Opens a file with single rays first, then with what is on trial. */
typedef picture_volumes (*mesh_opener)(const char *path, int threads);

/* mesh_pictures_of_all() - every mesh of the lab, `cubes` on a side, every so many views. Returns
 * the pixels with a surface. */
int mesh_pictures_of_all(mesh_opener open, int cubes, int every, uint64_t seed);

/* mesh_pictures_of_scenes() - one mesh: several isovalues, clipping, transparency, shadows. */
int mesh_pictures_of_scenes(mesh_opener open, const char *mesh, int cubes, int scenes,
                            field_random *r);

/* mesh_pictures_draw() - the close view of a file, opened with these options. */
void mesh_pictures_draw(const char *path, double isovalue, const leafcast_options *o, picture *p);

#endif
