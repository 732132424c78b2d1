/* surface_files.h - what the tests of the readers of surfaces share: reading one into arrays, and
 * the sweeps.
 */
#ifndef TESTS_SUPPORT_SURFACE_FILES_H
#define TESTS_SUPPORT_SURFACE_FILES_H

#include <stddef.h>
#include <stdint.h>

#include "formats/mesh/mesh_input.h"

enum { SURFACE_FILES_ROOM = 1 << 16, SURFACE_FILES_FIELDS = 3 };

/* What came of a surface. */
typedef struct surface_copy {
    mesh_report report;
    uint32_t fields; /* that were asked for */
    float xyz[SURFACE_FILES_ROOM][3];
    float values[SURFACE_FILES_FIELDS][SURFACE_FILES_ROOM];
    uint32_t triangles[SURFACE_FILES_ROOM][3];
    uint32_t normals[SURFACE_FILES_ROOM]; /* triangle_normal.h */
} surface_copy;

/* surface_files_take_normals() - whether readings from now on take normals, too. */
void surface_files_take_normals(bool take);

/* surface_files_read() - open, read, close: the status. names: fields to take, NULL: as the hints
 * say. Fails the test when memory is not given back, when points or values do not come in order and
 * complete, or when a triangle breaks mesh_sink.h's promise. The result is one static surface. */
status surface_files_read(const char *path, const mesh_hints *hints, const char *const *names,
                          uint32_t count, const surface_copy **out);

/* surface_files_good() - the same of the hints' field, and it must be fine. */
const surface_copy *surface_files_good(const char *path, const mesh_hints *hints);

/* surface_files_refused() - opening or reading fails with this status, and the description holds
 * `said`. */
void surface_files_refused(const char *path, const mesh_hints *hints, status st, const char *said);

/* surface_files_pipe() - read a file through a named pipe of that name, fed in pieces of so many
 * bytes. */
const surface_copy *surface_files_pipe(const char *path, const char *name, size_t piece);

/* The sweeps: every prefix but the last `spare` bytes is an error; any byte changed (in one of
 * three ways) gives an error or a surface; each allocation and each read failing in turn is told
 * and leaks nothing. */
void surface_files_truncate(const char *path, const mesh_hints *hints, size_t spare);
void surface_files_damage(const char *path, const mesh_hints *hints);
void surface_files_faults(const char *path, const mesh_hints *hints);

#endif
