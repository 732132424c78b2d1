/* leafcast info - what is in a treelet file, or in an input of convert. */
#include <string.h>
#include <sys/stat.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/file.h"
#include "formats/base/num.h"
#include "formats/curvilinear_options.h"
#include "formats/grid/grid.h"
#include "formats/info_leaf.h"
#include "formats/info_next.h"
#include "formats/input_facts.h"
#include "formats/trust_options.h"

typedef struct arguments {
    cli_common common;
    info_leaf_question leaf; /* of a treelet file */
    input_question question; /* of another input */
} arguments;

enum {
    KEY_ISO = 0x2000,
    KEY_STEPS,
    KEY_QUICK,
    KEY_FIELD,
    KEY_DIMS,
    KEY_TYPE,
    KEY_BIG_ENDIAN,
    KEY_SKIP
};

static const struct argp_option options[] = {
    {"iso", KEY_ISO, "V", CLI_BASIC,
     "of a treelet file: count what this isovalue needs; may be repeated", 0},
    {"steps", KEY_STEPS, STEP_LIST_FORM, CLI_BASIC,
     "of a treelet file: say where isovalues are in these time steps (all); count cells in the "
     "first",
     0},
    {"field", KEY_FIELD, "NAME", CLI_BASIC,
     "of several: this field, array, grid, data set or variable (default: the first)", 0},
    {NULL, 0, NULL, 0, "Other inputs:", 1},
    {"quick", KEY_QUICK, NULL, CLI_BASIC, "tell what the header says; do not read the values", 1},
    {"dims", KEY_DIMS, "X,Y,Z", CLI_BASIC, "of raw samples: how many per axis", 1},
    {"type", KEY_TYPE, "TYPE", CLI_BASIC,
     "of raw samples: u8 i8 u16 i16 u32 i32 u64 i64 f16 f32 f64", 1},
    {"big-endian", KEY_BIG_ENDIAN, NULL, 0, "of raw samples: most significant byte first", 1},
    {"skip", KEY_SKIP, "BYTES", 0, "of raw samples: header bytes to pass over", 1},
    TRUST_OPTIONS(1),
    CURVILINEAR_OPTIONS(1),
    {NULL, 0, NULL, 0, NULL, 0}};

static status add_iso(arguments *a, const char *text) {
    if (a->leaf.iso_count == INFO_ISOS_MAX)
        return status_describe(ST_USAGE, "more than %d isovalues", INFO_ISOS_MAX);
    return num_double(text, "--iso", &a->leaf.isos[a->leaf.iso_count++]);
}

static status set_option(void *own, int key, const char *text) {
    arguments *a = own;
    input_question *q = &a->question;
    switch (key) {
    case KEY_ISO: return add_iso(a, text);
    case KEY_QUICK: q->header_only = true; return ST_OK;
    case KEY_STEPS: return step_list_parse(text, "--steps", &a->leaf.steps);
    case KEY_FIELD:
        q->hints.curvilinear.field = q->hints.mesh.field = q->hints.grid.field = a->leaf.field =
            text;
        return ST_OK;
    case KEY_DIMS: return cli_dims(text, "--dims", 1, GRID_DIM_MAX, q->hints.grid.dims);
    case KEY_TYPE: return cli_sample_type(text, &q->hints.grid.type);
    case KEY_BIG_ENDIAN: q->hints.grid.big_endian = true; return ST_OK;
    case KEY_SKIP: return num_size(text, "--skip", &q->hints.grid.skip);
    default: break;
    }
    const status st = trust_option(&q->hints.grid.trust, key);
    return st == ST_AGAIN ? curvilinear_option(&q->hints.curvilinear, key, text) : st;
}

static status check(void *own) {
    const arguments *a = own;
    return a->common.input ? ST_OK : status_describe(ST_USAGE, "an INPUT is needed");
}

static const cli_verb verb = {
    .options = options,
    .set_option = set_option,
    .check = check,
    .input = "file",
    .args_doc = "INPUT",
    .doc = "Say what is in a treelet file, or in any input of convert: its format, sizes, fields, "
           "values as a histogram, the isovalues that are worth a look, and what to do next. An "
           "active treelet, cell or tet is one with min < V <= "
           "max over its samples.\vExample:\n  leafcast info bonsai.leaf --iso 37",
};

