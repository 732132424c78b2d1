#include "render/app/render_stats.h"

#include <sys/resource.h>

uint64_t render_stats_peak_rss(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0;
}

int render_stats_median(const leafcast_stats *all, int count) {
    for (int i = 0; i < count; i++) {
        int before = 0;
        for (int k = 0; k < count; k++)
            before +=
                all[k].render_s < all[i].render_s || (all[k].render_s == all[i].render_s && k < i);
        if (before == (count - 1) / 2)
            return i;
    }
    return 0;
}

static json_t *count_of(uint64_t n) {
    return json_integer((json_int_t)n);
}

static json_t *isovalues(const view_options *view) {
    json_t *list = json_array();
    for (int i = 0; i < view->isos; i++)
        json_array_append_new(list, json_real(view->surfaces[i].isovalue));
    return list;
}

json_t *render_stats_json(const render_stats *s, const view_options *view, const char *output) {
    const leafcast_stats *t = &s->trace;
    json_t *root = json_object();
    if (*output)
        json_object_set_new(root, "output", json_string(output));
    json_object_set_new(root, "isovalues", isovalues(view));
    if (s->field) {
        json_object_set_new(root, "field", json_string(s->field));
        json_object_set_new(root, "step", json_integer(s->step));
        json_object_set_new(root, "time", json_real(s->time));
    }
    json_object_set_new(root, "size",
                        json_pack("[i,i]", (int)view->camera.width, (int)view->camera.height));
    json_object_set_new(root, "time_s",
                        json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "open", t->open_s,
                                  "first_image", t->first_image_s, "load", t->load_s, "render",
                                  t->render_s, "write", s->write_s, "total", s->total_s));
    json_object_set_new(root, "rays", count_of(t->rays));
    json_object_set_new(root, "primary_rays", count_of(t->primary_rays));
    json_object_set_new(root, "shadow_rays", count_of(t->shadow_rays));
    json_object_set_new(root, "mrays_per_s",
                        json_real(t->render_s > 0.0 ? (double)t->rays / t->render_s * 1e-6 : 0.0));
    json_object_set_new(root, "treelets",
                        json_pack("{s:o, s:o, s:o}", "total", count_of(t->treelets_total), "active",
                                  count_of(t->treelets_active), "loaded",
                                  count_of(t->treelets_loaded)));
    json_object_set_new(root, "bytes",
                        json_pack("{s:o, s:o, s:o, s:o, s:o}", "file", count_of(t->bytes_file),
                                  "active", count_of(t->bytes_active), "visible",
                                  count_of(t->bytes_visible), "read", count_of(t->bytes_read),
                                  "resident", count_of(t->bytes_resident)));
    json_object_set_new(root, "peak_rss_bytes", count_of(s->peak_rss_bytes));
    json_object_set_new(root, "peak_budget_bytes", count_of(t->bytes_peak));
    json_object_set_new(root, "nodes", count_of(t->nodes));
    json_object_set_new(root, "cells", count_of(t->cells));
    json_object_set_new(root, "roots", count_of(t->roots));
    json_object_set_new(root, "covered_pixels", count_of(t->covered_pixels));
    json_object_set_new(root, "provisional_pixels", count_of(t->provisional_pixels));
    json_object_set_new(root, "ill_conditioned", count_of(t->ill_conditioned));
    json_object_set_new(root, "passes", count_of(t->passes));
    if (t->isorange_tests > 0)
        json_object_set_new(
            root, "packets",
            json_pack("{s:o, s:o, s:o, s:o, s:o}", "box_tests", count_of(t->box_tests),
                      "interval_tests", count_of(t->interval_tests), "isorange_tests",
                      count_of(t->isorange_tests), "polygon_tests", count_of(t->polygon_tests),
                      "isopolygons", count_of(t->isopolygons)));
    json_object_set_new(root, "repeats", json_integer(s->repeats));
    json_object_set_new(root, "threads", json_integer(t->threads));
    json_object_set_new(root, "isa", json_string(t->isa ? t->isa : "scalar"));
    return root;
}
