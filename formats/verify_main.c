/* leafcast verify - checks whether every byte of a treelet file is sound. */
#include <jansson.h>
#include <stdio.h>

#include "formats/base/cli.h"
#include "formats/base/file_guard.h"
#include "formats/base/text.h"
#include "formats/leaf/leaf_damage.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_repair.h"
#include "formats/leaf/leaf_verify.h"

typedef struct arguments {
    cli_common common;
    const char *from; /* --repair; NULL: only check */
} arguments;

enum { KEY_REPAIR = 0x2000 };

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "Repair:", 1},
    {"repair", KEY_REPAIR, "F.leaf", CLI_BASIC,
     "make the file whole from this copy of it, in its place or, with -o, in another", 1},
    {NULL, 0, NULL, 0, NULL, 0}};

static status set_option(void *own, int key, const char *text) {
    arguments *a = own;
    if (key != KEY_REPAIR)
        return ST_AGAIN;
    a->from = text;
    return ST_OK;
}

static status check(void *own) {
    const arguments *a = own;
    if (!a->common.input)
        return status_describe(ST_USAGE, "a treelet file is needed");
    if (a->from || (!a->common.output && !a->common.force))
        return ST_OK;
    return status_describe(ST_USAGE, "without --repair there is no %s: it would change nothing",
                           a->common.output ? "--output" : "--force");
}

static const output_kind *output(const void *own) {
    static const output_kind leaf = {.what = "a treelet file",
                                     .suffixes = ".leaf ",
                                     .instead = "`leafcast export F.leaf -o FILE' writes others"};
    (void)own;
    return &leaf;
}

static const cli_verb verb = {
    .options = options,
    .set_option = set_option,
    .check = check,
    .output = output,
    .input = "file",
    .args_doc = "F.leaf",
    .doc = "Check every byte of a treelet file: checksums, padding, ranges, the codes of every "
           "tree against its samples, samples that neighbours share; of a mesh, that boxes and "
           "ranges are those of their tets. Exit code 0 if it is sound, 3 if not. With --repair, "
           "take what is damaged from another copy of the file."
           "\vExample:\n  leafcast verify bonsai.leaf\v"
           "The other copy may be damaged, too, elsewhere; both may be cut short. What is damaged "
           "in both is listed, and then nothing is written. The result is checked before it "
           "gets its name.",
};

static json_t *facts(const leaf_header *h) {
    char id[LEAF_ID_TEXT];
    return json_pack("{s:b, s:I, s:I, s:s}", "sound", 1, "treelets", (json_int_t)h->treelets,
                     "file_bytes", (json_int_t)h->file_bytes, "id", leaf_id_text(h, id));
}

static void print_sound(const char *name, const leaf_header *h) {
    char id[LEAF_ID_TEXT], path[4096];
    printf("%s: sound: %llu treelets, %llu bytes, id %s\n", text_printable(path, sizeof path, name),
           (unsigned long long)h->treelets, (unsigned long long)h->file_bytes, leaf_id_text(h, id));
}

static status report(const arguments *a, const leaf_file *f) {
    if (a->common.json)
        return cli_print_json(&a->common, facts(&f->header));
    if (cli_results(&a->common, true))
        print_sound(a->common.input, &f->header);
    return ST_OK;
}

static status check_file(arguments *a, mem *m) {
    const progress *p = cli_progress(&a->common);
    leaf_file *f = NULL;
    status st = leaf_file_open(m, a->common.input, &f);
    if (st == ST_OK)
        st = leaf_verify(m, f, a->common.threads, p);
    if (st == ST_CORRUPT && f)
        st = leaf_damage_tell(m, f, p);
    if (st == ST_OK)
        st = report(a, f);
    leaf_file_close(f);
    return st;
}

/* ---- repair ---- */

static json_t *repair_facts(const leaf_repair_result *r) {
    json_t *json = facts(&r->header);
    json_t *more =
        json_pack("{s:b, s:I, s:I, s:I, s:I, s:I}", "mended", r->mended, "payloads_kept",
                  (json_int_t)r->payloads[LEAF_REPAIR_BAD], "payloads_taken",
                  (json_int_t)r->payloads[LEAF_REPAIR_FROM], "directory_kept",
                  (json_int_t)r->directory[LEAF_REPAIR_BAD], "directory_taken",
                  (json_int_t)r->directory[LEAF_REPAIR_FROM], "gaps", (json_int_t)r->gaps);
    json_object_update(json, more);
    json_decref(more);
    return json;
}

static status report_repair(const arguments *a, const leaf_repair_result *r) {
    const char *made = a->common.output ? a->common.output : a->common.input;
    char path[4096];
    if (a->common.json)
        return cli_print_json(&a->common, repair_facts(r));
    if (!cli_results(&a->common, true))
        return ST_OK;
    print_sound(made, &r->header);
    if (!r->mended) {
        printf("nothing was damaged\n");
        return ST_OK;
    }
    printf("from %s: %llu of %llu payloads, %llu of %llu parts of the directory\n",
           text_printable(path, sizeof path, a->from),
           (unsigned long long)r->payloads[LEAF_REPAIR_FROM],
           (unsigned long long)(r->payloads[0] + r->payloads[1]),
           (unsigned long long)r->directory[LEAF_REPAIR_FROM],
           (unsigned long long)(r->directory[0] + r->directory[1]));
    if (r->gaps)
        printf("zeros again: %llu gaps\n", (unsigned long long)r->gaps);
    return ST_OK;
}

/* Check all paths before work begins. Without -o, the file itself is the output. */
static status guard_files(const arguments *a, mem *m) {
    if (a->common.output) {
        status st = file_guard_input(a->from);
        return st == ST_OK ? cli_check_files(&a->common, m, &(const char *){a->common.output}, 1)
                           : st;
    }
    status st = file_guard_output(a->common.input);
    return st == ST_OK ? file_guard_input(a->from) : st;
}

static status repair_file(arguments *a, mem *m) {
    leaf_repair_result result;
    const leaf_repair_job job = {.bad = a->common.input,
                                 .from = a->from,
                                 .output = a->common.output,
                                 .force = a->common.force,
                                 .threads = a->common.threads,
                                 .progress = cli_progress(&a->common)};
    status st = guard_files(a, m);
    if (st == ST_OK)
        st = leaf_repair(m, &job, &result);
    return st == ST_OK ? report_repair(a, &result) : st;
}

int main(int argc, char **argv) {
    arguments a = {.common = {.verb = "verify"}};
    mem m;
    cli_parse(&verb, &a.common, argc, argv);
    mem_init(&m, a.common.memory);
    return cli_finish(&a.common, a.from ? repair_file(&a, &m) : check_file(&a, &m));
}
