/* leafcast generate - analytic test volumes as NRRD. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/num.h"
#include "prep/generate.h"

typedef struct arguments {
    cli_common common;
    const field_info *info;
    uint32_t dims[3];
    sample_type type;
    uint64_t seed;
    double spacing[3];
} arguments;

enum { KEY_DIMS = 0x2000, KEY_TYPE, KEY_SEED, KEY_SPACING };

static const struct argp_option options[] = {
    {"dims", KEY_DIMS, "N[,N,N]", 0, "samples per axis", 0},
    {"type", KEY_TYPE, "TYPE", 0, "u8 (default), u16 or f32", 0},
    {"seed", KEY_SEED, "S", 0, "seed of noise and attractor (default 1)", 0},
    {"spacing", KEY_SPACING, "S[,S,S]", 0, "distance of samples (default 1)", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static void usage_unless(struct argp_state *state, status st) {
    if (st != ST_OK)
        argp_error(state, "%s", status_text());
}

/* One number for all three axes, or three. */
static void parse_triple(struct argp_state *state, const char *text, const char *what,
                         const char *separators, double out[3]) {
    int count = text[strcspn(text, separators)] ? 3 : 1;
    usage_unless(state, num_doubles(text, what, separators, count, out));
    if (count == 1)
        out[1] = out[2] = out[0];
}

static void parse_dims(struct argp_state *state, arguments *a, const char *text) {
    double sizes[3];
    parse_triple(state, text, "--dims", ", x", sizes);
    for (int c = 0; c < 3; c++) {
        if (!(sizes[c] >= 2 && sizes[c] <= GRID_DIM_MAX && sizes[c] == (uint32_t)sizes[c]))
            argp_error(state, "--dims: \"%s\": expected whole numbers from 2 to %d", text,
                       GRID_DIM_MAX);
        a->dims[c] = (uint32_t)sizes[c];
    }
}

static void parse_field(struct argp_state *state, arguments *a, const char *name) {
    if (a->info)
        argp_error(state, "one FIELD at a time, not also \"%s\"", name);
    a->info = field_find(name);
    if (!a->info)
        argp_error(state, "no field \"%s\"; --help lists them", name);
}

static void parse_type(struct argp_state *state, arguments *a, const char *name) {
    if (!sample_parse(name, &a->type) ||
        (a->type != SAMPLE_U8 && a->type != SAMPLE_U16 && a->type != SAMPLE_F32))
        argp_error(state, "--type: \"%s\" is not one of u8, u16, f32", name);
}

static error_t parse(int key, char *arg, struct argp_state *state) {
    arguments *a = state->input;
    int64_t seed = 0;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = &a->common; break;
    case KEY_DIMS: parse_dims(state, a, arg); break;
    case KEY_TYPE: parse_type(state, a, arg); break;
    case KEY_SEED:
        usage_unless(state, num_int(arg, "--seed", 0, INT64_MAX, &seed));
        a->seed = (uint64_t)seed;
        break;
    case KEY_SPACING: parse_triple(state, arg, "--spacing", ", ", a->spacing); break;
    case ARGP_KEY_ARG: parse_field(state, a, arg); break;
    case ARGP_KEY_END:
        if (!a->info || !a->dims[0] || !a->common.output)
            argp_error(state, "a FIELD, --dims and -o are needed");
        break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

/* The list of fields behind the options. */
static char *help_filter(int key, const char *text, void *input) {
    (void)input;
    if (key != ARGP_KEY_HELP_POST_DOC)
        return (char *)(uintptr_t)text;
    char *list = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&list, &size);
    if (!stream)
        return NULL;
    fputs("Fields (their values; u8 and u16 map the given range to all of theirs):\n", stream);
    const field_info *info;
    for (size_t i = 0; (info = field_at(i)) != NULL; i++)
        fprintf(stream, "  %-15s %s\n", info->name, info->about);
    fclose(stream);
    return list;
}

static const struct argp_child children[] = {{&cli_common_argp, 0, NULL, 0}, {NULL, 0, NULL, 0}};
static const struct argp table = {
    .options = options,
    .parser = parse,
    .args_doc = "FIELD --dims N[,N,N] -o F.nrrd",
    .doc =
        "Write an analytic test volume as NRRD (-o -: to standard output). It is streamed, never "
        "held whole; the same arguments give the same bytes on any machine.\v",
    .children = children,
    .help_filter = help_filter,
};

static grid make_grid(const arguments *a) {
    grid g;
    grid_init(&g, a->dims, a->type);
    for (int c = 0; c < 3; c++)
        g.to_world[c][c] = a->spacing[c];
    snprintf(g.name, sizeof g.name, "%s", a->info->name);
    return g;
}

static status run(arguments *a) {
    grid g = make_grid(a);
    if (strcmp(a->common.output, "-") == 0 && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "-o -: samples do not go to a terminal");
    mem m;
    mem_init(&m, a->common.memory);
    const generate_options how = {.info = a->info,
                                  .seed = a->seed,
                                  .threads = a->common.threads,
                                  .output = a->common.output,
                                  .force = a->common.force};
    return generate_volume(&m, &g, &how, cli_progress(&a->common));
}

int main(int argc, char **argv) {
    arguments a = {
        .common = {.verb = "generate"}, .type = SAMPLE_U8, .seed = 1, .spacing = {1, 1, 1}};
    cli_parse(&table, &a.common, argc, argv, &a);
    return cli_finish(&a.common, run(&a));
}
