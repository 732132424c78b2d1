#include "tests/support/tet_lab.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/tet_kernel.h"
#include "tests/support/tet_hit.h"
#include "tests/support/tet_meshes.h"

enum { HITS_MAX = 64, RAYS_A_MESH = 64, SHOWN = 3 };

/* A mesh, and the tetrahedra as the kernel wants them. */
typedef struct subject {
    lab_mesh m;
    tet_ref *r;
    tet *tets;
    uint64_t *index; /* of each in m */
    size_t count;
} subject;

/* What both say of one ray. */
typedef struct answer {
    ref_ray ray;
    lab_ray kind;
    ref_hit truth[HITS_MAX];
    size_t truth_count;
    hit hits[HITS_MAX];
    size_t hit_count;
    bool on_surface; /* it begins there: those hits are left out */
} answer;

/* ---- meshes ---- */

/* Vertices in ascending order; false for what an importer leaves out. */
static bool tet_of(const lab_mesh *m, const uint32_t ids[4], tet *x) {
    uint32_t v[4];
    memcpy(v, ids, sizeof v);
    for (int i = 1; i < 4; i++)
        for (int k = i; k > 0 && v[k] < v[k - 1]; k--) {
            uint32_t swap = v[k];
            v[k] = v[k - 1];
            v[k - 1] = swap;
        }
    for (int i = 0; i < 4; i++) {
        if (v[i] >= m->point_count || (i > 0 && v[i] == v[i - 1]))
            return false;
        memcpy(x->p[i], m->points[v[i]], sizeof x->p[i]);
        x->f[i] = m->values[v[i]];
    }
    return true;
}

static void open_subject(subject *p, int which, uint64_t seed) {
    field_random r = {seed};
    seed = field_random_bits(&r);
    int side = 2 + (int)field_random_below(&r, 3);
    if (!lab_mesh_make(&p->m, lab_mesh_name(which), side, seed))
        abort();
    tet_ref_mesh raw = lab_mesh_reference(&p->m);
    p->r = tet_ref_create(&raw);
    p->tets = malloc(p->m.tet_count * sizeof *p->tets);
    p->index = malloc(p->m.tet_count * sizeof *p->index);
    if (!p->r || !p->tets || !p->index)
        abort(); /* a test's own memory */
    p->count = 0;
    for (size_t i = 0; i < p->m.tet_count; i++)
        if (tet_of(&p->m, p->m.tets[i], &p->tets[p->count]))
            p->index[p->count++] = i;
}

static void close_subject(subject *p) {
    tet_ref_destroy(p->r);
    free(p->tets);
    free(p->index);
    lab_mesh_release(&p->m);
}

/* ---- one ray ---- */

static int compare_hits(const void *a, const void *b) {
    return hit_less(a, b) ? -1 : hit_less(b, a);
}

/* All hits of all tetrahedra, in order, doubles left out. */
static size_t kernel_hits(const subject *p, const ref_ray *from, hit *hits) {
    ray r = {.t0 = 0, .t1 = INFINITY};
    size_t count = 0, kept = 0;
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = from->o[a];
        r.d[a] = from->d[a] + 0.0;
    }
    for (size_t i = 0; i < p->count; i++) {
        hit after = hit_before_all(), found;
        while (count < HITS_MAX &&
               tet_hit(&p->tets[i], &r, &p->m.iso, 1, p->index[i], &after, &found)) {
            hits[count++] = found;
            after = found;
        }
    }
    qsort(hits, count, sizeof hits[0], compare_hits);
    for (size_t i = 0; i < count; i++) {
        bool seen = false;
        for (size_t k = 0; k < kept; k++)
            seen |= flat_polygon_double(&hits[k], &hits[i]);
        if (!seen)
            hits[kept++] = hits[i];
    }
    return kept;
}

/* Leave out what both see where the ray begins. */
static void leave_start(const subject *p, answer *x) {
    const double *d = x->ray.d, length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    size_t truths = 0, hits = 0;
    if (x->kind != LAB_RAY_INSIDE && x->kind != LAB_RAY_ON_VERTEX)
        return;
    tet_ref_mesh raw = lab_mesh_reference(&p->m);
    for (size_t i = 0; i < x->truth_count; i++)
        if (fabs(x->truth[i].t) * x->truth[i].cells_per_t > 1e-6)
            x->truth[truths++] = x->truth[i];
    for (size_t i = 0; i < x->hit_count; i++)
        if (fabs(x->hits[i].t) * length > 1e-6 * tet_ref_local_edge(&raw, x->hits[i].cell))
            x->hits[hits++] = x->hits[i];
    x->on_surface = truths < x->truth_count || hits < x->hit_count;
    x->truth_count = truths;
    x->hit_count = hits;
}

