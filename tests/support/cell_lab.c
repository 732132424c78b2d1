#include "tests/support/cell_lab.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/batch_lab.h"
#include "tests/support/ray_cells.h"
#include "tests/support/ref_judge.h"

enum {
    CHUNK = 4096,
    SHOWN = 3,     /* faults printed of a case and intersector */
    ANSWER_MAX = 4 /* one more than a cell can hold */
};

static const char HOLES_NAME[] = "nan-inf", THIN[] = "thin";

const char *cell_lab_name(int which) {
    return which == CELL_LAB_HOLES ? HOLES_NAME : ray_cell_case_name(which);
}

static const double FILM_THICK = 1e-5, FILM_DEEP = 16 * DBL_EPSILON; /* see the header */

/* ---- what the intersectors say ---- */

static ray lab_ray(const ray_cell *c) {
    ray r = {.t0 = 0, .t1 = INFINITY};
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = c->o[a];
        r.d[a] = c->d[a] == 0 ? 0 : c->d[a];
    }
    return r;
}

static cell_box lab_box(const ray_cell *c) {
    cell_box box;
    for (int a = 0; a < 3; a++) {
        box.lo[a] = c->lo[a];
        box.hi[a] = c->hi[a];
        box.inv[a] = 1 / (c->hi[a] - c->lo[a]);
        box.last[a] = true;
    }
    return box;
}

typedef struct answer {
    double t[ANSWER_MAX];
    int count;
    bool first_entering;
    bool disorder;
} answer;

enum { CELL = 77, ISO = 2 };

/* From hit to hit, as pictures ask. */
static answer ask(const intersector *x, const ray *r, const cell_visit *v, const ray_cell *c) {
    answer a = {.count = 0};
    hit at = hit_before_all(), next;
    while (x->next_hit(r, v, c->samples, c->iso, ISO, CELL, &at, &next)) {
        if (a.count == ANSWER_MAX - 1 || next.cell != CELL || next.iso != ISO) {
            a.disorder = true;
            break;
        }
        if (a.count == 0)
            a.first_entering = next.entering;
        a.t[a.count++] = next.t;
        at = next;
    }
    return a;
}

/* From a hit of another isovalue at the same place this one is still to come, or is past. */
static bool ties_in_order(const ray *r, const cell_visit *v, const ray_cell *c, const hit *h) {
    hit other = *h, again;
    other.iso = ISO - 1;
    if (!cell_next_hit(r, v, c->samples, c->iso, ISO, CELL, &other, &again) || again.t != h->t)
        return false;
    other.iso = ISO + 1;
    return !cell_next_hit(r, v, c->samples, c->iso, ISO, CELL, &other, &again) || again.t > h->t;
}

/* The list of roots; from hit to hit there must be the same ones, of equal t one. */
static answer ask_exact(const ray *r, const cell_visit *v, const ray_cell *c) {
    answer a = {.count = 0};
    double b[4], s[3];
    hit at = hit_before_all(), next;
    if (cell_cubic(v, c->samples, c->iso, b)) {
        a.count = cell_roots(b, s);
        a.first_entering = !(b[0] >= 0);
        bool entering = a.first_entering;
        for (int i = 0; i < a.count; i++, entering = !entering) {
            a.t[i] = cell_root_t(v, s[i]);
            if (i > 0 && a.t[i] == a.t[i - 1])
                continue;
            bool found = cell_next_hit(r, v, c->samples, c->iso, ISO, CELL, &at, &next);
            if (!found || next.t != a.t[i] || next.cell != CELL || next.iso != ISO ||
                next.entering != entering || !ties_in_order(r, v, c, &next))
                a.disorder = true;
            at = next;
            if (!found)
                return a;
        }
    }
    a.disorder |= cell_next_hit(r, v, c->samples, c->iso, ISO, CELL, &at, &next);
    return a;
}

static bool is_exact(int x) {
    return intersector_at(x)->id == LEAFCAST_MARMITT;
}

unsigned cell_lab_exact(void) {
    unsigned bits = 0;
    for (int x = 0; x < INTERSECTOR_COUNT; x++)
        bits |= (unsigned)is_exact(x) << x;
    return bits;
}

/* ---- judging ---- */

