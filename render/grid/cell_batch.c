#include "render/grid/cell_batch.h"

#include "render/grid/cell_kernel.h"

/* Find where one lane's ray visits its cell. Returns false if it does not. */
static bool visit_of(const cell_batch *b, int lane, ray *r, float samples[8], cell_visit *visit) {
    cell_box box;
    *r = (ray){.t0 = b->t0[lane], .t1 = b->t1[lane]};
    for (int a = 0; a < 3; a++) {
        r->d[a] = b->d[a][lane];
        box.lo[a] = b->lo[a][lane];
        box.hi[a] = b->hi[a][lane];
        box.inv[a] = b->inv[a][lane];
        box.last[a] = false; /* matters to rays with d = 0 only */
    }
    for (int i = 0; i < 8; i++)
        samples[i] = b->samples[i][lane];
    return cell_visit_of(r, &box, visit);
}

/* Returns one lane's first hit, with cell number 0, or hit_none(). Sets *t_out to where the visit
 * ends. */
static hit first_hit(const cell_batch *b, int lane, const double *isovalues, int count,
                     double *t_out) {
    const hit start = hit_before_all();
    hit best = hit_none();
    ray r;
    float samples[8];
    cell_visit visit;
    if (!visit_of(b, lane, &r, samples, &visit))
        return best;
    *t_out = visit.t_out;
    for (int i = 0; i < count; i++) {
        hit h;
        if (cell_next_hit(&r, &visit, samples, isovalues[i], i, 0, &start, &h) &&
            hit_less(&h, &best))
            best = h;
    }
    return best;
}

static void cell_batch_scalar(const cell_batch *b, int lanes, const double *isovalues, int count,
                              cell_batch_hits *out) {
    out->found = out->entering = out->at_exit = 0;
    for (int k = 0; k < lanes; k++) {
        double t_out = 0.0;
        const hit h = first_hit(b, k, isovalues, count, &t_out);
        if (h.cell != 0)
            continue;
        out->t[k] = h.t;
        out->iso[k] = h.iso;
        out->found |= 1u << k;
        out->entering |= (uint32_t)h.entering << k;
        out->at_exit |= (uint32_t)(h.t == t_out) << k;
    }
}

static void cell_roots_scalar(const cell_batch *b, int lanes, double isovalue,
                              cell_batch_roots *out) {
    *out = (cell_batch_roots){.found = {0}};
    for (int k = 0; k < lanes; k++) {
        ray r;
        float samples[8];
        cell_visit visit;
        double control[4], roots[CELL_ROOTS_MAX];
        if (!visit_of(b, k, &r, samples, &visit) || !cell_cubic(&visit, samples, isovalue, control))
            continue;
        const int count = cell_roots(control, roots);
        const bool outside = !(control[0] >= 0.0);
        for (int n = 0; n < count; n++) {
            out->t[n][k] = cell_root_t(&visit, roots[n]);
            out->found[n] |= 1u << k;
            out->entering[n] |= (uint32_t)(outside == (n % 2 == 0)) << k;
            out->at_exit[n] |= (uint32_t)(out->t[n][k] == visit.t_out) << k;
        }
    }
}

CPU_KERNELS(cell_batch_fn, cell_batch_kernels, cell_batch_scalar, cell_batch);
CPU_KERNELS(cell_roots_fn, cell_roots_kernels, cell_roots_scalar, cell_roots);
