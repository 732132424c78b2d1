#include "prep/generate/generate_steps.h"

#include <limits.h>
#include <stdio.h>
#include <unistd.h>

#include "formats/base/sequence.h"

status generate_steps_name(const char *output, uint32_t steps, uint32_t step, char *out) {
    if (steps > 0)
        return sequence_name(output, (int)step, out, PATH_MAX);
    if (snprintf(out, PATH_MAX, "%s", output) < PATH_MAX)
        return ST_OK;
    return status_describe(ST_USAGE, "the name of a file is longer than %d bytes", PATH_MAX - 1);
}

status generate_steps_check(const char *output, uint32_t steps, bool force) {
    char path[PATH_MAX];
    status st = ST_OK;
    for (uint32_t step = 0; st == ST_OK && step < steps; step++) {
        st = generate_steps_name(output, steps, step, path);
        if (st == ST_OK && !force && access(path, F_OK) == 0)
            st = status_describe(ST_EXISTS, "%s exists (--force overwrites)", path);
    }
    return st;
}

double generate_steps_time(uint32_t steps, uint32_t step) {
    return steps > 1 ? step / (steps - 1.0) : 0;
}
