/* curvilinear_input_facts.h - what is told of a curvilinear grid that is an input: a row of
 * input_facts.c.
 *
 * It is read once; two planes of a zone are in memory.
 */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_INPUT_FACTS_H
#define FORMATS_CURVILINEAR_CURVILINEAR_INPUT_FACTS_H

#include "formats/input_facts_kind.h"

enum { CURVILINEAR_FACTS_ZONES = 16 };

/* Facts of its own. The last three only if the values were read. */
typedef struct curvilinear_input_facts {
    uint32_t zones;
    uint32_t nodes[CURVILINEAR_FACTS_ZONES][3]; /* of the first zones, along i, j, k */
    uint64_t total;                             /* nodes of all zones */
    bool flows;
    double flow[4]; /* of the first zone: Mach, angle of attack, Reynolds number, time */
    uint64_t cells; /* all eight corners are nodes */
    uint64_t blanked;
    float bounds[6]; /* lo, hi */
} curvilinear_input_facts;

/* curvilinear_input_facts_of() - returns those of an input of this kind. */
const curvilinear_input_facts *curvilinear_input_facts_of(const input_facts *x);

extern const input_facts_kind curvilinear_input_facts_kind;

#endif
