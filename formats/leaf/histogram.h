/* histogram.h - the distribution of a field's values, and isovalues that are worth a look.
 *
 * Counting every cell of a volume would cost more than converting it. So cells are sampled
 * (histogram_draw.h): all of a small volume, at most HISTOGRAM_DRAWS of a large one, always the
 * same ones. A share p of the cells is then known to about sqrt(p / HISTOGRAM_DRAWS).
 *
 * The same cells give the same bits. No function here allocates or fails; all are thread-safe.
 */
#ifndef FORMATS_LEAF_HISTOGRAM_H
#define FORMATS_LEAF_HISTOGRAM_H

#include <float.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/sample.h"

enum { HISTOGRAM_BINS = 256, HISTOGRAM_DRAWS = 1 << 16, HISTOGRAM_ISOVALUES = 4 };

/* What was drawn: a node of a grid with the cell that begins there, or a tetrahedron. */
typedef struct histogram_cell {
    float value;  /* the node's value, or the mean of a tet's four; NaN: not finite */
    float lo, hi; /* range of the cell's corners; lo > hi: no cell begins there, or a corner is NaN
                     or inf */
    float slope;  /* length of the gradient at the cell's middle, per world unit */
    float area;   /* mean area of its isosurfaces over the isovalues in (lo, hi], world units: its
                     volume times slope / (hi - lo) */
    uint8_t position[4]; /* a grid's cell: 255 * node / cells on x, y, z, rounded down; then 0 */
} histogram_cell;

/* Bin i holds the values with edges[i] <= value < edges[i + 1]. At the isovalue edges[i] a cell is
 * active iff lo < edges[i] && edges[i] <= hi.
 *
 * Integers: every edge lies half way between two integers. Each integer has its own bin if 256 bins
 * are enough. Wide ranges: the first and last bin may be tails, which reach far beyond the others.
 * A marker (below) has its own bin at one end, and an empty one between it and the others. This is
 * also the layout in a treelet file (FORMAT.md). */
typedef struct histogram {            /* offset size */
    uint32_t bins;                    /*    0    4  0: no finite value was drawn */
    uint32_t reserved0;               /*    4    4 */
    uint64_t drawn;                   /*    8    8  sum of samples[] */
    uint64_t cells;                   /*   16    8  cells that were drawn and have a range */
    uint64_t total;                   /*   24    8  nodes of the grid, tets of the mesh */
    uint64_t reserved[3];             /*   32   24 */
    double edges[HISTOGRAM_BINS + 1]; /*   56 2056  ascending; 0 behind edges[bins], as below */
    uint32_t samples[HISTOGRAM_BINS]; /* 2112 1024  values drawn in bin i */
    uint32_t active[HISTOGRAM_BINS];  /* 3136 1024  cells drawn that are active at edges[i] */
    float gradient[HISTOGRAM_BINS];   /* 4160 1024  mean slope of these cells; 0 where there are
                                         none */
    float area[HISTOGRAM_BINS];       /* 5184 1024  estimated area of the surface at edges[i]: sum
                                         of the cells' areas times total / number drawn */
    uint8_t box[HISTOGRAM_BINS][6];   /* 6208 1536  of the cells counted in active[i]: smallest
                                         position on x, y, z, then largest; 0 for a mesh, and where
                                         there are none */
} histogram;
_Static_assert(sizeof(histogram) == 7744, "histogram is 7744 bytes");

/* histogram_limited() - a slope or an area as a float, at most FLT_MAX. v is not NaN. */
static inline float histogram_limited(double v) {
    return v < (double)FLT_MAX ? (float)v : FLT_MAX;
}

/* histogram_build() - make the histogram of count cells that were drawn from `total`. type: the
 * samples' stored type. range: of all finite values, drawn or not; lo > hi: there are none. */
void histogram_build(histogram *h, const histogram_cell *cells, uint32_t count, sample_type type,
                     const double range[2], uint64_t total);

/* histogram_count() - the same, but keep h->bins and h->edges; the rest of *h is recomputed. */
void histogram_count(histogram *h, const histogram_cell *cells, uint32_t count, uint64_t total);

/* histogram_fault() - a description of what contradicts the layout above; NULL: nothing. For bytes
 * that come from a file. */
const char *histogram_fault(const histogram *h);

/* histogram_suggest() - up to `most` isovalues that are worth a look, best first; returns how many.
 * None where all values are equal or not finite. The rule is "sharp and large": see histogram.c.
 * Ignores a marker. */
int histogram_suggest(const histogram *h, double *isovalues, int most);

/* histogram_parting() - Otsu's method: the bin of [from, to) at which the samples are best split in
 * two. Best: the weighted distance of the two means is greatest. Returns `from` where all share a
 * bin. from < to. */
uint32_t histogram_parting(const double *edges, const uint32_t *samples, uint32_t from,
                           uint32_t to);

/* A value that may stand for missing data, such as -9999 or 1e30. */
typedef struct histogram_marker {
    double value;
    double share;     /* share of the samples drawn that are numbers */
    double others[2]; /* the least and the greatest other value that was drawn */
} histogram_marker;

/* histogram_find_marker() - whether the drawn cells have a marker: the least or the greatest value
 * of all (range). At least one sample in a thousand has it. It is more than ten times as far from 0
 * as any other value, and the others differ. Without one *out is untouched. */
bool histogram_find_marker(const histogram_cell *cells, uint32_t count, const double range[2],
                           histogram_marker *out);

/* histogram_data() - the bins [bins[0], bins[1]) that hold data: all, or all but the marker's and
 * the empty one beside it. Returns whether there is a marker, and describes it in *out, which is
 * untouched otherwise. Its `others` are the ends of the other bins. */
bool histogram_data(const histogram *h, uint32_t bins[2], histogram_marker *out);

#endif
