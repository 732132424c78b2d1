/* ref_judge.h - what another renderer's answers are worth: missed, false and wrong surfaces,
 * outside the grazing band.
 *
 * The band: rays whose own answer changes when they are moved sideways by REF_GRAZING_SHIFT of a
 * cell. They are counted and not judged.
 */
#ifndef TESTS_SUPPORT_REF_JUDGE_H
#define TESTS_SUPPORT_REF_JUDGE_H

#include "tests/support/ref_camera.h"
#include "tests/support/reference.h"

#define REF_GRAZING_SHIFT  1e-6 /* cells by which a ray is moved */
#define REF_GRAZING_CHANGE 1e-4 /* cells by which its distance may then change */

/* ref_grazing() - whether the answer changes (hit or miss, or the distance by more than
 * REF_GRAZING_CHANGE) when the ray is moved sideways by REF_GRAZING_SHIFT in any of eight
 * directions. Judges the first `depth` <= 64 surfaces; 1: the nearest. */
bool ref_grazing(const ref_volume *v, const ref_ray *ray, const double *isos, int iso_count,
                 const ref_clip *clip, size_t depth);

typedef struct ref_tally {
    uint64_t rays;       /* all that were judged */
    uint64_t hits;       /* surfaces outside the grazing band that the reference sees */
    uint64_t missed;     /* of these, not seen by the other */
    uint64_t false_hits; /* seen by the other alone */
    uint64_t too_far;    /* seen by both, distance off by more than REF_GRAZING_CHANGE and an ulp */
    uint64_t grazing;    /* rays in the band: not judged */
    uint64_t grazing_wrong; /* of these, those that would have been a fault */
    double worst;           /* distance error in cells, outside the band */
    double sum_squares;
} ref_tally;

typedef enum ref_verdict {
    REF_SAME,
    REF_GRAZING,
    REF_MISSED,
    REF_FALSE_HIT,
    REF_TOO_FAR
} ref_verdict;

/* ref_judge() - compare one distance (+inf: a miss) with the reference and count it. */
ref_verdict ref_judge(ref_tally *tally, const ref_volume *v, const ref_ray *ray, const double *isos,
                      int iso_count, const ref_clip *clip, double depth);

/* ref_judge_roots() - compare the other's list of distances in one cell with the reference's (each
 * fewer than 64); `grazing` says whether the ray is excused. Counts every root. A pair of roots
 * within REF_GRAZING_CHANGE of a third one is no fault, seen or not. */
ref_verdict ref_judge_roots(ref_tally *tally, const ref_hit *hits, int hit_count, const double *t,
                            int t_count, bool grazing);

/* ref_compare() - judge pixel (x, y) of every `every`-th pixel of an image of distances, row by
 * row; each fault is a line on `log` that starts with `rerun` and names the pixel. log may be NULL.
 */
void ref_compare(ref_tally *tally, const ref_volume *v, const ref_camera *camera,
                 const double *isos, int iso_count, const ref_clip *clip, const double *depth,
                 int every, const char *rerun, FILE *log);

/* ref_print_fault() - one line: what was wrong, the truth, and how to run this pixel again. */
void ref_print_fault(FILE *log, const ref_volume *v, const ref_ray *ray, const double *isos,
                     int iso_count, const ref_clip *clip, double depth, ref_verdict verdict,
                     const char *rerun, int x, int y);

/* ref_same_answer() - both see the same surfaces in the same places, but for what the band allows.
 */
bool ref_same_answer(const ref_hit *a, size_t a_count, const ref_hit *b, size_t b_count);

/* ref_tally_hit() - a hit outside the band, off by so many cells. */
void ref_tally_hit(ref_tally *tally, double cells);
void ref_tally_add(ref_tally *to, const ref_tally *from);
double ref_tally_rms(const ref_tally *tally);         /* cells */
uint64_t ref_tally_faults(const ref_tally *tally);    /* missed + false + too far */
const char *ref_verdict_name(ref_verdict verdict);    /* "missed", "false hit", ... */
void ref_tally_heading(FILE *out, const char *first); /* a table: its heading */
void ref_tally_row(FILE *out, const char *first, const ref_tally *tally); /* and a row of it */

#endif
