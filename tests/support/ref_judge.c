#include "tests/support/ref_judge.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

enum { DEPTH_MAX = 64 };

/* ---- the grazing band ---- */

/* Cell widths by which a ray is moved: those of the cell that was hit, else the widest of each
 * axis. */
static void cell_widths(const ref_volume *v, const ref_hit *hit, long double width[3]) {
    int64_t cx = v->dims[0] - 1, cy = v->dims[1] - 1;
    for (int a = 0; a < 3; a++) {
        width[a] = 1;
        if (!v->axis[a])
            continue;
        long at = 0;
        if (hit)
            at = (long)(a == 0   ? hit->cell % cx
                        : a == 1 ? hit->cell / cx % cy
                                 : hit->cell / cx / cy);
        width[a] = (long double)v->axis[a][at + 1] - v->axis[a][at];
        for (long i = 0; !hit && i + 1 < v->dims[a]; i++)
            width[a] = fmaxl(width[a], (long double)v->axis[a][i + 1] - v->axis[a][i]);
    }
}

bool ref_same_answer(const ref_hit *a, size_t a_count, const ref_hit *b, size_t b_count) {
    if (a_count != b_count)
        return false;
    for (size_t i = 0; i < a_count; i++)
        if (a[i].iso != b[i].iso ||
            fabsl(a[i].t_exact - b[i].t_exact) * a[i].cells_per_t > REF_GRAZING_CHANGE)
            return false;
    return true;
}

static size_t first_hits(const ref_volume *v, const ref_ray *ray, const long double shift[3],
                         const double *isos, int iso_count, const ref_clip *clip, ref_hit *hits,
                         size_t depth) {
    size_t found = ref_trace_shifted(v, ray, shift, isos, iso_count, clip, hits, depth);
    return found < depth ? found : depth;
}

bool ref_grazing(const ref_volume *v, const ref_ray *ray, const double *isos, int iso_count,
                 const ref_clip *clip, size_t depth) {
    ref_hit truth[DEPTH_MAX], moved[DEPTH_MAX];
    assert(depth >= 1 && depth <= DEPTH_MAX);
    size_t count = first_hits(v, ray, NULL, isos, iso_count, clip, truth, depth);

    /* Sideways means perpendicular where cells are cubes. */
    long double o[3], d[3], width[3], shift[3];
    ref_to_grid(v, ray, o, d);
    cell_widths(v, count ? truth : NULL, width);
    for (int a = 0; a < 3; a++)
        d[a] /= width[a];
    for (int n = 0; n < REF_SIDEWAYS; n++) {
        ref_sideways(d, n, shift);
        for (int a = 0; a < 3; a++)
            shift[a] *= REF_GRAZING_SHIFT * width[a];
        size_t moved_count = first_hits(v, ray, shift, isos, iso_count, clip, moved, depth);
        if (!ref_same_answer(truth, count, moved, moved_count))
            return true;
    }
    return false;
}

/* ---- judging ---- */

/* The distance between two t's in cells, and whether that is more than a sound renderer may be off.
 */
static bool too_far(const ref_hit *hit, double t, double *cells) {
    double ulp = nextafter(fabs(hit->t), INFINITY) - fabs(hit->t);
    double error = (double)fabsl((long double)t - hit->t_exact);
    *cells = error * hit->cells_per_t;
    return !(*cells <= REF_GRAZING_CHANGE + ulp * hit->cells_per_t);
}

void ref_tally_hit(ref_tally *tally, double cells) {
    tally->hits++;
    tally->worst = fmax(tally->worst, cells);
    tally->sum_squares += cells * cells;
}

ref_verdict ref_judge(ref_tally *tally, const ref_volume *v, const ref_ray *ray, const double *isos,
                      int iso_count, const ref_clip *clip, double depth) {
    ref_hit hit;
    bool is_hit = ref_trace(v, ray, isos, iso_count, clip, &hit, 1) > 0,
         sees = depth != (double)INFINITY; /* NaN: seen, and wrong */
    double cells = 0;
    ref_verdict verdict = REF_SAME;
    if (is_hit && !sees)
        verdict = REF_MISSED;
    else if (!is_hit && sees)
        verdict = REF_FALSE_HIT;
    else if (is_hit && too_far(&hit, depth, &cells))
        verdict = REF_TOO_FAR;

    tally->rays++;
    if (ref_grazing(v, ray, isos, iso_count, clip, 1)) {
        tally->grazing++;
        tally->grazing_wrong += verdict != REF_SAME;
        return REF_GRAZING;
    }
    if (is_hit)
        ref_tally_hit(tally, cells);
    tally->missed += verdict == REF_MISSED;
    tally->false_hits += verdict == REF_FALSE_HIT;
    tally->too_far += verdict == REF_TOO_FAR;
    return verdict;
}

/* Whether each list has, for every root of the other, one as near as REF_GRAZING_CHANGE: beside a
 * root, a pair that close makes no other picture. */
