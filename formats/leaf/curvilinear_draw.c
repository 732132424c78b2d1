#include "formats/leaf/curvilinear_draw.h"

void curvilinear_draw_begin(curvilinear_draw *d, const histogram_run *runs, uint64_t first,
                            const uint32_t cells[3]) {
    *d = (curvilinear_draw){.runs = runs, .first = first, .cells = cells};
    d->end = first + (uint64_t)cells[0] * cells[1] * cells[2];
    d->next = runs->step ? first / runs->step : 0;
}

bool curvilinear_draw_next(curvilinear_draw *d) {
    while (d->next < d->runs->count && d->next * d->runs->step < d->end) {
        d->run = (uint32_t)d->next++;
        const uint64_t cell = histogram_draw_tet(d->runs, d->run);
        if (cell < d->first || cell >= d->end)
            continue;
        const uint32_t n = (uint32_t)(cell - d->first), *cells = d->cells;
        d->place[0] = n % cells[0];
        d->place[1] = n / cells[0] % cells[1];
        d->place[2] = n / (cells[0] * cells[1]);
        d->node = d->place[0] + (cells[0] + 1) * (d->place[1] + (cells[1] + 1) * d->place[2]);
        return true;
    }
    return false;
}