/* A ray-cell with all that is said about it. */
typedef struct trial {
    ray_cell c;
    ref_hit truth[REF_CELL_ROOTS_MAX];
    int truth_count;
    bool visited;
    double cells_per_t;
    answer of[INTERSECTOR_COUNT];
    unsigned unlike[INTERSECTOR_COUNT]; /* bit per ISA */
    bool grazing;
} trial;

/* Which of the longer list go with the shorter one, as bits, so that the errors add up to the
 * least. */
static unsigned best_match(const trial *t, const answer *a) {
    const bool truth_longer = t->truth_count > a->count;
    const int longer = truth_longer ? t->truth_count : a->count;
    const int shorter = truth_longer ? a->count : t->truth_count;
    unsigned best = 0;
    double least = INFINITY;
    for (unsigned bits = 0; bits < 1u << longer; bits++) {
        if (__builtin_popcount(bits) != shorter)
            continue;
        double sum = 0;
        for (int i = 0, k = 0; i < longer; i++)
            if (bits >> i & 1u) {
                sum += fabs(t->truth[truth_longer ? i : k].t - a->t[truth_longer ? k : i]);
                k++;
            }
        if (!(sum >= least)) {
            least = sum;
            best = bits;
        }
    }
    return best;
}

static double error_in_cells(const ref_hit *truth, double t) {
    const double error = (double)fabsl((long double)t - truth->t_exact) * truth->cells_per_t;
    return isnan(error) ? INFINITY : error;
}

static bool too_far(const ref_hit *truth, double cells) {
    const double ulp = nextafter(fabs(truth->t), INFINITY) - fabs(truth->t);
    return !(cells <= REF_GRAZING_CHANGE + ulp * truth->cells_per_t);
}

/* Whether the i-th of the longer list lies that near to one of the other list. */
static bool beside_another(const trial *t, const answer *a, int i) {
    const bool truth_longer = t->truth_count > a->count;
    for (int k = 0; k < (truth_longer ? a->count : t->truth_count); k++) {
        const ref_hit *truth = &t->truth[truth_longer ? i : k];
        if (error_in_cells(truth, a->t[truth_longer ? k : i]) <= REF_GRAZING_CHANGE)
            return true;
    }
    return false;
}

/* |f - iso| on the ray at t, in units of the largest |sample - iso|. */
static long double depth_at(const ray_cell *c, long double t) {
    long double p[3], f = 0, most = 0;
    for (int a = 0; a < 3; a++)
        p[a] = (c->o[a] + t * c->d[a] - c->lo[a]) / ((long double)c->hi[a] - c->lo[a]);
    for (int n = 0; n < 8; n++) {
        const long double g = (long double)c->samples[n] - c->iso;
        f += (n & 1 ? p[0] : 1 - p[0]) * (n & 2 ? p[1] : 1 - p[1]) * (n & 4 ? p[2] : 1 - p[2]) * g;
        most = fmaxl(most, fabsl(g));
    }
    return fabsl(f) / most;
}

/* Whether the surfaces alone, as bits of the longer list, are one film. */
static bool is_film(const trial *t, const answer *a, unsigned alone) {
    const int first = alone ? __builtin_ctz(alone) : 0;
    if (alone != 3u << first)
        return false;
    const bool in_truth = t->truth_count > a->count;
    const long double from = in_truth ? t->truth[first].t_exact : a->t[first];
    const long double to = in_truth ? t->truth[first + 1].t_exact : a->t[first + 1];
    return (to - from) * t->cells_per_t <= FILM_THICK &&
           depth_at(&t->c, from + (to - from) / 2) <= FILM_DEEP;
}

/* What one answer is worth, as a tally of one; returns the fault's name or NULL. */
static const char *worth(const trial *t, int x, cell_lab_tally *one) {
    const answer *a = &t->of[x];
    const bool truth_longer = t->truth_count > a->count;
    const int longer = truth_longer ? t->truth_count : a->count;
    const unsigned match = best_match(t, a);
    const char *fault = NULL;
    uint64_t alone = 0, alone_near = 0;
    *one = (cell_lab_tally){.cells = 1, .surfaces = (uint64_t)t->truth_count};
    for (int i = 0, k = 0; i < longer; i++) {
        if (!(match >> i & 1u)) {
            alone++;
            alone_near += beside_another(t, a, i);
            continue;
        }
        const ref_hit *truth = &t->truth[truth_longer ? i : k];
        const double cells = error_in_cells(truth, a->t[truth_longer ? k : i]);
        k++;
        one->matched++;
        one->worst = fmax(one->worst, cells);
        one->sum_squares += cells * cells;
        if (too_far(truth, cells)) {
            one->too_far++;
            fault = "too far";
        }
    }
    if (is_film(t, a, ((1u << longer) - 1) & ~match)) {
        one->thin = 2;
        fault = THIN;
    } else if (alone > 0 && !(alone % 2 == 0 && alone_near == alone)) {
        *(truth_longer ? &one->missed : &one->false_hits) = alone;
        fault = truth_longer ? "missed" : "false";
    }
    return fault;
}