/* ---- an input that is not a treelet file ---- */

/* Beside what inputs are like: what only treelet files or only other inputs can use. */
enum { LEAF = INPUT_TRAIT_END, INPUT = 2 * LEAF };
static const char *const input_names[] = {
    INPUT_TRAIT_NAMES, [LEAF] = "treelet files", [INPUT] = "inputs of convert",
    [LEAF | INPUT_CHOICES] = "treelet files, and formats that have several"};
static const cli_use uses[] = {{KEY_ISO, LEAF},
                               {KEY_STEPS, LEAF},
                               {KEY_QUICK, INPUT},
                               {KEY_FIELD, LEAF | INPUT_CHOICES},
                               {KEY_DIMS, INPUT_RAW},
                               {KEY_TYPE, INPUT_RAW},
                               {KEY_BIG_ENDIAN, INPUT_RAW},
                               {KEY_SKIP, INPUT_RAW},
                               {TRUST_KEY_LINKS, INPUT_FILES},
                               {TRUST_KEY_MISSING, INPUT_PARTS}};

/* Refuse options that the input cannot use. */
static status check_uses(const arguments *a, unsigned input, const char *format) {
    return cli_check_uses(&a->common, uses, sizeof uses / sizeof *uses, input, input_names, format);
}

static status report_input(arguments *a, const input_facts *x) {
    char line[INFO_NEXT_MAX];
    const char *next = input_facts_next(x, &a->question, line, sizeof line) ? line : NULL;
    if (a->common.json) {
        const fact_sheet to = {.values = input_facts_json(x)};
        info_next_tell(&to, next);
        return cli_print_json(&a->common, to.values);
    }
    const fact_sheet to = {.lines = stdout};
    cli_results(&a->common, false);
    input_facts_print(stdout, x);
    info_next_tell(&to, next);
    return ST_OK;
}

static status check_opened(void *ctx, const input_facts *x) {
    return check_uses(ctx, x->traits | INPUT, x->format);
}

static status run_input(arguments *a, mem *m) {
    input_facts *x = mem_zalloc(m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    a->question.path = a->common.input;
    a->question.opened = check_opened;
    a->question.ctx = a;
    status st = input_facts_read(m, &a->question, cli_progress(&a->common), x);
    if (st == ST_OK)
        st = report_input(a, x);
    mem_free(m, x);
    return st;
}

/* By first bytes or name. F.leaf counts in any case: opening it tells what is wrong. */
static status is_leaf(mem *m, const char *path, bool *is) {
    const size_t length = strlen(path);
    *is = length > 5 && strcmp(path + length - 5, ".leaf") == 0;
    if (*is || strcmp(path, "-") == 0)
        return ST_OK;
    file *f = NULL;
    char magic[sizeof LEAF_MAGIC - 1];
    struct stat info;
    if (stat(path, &info) != 0 || !S_ISREG(info.st_mode))
        return ST_OK;
    status st = file_open(m, path, &f);
    if (st == ST_OK && file_size(f) >= sizeof magic)
        st = file_read_at(f, 0, magic, sizeof magic);
    *is =
        st == ST_OK && file_size(f) >= sizeof magic && memcmp(magic, LEAF_MAGIC, sizeof magic) == 0;
    file_close(f);
    return st;
}

static status run(arguments *a) {
    mem m;
    mem_init(&m, a->common.memory);
    leaf_file *f = NULL;
    bool leaf = false;
    status st = is_leaf(&m, a->common.input, &leaf);
    if (st == ST_OK && !leaf)
        return run_input(a, &m);
    if (st == ST_OK)
        st = check_uses(a, LEAF, "a treelet file");
    if (st == ST_OK)
        st = leaf_file_open(&m, a->common.input, &f);
    if (st == ST_OK)
        st = info_leaf_report(&a->common, &m, f, &a->leaf);
    leaf_file_close(f);
    return st;
}

int main(int argc, char **argv) {
    arguments a = {.common = {.verb = "info", .without = "output force"}};
    cli_parse(&verb, &a.common, argc, argv);
    const int code = cli_finish(&a.common, run(&a));
    curvilinear_options_release(&a.question.hints.curvilinear);
    return code;
}
