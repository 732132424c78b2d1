#include "tests/support/batch_lab.h"

#include <string.h>

bool batch_lab_put(batch_lab *b, const ray *r, const cell_box *box, const float samples[8]) {
    for (int i = 0; i < 8; i++)
        if (!isfinite(samples[i]))
            return false;
    if (r->d[0] == 0 || r->d[1] == 0 || r->d[2] == 0)
        return false;
    b->next = (b->next + 1) % CELL_BATCH;
    for (int k = 0; k < CELL_BATCH; k++) {
        if (b->full && k != b->next)
            continue;
        for (int a = 0; a < 3; a++) {
            b->lanes.d[a][k] = r->d[a];
            b->lanes.lo[a][k] = box->lo[a] - r->o[a];
            b->lanes.hi[a][k] = box->hi[a] - r->o[a];
            b->lanes.inv[a][k] = box->inv[a];
        }
        b->lanes.t0[k] = r->t0;
        b->lanes.t1[k] = r->t1;
        for (int i = 0; i < 8; i++)
            b->lanes.samples[i][k] = samples[i];
    }
    b->full = true;
    return true;
}

unsigned batch_lab_unlike(const batch_lab *b, double iso, const hit *first) {
    unsigned unlike = 0;
    for (int isa = CPU_SCALAR; isa <= (int)cpu_best(); isa++) {
        cell_batch_hits hits = {.found = 0};
        cell_batch_kernels[(cpu_isa)isa](&b->lanes, CELL_BATCH, &iso, 1, &hits);
        const bool found = hits.found >> b->next & 1u, entering = hits.entering >> b->next & 1u;
        bool alike = found == (first != NULL);
        if (found && first)
            alike = memcmp(&hits.t[b->next], &first->t, sizeof first->t) == 0 &&
                    entering == first->entering && hits.iso[b->next] == 0;
        unlike |= (unsigned)!alike << isa;
    }
    return unlike;
}
