#include "tests/support/tet_judge.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum { DEPTH_MAX = 64 };

/* ---- the grazing band ---- */

static size_t first_hits(const tet_ref *r, const ref_ray *ray, const long double shift[3],
                         const double *isos, int iso_count, const ref_clip *clip, ref_hit *hits,
                         size_t depth) {
    size_t found = tet_ref_trace_shifted(r, ray, shift, isos, iso_count, clip, hits, depth);
    return found < depth ? found : depth;
}

/* A ray, its answer, and how far it is moved to see whether that changes. */
typedef struct band {
    const tet_ref *r;
    const ref_ray *ray;
    const double *isos;
    int iso_count;
    const ref_clip *clip;
    size_t depth, count;
    ref_hit truth[DEPTH_MAX];
    double shift;
} band;

static bool find_band(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                      const ref_clip *clip, size_t depth, band *b) {
    assert(depth >= 1 && depth <= DEPTH_MAX);
    *b = (band){
        .r = r, .ray = ray, .isos = isos, .iso_count = iso_count, .clip = clip, .depth = depth};
    b->count = first_hits(r, ray, NULL, isos, iso_count, clip, b->truth, depth);
    double length = sqrt(ray->d[0] * ray->d[0] + ray->d[1] * ray->d[1] + ray->d[2] * ray->d[2]);
    double edge = b->count ? 0 : tet_ref_nearby(r, ray, isos, iso_count, clip);
    for (size_t i = 0; i < b->count; i++)
        edge = fmax(edge, length / b->truth[i].cells_per_t);
    b->shift = REF_GRAZING_SHIFT * edge;
    return edge > 0;
}

/* Whether the answer is another one for the ray moved towards this unit vector. */
static bool changes(const band *b, const long double towards[3]) {
    ref_hit moved[DEPTH_MAX];
    long double shift[3];
    for (int a = 0; a < 3; a++)
        shift[a] = towards[a] * b->shift;
    size_t count = first_hits(b->r, b->ray, shift, b->isos, b->iso_count, b->clip, moved, b->depth);
    return !ref_same_answer(b->truth, b->count, moved, count);
}

bool tet_judge_grazing(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                       const ref_clip *clip, size_t depth) {
    band b;
    long double d[3] = {ray->d[0], ray->d[1], ray->d[2]}, towards[3];
    bool near = find_band(r, ray, isos, iso_count, clip, depth, &b);
    for (int n = 0; near && n < REF_SIDEWAYS; n++) {
        ref_sideways(d, n, towards);
        if (changes(&b, towards))
            return true;
    }
    return false;
}

/* ---- sectors ---- */

static int compare_angles(const void *a, const void *b) {
    long double x = *(const long double *)a, y = *(const long double *)b;
    return (x > y) - (x < y);
}

/* A vertex as seen along the ray: across[0] and across[1] from it. */
static void look_at(const band *b, const long double basis[2][3], uint32_t id,
                    long double across[2]) {
    const float *p = tet_ref_raw(b->r)->points[id];
    for (int k = 0; k < 2; k++) {
        across[k] = 0;
        for (int a = 0; a < 3; a++)
            across[k] += basis[k][a] * ((long double)p[a] - b->ray->o[a]);
    }
}

/* Angles at which the vertices of one tetrahedron are seen, when the ray passes through another of
 * them. */
static size_t tet_angles(const band *b, const long double basis[2][3], const uint32_t ids[4],
                         long double angle[4]) {
    size_t count = 0;
    bool through = false;
    for (int i = 0; i < 4; i++) {
        long double across[2];
        if (ids[i] >= tet_ref_raw(b->r)->point_count)
            return 0;
        look_at(b, basis, ids[i], across);
        if (hypotl(across[0], across[1]) <= b->shift / 100)
            through = true;
        else
            angle[count++] = atan2l(across[1], across[0]);
    }
    return through ? count : 0;
}

/* Seen along a ray through a vertex, or along an edge, the tetrahedra there are sectors around a
 * point; one that is missing may be narrower than those of tet_judge_grazing(). A look into each.
 */
static bool is_in_sectors(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                          const ref_clip *clip, size_t depth) {
    enum { ANGLES_MAX = 1024 };
    band b;
    long double d[3] = {ray->d[0], ray->d[1], ray->d[2]}, basis[2][3], angle[ANGLES_MAX + 4];
    size_t count = 0;
    if (!find_band(r, ray, isos, iso_count, clip, depth, &b))
        return false;
    ref_sideways(d, 0, basis[0]);
    ref_sideways(d, 2, basis[1]); /* the first two of its pairs are at a right angle */
    const tet_ref_mesh *m = tet_ref_raw(r);
    for (size_t i = 0; i < m->tet_count && count < ANGLES_MAX; i++)
        count += tet_angles(&b, basis, m->tets[i], angle + count);
    qsort(angle, count, sizeof angle[0], compare_angles);
    for (size_t i = 0; i < count; i++) {
        const long double next = i + 1 < count ? angle[i + 1] : angle[0] + 2 * acosl(-1);
        const long double middle = angle[i] + (next - angle[i]) / 2;
        long double towards[3];
        for (int a = 0; a < 3; a++)
            towards[a] = cosl(middle) * basis[0][a] + sinl(middle) * basis[1][a];
        if (changes(&b, towards))
            return true;
    }
    return false;
}

