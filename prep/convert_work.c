#include "prep/convert_work.h"

#include <string.h>
#include <sys/stat.h>

#include "formats/base/file_guard.h"
#include "formats/leaf/leaf_file.h"
#include "prep/convert_request.h"

static status add_input(void *job, const char *path) {
    return convert_job_input(job, path);
}

/* Name the options and inputs that the output depends on. Options in the table's order. */
static status describe_job(const convert_request *a, mem *m, convert_job *j) {
    status st = convert_job_init(j, m, a->common.output);
    for (const struct argp_option *o = a->options; (o->name || o->doc) && st == ST_OK; o++)
        for (size_t i = 0; i < a->told_count && st == ST_OK; i++)
            if (o->name && a->told[i].key == o->key)
                st = convert_job_option(j, o->name, a->told[i].text ? a->told[i].text : "");
    for (int i = 0; i < a->common.input_count && st == ST_OK; i++)
        st = convert_job_input(j, a->common.inputs[i]);
    return st == ST_OK ? convert_request_beside(a, add_input, j) : st;
}

static status compare_job(void *ctx, state_io *io) {
    return convert_job_keep(ctx, io);
}

static status look_at_work(convert_request *a, bool *done) {
    work_folder *w = a->work.folder;
    a->work.resumes = work_folder_resumes(w);
    if (!a->work.resumes)
        return ST_OK;
    status st = work_folder_load(w, compare_job, &a->work.job);
    *done = st == ST_OK && work_folder_published(w);
    if (st == ST_OK && *done)
        cli_note(&a->common, 1, "%s: was complete already", a->common.output);
    else if (st == ST_OK)
        cli_note(&a->common, 1, "%s: goes on at %.0f %%", a->common.output,
                 100 * work_folder_share(w));
    return st;
}

/* ---- an output without unfinished work ---- */

/* Refuse to take the output for that of this job. */
static status no_output_of_this(const convert_request *a, status st, const char *why) {
    return status_describe(st,
                           "%s: is there already, and no unfinished work; but %s: --force makes it "
                           "again, another -o leaves it",
                           a->common.output, why);
}

/* ST_EXISTS: the input was written after the output. */
static status check_older(void *ctx, const char *input) {
    const struct stat *output = ctx;
    struct stat s;
    if (stat(input, &s) != 0)
        return ST_OK; /* the output is there without it */
    const bool later =
        s.st_mtim.tv_sec > output->st_mtim.tv_sec ||
        (s.st_mtim.tv_sec == output->st_mtim.tv_sec && s.st_mtim.tv_nsec > output->st_mtim.tv_nsec);
    return later ? ST_EXISTS : ST_OK;
}

/* Look whether the output is whole, and may be of this job. It does not say with which options it
 * was made. */
static status look_at_output(const convert_request *a, mem *m, struct stat *output) {
    leaf_file *f = NULL;
    file_guard_look(true);
    const status st = leaf_file_open(m, a->common.output, &f);
    file_guard_look(false);
    const bool in_place = st == ST_OK && f->samples;
    leaf_file_close(f);
    if (st != ST_OK)
        return no_output_of_this(a, st, status_text());
    for (int i = 0; i < a->common.input_count; i++) {
        if (strcmp(a->common.inputs[i], "-") == 0)
            return no_output_of_this(a, ST_EXISTS, "whether it is of standard input is not known");
        if (check_older(output, a->common.inputs[i]) != ST_OK)
            return no_output_of_this(a, ST_EXISTS, "its input was written after it");
    }
    if (convert_request_beside(a, check_older, output) != ST_OK)
        return no_output_of_this(a, ST_EXISTS, "a file that an option names was written after it");
    if (in_place != a->in_place)
        return no_output_of_this(a, ST_EXISTS,
                                 in_place ? "it was made with --in-place"
                                          : "it was made without --in-place");
    cli_note(&a->common, 1,
             "%s: is there already, whole, and written after its input: nothing is done (if other "
             "options are wanted than it was made with, --force makes it again)",
             a->common.output);
    return ST_OK;
}

/* With --resume: an earlier run may have been done. */
static status look_for_output(const convert_request *a, mem *m, bool *done) {
    struct stat output;
    *done =
        a->resume && !a->work.resumes && !a->common.force && stat(a->common.output, &output) == 0;
    return *done ? look_at_output(a, m, &output) : ST_OK;
}

status convert_work_open(convert_request *a, mem *m, bool *done) {
    const work_found found = a->resume ? WORK_RESUME : a->common.force ? WORK_REMOVE : WORK_REFUSE;
    *done = false;
    status st = describe_job(a, m, &a->work.job);
    if (st == ST_OK)
        st = work_folder_open(m, a->common.output, found, a->checkpoint, &a->work.folder);
    if (st == ST_OK)
        st = look_at_work(a, done);
    if (st == ST_OK && !*done)
        st = look_for_output(a, m, done);
    return st;
}

/* Whether another run may come further than this one. What an earlier run has left stays. */
static bool may_go_on(const convert_request *a, status st) {
    return (a->work.resumes && st != ST_OK) || st == ST_STOPPED || st == ST_NOSPACE ||
           st == ST_NOMEM || st == ST_IO || st == ST_USAGE;
}

status convert_work_close(convert_request *a, status st) {
    convert_job_release(&a->work.job);
    if (!a->work.folder)
        return st;
    const double share = work_folder_share(a->work.folder);
    a->common.resumable = work_folder_close(a->work.folder, may_go_on(a, st));
    a->work.folder = NULL;
    if (!a->common.resumable)
        return st;
    return status_describe(st, "%s (%.0f %% is done: the same command with --resume goes on)",
                           status_text(), 100 * share);
}
