/* mesh_files.h - what the tests of all mesh formats share: reading a mesh into arrays, comparing,
 * and the sweeps.
 */
#ifndef TESTS_SUPPORT_MESH_FILES_H
#define TESTS_SUPPORT_MESH_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/mesh/mesh_input.h"

enum { MESH_FILES_ROOM = 1 << 18 };

/* What came of a mesh. `points` etc. are in the report. */
typedef struct mesh_copy {
    char name[MESH_NAME_MAX + 1];
    mesh_report report;
    float xyz[MESH_FILES_ROOM][3];
    float values[MESH_FILES_ROOM];
    uint32_t tets[MESH_FILES_ROOM][4];
} mesh_copy;

/* mesh_files_recognised() - whether a file is one of a mesh. */
bool mesh_files_recognised(const char *path);

/* mesh_files_read() - open, read, close: the status. Fails the test when memory is not given back,
 * when points or values do not come in order and complete, or when a tet breaks mesh_input.h's
 * promise. The result is one static mesh, valid until the next call; more than it has room for is
 * ST_FAILED. path may be "-". */
status mesh_files_read(const char *path, const mesh_hints *hints, const mesh_copy **out);

/* mesh_files_good() - the same, and it must be fine. */
const mesh_copy *mesh_files_good(const char *path, const mesh_hints *hints);

/* mesh_files_refused() - opening or reading fails with this status, and the description holds
 * `said`. */
void mesh_files_refused(const char *path, const mesh_hints *hints, status st, const char *said);

/* mesh_files_same() - two meshes with the same points, values and tets, to the bit. a is a copy
 * that mesh_files_keep() made, which the caller frees. */
void mesh_files_same(const mesh_copy *a, const mesh_copy *b);
mesh_copy *mesh_files_keep(const mesh_copy *a);

/* mesh_files_stage() - a file of a set in the data folder, decompressed if it is NAME.zst, as a
 * file of the scratch folder; NULL when it is not there. */
const char *mesh_files_stage(const char *set, const char *name);

/* mesh_files_volume() - the sum of the tets' signed volumes, and of their magnitudes. */
double mesh_files_volume(const mesh_copy *a, double *magnitude);

/* mesh_files_closed() - every face belongs to one tet, or to two that lie on its two sides. */
bool mesh_files_closed(const mesh_copy *a);

/* mesh_files_truncate() - every prefix of a file gives an error, but for the last `spare` bytes. */
void mesh_files_truncate(const char *path, const mesh_hints *hints, size_t spare);

/* mesh_files_damage() - with any byte changed, reading ends in an error or in a mesh; never in
 * anything else. Returns how many changes went unnoticed. Each byte in three ways, in files of 1000
 * bytes and more in one. */
size_t mesh_files_damage(const char *path, const mesh_hints *hints);

/* mesh_files_faults() - with each allocation and each read failing in turn: an error, a
 * description, nothing leaked. */
void mesh_files_faults(const char *path, const mesh_hints *hints);

#endif
