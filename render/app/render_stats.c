#include "render/app/render_stats.h"

#include <sys/resource.h>

#include "formats/base/cli_json.h"
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

static json_t *isovalues(const view_options *view) {
    json_t *list = json_array();
    for (int i = 0; i < view->isos; i++)
        json_array_append_new(list, json_real(view->surfaces[i].isovalue));
    return list;
}

static json_t *packets(const leafcast_stats *t) {
    json_t *counts = json_object();
#define COUNTER(name) json_object_set_new(counts, #name, cli_json_count(t->name));
    PACKET_COUNTERS(COUNTER)
#undef COUNTER
    return counts;
}

void render_stats_set(json_t *root, const leafcast *volume, uint32_t field, uint32_t step,
                      double between) {
    double time = leafcast_step_time(volume, step);
    const leafcast_info info = leafcast_describe(volume);
    if (info.fields == 1 && info.steps == 1)
        return;
    json_object_set_new(root, "field", json_string(leafcast_field_name(volume, field)));
    json_object_set_new(root, "step", json_integer(step));
    if (between > 0.0) {
        time = (1.0 - between) * time + between * leafcast_step_time(volume, step + 1);
        json_object_set_new(root, "between", cli_json_real(between));
    }
    json_object_set_new(root, "time", cli_json_real(time));
}

void render_stats_data(json_t *root, const leafcast_stats *t, uint64_t peak_rss, bool visible) {
    json_object_set_new(
        root, "treelets",
        json_pack("{s:o, s:o, s:o, s:o}", "total", cli_json_count(t->treelets_total), "active",
                  cli_json_count(t->treelets_active), "loaded", cli_json_count(t->treelets_loaded),
                  "lost", cli_json_count(t->treelets_lost)));
    json_t *bytes = json_pack("{s:o, s:o}", "file", cli_json_count(t->bytes_file), "active",
                              cli_json_count(t->bytes_active));
    if (visible)
        json_object_set_new(bytes, "visible", cli_json_count(t->bytes_visible));
    json_object_set_new(bytes, "read", cli_json_count(t->bytes_read));
    json_object_set_new(bytes, "resident", cli_json_count(t->bytes_resident));
    json_object_set_new(root, "bytes", bytes);
    json_object_set_new(root, "peak_rss_bytes", cli_json_count(peak_rss));
    json_object_set_new(root, "peak_budget_bytes", cli_json_count(t->bytes_peak));
}

json_t *render_stats_json(const render_stats *s, const view_options *view, const char *output) {
    const leafcast_stats *t = &s->trace;
    json_t *root = json_object();
    if (*output)
        json_object_set_new(root, "output", json_string(output));
    json_object_set_new(root, "isovalues", isovalues(view));
    render_stats_set(root, s->volume, s->field, s->step, s->between);
    if (view->colour_by[0])
        json_object_set_new(root, "colour_by", json_string(view->colour_by));
    json_object_set_new(root, "size",
                        json_pack("[i,i]", (int)view->camera.width, (int)view->camera.height));
    json_object_set_new(root, "time_s",
                        json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "open", t->open_s,
                                  "first_image", t->first_image_s, "load", t->load_s, "render",
                                  t->render_s, "write", s->write_s, "total", s->total_s));
    json_object_set_new(root, "rays", cli_json_count(t->rays));
    json_object_set_new(root, "mrays_per_s",
                        json_real(t->render_s > 0.0 ? (double)t->rays / t->render_s * 1e-6 : 0.0));
    render_stats_data(root, t, s->peak_rss_bytes, true);
#define COUNTER(name) json_object_set_new(root, #name, cli_json_count(t->name));
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
    if (s->first_s > 0.0)
        json_object_set_new(root, "first_picture",
                            json_pack("{s:f, s:o}", "time_s", s->first_s, "provisional_pixels",
                                      cli_json_count(s->first_provisional)));
    json_object_set_new(root, "repeats", json_integer(s->repeats));
    json_object_set_new(root, "threads", json_integer(t->threads));
    json_object_set_new(root, "isa", json_string(t->isa ? t->isa : "scalar"));
    return root;
}
