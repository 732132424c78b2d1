#include "formats/base/cli_options.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { GROUP_EXPERIMENTS = 95 };

/* Whether a row is an option or a heading: not the table's end. */
static bool is_row(const struct argp_option *o) {
    return o->name || o->key || o->doc;
}

static bool is_heading(const struct argp_option *o) {
    return !o->name && !o->key;
}

bool cli_options_listed(const char *list, const char *name) {
    const size_t size = name ? strlen(name) : 0;
    for (const char *at = list; at && size && *at; at += strcspn(at, " "), at += *at == ' ')
        if (strcspn(at, " ") == size && strncmp(at, name, size) == 0)
            return true;
    return false;
}

/* ---- two spellings of a word ---- */

static const char COLOUR[] = "colour", COLOR[] = "color";
enum { NAME_ROOM = 64 }; /* longer than any option's name */

void cli_options_name(const char *given, char *out, size_t room) {
    size_t n = 0;
    while (*given && n + 1 < room) {
        if (strncmp(given, COLOR, sizeof COLOR - 1) == 0 && n + sizeof COLOUR <= room) {
            memcpy(out + n, COLOUR, sizeof COLOUR - 1);
            n += sizeof COLOUR - 1;
            given += sizeof COLOR - 1;
        } else {
            out[n++] = *given == '_' ? '-' : *given;
            given++;
        }
    }
    out[n] = 0;
}

bool cli_options_same(const char *name, const char *option) {
    char own[NAME_ROOM];
    cli_options_name(name, own, sizeof own);
    return option && strcmp(own, option) == 0;
}

/* The other spelling of a name, never freed. NULL: there is none, or no memory. */
static char *other_spelling(const char *name) {
    const char *word = name ? strstr(name, COLOUR) : NULL;
    char *other = NULL;
    if (!word ||
        asprintf(&other, "%.*s%s%s", (int)(word - name), name, COLOR, word + sizeof COLOUR - 1) < 0)
        return NULL;
    return other;
}

const struct argp_option *cli_options_spelt(const struct argp_option *table) {
    size_t rows = 1, n = 0;
    for (const struct argp_option *o = table; o && is_row(o); o++)
        rows += 2;
    struct argp_option *out = calloc(rows, sizeof *out);
    for (const struct argp_option *o = table; out && o && is_row(o); o++) {
        out[n++] = *o;
        const char *other = other_spelling(o->name);
        if (other)
            out[n++] = (struct argp_option){
                .name = other, .key = o->key, .flags = OPTION_ALIAS | OPTION_HIDDEN};
    }
    return out;
}

/* ---- the rows of one view ---- */

typedef struct rows {
    struct argp_option *list; /* ends with an empty row */
    size_t count;
} rows;

/* Append a row. A heading replaces a heading directly before it, which has no options. */
static void add_row(rows *r, struct argp_option option) {
    if (is_heading(&option) && r->count > 0 && is_heading(&r->list[r->count - 1]))
        r->count--;
    r->list[r->count++] = option;
}

/* Add the options of --help. Each gets its own group, so that argp keeps the order of the table. */
static void add_basic(rows *r, const struct argp_option *from, const char *without) {
    bool shown = false;
    for (const struct argp_option *o = from; is_row(o); o++) {
        struct argp_option row = *o;
        if (!(o->flags & OPTION_ALIAS))
            shown = o->flags & CLI_BASIC;
        if (!shown || (o->flags & OPTION_ALIAS) || cli_options_listed(without, o->name))
            continue;
        row.group = (int)r->count + 1;
        add_row(r, row);
    }
}

/* Add either the experiments, or all other options under their headings. An alias goes with the
 * option before it. */
static void add_all(rows *r, const struct argp_option *from, const char *without,
                    bool experiments) {
    bool experiment = false;
    for (const struct argp_option *o = from; is_row(o); o++) {
        struct argp_option row = *o;
        if (!(o->flags & OPTION_ALIAS))
            experiment = o->flags & CLI_EXPERIMENT;
        if (experiment != experiments || cli_options_listed(without, o->name))
            continue;
        if (experiment)
            row.group = GROUP_EXPERIMENTS;
        add_row(r, row);
    }
}

static bool has_experiments(const struct argp_option *from) {
    for (const struct argp_option *o = from; is_row(o); o++)
        if (o->flags & CLI_EXPERIMENT)
            return true;
    return false;
}

/* List the tables of a verb: its own, if it has one, then its children's. */
enum { TABLES_MAX = 4 };

static int tables_of(const struct argp *table, const struct argp_option *out[TABLES_MAX]) {
    int count = 0;
    if (table->options)
        out[count++] = table->options;
    for (const struct argp_child *c = table->children; c && c->argp && count < TABLES_MAX; c++)
        out[count++] = c->argp->options;
    return count;
}

