#include "render/app/render_stats.h"

#include <sys/resource.h>

#include "render/ray/counters.h"

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

static json_t *packets(const leafcast_stats *t) {
    json_t *counts = json_object();
#define COUNTER(name) json_object_set_new(counts, #name, count_of(t->name));
    PACKET_COUNTERS(COUNTER)
#undef COUNTER
    return counts;
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
#define COUNTER(name) json_object_set_new(root, #name, count_of(t->name));
    RAY_COUNTERS(COUNTER)
#undef COUNTER
    json_object_set_new(root, "provisional_error",
                        json_pack("{s:f, s:f}", "mean", t->provisional_error_mean, "most",
                                  t->provisional_error_most));
    if (t->isorange_tests > 0)
        json_object_set_new(root, "packets", packets(t));
    if (s->certified.made)
        json_object_set_new(root, "certified",
                            json_pack("{s:f, s:f}", "difference", s->certified.difference,
                                      "of_bounds", s->certified.of_bounds));
    json_object_set_new(root, "repeats", json_integer(s->repeats));
    json_object_set_new(root, "threads", json_integer(t->threads));
    json_object_set_new(root, "isa", json_string(t->isa ? t->isa : "scalar"));
    return root;
}
