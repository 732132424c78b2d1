/* expansion.h - sums and products of doubles without any rounding (Shewchuk 1997).
 *
 * A number is a sum of doubles that do not overlap, smallest first, zeros left out. Exact while
 * nothing overflows or underflows: three factors between 1e-90 and 1e90 never do. No FMA, so the
 * same bits everywhere.
 */
#ifndef FORMATS_BASE_EXPANSION_H
#define FORMATS_BASE_EXPANSION_H

enum { EXPANSION_MAX = 192 }; /* terms of a 3 x 3 determinant of differences */

typedef struct expansion {
    int terms;
    double term[EXPANSION_MAX];
} expansion;

/* expansion_difference() - a - b. */
void expansion_difference(expansion *e, double a, double b);

/* expansion_add() - to += x; expansion_subtract() - to -= x. to and x differ. */
void expansion_add(expansion *to, const expansion *x);
void expansion_subtract(expansion *to, const expansion *x);

/* expansion_multiply() - e = a b; twice a's terms times b's fit. e is neither. */
void expansion_multiply(expansion *e, const expansion *a, const expansion *b);

/* expansion_value() - its sign is exact, its size right to a few bits of a double's last. */
double expansion_value(const expansion *e);

#endif