static void add(cell_lab_tally *to, const cell_lab_tally *from) {
    to->cells += from->cells;
    to->grazing += from->grazing;
    to->excused += from->excused;
    to->surfaces += from->surfaces;
    to->missed += from->missed;
    to->false_hits += from->false_hits;
    to->too_far += from->too_far;
    to->disorder += from->disorder;
    to->unlike += from->unlike;
    to->thin += from->thin;
    to->matched += from->matched;
    to->worst = fmax(to->worst, from->worst);
    to->sum_squares += from->sum_squares;
}

/* Charge one answer; returns the fault's name or NULL. */
static const char *judge(const trial *t, int x, cell_lab_tally *sum) {
    const answer *a = &t->of[x];
    cell_lab_tally one;
    const char *fault = worth(t, x, &one);
    if (fault && t->grazing) {
        one = (cell_lab_tally){.cells = 1, .excused = 1};
        fault = NULL;
    }
    one.grazing = t->grazing;
    /* Order among its own answers excuses nothing. */
    if (a->disorder) {
        one.disorder++;
        fault = "disorder";
    }
    if (is_exact(x) && !t->grazing && a->count > 0 && a->count == t->truth_count &&
        a->first_entering == t->truth[0].from_inside) {
        one.disorder++;
        fault = "wrong side";
    }
    if (t->unlike[x]) {
        one.unlike++;
        fault = "unlike";
    }
    add(sum, &one);
    return fault;
}

/* Whether anything hangs on the ray's being in the band. */
static bool in_question(const trial *t) {
    for (int x = 0; x < INTERSECTOR_COUNT; x++)
        if (t->of[x].count > 0)
            return true;
    return t->truth_count > 0;
}

/* The exact one again, by the kernels for sixteen at a time. */
static void try_batches(batch_lab *batch, const ray *r, const cell_box *box, trial *t) {
    memset(t->unlike, 0, sizeof t->unlike);
    if (!batch_lab_put(batch, r, box, t->c.samples))
        return;
    for (int x = 0; x < INTERSECTOR_COUNT; x++) {
        const answer *a = &t->of[x];
        const hit first = {.t = a->t[0], .entering = a->first_entering};
        if (is_exact(x))
            t->unlike[x] = batch_lab_unlike(batch, t->c.iso, a->count > 0 ? &first : NULL);
    }
}

static void try_cell(const cell_lab_job *job, uint64_t index, batch_lab *batch, trial *t) {
    ray_cell *c = &t->c;
    bool offered = true;
    if (job->which == CELL_LAB_HOLES)
        offered = holes_cell(job->h, index, c);
    else
        ray_cell_make(job->which, job->seed, index, c);
    t->truth_count = ref_cell_roots(c->o, c->d, c->lo, c->hi, c->samples, c->iso, t->truth);
    const ray r = lab_ray(c);
    const cell_box box = lab_box(c);
    cell_visit v;
    double sum = 0;
    for (int a = 0; a < 3; a++)
        sum += r.d[a] * box.inv[a] * r.d[a] * box.inv[a];
    t->cells_per_t = sqrt(sum);
    t->visited = cell_visit_of(&r, &box, &v) && offered;
    for (int x = 0; x < INTERSECTOR_COUNT; x++) {
        if (!t->visited)
            t->of[x] = (answer){.count = 0};
        else
            t->of[x] = is_exact(x) ? ask_exact(&r, &v, c) : ask(intersector_at(x), &r, &v, c);
    }
    if (offered)
        try_batches(batch, &r, &box, t);
    else
        memset(t->unlike, 0, sizeof t->unlike);
    t->grazing = in_question(t) && ref_cell_grazing(c->o, c->d, c->lo, c->hi, c->samples, c->iso,
                                                    REF_GRAZING_SHIFT, REF_GRAZING_CHANGE);
}

/* ---- many ---- */

