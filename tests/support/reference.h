/* reference.h - the brute-force ray tracer that says what is true.
 *
 * Slow, in long double, and independent: it shares no code and no types with the renderer. It keeps
 * the project's conventions and nothing else:
 *   - inside is f >= iso; a surface is a change of that side along the ray;
 *   - a cell owns [i, i+1) on each axis, the last its end; a direction component of 0 counts as +0;
 *     planes that are crossed at the same t are crossed x first, then y, then z, and the
 *     zero-length visits between them are kept;
 *   - the value at a face is the bilinear form of its 4 samples, so both cells at the face see
 *     the same side;
 *   - the side at the start is that of f(start), also where a clip begins; no cap at the box,
 *     a clip or missing data;
 *   - a cell that touches NaN or inf holds no surface; nor does one whose samples all lie on
 *     one side;
 *   - equal t: lowest global cell first, then lowest isovalue index.
 */
#ifndef TESTS_SUPPORT_REFERENCE_H
#define TESTS_SUPPORT_REFERENCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* A whole volume in memory; all pointers are the caller's. */
typedef struct ref_volume {
    long dims[3];          /* nodes per axis, each >= 2 */
    const float *samples;  /* dims[0] * dims[1] * dims[2], x fastest */
    const double *axis[3]; /* strictly increasing node coordinates; NULL: 0, 1, 2, ... */
    double to_world[3][4]; /* affine, row-major: world = to_world * (node coordinates, 1) */
} ref_volume;

/* A ray in world space; d need not have unit length, t counts in units of |d|. */
typedef struct ref_ray {
    double o[3];
    double d[3];
} ref_ray;

/* Where a ray counts: t in [t0, t1], on the positive side of every plane, inside the box. All in
 * world space. */
typedef struct ref_clip {
    double t0, t1;
    const double (*planes)[4]; /* kept where n . x + w >= 0 for (n, w) */
    int plane_count;
    const double (*box)[3]; /* [2][3] lower and upper corner, or NULL */
} ref_clip;

typedef struct ref_hit {
    double t;
    int64_t cell;        /* i + cx * (j + cy * k), cx and cy cells per axis */
    int iso;             /* index in the list of isovalues */
    bool from_inside;    /* the side the ray comes from */
    double cells_per_t;  /* length, in cells of this size, of a step of t = 1 */
    long double t_exact; /* t before it was rounded */
} ref_hit;

/* ref_volume_regular() - samples at origin + i * spacing, axis-aligned. NULL for spacing 1 and for
 * origin 0. */
ref_volume ref_volume_regular(const long dims[3], const float *samples, const double spacing[3],
                              const double origin[3]);

/* ref_trace() - every surface along the ray, in order; returns how many there are and stores the
 * first `capacity`. With a capacity of 1 it stops at the nearest and the result says only whether
 * there is one. clip NULL: all t >= 0. */
size_t ref_trace(const ref_volume *v, const ref_ray *ray, const double *isos, int iso_count,
                 const ref_clip *clip, ref_hit *hits, size_t capacity);

/* ref_trace_shifted() - the same with the ray moved by `shift`,
 * in node coordinates; the clip stays where it is. */
size_t ref_trace_shifted(const ref_volume *v, const ref_ray *ray, const long double shift[3],
                         const double *isos, int iso_count, const ref_clip *clip, ref_hit *hits,
                         size_t capacity);

/* ref_visits() - the cells the ray visits, in order, those of zero length included; returns how
 * many there are. */
typedef struct ref_visit {
    int64_t cell;
    long double t_in, t_out;
} ref_visit;
size_t ref_visits(const ref_volume *v, const ref_ray *ray, const ref_clip *clip, ref_visit *visits,
                  size_t capacity);

/* ref_value() - f - iso at a point of node coordinates; NaN outside the volume or in a cell without
 * data. */
long double ref_value(const ref_volume *v, const long double p[3], double iso);

/* ref_to_grid() - the ray in node coordinates, not yet rounded to double. */
void ref_to_grid(const ref_volume *v, const ref_ray *ray, long double o[3], long double d[3]);

/* ref_clip_interval() - [t0, t1] of the ray that the clip keeps, empty where t0 > t1. clip NULL:
 * all t >= 0. */
void ref_clip_interval(const ref_clip *clip, const ref_ray *ray, long double *t0, long double *t1);

/* ---- one cell ---- */

enum { REF_CELL_ROOTS_MAX = 3 };

/* ref_cell_roots() - all crossings of one cell [lo, hi] by the grid-space ray o + t d for t >= 0,
 * in order. samples: x fastest, then y, then z. Returns 0 to 3. */
int ref_cell_roots(const double o[3], const double d[3], const double lo[3], const double hi[3],
                   const float samples[8], double iso, ref_hit hits[REF_CELL_ROOTS_MAX]);

/* ref_cell_grazing() - whether a root appears, goes, or moves by more than `change` cells when the
 * way through the cell is moved sideways by `shift` cells, no further than the cell reaches. */
bool ref_cell_grazing(const double o[3], const double d[3], const double lo[3], const double hi[3],
                      const float samples[8], double iso, double shift, double change);

/* ref_sideways() - one of REF_SIDEWAYS unit vectors perpendicular to d, 45 degrees apart. */
enum { REF_SIDEWAYS = 8 };
void ref_sideways(const long double d[3], int direction, long double shift[3]);

#endif
