/* mesh_movies.h - meshes of several steps and fields: in memory, in files, and converted. */
#ifndef TESTS_SUPPORT_MESH_MOVIES_H
#define TESTS_SUPPORT_MESH_MOVIES_H

#include "tests/support/mesh_cases.h"

enum { MESH_MOVIES_STEPS = 8, MESH_MOVIES_FIELDS = 3 };

/* A mesh with the points of each step, and the values of each field at each step. */
typedef struct mesh_movie {
    mesh_case c;
    uint32_t steps, fields;
    float (*points[MESH_MOVIES_STEPS])[3];
    float *values[MESH_MOVIES_STEPS][MESH_MOVIES_FIELDS];
    const char *paths[MESH_MOVIES_STEPS];
    const char *names[MESH_MOVIES_FIELDS];
    double times[MESH_MOVIES_STEPS];
    const uint32_t (*hexes)[8]; /* in place of c's tets, as VTK has their corners; or NULL */
    size_t hex_count;
    mesh_series series;
} mesh_movie;

/* mesh_movies_make() - c at these steps, which owns it. Steps before `moves` have the first one's
 * points, that one the first `same` of them, too. */
mesh_movie mesh_movies_make(mesh_case c, uint32_t fields, uint32_t steps, uint32_t moves,
                            size_t same);
void mesh_movies_release(mesh_movie *v);

/* mesh_movies_write() - write all steps to scratch files, and say so in v->paths and v->series.
 * mesh_movies_stream() - write the first field at step s, with so many tets, to a mesh stream of
 * this name; returns its path. */
void mesh_movies_write(mesh_movie *v);
const char *mesh_movies_stream(const mesh_movie *v, uint32_t s, const char *name, size_t tets);

/* mesh_movies_convert() - convert the steps of v->series to the file at a path, within the budget
 * of v's options; dry: only plan. */
status mesh_movies_convert(mem *m, const mesh_movie *v, const char *path, mesh_result *r, bool dry);

#endif
