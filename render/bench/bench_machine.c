#include "render/bench/bench_machine.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "formats/base/cpu.h"
#include "formats/base/pool.h"
#include "render/leafcast.h"

enum { LINE_MAX_BYTES = 512, MODEL_MAX = BENCH_MACHINE_MAX / 2 };

/* What a line "key : X" has, into text; left as it is where the line is another. */
static void take_value(const char *line, const char *key, char *text, size_t size) {
    const size_t length = strlen(key);
    if (strncmp(line, key, length) != 0 || line[length + strspn(line + length, "\t ")] != ':')
        return;
    const char *value = strchr(line, ':') + 1;
    value += strspn(value, " ");
    snprintf(text, size, "%.*s", (int)strcspn(value, "\n"), value);
}

/* The CPU by its name, which may leave its generation open, and by its numbers, which do not. "":
 * the kernel does not say. */
static void find_model(char model[MODEL_MAX]) {
    char line[LINE_MAX_BYTES], name[MODEL_MAX / 2] = "", family[16] = "", number[16] = "";
    FILE *f = fopen("/proc/cpuinfo", "re");
    while (f && fgets(line, sizeof line, f) && line[0] != '\n') {
        take_value(line, "model name", name, sizeof name);
        take_value(line, "cpu family", family, sizeof family);
        take_value(line, "model", number, sizeof number);
    }
    if (f)
        fclose(f);
    if (family[0] && number[0])
        snprintf(model, MODEL_MAX, "%s (family %s, model %s)", name, family, number);
    else
        snprintf(model, MODEL_MAX, "%s", name);
}

void bench_machine(cpu_isa isa, const char *commit, char text[BENCH_MACHINE_MAX]) {
    char model[MODEL_MAX], date[16] = "";
    const time_t now = time(NULL);
    struct tm utc;
    find_model(model);
    if (gmtime_r(&now, &utc))
        strftime(date, sizeof date, "%Y-%m-%d", &utc);
    snprintf(text, BENCH_MACHINE_MAX, "%s%s%d CPUs, %s; %s; leafcast %s%s%s", model,
             model[0] ? ", " : "", pool_default_threads(), cpu_isa_name(isa), date,
             leafcast_version(), commit[0] ? ", " : "", commit);
}
