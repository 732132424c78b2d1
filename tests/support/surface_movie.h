/* surface_movie.h - a sheet of triangles at several steps, with several fields, in files of PLY,
 * and what a treelet file of it must hold. Trouble fails the running test.
 */
#ifndef TESTS_SUPPORT_SURFACE_MOVIE_H
#define TESTS_SUPPORT_SURFACE_MOVIE_H

#include "prep/mesh/mesh_convert.h"

enum { SURFACE_MOVIE_STEPS = 4, SURFACE_MOVIE_FIELDS = 2 };

/* Of its triangles one has no area, one a vertex twice and one an index that is no point's; some
 * values are NaN. */
typedef struct surface_movie {
    uint32_t points, triangles, fields, steps;
    bool moves, normals; /* normals: the files have some */
    float (*xyz[SURFACE_MOVIE_STEPS])[3];
    float *values[SURFACE_MOVIE_STEPS][SURFACE_MOVIE_FIELDS];
    uint32_t (*corner)[3]; /* those that are kept, in the order of the files */
    const char *paths[SURFACE_MOVIE_STEPS];
    mesh_series series;
    mesh_options options; /* in memory, two threads, raw, treelets of 100 */
} surface_movie;

/* surface_movie_make() - a sheet of side^2 squares, in a random order; written as NAME0.ply and so
 * on into the scratch folder. Release it; the files stay. */
surface_movie surface_movie_make(uint32_t side, uint32_t fields, uint32_t steps, bool moves,
                                 const char *name);
void surface_movie_release(surface_movie *v);

/* surface_movie_give_normals() - write the files again, with normals: some have no direction.
 * surface_movie_normal() - a point's at a step, of any length. */
void surface_movie_give_normals(surface_movie *v, const char *name);
void surface_movie_normal(const surface_movie *v, uint32_t step, uint32_t point, float normal[3]);

/* surface_movie_convert() - the status, to a path. dry: plan alone. */
CHECKED status surface_movie_convert(mem *m, const surface_movie *v, const char *path,
                                     const progress *p, bool dry, mesh_result *r);

/* surface_movie_check() - a file holds what v does, as the second reader sees it: each triangle
 * once, its corners in their order, every bit of it. */
void surface_movie_check(const surface_movie *v, const char *path);

#endif
