#include "prep/export/sample_times.h"

#include <math.h>

static const double TOLERANCE = 1e-6;

static bool is_even(const leaf_file *f, double first, double apart) {
    for (uint32_t i = 1; i < f->header.steps; i++)
        if (!(fabs(leaf_file_step_time(f, i) - (first + i * apart)) <= TOLERANCE * apart))
            return false;
    return true;
}

sample_times sample_times_of(const leaf_file *f, bool all) {
    const uint32_t steps = f->header.steps;
    sample_times t = {.steps = all ? steps : 1, .apart = 1, .unit = ""};
    if (!all || !f->has_times || steps < 2)
        return t;
    const double first = leaf_file_step_time(f, 0);
    const double apart = (leaf_file_step_time(f, steps - 1) - first) / (steps - 1);
    t.uneven = !is_even(f, first, apart);
    if (t.uneven)
        return t;
    t.first = first;
    t.apart = apart;
    t.unit = f->frame.time_unit;
    return t;
}
