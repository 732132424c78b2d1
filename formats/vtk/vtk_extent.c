#include "formats/vtk/vtk_extent.h"

bool vtk_extent_holds(const vtk_extent *outer, const vtk_extent *inner) {
    for (int a = 0; a < 3; a++)
        if (inner->lo[a] < outer->lo[a] || inner->hi[a] > outer->hi[a])
            return false;
    return true;
}

bool vtk_extent_is_empty(const vtk_extent *e) {
    return e->lo[0] > e->hi[0] || e->lo[1] > e->hi[1] || e->lo[2] > e->hi[2];
}
