#include "formats/input_facts.h"

#include <assert.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "formats/base/num.h"
#include "formats/base/shell_line.h"
#include "formats/base/text.h"
#include "formats/curvilinear/curvilinear_input_facts.h"
#include "formats/grid/volume_facts.h"
#include "formats/input/unpack_stream.h"
#include "formats/input_open.h"
#include "formats/leaf/histogram_text.h"
#include "formats/mesh/mesh_input_facts.h"
#include "formats/surface/surface_input_facts.h"

static const input_facts_kind *const kinds[] = {&volume_facts_kind, &mesh_input_facts_kind,
                                                &surface_input_facts_kind,
                                                &curvilinear_input_facts_kind};

static const input_facts_kind *kind_of(const input_facts *x) {
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (kinds[i]->of == x->kind)
            return kinds[i];
    assert(false); /* a kind of input without a row */
    return NULL;
}

status input_facts_read(mem *m, const input_question *q, const progress *p, input_facts *out) {
    input in;
    *out = (input_facts){.path = q->path,
                         .read = !q->header_only,
                         .steps = 1,
                         .components = 1,
                         .range = {DBL_MAX, -DBL_MAX}};
    input_hints hints = q->hints;
    hints.curvilinear.trust = hints.mesh.trust = hints.grid.trust;
    status st = input_open(m, q->path, &hints, &in);
    if (st == ST_OK) {
        out->kind = in.kind;
        out->format = in.kind->format(in.own);
        out->traits = in.kind->traits(in.own);
        st = kind_of(out)->ask(m, in.own, q, p, out);
    }
    input_close(&in);
    return st;
}

/* ---- for people ---- */

static void print_field(FILE *to, const input_facts *x, const input_field *f) {
    fputs(f->name, to);
    if (f->components > 1)
        fprintf(to, ", %u components", f->components);
    if (f->steps > 1)
        fprintf(to, ", %u steps", f->steps);
    fputs(strcmp(f->name, x->field) == 0 ? " (taken here)\n" : "\n", to);
}

/* Print what can be chosen where there are several, and the default. */
static void print_choices(FILE *to, const input_facts *x) {
    char n[2][NUM_TEXT_MAX];
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++) {
        fputs(i ? "            " : "fields      ", to);
        print_field(to, x, &x->fields[i]);
    }
    if (x->field_count > INPUT_FACTS_FIELDS)
        fprintf(to, "            .. %u in all\n", x->field_count);
    if (x->components > 1 && x->component)
        fprintf(to, "components  %u a sample, number %u is taken here\n", x->components,
                x->component);
    else if (x->components > 1)
        fprintf(to, "components  %u a sample, taken here as their %s\n", x->components,
                x->colours ? "luminance" : "magnitude");
    if (x->steps > 1)
        fprintf(to, "steps       %u, the first is taken here\n", x->steps);
    if (x->steps > 1 && x->timed)
        fprintf(to, "times       %s .. %s%s%s\n", num_print(x->times[0], n[0]),
                num_print(x->last_time, n[1]), x->frame.time_unit[0] ? " " : "",
                x->frame.time_unit);
}

static void print_values(FILE *to, const input_facts *x) {
    char lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX];
    if (x->range[0] <= x->range[1])
        fprintf(to, "values      %s .. %s\n", num_print(x->range[0], lo),
                num_print(x->range[1], hi));
    else
        fprintf(to, "values      none that are finite\n");
    if (x->non_finite)
        fprintf(to, "no data     %llu values are NaN or infinite\n",
                (unsigned long long)x->non_finite);
    if (x->trailing)
        fprintf(to, "behind      %llu bytes behind the samples\n", (unsigned long long)x->trailing);
    histogram_print(to, &x->values, kind_of(x)->drawn, !x->is_surface);
    histogram_print_isovalues(to, &x->values, !x->is_surface);
}

void input_facts_print(FILE *to, const input_facts *x) {
    char path[4096];
    const fact_sheet lines = {.lines = to};
    fact_sheet_line(&lines, "input", "%s", text_printable(path, sizeof path, x->path));
    fact_sheet_line(&lines, "format", "%s", x->format);
    if (x->name[0])
        fact_sheet_line(&lines, "name", "%s", x->name);
    kind_of(x)->tell(x, &lines);
    print_choices(to, x);
    if (x->read)
        print_values(to, x);
}

/* Remove slashes behind a folder, and the suffix of a compressed file. Cut if too long. */
static const char *unpacked_path(const char *path, char copy[PATH_MAX]) {
    snprintf(copy, PATH_MAX, "%s", path);
    for (size_t n = strlen(copy); n > 1 && copy[n - 1] == '/'; n--)
        copy[n - 1] = 0;
    if (packer_is_suffix(copy))
        *strrchr(copy, '.') = 0;
    return copy;
}

