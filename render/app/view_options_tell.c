/* view_options_tell.c - what flags say together: of media, projections and glass. */
#include "render/app/view_options.h"

bool view_options_transparent(const view_options *v) {
    for (int i = 0; i < v->opacities; i++)
        if (v->surfaces[i].opacity < 1.0f)
            return true;
    return false;
}

bool view_options_filled(const view_options *v) {
    return v->scene.project != LEAFCAST_PROJECT_NONE || view_options_medium(v);
}

bool view_options_coloured(const view_options *v) {
    return v->colour_by[0] || (v->is_surface && medium_options_given(&v->medium));
}

bool view_options_medium(const view_options *v) {
    return !v->is_surface && !v->colour_by[0] && medium_options_given(&v->medium);
}

bool view_options_any_filled(const view_options *v) {
    return v->others_filled || view_options_filled(v);
}

bool view_options_any_medium(const view_options *v) {
    return v->scene.project == LEAFCAST_PROJECT_NONE && view_options_any_filled(v);
}

leafcast_scene view_options_scene(const view_options *v, leafcast_scene_experiments *e) {
    leafcast_scene scene = v->scene;
    *e = v->experiments;
    e->size = sizeof *e;
    scene.experiments = e;
    return scene;
}

status view_options_field(const view_options *v, const leafcast *volume, uint32_t *field) {
    *field = 0;
    return v->field[0] ? (status)leafcast_find_field(volume, v->field, field) : ST_OK;
}
