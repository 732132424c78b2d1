/* geotiff.h - where the pixels of a TIFF lie on a map, and which of them have no data: the tags of
 * GeoTIFF (OGC 19-008r4, sections 7.1 and B.6) and GDAL's for no data.
 *
 * A map gives x and y of pixels' centres: of the corner that GeoTIFF starts from, half a pixel on,
 * unless pixels are points. It needs a scale and a tie point, or a matrix; several tie points alone
 * are no affine map. Degrees are left as they are. Projections are not looked into.
 */
#ifndef PREP_IMPORT_IMAGES_GEOTIFF_H
#define PREP_IMPORT_IMAGES_GEOTIFF_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct geotiff {
    bool placed;      /* the first page lies on a map: */
    double map[2][3]; /* (x, y) = map * (column, row, 1) */
    const char *unit; /* of x and y: "degree", "m", "ft"; "": not told */
    const char *up;   /* of elevations; "": not told */
    bool has_missing; /* pixels that are `missing` have no data */
    double missing;
    bool scaled; /* its numbers times a scale, or with an offset, are what is meant */
    /* private: */
    mem *m;
    uint8_t *beside; /* of each page */
    size_t room;
} geotiff;

/* geotiff_read() - read the tags of the first page, and which pages are beside others. What is
 * malformed tells nothing. geotiff_release() in any case; zeros are fine. ST_CORRUPT: the chain of
 * pages is broken; ST_IO, ST_NOMEM. */
CHECKED status geotiff_read(mem *m, const char *path, geotiff *out);
void geotiff_release(geotiff *g);

/* geotiff_is_beside() - whether a page is a smaller copy of another one, or its mask. */
bool geotiff_is_beside(const geotiff *g, uint32_t page);

#endif