bool tet_judge_excused(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                       const ref_clip *clip, size_t depth) {
    return tet_judge_grazing(r, ray, isos, iso_count, clip, depth) ||
           is_in_sectors(r, ray, isos, iso_count, clip, depth);
}

/* ---- judging ---- */

/* The distance between two t's in edges, and whether that is more than a sound renderer may be off.
 */
static bool too_far(const ref_hit *hit, double t, double *edges) {
    double ulp = nextafter(fabs(hit->t), INFINITY) - fabs(hit->t);
    double error = (double)fabsl((long double)t - hit->t_exact);
    *edges = error * hit->cells_per_t;
    return !(error <= TET_JUDGE_ERROR / hit->cells_per_t + 4 * ulp);
}

ref_verdict tet_judge_pixel(ref_tally *tally, const tet_ref *r, const ref_ray *ray,
                            const double *isos, int iso_count, const ref_clip *clip, double depth) {
    ref_hit hit;
    bool is_hit = tet_ref_trace(r, ray, isos, iso_count, clip, &hit, 1) > 0,
         sees = depth != (double)INFINITY; /* NaN: seen, and wrong */
    double edges = 0;
    ref_verdict verdict = REF_SAME;
    if (is_hit && !sees)
        verdict = REF_MISSED;
    else if (!is_hit && sees)
        verdict = REF_FALSE_HIT;
    else if (is_hit && too_far(&hit, depth, &edges))
        verdict = REF_TOO_FAR;

    tally->rays++;
    if (tet_judge_grazing(r, ray, isos, iso_count, clip, 1) ||
        (verdict != REF_SAME && is_in_sectors(r, ray, isos, iso_count, clip, 1))) {
        tally->grazing++;
        tally->grazing_wrong += verdict != REF_SAME;
        return REF_GRAZING;
    }
    if (is_hit)
        ref_tally_hit(tally, edges);
    tally->missed += verdict == REF_MISSED;
    tally->false_hits += verdict == REF_FALSE_HIT;
    tally->too_far += verdict == REF_TOO_FAR;
    return verdict;
}

/* How many of the reference's surfaces have no t near them, and how many t have no surface. */
static void match(const ref_hit *hits, size_t hit_count, const double *t, size_t t_count,
                  size_t *missed, size_t *false_hits, ref_tally *seen) {
    double edges;
    *missed = *false_hits = 0;
    for (size_t i = 0; i < hit_count; i++) {
        double least = INFINITY;
        bool near = false;
        for (size_t k = 0; k < t_count; k++) {
            near |= !too_far(&hits[i], t[k], &edges);
            least = fmin(least, edges);
        }
        *missed += !near;
        if (near)
            ref_tally_hit(seen, least);
    }
    for (size_t k = 0; k < t_count; k++) {
        bool near = false;
        for (size_t i = 0; i < hit_count && !near; i++)
            near = !too_far(&hits[i], t[k], &edges);
        *false_hits += !near;
    }
}

ref_verdict tet_judge_hits(ref_tally *tally, const tet_ref *r, const ref_ray *ray, double iso,
                           const ref_clip *clip, const ref_hit *hits, size_t hit_count,
                           const double *t, size_t t_count) {
    ref_tally seen = {0};
    size_t missed, false_hits, far = 0;
    assert(hit_count <= DEPTH_MAX);
    match(hits, hit_count, t, t_count, &missed, &false_hits, &seen);
    tally->rays++;
    ref_verdict verdict = missed ? REF_MISSED : false_hits ? REF_FALSE_HIT : REF_SAME;
    if (missed > 0 && missed == false_hits) {
        verdict = REF_TOO_FAR;
        far = missed;
        missed = false_hits = 0;
    }
    size_t depth = hit_count ? hit_count : 1;
    if (verdict != REF_SAME &&
        tet_judge_excused(r, ray, &iso, 1, clip, depth < DEPTH_MAX ? depth + 1 : DEPTH_MAX)) {
        tally->grazing++;
        tally->grazing_wrong++;
        return REF_GRAZING;
    }
    ref_tally_add(tally, &seen);
    tally->hits += missed + far;
    tally->missed += missed;
    tally->false_hits += false_hits;
    tally->too_far += far;
    return verdict;
}
