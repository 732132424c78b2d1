#include "formats/grid/ngff_units.h"

#include <stddef.h>
#include <string.h>

static const char *const units[][2] = {
    {"pm", "picometer"},   {"nm", "nanometer"},   {"um", "micrometer"}, {"mm", "millimeter"},
    {"cm", "centimeter"},  {"m", "meter"},        {"km", "kilometer"},  {"ns", "nanosecond"},
    {"us", "microsecond"}, {"ms", "millisecond"}, {"s", "second"},      {"min", "minute"},
    {"h", "hour"},         {"d", "day"},
};

static const char *find(const char *unit, int from) {
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcmp(unit, units[i][from]) == 0)
            return units[i][!from];
    return unit;
}

const char *ngff_units_name(const char *symbol) {
    return find(symbol, 0);
}

const char *ngff_units_symbol(const char *name) {
    return find(name, 1);
}