typedef struct fault_note {
    uint64_t index;
    const char *what; /* NULL: none */
} fault_note;

typedef struct chunk {
    cell_lab_row row;
    fault_note notes[INTERSECTOR_COUNT][2][SHOWN]; /* thin ones apart: they crowd nothing out */
} chunk;

typedef struct run_context {
    const cell_lab_job *job;
    chunk *chunks;
} run_context;

static status run_chunk(void *ctx, size_t at, int worker) {
    (void)worker;
    const run_context *run = ctx;
    const cell_lab_job *job = run->job;
    chunk *c = &run->chunks[at];
    int noted[INTERSECTOR_COUNT][2] = {{0}};
    batch_lab batch;
    memset(&batch, 0, sizeof batch);
    for (uint64_t i = at * CHUNK; i < job->count && i < (at + 1) * CHUNK; i++) {
        trial t;
        try_cell(job, job->first + i, &batch, &t);
        for (int x = 0; x < INTERSECTOR_COUNT; x++) {
            const char *fault = judge(&t, x, &c->row.of[x]);
            if (!fault || !(job->exact >> x & 1u))
                continue;
            const int kind = strcmp(fault, THIN) == 0;
            if (noted[x][kind] < SHOWN)
                c->notes[x][kind][noted[x][kind]++] = (fault_note){job->first + i, fault};
        }
    }
    return ST_OK;
}

static void print_notes(const cell_lab_job *job, int x, int kind, const chunk *chunks,
                        size_t count) {
    int shown = 0;
    for (size_t at = 0; at < count; at++) {
        const fault_note *notes = chunks[at].notes[x][kind];
        for (int n = 0; n < SHOWN && notes[n].what && shown < SHOWN; n++, shown++)
            fprintf(job->log, "%s: %s, %s; rerun: %s cell %s %llu %llu %s\n", notes[n].what,
                    intersector_at(x)->name, cell_lab_name(job->which), job->rerun,
                    cell_lab_name(job->which), (unsigned long long)job->seed,
                    (unsigned long long)notes[n].index, intersector_at(x)->name);
    }
}

static void sum_up(const cell_lab_job *job, const chunk *chunks, size_t count, cell_lab_row *row) {
    memset(row, 0, sizeof *row);
    for (int x = 0; x < INTERSECTOR_COUNT; x++) {
        for (size_t at = 0; at < count; at++)
            add(&row->of[x], &chunks[at].row.of[x]);
        print_notes(job, x, 0, chunks, count);
        print_notes(job, x, 1, chunks, count);
    }
}

status cell_lab_run(pool *p, const cell_lab_job *job, cell_lab_row *row) {
    const size_t count = (size_t)((job->count + CHUNK - 1) / CHUNK);
    run_context run = {job, calloc(count ? count : 1, sizeof(chunk))};
    if (!run.chunks)
        return status_describe(ST_NOMEM, "no room for %zu parts", count);
    status st = pool_run(p, count, run_chunk, &run);
    if (st == ST_OK)
        sum_up(job, run.chunks, count, row);
    free(run.chunks);
    return st;
}

/* ---- tables ---- */

uint64_t cell_lab_faults(const cell_lab_tally *tally) {
    return tally->missed + tally->false_hits + tally->too_far + tally->disorder + tally->unlike +
           (tally->thin > tally->cells / 10000 ? tally->thin : 0);
}

double cell_lab_rms(const cell_lab_tally *tally) {
    return tally->matched ? sqrt(tally->sum_squares / (double)tally->matched) : 0;
}

static double share(uint64_t part, const cell_lab_tally *tally) {
    return tally->cells ? (double)part / (double)tally->cells : 0;
}

void cell_lab_heading(FILE *out) {
    fprintf(out, "%-16s %-9s %9s %9s %8s %8s %8s %6s %8s %8s %8s %8s\n", "case", "by", "ray-cells",
            "surfaces", "missed", "false", "too far", "thin", "worst", "rms", "in band", "excused");
}