static void ask(const subject *p, uint64_t seed, uint64_t index, answer *x) {
    field_random r = {seed ^ (index + 1) * UINT64_C(0x9e3779b97f4a7c15)};
    x->kind = (lab_ray)(index % LAB_RAY_KINDS);
    x->ray = lab_mesh_ray(&p->m, x->kind, &r);
    x->truth_count = tet_ref_trace(p->r, &x->ray, &p->m.iso, 1, NULL, x->truth, HITS_MAX);
    x->truth_count = x->truth_count < HITS_MAX ? x->truth_count : HITS_MAX;
    x->hit_count = kernel_hits(p, &x->ray, x->hits);
    x->on_surface = false;
    leave_start(p, x);
}

/* ---- judging ---- */

/* Whether a closed surface must stop the ray, and the t before which it must do so. */
static bool must_stop(const subject *p, const answer *x, double *before) {
    if (!p->m.closed || x->on_surface)
        return false;
    size_t n = 0;
    *before = INFINITY;
    if (x->kind == LAB_RAY_INSIDE || x->kind == LAB_RAY_ON_VERTEX)
        return p->m.sound && x->truth_count % 2 == 1; /* what is inside of a flat one? */
    for (size_t i = 0; i < x->truth_count; i++) {
        if (fabs(x->truth[i].t - 1) * x->truth[i].cells_per_t < 1e-6)
            return false;
        n += x->truth[i].t < 1;
    }
    *before = 1;
    return n % 2 == 1;
}

/* Whether f at t is above iso by more than rounding, in every tetrahedron there. */
static bool is_above(const subject *p, const ref_ray *along, double t, double *edge) {
    tet_ref_mesh raw = lab_mesh_reference(&p->m);
    bool above = false;
    for (size_t i = 0; i < p->count; i++) {
        long double at[2], f[2], most = 0;
        if (!tet_ref_crossings(&raw, p->index[i], along, at, f) || at[0] > t || at[1] < t)
            continue;
        long double share = at[1] > at[0] ? (t - at[0]) / (at[1] - at[0]) : 0;
        for (int k = 0; k < 4; k++)
            most = fmaxl(most, fabsl(p->tets[i].f[k] - (long double)p->m.iso));
        if (f[0] + share * (f[1] - f[0]) - p->m.iso < 1e-9L * most)
            return false;
        *edge = tet_ref_local_edge(&raw, p->index[i]);
        above = true;
    }
    return above;
}

/* The same, and around it: not on a sheet, or a thread, where f = iso between all that is below,
 * nor on the face of a tetrahedron that falls to -1e30 behind it. */
static bool is_solid(const subject *p, const answer *x, double t) {
    double edge, unused;
    if (!is_above(p, &x->ray, t, &edge))
        return false;
    for (int n = 0; n < REF_SIDEWAYS; n++) {
        const long double d[3] = {x->ray.d[0], x->ray.d[1], x->ray.d[2]};
        long double towards[3];
        ref_ray moved = x->ray;
        ref_sideways(d, n, towards);
        for (int a = 0; a < 3; a++)
            moved.o[a] += (double)(1e-9L * edge * towards[a]);
        if (!is_above(p, &moved, t, &unused))
            return false;
    }
    return true;
}

/* Whether the way through a surface's tetrahedron is no longer than rounding: which end comes first
 * is then anyone's guess, and with it the reference's side. */
static bool is_touched(const subject *p, const ref_ray *along, const ref_hit *h) {
    tet_ref_mesh raw = lab_mesh_reference(&p->m);
    long double at[2], f[2];
    return tet_ref_crossings(&raw, (size_t)h->cell, along, at, f) &&
           (at[1] - at[0]) * h->cells_per_t < 1e-12L;
}

/* Whether surfaces i of both lists, of equal length, stand apart from the others and differ in
 * their sides. */
