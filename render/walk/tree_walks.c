#include "render/walk/tree_walks.h"

#include "render/walk/tree_extremes.h"
#include "render/walk/tree_hits.h"
#include "render/walk/tree_pieces.h"
#include "render/walk/tree_points.h"

const kind_walks tree_walks = {.overlaps = true,
                               .active_box = tree_active_box,
                               .span = tree_span,
                               .cells_along = tree_cells_along,
                               .rank = tree_rank,
                               .next = tree_hits_next,
                               .segments = tree_pieces,
                               .extreme_ways = tree_extreme_ways,
                               .extreme = tree_extreme,
                               .extreme_near = tree_extreme_near,
                               .treelet_at = tree_treelet_at};
