/* curvilinear_steps.h - a curvilinear grid of arrays, as a reader would hand it over: with several
 * fields and steps that follow from those of the zones.
 */
#ifndef TESTS_SUPPORT_CURVILINEAR_STEPS_H
#define TESTS_SUPPORT_CURVILINEAR_STEPS_H

#include "prep/curvilinear/curvilinear_convert.h"
#include "tests/support/curvilinear_file.h"

enum { CURVILINEAR_STEPS_ZONES = 4 };

typedef struct curvilinear_steps {
    const curvilinear_zone *zones;
    bool moves;          /* nodes are elsewhere at each step */
    uint32_t fails_from; /* from this step on, reading fails; 0: never */
    uint32_t before;     /* the series' first step is the one behind so many */
    curvilinear_series series;
    /* Inside: */
    curvilinear_source source;
    uint32_t nodes[CURVILINEAR_STEPS_ZONES][3], step;
} curvilinear_steps;

/* curvilinear_steps_init() - of up to CURVILINEAR_STEPS_ZONES zones; s must not be moved then. */
void curvilinear_steps_init(curvilinear_steps *s, const curvilinear_zone zones[], uint32_t count,
                            uint32_t fields, uint32_t steps);

/* curvilinear_steps_value(), curvilinear_steps_place() - what the source tells of a node, before
 * blanks. */
float curvilinear_steps_value(const curvilinear_steps *s, uint32_t zone, size_t node,
                              uint32_t field, uint32_t step);
void curvilinear_steps_place(const curvilinear_steps *s, uint32_t zone, size_t node, uint32_t step,
                             float out[3]);

#endif
