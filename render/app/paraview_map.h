/* paraview_map.h - colour maps as ParaView exports them: JSON, and XML of older versions.
 */
#ifndef RENDER_APP_PARAVIEW_MAP_H
#define RENDER_APP_PARAVIEW_MAP_H

#include "formats/base/name_list.h"
#include "formats/input/byte_stream.h"
#include "render/app/colour_map.h"
#include "render/app/opacity_curve.h"

/* One map of a file. Start with all zeros but for m and wanted. */
typedef struct paraview_map {
    mem *m;
    const char *wanted; /* its name; NULL: the only one */
    colour_space space;
    colour_point *colours;
    size_t colour_count, colour_room;
    opacity_point *opacities; /* none: it has none */
    size_t opacity_count, opacity_room;
    int maps;        /* that the file has, with */
    name_list names; /* these */
    bool found;
} paraview_map;

/* paraview_map_read_json(), paraview_map_read_xml() - from the start of a stream. ST_CORRUPT and
 * ST_UNSUPPORTED with file, place and what was expected; ST_USAGE where it is not clear which map
 * is meant; ST_NOMEM, ST_IO. paraview_map_release() in any case. */
CHECKED status paraview_map_read_json(paraview_map *p, byte_stream *s);
CHECKED status paraview_map_read_xml(paraview_map *p, byte_stream *s);
void paraview_map_release(paraview_map *p);

#endif
