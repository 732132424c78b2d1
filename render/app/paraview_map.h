/* paraview_map.h - read colour maps as ParaView exports them: JSON, and XML of older versions. */
#ifndef RENDER_APP_PARAVIEW_MAP_H
#define RENDER_APP_PARAVIEW_MAP_H

#include "formats/base/name_list.h"
#include "formats/input/byte_stream.h"
#include "render/app/colour_map.h"
#include "render/app/opacity_curve.h"

/* One map of a file. Start with all zeros but for m and wanted. */
typedef struct paraview_map {
    mem *m;
    const char *wanted; /* name of the map to read; NULL: the file's only one */
    colour_space space;
    colour_point *colours;
    size_t colour_count, colour_room;
    opacity_point *opacities; /* empty: the map has no opacities */
    size_t opacity_count, opacity_room;
    int maps;        /* number of maps in the file */
    name_list names; /* their names */
    bool found;
} paraview_map;

/* paraview_map_read_json(), paraview_map_read_xml() - read a map from the start of a stream.
 * ST_CORRUPT and ST_UNSUPPORTED name the file, the place and what was expected; ST_USAGE if it is
 * unclear which map is meant; ST_NOMEM, ST_IO. Call paraview_map_release() in any case. */
CHECKED status paraview_map_read_json(paraview_map *p, byte_stream *s);
CHECKED status paraview_map_read_xml(paraview_map *p, byte_stream *s);
void paraview_map_release(paraview_map *p);

#endif
