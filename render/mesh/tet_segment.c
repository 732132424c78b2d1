#include "render/mesh/tet_segment.h"

#include "render/mesh/tet_sight.h"

bool tet_segment(const tet *x, const ray *r, tet_piece *out) {
    tet_sight s;
    int crossed[2], count = 0;
    s.tests = 0;
    tet_sight_begin(&s, x, r);
    for (int i = 0; i < TET_FACES && count < 2; i++)
        if (tet_sight_crosses(&s, i))
            crossed[count++] = i;
    const int orientation = count == 2 ? exact_orientation((const double(*)[3])s.p) : 0;
    if (orientation == 0)
        return false;
    const bool enters = tet_sight_enters(&s, crossed[0], orientation);
    tet_sight_meet(&s, crossed[0], &out->t[!enters], &out->f[!enters]);
    tet_sight_meet(&s, crossed[1], &out->t[enters], &out->f[enters]);
    return true;
}