static bool wrong_side(const subject *p, const answer *x, size_t i) {
    const ref_hit *h = x->truth;
    for (size_t k = i ? i - 1 : 0; k <= i + 1 && k < x->truth_count; k++)
        if (k != i && fabs(h[k].t - h[i].t) * h[i].cells_per_t < 1e-4)
            return false;
    return x->hits[i].entering == h[i].from_inside && !is_touched(p, &x->ray, &h[i]);
}

static bool is_grazing(const subject *p, const answer *x) {
    size_t depth = x->truth_count < HITS_MAX ? x->truth_count + 1 : HITS_MAX;
    return tet_judge_excused(p->r, &x->ray, &p->m.iso, 1, NULL, depth);
}

/* Whether the kernel's hit lies on a corner of its polygon: where f = iso on an edge. */
static bool at_corner(const subject *p, const answer *x, const hit *h) {
    const uint32_t *ids = p->m.tets[h->cell];
    tet_ref_mesh raw = lab_mesh_reference(&p->m);
    const long double near = 1e-7L * tet_ref_local_edge(&raw, h->cell);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            long double f = p->m.values[ids[i]] - (long double)p->m.iso;
            long double g = p->m.values[ids[k]] - (long double)p->m.iso;
            bool here = f < 0 && g >= 0;
            for (int a = 0; a < 3; a++) {
                long double from = p->m.points[ids[i]][a], to = p->m.points[ids[k]][a];
                long double corner = from + (to - from) * (f / (f - g));
                long double at = x->ray.o[a] + (long double)h->t * x->ray.d[a];
                here = here && fabsl(corner - at) <= near;
            }
            if (here)
                return true;
        }
    return false;
}

/* Distances, but for corners that the kernel alone sees; returns how many. */
static size_t without_touches(const subject *p, const answer *x, double t[HITS_MAX]) {
    size_t count = 0;
    for (size_t i = 0; i < x->hit_count; i++) {
        bool both = false;
        for (size_t k = 0; k < x->truth_count; k++)
            both |= fabs(x->truth[k].t - x->hits[i].t) * x->truth[k].cells_per_t < 1e-6;
        if (both || !at_corner(p, x, &x->hits[i]))
            t[count++] = x->hits[i].t;
    }
    return count;
}

/* Whether the kernel sees two surfaces in one point, as far as doubles tell points apart. */
static bool has_touch(const answer *x) {
    for (size_t i = 0; i + 1 < x->hit_count; i++)
        if (x->hits[i + 1].t - x->hits[i].t <= 8 * DBL_EPSILON * x->hits[i].t)
            return true;
    return false;
}

/* Numbers and sides of surfaces, where their places are right. */
static const char *judge_sides(const subject *p, const answer *x, tet_lab_row *row) {
    if (!p->m.sound || x->on_surface)
        return NULL;
    if (p->m.closed && x->hit_count % 2 != x->truth_count % 2 && !is_grazing(p, x)) {
        if (has_touch(x)) {
            row->touches++;
            return NULL;
        }
        row->uneven++;
        return "uneven";
    }
    for (size_t i = 0; i < x->truth_count && x->hit_count == x->truth_count; i++)
        if (wrong_side(p, x, i) && !is_grazing(p, x)) {
            row->sides++;
            return "side";
        }
    return NULL;
}

/* Counts; returns what is wrong, or NULL. */
static const char *judge(const subject *p, const answer *x, tet_lab_row *row) {
    double t[HITS_MAX], before;
    tet_lab_row once = {0};
    for (size_t i = 0; i < x->hit_count; i++)
        t[i] = x->hits[i].t;
    if (must_stop(p, x, &before)) {
        bool leaks = (x->hit_count == 0 || t[0] >= before) && is_solid(p, x, before < 2 ? 1 : 0);
        row->stopped++;
        /* Within a sheet as thin as rounding the rounded surface may lie beside the ray. */
        if (leaks && (p->m.sound || !is_grazing(p, x))) {
            row->leaks++;
            return "leak";
        }
    }
    ref_verdict verdict = tet_judge_hits(&once.tally, p->r, &x->ray, p->m.iso, NULL, x->truth,
                                         x->truth_count, t, x->hit_count);
    if (verdict == REF_FALSE_HIT) {
        size_t untouched = without_touches(p, x, t);
        once = (tet_lab_row){.touches = untouched < x->hit_count};
        verdict = tet_judge_hits(&once.tally, p->r, &x->ray, p->m.iso, NULL, x->truth,
                                 x->truth_count, t, untouched);
    }
    tet_lab_add(row, &once);
    if (verdict == REF_GRAZING)
        return NULL;
    if (verdict != REF_SAME)
        return ref_verdict_name(verdict);
    return judge_sides(p, x, row);
}

