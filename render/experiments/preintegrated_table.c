#include "render/experiments/preintegrated_table.h"

#include "render/medium/medium_stretch.h"

typedef struct making {
    preintegrated_table *table;
    medium_rule rule;
    double range[2];
} making;

static double value_of(const making *k, int entry) {
    const double share = (double)entry / (k->table->side - 1);
    return (1.0 - share) * k->range[0] + share * k->range[1];
}

static status make_row(void *ctx, size_t front, int worker) {
    const making *k = ctx;
    const preintegrated_table *t = k->table;
    (void)worker;
    for (int back = 0; back < t->side; back++) {
        const segment piece = {
            .t1 = t->step, .b = {value_of(k, (int)front), value_of(k, back)}, .degree = 1};
        const medium_stretch s = medium_of_piece(&k->rule, &piece);
        t->entry[front * (size_t)t->side + (size_t)back] = (preintegrated_entry){
            (float)s.rgb[0], (float)s.rgb[1], (float)s.rgb[2], (float)s.through};
    }
    return ST_OK;
}

status preintegrated_table_make(preintegrated_table *t, mem *m, pool *threads,
                                const transfer *medium, const double range[2], double step,
                                int side) {
    const double error = 1e-5; /* the most, of all steps of a ray together */
    making k = {.table = t,
                .rule = {.transfer = medium,
                         .share = error,
                         .per_length = error / step,
                         .drop = 1e-3 * error},
                .range = {range[0], range[1]}};
    *t = (preintegrated_table){.side = side, .least = range[0], .step = step};
    if (!(range[0] <= range[1])) /* no value is finite, so no piece will come */
        k.range[0] = k.range[1] = t->least = 0.0;
    if (k.range[0] < k.range[1])
        t->scale = (side - 1) / (k.range[1] - k.range[0]);
    t->entry = mem_array(m, (size_t)side * (size_t)side, sizeof *t->entry);
    return t->entry ? pool_run(threads, (size_t)side, make_row, &k) : ST_NOMEM;
}

void preintegrated_table_release(preintegrated_table *t, mem *m) {
    mem_free(m, t->entry);
    *t = (preintegrated_table){0};
}
