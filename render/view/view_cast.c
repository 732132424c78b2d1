#include "render/view/view_cast.h"

#include <stdio.h>
#include <string.h>

#include "render/app/scene_file.h"

/* List the objects that are shown. Returns how many there are. */
static int list_shown(const view_scene *s, const view_changes *c, int *objects) {
    int count = 0;
    for (int i = 0; i < s->count; i++)
        if (!view_changes_hides(c, i))
            objects[count++] = i;
    return count;
}

/* first: of each volume's keeper, 1 + the place in the cast of its first object there; 0: none yet.
 */
static void cast_object(view_cast *cast, const view_scene *s, const view_changes *c, int k,
                        int *first) {
    const int object = cast->objects[k];
    int *const at = &first[view_scene_keeper(s, object)], same = *at - 1;
    *at = *at ? *at : k + 1;
    if (k == 0)
        return;
    cast->job.also[k - 1] = (render_also){.path = view_scene_path(s, object),
                                          .view = *view_changes_view(c, s, object),
                                          .volume = view_scene_volume(s, object),
                                          .same = same,
                                          .places = *view_scene_places(s, object)};
}

/* Note whose places the job's objects are. */
static status note_owners(view_cast *cast) {
    int n = 0;
    cast->owner = mem_array(&cast->job.m, (size_t)cast->job.object_count, sizeof *cast->owner);
    if (!cast->owner)
        return ST_NOMEM;
    for (int k = 0; k <= cast->job.also_count; k++) {
        const render_places *p = k == 0 ? &cast->job.places : &cast->job.also[k - 1].places;
        for (int i = 0; i < (p->count > 0 ? p->count : 1); i++)
            cast->owner[n++] = cast->objects[k];
    }
    return ST_OK;
}

/* strict: the flags that are given. */
static status make(view_cast *cast, const view_scene *s, const view_options *all,
                   const view_changes *c, uint64_t strict) {
    render_job *job = &cast->job;
    mem_init(&job->m, 0);
    cast->objects = mem_array(&job->m, (size_t)s->count, sizeof *cast->objects);
    cast->first = mem_array(&job->m, (size_t)s->count, sizeof *cast->first);
    if (!cast->objects || !cast->first)
        return ST_NOMEM;
    const int count = list_shown(s, c, cast->objects), first = cast->objects[0];
    job->also = mem_array(&job->m, (size_t)count, sizeof *job->also);
    if (!job->also)
        return ST_NOMEM;
    job->volume = view_scene_volume(s, first);
    job->places = *view_scene_places(s, first);
    job->source = view_scene_path(s, first);
    job->also_count = count - 1;
    job->fits_all = true;
    for (int k = 0; k < count; k++)
        cast_object(cast, s, c, k, cast->first);
    cast->frame.view = *all;
    cast->frame.view.given &= strict;
    scene_file_take_first(&cast->frame.view, view_changes_view(c, s, first));
    cast->frame.view.is_surface = view_changes_view(c, s, first)->is_surface;
    status st = render_job_list(job);
    if (st == ST_OK)
        st = note_owners(cast);
    return st == ST_OK ? render_job_check(job, &cast->frame) : st;
}

static status make_strict(mem *m, const view_scene *s, const view_options *all,
                          const view_changes *c, uint64_t strict, view_cast **out) {
    view_cast *cast = mem_zalloc(m, sizeof *cast);
    if (!cast)
        return ST_NOMEM;
    const status st = make(cast, s, all, c, strict);
    if (st == ST_OK)
        *out = cast;
    else
        view_cast_free(m, cast);
    return st;
}

status view_cast_make(mem *m, const view_scene *s, const view_options *all, const view_changes *c,
                      view_cast **out) {
    const uint64_t always = view_scene_bit("project") | view_scene_bit("normals") |
                            view_scene_bit("lod") | view_scene_bit("intersector");
    return make_strict(m, s, all, c, view_changes_any(c) ? always : UINT64_MAX, out);
}

bool view_cast_idle(mem *m, const view_scene *s, const view_options *all, const view_changes *c,
                    const char *flag) {
    view_cast *cast = NULL;
    const status st = make_strict(m, s, all, c, view_scene_bit(flag), &cast);
    view_cast_free(m, cast);
    return st != ST_OK;
}

void view_cast_free(mem *m, view_cast *cast) {
    if (!cast)
        return;
    render_job_unlist(&cast->job);
    mem_free(&cast->job.m, cast->job.also);
    mem_free(&cast->job.m, cast->objects);
    mem_free(&cast->job.m, cast->first);
    mem_free(&cast->job.m, cast->owner);
    mem_free(m, cast);
}

status view_cast_room(const view_cast *cast, const view_scene *s, const leafcast_scene *scene,
                      const leafcast_camera *camera, const leafcast_image *planes,
                      uint64_t beside) {
    char why[STATUS_TEXT_MAX];
    status st =
        (status)leafcast_check_room(scene->volumes[0].volume, scene, camera, planes, beside);
    snprintf(why, sizeof why, "%s", st == ST_OK ? "" : status_text());
    for (int i = 0; i < scene->volume_count && st == ST_NOMEM; i++) {
        leafcast_scene one = *scene;
        one.volumes = &scene->volumes[i];
        one.volume_count = 1;
        one.media = scene->media_count > 0 ? &scene->media[i] : NULL;
        one.media_count = scene->media_count > 0;
        if (leafcast_check_room(one.volumes->volume, &one, camera, planes, beside) ==
            LEAFCAST_NOMEM)
            return status_describe(ST_NOMEM, "%s does not fit: %s", s->names[cast->owner[i]],
                                   status_text());
    }
    return st == ST_NOMEM
               ? status_describe(st, "%d objects do not fit together: %s", scene->volume_count, why)
               : st;
}