/* Append NAME.leaf, in the current folder, for an input called NAME with its last suffix. */
static void put_leaf_name(shell_line *c, const char *path) {
    char name[PATH_MAX], copy[PATH_MAX];
    size_t length;
    const char *stem = text_stem(unpacked_path(path, copy), &length);
    if (strcmp(path, "-") == 0)
        shell_line_put(c, "F.leaf");
    else if (snprintf(name, sizeof name, "%.*s.leaf", (int)length, stem) < (int)sizeof name)
        shell_line_path(c, name);
    else
        c->full = true;
}

static void put_curvilinear(shell_line *c, const curvilinear_hints *h) {
    const struct {
        const char *option;
        const path_list *files;
    } options[] = {{" --solution ", &h->solutions}, {" --functions ", &h->functions}};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        for (int k = 0; k < options[i].files->count; k++) {
            shell_line_put(c, options[i].option);
            shell_line_path(c, options[i].files->paths[k]);
        }
    if (h->layout) {
        shell_line_put(c, " --plot3d ");
        shell_line_word(c, h->layout);
    }
    if (h->to) {
        shell_line_put(c, " --to ");
        shell_line_word(c, h->to);
    }
}

bool input_facts_next(const input_facts *x, const input_question *q, char *text, size_t room) {
    shell_line c = shell_line_begin(text, room);
    const volume_hints *grids = &q->hints.grid;
    const mesh_hints *meshes = &q->hints.mesh;
    char number[64];
    shell_line_put(&c, "leafcast convert ");
    if (strcmp(x->path, "-") == 0)
        shell_line_put(&c, "-");
    else
        shell_line_path(&c, x->path);
    if (grids->dims[0]) {
        snprintf(number, sizeof number, " --dims %u,%u,%u", grids->dims[0], grids->dims[1],
                 grids->dims[2]);
        shell_line_put(&c, number);
    }
    if (grids->type) {
        shell_line_put(&c, " --type ");
        shell_line_put(&c, sample_name(grids->type));
    }
    if (meshes->field) {
        shell_line_put(&c, " --field ");
        shell_line_word(&c, meshes->field);
    }
    if (meshes->cells_to_points)
        shell_line_put(&c, " --cells-to-points");
    if (meshes->by_corners)
        shell_line_put(&c, " --by-corners");
    if (x->needs_whole)
        shell_line_put(&c, " --whole-cells");
    if (grids->trust.follow_links)
        shell_line_put(&c, " --follow-links");
    if (grids->trust.allow_missing)
        shell_line_put(&c, " --allow-missing");
    put_curvilinear(&c, &q->hints.curvilinear);
    /* Without this option convert would refuse it: there is nothing to draw. */
    if (x->lacks_values)
        shell_line_put(&c, " --allow-empty");
    shell_line_put(&c, " -o ");
    put_leaf_name(&c, x->path);
    return !c.full;
}

/* ---- for programs ---- */

static void set_choices(json_t *json, const input_facts *x) {
    json_t *fields = json_array(), *times = json_array();
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++) {
        const input_field *f = &x->fields[i];
        json_array_append_new(fields, json_pack("{s:s, s:I, s:I}", "name", f->name, "steps",
                                                (json_int_t)f->steps, "components",
                                                (json_int_t)f->components));
    }
    json_object_set_new(json, "field_count", json_integer(x->field_count));
    json_object_set_new(json, "fields", fields);
    json_object_set_new(json, "field", json_string(x->field));
    json_object_set_new(json, "steps", json_integer(x->steps));
    json_object_set_new(json, "components", json_integer(x->components));
    json_object_set_new(json, "component", json_integer(x->component));
    json_object_set_new(json, "colours", json_boolean(x->colours));
    for (uint32_t i = 0; x->timed && i < x->steps && i < INPUT_FACTS_TIMES; i++)
        json_array_append_new(times, json_real(x->times[i]));
    json_object_set_new(json, "times", times);
}

json_t *input_facts_json(const input_facts *x) {
    const bool any = x->range[0] <= x->range[1];
    json_t *json =
        json_pack("{s:s, s:s, s:s}", "format", x->format, "kind", x->kind->name, "name", x->name);
    const fact_sheet to = {.values = json};
    set_choices(json, x);
    kind_of(x)->tell(x, &to);
    if (x->read) {
        fact_sheet_real(&to, "value_min", any ? x->range[0] : NAN);
        fact_sheet_real(&to, "value_max", any ? x->range[1] : NAN);
        fact_sheet_whole(&to, "non_finite", x->non_finite);
        fact_sheet_json(&to, "histogram", histogram_json(&x->values, !x->is_surface));
    }
    return json;
}