void cell_lab_print(FILE *out, const char *name, const cell_lab_row *row) {
    for (int x = 0; x < INTERSECTOR_COUNT; x++) {
        const cell_lab_tally *t = &row->of[x];
        fprintf(out,
                "%-16s %-9s %9llu %9llu %8llu %8llu %8llu %6llu %8.1e %8.1e %7.3f%% %7.3f%%%s\n",
                name, intersector_at(x)->name, (unsigned long long)t->cells,
                (unsigned long long)t->surfaces, (unsigned long long)t->missed,
                (unsigned long long)t->false_hits, (unsigned long long)t->too_far,
                (unsigned long long)t->thin, t->worst, cell_lab_rms(t), 100 * share(t->grazing, t),
                100 * share(t->excused, t),
                t->disorder ? " DISORDER"
                : t->unlike ? " UNLIKE"
                            : "");
    }
    fflush(out);
}

void cell_lab_csv_heading(FILE *out) {
    fprintf(out, "case,intersector,ray_cells,surfaces,missed,false,too_far,thin,disorder,"
                 "unlike,worst_cells,rms_cells,in_band,excused\n");
}

void cell_lab_csv(FILE *out, const char *name, const cell_lab_row *row) {
    for (int x = 0; x < INTERSECTOR_COUNT; x++) {
        const cell_lab_tally *t = &row->of[x];
        fprintf(out, "%s,%s,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%.3g,%.3g,%llu,%llu\n", name,
                intersector_at(x)->name, (unsigned long long)t->cells,
                (unsigned long long)t->surfaces, (unsigned long long)t->missed,
                (unsigned long long)t->false_hits, (unsigned long long)t->too_far,
                (unsigned long long)t->thin, (unsigned long long)t->disorder,
                (unsigned long long)t->unlike, t->worst, cell_lab_rms(t),
                (unsigned long long)t->grazing, (unsigned long long)t->excused);
    }
    fflush(out);
}

/* ---- one again ---- */

static void show(const trial *t) {
    const ray_cell *c = &t->c;
    printf("o  %.17g %.17g %.17g\nd  %.17g %.17g %.17g\n", c->o[0], c->o[1], c->o[2], c->d[0],
           c->d[1], c->d[2]);
    printf("lo %.17g %.17g %.17g\nhi %.17g %.17g %.17g\nsamples", c->lo[0], c->lo[1], c->lo[2],
           c->hi[0], c->hi[1], c->hi[2]);
    for (int n = 0; n < 8; n++)
        printf(" %.9g", (double)c->samples[n]);
    printf("\niso %.17g, visited %d, grazing %d\n%-10s", c->iso, t->visited, t->grazing, "truth");
    for (int i = 0; i < t->truth_count; i++)
        printf(" %.20Lg", t->truth[i].t_exact);
    for (int x = 0; x < INTERSECTOR_COUNT; x++) {
        printf("\n%-10s", intersector_at(x)->name);
        for (int i = 0; i < t->of[x].count; i++)
            printf(" %.17g", t->of[x].t[i]);
    }
    printf("\n");
}

int cell_lab_rerun(int argc, char **argv) {
    const bool in_holes = argc >= 3 && strcmp(argv[0], HOLES_NAME) == 0;
    const int which = argc >= 3 ? ray_cell_case(argv[0]) : -1;
    unsigned exact = argc > 3 ? 0 : cell_lab_exact();
    if (which < 0 && !in_holes)
        return 2;
    for (int i = 3; i < argc; i++) {
        unsigned bit = 0;
        for (int x = 0; x < INTERSECTOR_COUNT; x++)
            bit |= (unsigned)(strcmp(argv[i], intersector_at(x)->name) == 0) << x;
        if (!bit)
            return 2;
        exact |= bit;
    }
    cell_lab_job job = {.which = which, .seed = strtoull(argv[1], NULL, 10)};
    holes *h = in_holes ? holes_make(job.seed) : NULL;
    job.h = h;
    trial t;
    int bad = 0;
    batch_lab batch;
    memset(&batch, 0, sizeof batch);
    /* With the lanes that were beside it. */
    const uint64_t index = strtoull(argv[2], NULL, 10), start = index / CHUNK * CHUNK;
    for (uint64_t i = index < start + CELL_BATCH ? start : index - CELL_BATCH; i <= index; i++)
        try_cell(&job, i, &batch, &t);
    holes_free(h);
    show(&t);
    for (int x = 0; x < INTERSECTOR_COUNT; x++) {
        cell_lab_tally sum = {0};
        const char *fault = judge(&t, x, &sum);
        if (fault && (exact >> x & 1u)) {
            printf("%s: %s, error %.3g cells\n", fault, intersector_at(x)->name, sum.worst);
            bad = 1;
        }
    }
    return bad;
}
