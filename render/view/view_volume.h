/* view_volume.h - describe a volume to a page that opens it. */
#ifndef RENDER_VIEW_VIEW_VOLUME_H
#define RENDER_VIEW_VIEW_VOLUME_H

#include <jansson.h>

#include "render/view/view_scene.h"

/* A treelet file that is shown. */
typedef struct view_file {
    const char *path;
    leafcast *volume;
} view_file;

/* The options that the device was made with. */
typedef struct view_machine {
    uint64_t memory; /* 0: no limit */
    int threads;
    const char *isa;
} view_machine;

/* view_volume_json() - returns the message "volume" about files[which], one of `count` files.
 * scene: NULL, or the scene whose objects' files these are. NULL: no memory. */
json_t *view_volume_json(const view_file *files, int count, int which, const view_scene *scene,
                         const view_machine *machine);

#endif