static rows make_rows(const struct argp *table, const char *without, cli_view view) {
    const struct argp_option *tables[TABLES_MAX];
    const int count = tables_of(table, tables);
    size_t most = 2;
    for (int i = 0; i < count; i++)
        for (const struct argp_option *o = tables[i]; is_row(o); o++)
            most++;
    rows r = {.list = calloc(most, sizeof *r.list)};
    if (!r.list)
        return r;
    for (int i = 0; i < count; i++)
        if (view == CLI_VIEW_BASIC)
            add_basic(&r, tables[i], without);
        else
            add_all(&r, tables[i], without, false);
    if (view != CLI_VIEW_BASIC && has_experiments(tables[0])) {
        add_row(&r, (struct argp_option){.doc = "Experiments:", .group = GROUP_EXPERIMENTS});
        add_all(&r, tables[0], without, true);
    }
    return r;
}

/* ---- help ---- */

/* The parts of "does\vexample\vmore" that a view shows, in the form of argp's doc. Free the
 * result. */
static char *doc_of(const char *doc, cli_view view) {
    char *text = NULL;
    const char *first = doc ? doc : "";
    const int does = (int)strcspn(first, "\v");
    const char *second = first[does] ? first + does + 1 : "";
    const int shown = (int)strcspn(second, "\v");
    const char *third = second[shown] && view == CLI_VIEW_ALL ? second + shown + 1 : "";
    const char *gap = shown > 0 && *third ? "\n\n" : "";
    if (asprintf(&text, "%.*s\v%.*s%s%s", does, first, shown, second, gap, third) < 0)
        return NULL;
    return text;
}

void cli_options_help(const struct argp *table, const char *without, const char *command,
                      cli_view view, FILE *out) {
    rows r = make_rows(table, without, view);
    char *doc = doc_of(table->doc, view);
    const struct argp shown = {.options = r.list, .args_doc = table->args_doc, .doc = doc};
    char name[128];
    snprintf(name, sizeof name, "%s", command);
    if (r.list && doc)
        argp_help(&shown, out, view == CLI_VIEW_USAGE ? ARGP_HELP_USAGE : ARGP_HELP_STD_HELP, name);
    free(doc);
    free(r.list);
}

/* ---- the list for completion ---- */

static const char *class_of(const struct argp_option *o) {
    return o->flags & OPTION_ALIAS     ? "alias"
           : o->flags & CLI_EXPERIMENT ? "experiment"
           : o->flags & CLI_BASIC      ? "basic"
                                       : "more";
}

static void list_table(const struct argp_option *from, const char *without, FILE *out) {
    const char *arg = NULL, *doc = NULL;
    for (const struct argp_option *o = from; is_row(o); o++) {
        if (is_heading(o) || (o->flags & OPTION_HIDDEN) || cli_options_listed(without, o->name))
            continue;
        if (!(o->flags & OPTION_ALIAS)) {
            arg = o->arg;
            doc = o->doc;
        }
        fprintf(out, "--%s\t", o->name);
        if (o->key > 0 && o->key < 128 && isgraph(o->key) && !(o->flags & OPTION_ALIAS))
            fprintf(out, "-%c", o->key);
        fprintf(out, "\t%s%s\t%s\t%s\n", o->flags & OPTION_ARG_OPTIONAL ? "?" : "", arg ? arg : "",
                class_of(o), doc ? doc : "");
    }
}

void cli_options_list(const struct argp *table, const char *without, FILE *out) {
    const struct argp_option *tables[TABLES_MAX];
    const int count = tables_of(table, tables);
    /* Of several lines of arguments, list the first. */
    const char *args = table->args_doc ? table->args_doc : "";
    fprintf(out, "\t\t%.*s\t\t\n", (int)strcspn(args, "\n"), args);
    for (int i = 0; i < count; i++)
        list_table(tables[i], without, out);
}

/* ---- misspelt options ---- */

enum { NAME_MAX_COMPARED = 40 };

/* The edit distance: how many letters to change, add or leave out. */
static int distance(const char *a, const char *b) {
    int row[NAME_MAX_COMPARED + 1];
    const int n = (int)strlen(b);
    for (int j = 0; j <= n; j++)
        row[j] = j;
    for (int i = 0; a[i]; i++) {
        int corner = row[0]++;
        for (int j = 0; j < n; j++) {
            const int changed = corner + (a[i] != b[j]);
            const int shorter = (row[j] < row[j + 1] ? row[j] : row[j + 1]) + 1;
            corner = row[j + 1];
            row[j + 1] = changed < shorter ? changed : shorter;
        }
    }
    return row[n];
}

bool cli_options_nearest(const struct argp *table, const char *name, char *near, size_t room) {
    const struct argp_option *tables[TABLES_MAX];
    const int count = tables_of(table, tables);
    char word[NAME_MAX_COMPARED];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(name, "'="), name);
    /* Distances are doubled; another first letter adds 1, as slips rarely change it. */
    int best = strlen(word) > 3 ? 6 : 4;
    const int far = best;
    for (int i = 0; i < count; i++)
        for (const struct argp_option *o = tables[i]; is_row(o); o++) {
            if (!o->name || (o->flags & OPTION_HIDDEN) || strlen(o->name) > NAME_MAX_COMPARED)
                continue;
            const int d = 2 * distance(word, o->name) + (word[0] != o->name[0]);
            if (d < best)
                snprintf(near, room, "%s", o->name);
            best = d < best ? d : best;
        }
    return best < far;
}
