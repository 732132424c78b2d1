#include "tests/support/tet_judge.h"

#include <assert.h>
#include <math.h>

enum { DEPTH_MAX = 64 };

/* ---- the grazing band ---- */

static bool same_answer(const ref_hit *a, size_t a_count, const ref_hit *b, size_t b_count) {
    if (a_count != b_count)
        return false;
    for (size_t i = 0; i < a_count; i++)
        if (a[i].iso != b[i].iso ||
            fabsl(a[i].t_exact - b[i].t_exact) * a[i].cells_per_t > REF_GRAZING_CHANGE)
            return false;
    return true;
}

static size_t first_hits(const tet_ref *r, const ref_ray *ray, const long double shift[3],
                         const double *isos, int iso_count, const ref_clip *clip, ref_hit *hits,
                         size_t depth) {
    size_t found = tet_ref_trace_shifted(r, ray, shift, isos, iso_count, clip, hits, depth);
    return found < depth ? found : depth;
}

bool tet_judge_grazing(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                       const ref_clip *clip, size_t depth) {
    ref_hit truth[DEPTH_MAX], moved[DEPTH_MAX];
    assert(depth >= 1 && depth <= DEPTH_MAX);
    size_t count = first_hits(r, ray, NULL, isos, iso_count, clip, truth, depth);

    long double d[3] = {ray->d[0], ray->d[1], ray->d[2]}, shift[3];
    double length = sqrt(ray->d[0] * ray->d[0] + ray->d[1] * ray->d[1] + ray->d[2] * ray->d[2]);
    double edge = count ? 0 : tet_ref_nearby(r, ray, isos, iso_count, clip);
    for (size_t i = 0; i < count; i++)
        edge = fmax(edge, length / truth[i].cells_per_t);
    for (int n = 0; n < REF_SIDEWAYS && edge > 0; n++) {
        ref_sideways(d, n, shift);
        for (int a = 0; a < 3; a++)
            shift[a] *= REF_GRAZING_SHIFT * edge;
        size_t moved_count = first_hits(r, ray, shift, isos, iso_count, clip, moved, depth);
        if (!same_answer(truth, count, moved, moved_count))
            return true;
    }
    return false;
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

static void count_hit(ref_tally *tally, double edges) {
    tally->hits++;
    tally->worst = fmax(tally->worst, edges);
    tally->sum_squares += edges * edges;
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
    if (tet_judge_grazing(r, ray, isos, iso_count, clip, 1)) {
        tally->grazing++;
        tally->grazing_wrong += verdict != REF_SAME;
        return REF_GRAZING;
    }
    if (is_hit)
        count_hit(tally, edges);
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
            count_hit(seen, least);
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
        tet_judge_grazing(r, ray, &iso, 1, clip, depth < DEPTH_MAX ? depth + 1 : DEPTH_MAX)) {
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
