#include "render/bench/bench_machine.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "formats/base/cpu.h"
#include "formats/base/pool.h"
#include "render/leafcast.h"

enum { LINE_MAX_BYTES = 512 };

/* Of a line "model name : X"; false where it is another. */
static bool model_in(const char *line, char model[BENCH_MACHINE_MAX / 2]) {
    static const char key[] = "model name";
    const char *colon = strchr(line, ':');
    if (!colon || strncmp(line, key, sizeof key - 1) != 0)
        return false;
    colon += 1 + strspn(colon + 1, " ");
    snprintf(model, BENCH_MACHINE_MAX / 2, "%.*s", (int)strcspn(colon, "\n"), colon);
    return true;
}

/* "": the kernel does not say. */
static void find_model(char model[BENCH_MACHINE_MAX / 2]) {
    char line[LINE_MAX_BYTES];
    FILE *f = fopen("/proc/cpuinfo", "re");
    model[0] = 0;
    while (f && fgets(line, sizeof line, f) && !model_in(line, model))
        continue;
    if (f)
        fclose(f);
}

void bench_machine(cpu_isa isa, const char *commit, char text[BENCH_MACHINE_MAX]) {
    char model[BENCH_MACHINE_MAX / 2], date[16] = "";
    const time_t now = time(NULL);
    struct tm utc;
    find_model(model);
    if (gmtime_r(&now, &utc))
        strftime(date, sizeof date, "%Y-%m-%d", &utc);
    snprintf(text, BENCH_MACHINE_MAX, "%s%s%d CPUs, %s; %s; leafcast %s%s%s", model,
             model[0] ? ", " : "", pool_default_threads(), cpu_isa_name(isa), date,
             leafcast_version(), commit[0] ? ", " : "", commit);
}