static uint64_t mesh_seed(uint64_t seed, uint64_t index) {
    return seed * UINT64_C(1000003) + index / RAYS_A_MESH;
}

void tet_lab_run(const tet_lab_job *job, tet_lab_row *row) {
    subject p;
    answer x;
    int shown = 0;
    *row = (tet_lab_row){0};
    for (uint64_t i = job->first; i < job->first + job->count; i++) {
        if (i == job->first || i % RAYS_A_MESH == 0) {
            if (i != job->first)
                close_subject(&p);
            open_subject(&p, job->which, mesh_seed(job->seed, i));
        }
        ask(&p, job->seed, i, &x);
        const char *fault = judge(&p, &x, row);
        if (fault && job->log && shown++ < SHOWN)
            fprintf(job->log, "%s: %s, %s ray: %zu surfaces for %zu; rerun: %s %s %llu %llu\n",
                    lab_mesh_name(job->which), fault, lab_ray_name(x.kind), x.hit_count,
                    x.truth_count, job->rerun, lab_mesh_name(job->which),
                    (unsigned long long)job->seed, (unsigned long long)i);
    }
    if (job->count > 0)
        close_subject(&p);
}

/* ---- telling ---- */

void tet_lab_add(tet_lab_row *to, const tet_lab_row *from) {
    ref_tally_add(&to->tally, &from->tally);
    to->stopped += from->stopped;
    to->leaks += from->leaks;
    to->sides += from->sides;
    to->uneven += from->uneven;
    to->touches += from->touches;
}

uint64_t tet_lab_faults(const tet_lab_row *row) {
    return ref_tally_faults(&row->tally) + row->leaks + row->sides + row->uneven;
}

void tet_lab_heading(FILE *out) {
    fprintf(out, "%-22s %9s %9s %7s %7s %7s %7s %7s %7s %8s %8s %9s %7s %9s\n", "case", "rays",
            "surfaces", "missed", "false", "too_far", "leaks", "sides", "uneven", "worst", "rms",
            "excused", "touches", "stopped");
}

void tet_lab_print(FILE *out, const char *name, const tet_lab_row *row) {
    const ref_tally *t = &row->tally;
    const uint64_t counts[] = {t->rays,    t->hits,    t->missed,  t->false_hits,
                               t->too_far, row->leaks, row->sides, row->uneven};
    fprintf(out, "%-22s", name);
    for (int i = 0; i < 8; i++)
        fprintf(out, " %*llu", i < 2 ? 9 : 7, (unsigned long long)counts[i]);
    double share = t->rays ? 100 * (double)t->grazing / (double)t->rays : 0;
    fprintf(out, " %8.1e %8.1e %8.4f%% %7llu %9llu\n", t->worst, ref_tally_rms(t), share,
            (unsigned long long)row->touches, (unsigned long long)row->stopped);
}

bool tet_lab_show(int which, uint64_t seed, uint64_t index) {
    subject p;
    answer x;
    tet_lab_row row = {0};
    open_subject(&p, which, mesh_seed(seed, index));
    ask(&p, seed, index, &x);
    const char *fault = judge(&p, &x, &row);
    printf("%s: %zu tetrahedra, %s ray from %a %a %a along %a %a %a: %s\n", p.m.name, p.m.tet_count,
           lab_ray_name(x.kind), x.ray.o[0], x.ray.o[1], x.ray.o[2], x.ray.d[0], x.ray.d[1],
           x.ray.d[2],
           fault               ? fault
           : row.tally.grazing ? "excused"
                               : "no fault");
    for (size_t i = 0; i < x.truth_count; i++)
        printf("  reference: t %.17g tet %lld from %s, an edge is %.3g\n", x.truth[i].t,
               (long long)x.truth[i].cell, x.truth[i].from_inside ? "inside" : "outside",
               1 / x.truth[i].cells_per_t);
    for (size_t i = 0; i < x.hit_count; i++)
        printf("  kernel:    t %.17g tet %llu from %s\n", x.hits[i].t,
               (unsigned long long)x.hits[i].cell, x.hits[i].entering ? "outside" : "inside");
    close_subject(&p);
    return fault != NULL;
}
