/* leafcast verify - checks whether every byte of a treelet file is sound. */
#include <jansson.h>
#include <stdio.h>

#include "formats/base/cli.h"
#include "formats/base/text.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_verify.h"

typedef struct arguments {
    cli_common common;
} arguments;

static status check(void *own) {
    const arguments *a = own;
    return a->common.input ? ST_OK : status_describe(ST_USAGE, "a treelet file is needed");
}

static const cli_verb verb = {
    .check = check,
    .input = "file",
    .args_doc = "F.leaf",
    .doc = "Check every byte of a treelet file: checksums, padding, ranges, the codes of every "
           "tree against its samples, samples that neighbours share; of a mesh, that boxes and "
           "ranges are those of their tets. Exit code 0 if it is sound, 3 if not."
           "\vExample:\n  leafcast verify bonsai.leaf",
};

static status report(const arguments *a, const leaf_file *f) {
    const leaf_header *h = &f->header;
    char id[LEAF_ID_TEXT], path[4096];
    leaf_id_text(h, id);
    if (!a->common.json) {
        if (!cli_results(&a->common, true))
            return ST_OK;
        printf("%s: sound: %llu treelets, %llu bytes, id %s\n",
               text_printable(path, sizeof path, a->common.input), (unsigned long long)h->treelets,
               (unsigned long long)h->file_bytes, id);
        return ST_OK;
    }
    json_t *json =
        json_pack("{s:b, s:I, s:I, s:s}", "sound", 1, "treelets", (json_int_t)h->treelets,
                  "file_bytes", (json_int_t)h->file_bytes, "id", id);
    return cli_print_json(&a->common, json);
}

static status run(arguments *a) {
    mem m;
    mem_init(&m, a->common.memory);
    leaf_file *f = NULL;
    status st = leaf_file_open(&m, a->common.input, &f);
    if (st == ST_OK)
        st = leaf_verify(&m, f, a->common.threads, cli_progress(&a->common));
    if (st == ST_OK)
        st = report(a, f);
    leaf_file_close(f);
    return st;
}

int main(int argc, char **argv) {
    arguments a = {.common = {.verb = "verify", .without = "output force"}};
    cli_parse(&verb, &a.common, argc, argv);
    return cli_finish(&a.common, run(&a));
}
