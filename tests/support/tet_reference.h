/* tet_reference.h - the brute-force ray tracer for tetrahedral meshes that says what is true.
 *
 * In long double, where signs decide exact, and independent: it shares no code and no types with
 * the renderer. f is linear in each tetrahedron; the conventions are those of reference.h:
 *   - inside is f >= iso; a surface is a change of that side along the ray;
 *   - the ray is taken to pass infinitely little beside where it is: by (e, e^2, e^3). So it
 *     crosses exactly two faces of a tetrahedron or none, whatever it runs through or along;
 *   - the value where it crosses a face comes from that face's three vertices, so both
 *     tetrahedra at the face see the same side: no surface is seen twice or by none of them;
 *   - the side at the start is that of f(start), also where a clip begins; no cap at the mesh's
 *     boundary, a clip or missing data;
 *   - a tetrahedron with NaN or inf among its values, one that names a vertex twice or a point that
 *     is not there, holds no surface; one that is flat is crossed in no time: its faces may yet lie
 *     on different sides, and then it closes what would be a hole;
 *   - tetrahedra named twice count once; orientation is no matter;
 *   - equal t: lowest tetrahedron first, then lowest isovalue index.
 */
#ifndef TESTS_SUPPORT_TET_REFERENCE_H
#define TESTS_SUPPORT_TET_REFERENCE_H

#include "tests/support/reference.h"

/* A mesh in memory; all pointers are the caller's. */
typedef struct tet_ref_mesh {
    size_t point_count, tet_count;
    const float (*points)[3];
    const float *values; /* one a point */
    const uint32_t (*tets)[4];
} tet_ref_mesh;

/* The mesh and a tree of boxes over it. */
typedef struct tet_ref tet_ref;

/* tet_ref_create() - m and all it points to must stay; NULL when there is no room. */
tet_ref *tet_ref_create(const tet_ref_mesh *m);
void tet_ref_destroy(tet_ref *r);

/* tet_ref_raw() - the mesh it is of. */
const tet_ref_mesh *tet_ref_raw(const tet_ref *r);

/* tet_ref_trace() - every surface along the ray, in order; returns how many there are and stores
 * the first `capacity`. Of a ref_hit, cell is the tetrahedron and cells_per_t the length, in its
 * local edge, of a step of t = 1. clip NULL: all t >= 0. */
size_t tet_ref_trace(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                     const ref_clip *clip, ref_hit *hits, size_t capacity);

/* tet_ref_trace_shifted() - the same with the ray moved by `shift` (NULL: not at all); the clip
 * stays where it is. */
size_t tet_ref_trace_shifted(const tet_ref *r, const ref_ray *ray, const long double shift[3],
                             const double *isos, int iso_count, const ref_clip *clip, ref_hit *hits,
                             size_t capacity);

/* tet_ref_nearby() - the longest local edge of the tetrahedra that may hold one of the isovalues
 * and are near the ray (a box of a few of them, a little grown, meets it); 0: none. */
double tet_ref_nearby(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                      const ref_clip *clip);

/* tet_ref_local_edge() - the third shortest of the six edges: that of the narrow side of a needle,
 * and not of an edge that has collapsed. */
double tet_ref_local_edge(const tet_ref_mesh *m, size_t tet);

/* tet_ref_crossings() - where the ray passes through the faces of one tetrahedron: t[0] <= t[1],
 * and f there. false: it passes by. */
bool tet_ref_crossings(const tet_ref_mesh *m, size_t tet, const ref_ray *ray, long double t[2],
                       long double value[2]);

/* tet_ref_exact_crossings() - the same to the last bits: determinants are summed exactly, and no
 * value is taken for 0. */
bool tet_ref_exact_crossings(const tet_ref_mesh *m, size_t tet, const ref_ray *ray,
                             long double t[2], long double value[2]);

#endif