static bool same_places(const ref_hit *hits, int hit_count, const double *t, int t_count) {
    if ((hit_count - t_count) % 2 != 0)
        return false;
    uint64_t hit_near = 0, t_near = 0;
    for (int i = 0; i < hit_count; i++)
        for (int k = 0; k < t_count; k++)
            if (fabs(hits[i].t - t[k]) * hits[i].cells_per_t <= REF_GRAZING_CHANGE) {
                hit_near |= UINT64_C(1) << i;
                t_near |= UINT64_C(1) << k;
            }
    return hit_near == (UINT64_C(1) << hit_count) - 1 && t_near == (UINT64_C(1) << t_count) - 1;
}

ref_verdict ref_judge_roots(ref_tally *tally, const ref_hit *hits, int hit_count, const double *t,
                            int t_count, bool grazing) {
    ref_verdict verdict = REF_SAME;
    double cells[DEPTH_MAX] = {0};
    int common = hit_count < t_count ? hit_count : t_count, far = 0;
    assert(hit_count < DEPTH_MAX && t_count < DEPTH_MAX);
    bool same_count = hit_count == t_count;
    for (int i = 0; same_count && i < common; i++)
        far += too_far(&hits[i], t[i], &cells[i]);
    if (far > 0)
        verdict = REF_TOO_FAR;
    else if (!same_count && !same_places(hits, hit_count, t, t_count))
        verdict = hit_count > t_count ? REF_MISSED : REF_FALSE_HIT;

    tally->rays++;
    if (grazing) {
        tally->grazing++;
        tally->grazing_wrong += verdict != REF_SAME;
        return REF_GRAZING;
    }
    for (int i = 0; i < hit_count; i++)
        ref_tally_hit(tally, cells[i]);
    tally->missed += verdict == REF_MISSED ? (uint64_t)(hit_count - common) : 0;
    tally->false_hits += verdict == REF_FALSE_HIT ? (uint64_t)(t_count - common) : 0;
    tally->too_far += (uint64_t)far;
    return verdict;
}

void ref_compare(ref_tally *tally, const ref_volume *v, const ref_camera *camera,
                 const double *isos, int iso_count, const ref_clip *clip, const double *depth,
                 int every, const char *rerun, FILE *log) {
    size_t pixels = (size_t)camera->width * (size_t)camera->height;
    for (size_t at = 0; at < pixels; at += (size_t)every) {
        int x = (int)(at % (size_t)camera->width), y = (int)(at / (size_t)camera->width);
        ref_ray ray = ref_primary_ray(camera, x, y);
        ref_verdict verdict = ref_judge(tally, v, &ray, isos, iso_count, clip, depth[at]);
        if (log && verdict != REF_SAME && verdict != REF_GRAZING)
            ref_print_fault(log, v, &ray, isos, iso_count, clip, depth[at], verdict, rerun, x, y);
    }
}

void ref_print_fault(FILE *log, const ref_volume *v, const ref_ray *ray, const double *isos,
                     int iso_count, const ref_clip *clip, double depth, ref_verdict verdict,
                     const char *rerun, int x, int y) {
    ref_hit hit = {.t = INFINITY, .cell = -1, .iso = -1};
    ref_trace(v, ray, isos, iso_count, clip, &hit, 1);
    fprintf(log, "%s: got %.17g, truth %.17g (cell %lld, isovalue %d); rerun: %s --pixel %d,%d\n",
            ref_verdict_name(verdict), depth, hit.t, (long long)hit.cell, hit.iso, rerun, x, y);
}

/* ---- tallies ---- */

void ref_tally_add(ref_tally *to, const ref_tally *from) {
    to->rays += from->rays;
    to->hits += from->hits;
    to->missed += from->missed;
    to->false_hits += from->false_hits;
    to->too_far += from->too_far;
    to->grazing += from->grazing;
    to->grazing_wrong += from->grazing_wrong;
    to->worst = fmax(to->worst, from->worst);
    to->sum_squares += from->sum_squares;
}

double ref_tally_rms(const ref_tally *tally) {
    return tally->hits ? sqrt(tally->sum_squares / (double)tally->hits) : 0;
}

uint64_t ref_tally_faults(const ref_tally *tally) {
    return tally->missed + tally->false_hits + tally->too_far;
}

const char *ref_verdict_name(ref_verdict verdict) {
    static const char *const names[] = {"same", "grazing", "missed", "false hit", "too far"};
    return names[verdict];
}

void ref_tally_heading(FILE *out, const char *first) {
    fprintf(out, "%-28s %9s %9s %7s %7s %7s %10s %10s %9s %7s\n", first, "rays", "hits", "missed",
            "false", "too_far", "worst", "rms", "grazing", "of_them");
}

void ref_tally_row(FILE *out, const char *first, const ref_tally *tally) {
    double share = tally->rays ? 100 * (double)tally->grazing / (double)tally->rays : 0;
    fprintf(out, "%-28s %9llu %9llu %7llu %7llu %7llu %10.2e %10.2e %8.4f%% %7llu\n", first,
            (unsigned long long)tally->rays, (unsigned long long)tally->hits,
            (unsigned long long)tally->missed, (unsigned long long)tally->false_hits,
            (unsigned long long)tally->too_far, tally->worst, ref_tally_rms(tally), share,
            (unsigned long long)tally->grazing_wrong);
}
