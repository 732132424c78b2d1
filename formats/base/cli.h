/* cli.h - what all verbs share: common flags, exit codes, messages, the progress bar, Ctrl-C.
 *
 * A verb describes itself in a cli_verb: its own options in a table of glibc's argp, and the
 * function that takes their values. An option's value may start with a minus: --iso -500. Only main
 * programs (*_main.c) include this; the library never does.
 */
#ifndef FORMATS_BASE_CLI_H
#define FORMATS_BASE_CLI_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/cli_json.h"
#include "formats/base/cli_options.h"
#include "formats/base/mem.h"
#include "formats/base/output_name.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"

typedef struct cli_common {
    const char *verb;    /* set by the verb before parsing, and kept as it is */
    const char *without; /* common options that the verb refuses, separated by blanks; or NULL */
    const char *input;   /* the first argument; NULL when there are none */
    char **inputs;       /* all arguments */
    int input_count;
    const char *output; /* -o FILE; NULL when absent */
    int threads;        /* --threads N; default: the CPUs this process may use */
    uint64_t memory;    /* --memory SIZE in bytes; 0 when absent */
    int verbosity;      /* 0 quiet, 1 normal, 2+ verbose */
    bool json;          /* --json */
    bool json_lines;    /* --json prints one line per document; the verb sets it before it prints
                           any */
    bool force;         /* --force: overwrite outputs */
    bool resumable;     /* the job failed, but another run can go on; the verb sets it */
    uint64_t given[2];  /* bits for the verb's own options, see cli_given() */
} cli_common;

typedef struct cli_verb {
    const struct argp_option *options; /* the verb's own options; NULL: none */
    const char *args_doc, *doc;        /* as argp's; doc: see cli_options.h */
    const char *input;                 /* what an argument is, for messages: "treelet file" */
    int inputs_max;                    /* most arguments; 0: one */
    /* Set one of the verb's own options; text is NULL where it takes no value. Returns ST_AGAIN for
     * a key that is none of them. own: the struct that begins with the verb's cli_common. NULL: the
     * verb has no options of its own. */
    status (*set_option)(void *own, int key, const char *text);
    status (*check)(void *own); /* check the options together, after parsing; NULL: nothing to
                                   check */
    /* Returns what -o names, asked after check(). A name that says another format is a usage error.
     * NULL: the verb has no -o. */
    const output_kind *(*output)(const void *own);
} cli_verb;

/* cli_parse() - parse argv for a verb, whose options begin with `common`.
 *
 * --version, and the options that ask for help (see cli_options.h), print on stdout and exit 0. A
 * usage error prints the error and a line that says where help is, both on stderr, and exits 2.
 * (Only main programs call this function, so it may exit.)
 * Sets the defaults of common, except its verb. set_option() and check() return usage errors.
 * Installs handlers for SIGINT, SIGTERM and SIGHUP that make the progress of cli_progress() stop
 * the job; a second signal kills. Ignores SIGPIPE and SIGXFSZ, so that the write itself fails.
 */
void cli_parse(const cli_verb *verb, cli_common *common, int argc, char **argv);

/* cli_given() - whether one of the verb's own options was given. */
bool cli_given(const cli_common *common, int key);

/* An option that only some inputs can use. inputs: bits that the verb defines. */
typedef struct cli_use {
    int key;
    unsigned inputs;
} cli_use;

/* cli_check_uses() - returns ST_USAGE for an option that was given but that this input cannot use,
 * since it would change nothing. input: the input's bit. format: its format, for the message.
 * names[cli_use.inputs]: what those inputs are called. */
CHECKED status cli_check_uses(const cli_common *common, const cli_use *uses, size_t count,
                              unsigned input, const char *const *names, const char *format);

/* cli_check_files() - before any work: register the input, announce the outputs to file_guard.h,
 * and check that they can be created. NULL: not written. m: for the checks. */
CHECKED status cli_check_files(const cli_common *common, mem *m, const char *const *outputs,
                               int count);

/* cli_progress() - the progress of the job: a bar on a terminal, otherwise a line every few
 * seconds; nothing with -q. Valid for the life of the process. */
const progress *cli_progress(cli_common *common);

/* cli_signal() - the signal that asked the job to stop; 0: none. */
int cli_signal(void);

/* cli_note() - print "leafcast VERB: ..." on stderr, if common's verbosity is at least this one. */
void cli_note(const cli_common *common, int verbosity, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/* cli_results() - call it before results are printed on stdout: it removes the progress bar.
 * Returns whether to print them: -q suppresses a mere summary of what was done. */
bool cli_results(const cli_common *common, bool summary);

/* cli_print_json() - print the verb's results on stdout, as one document or as one of several
 * lines. Takes the reference. Errors as of cli_json_write(). */
CHECKED status cli_print_json(const cli_common *common, json_t *results);

/* cli_error_json() - the described error as the JSON that --json prints. */
json_t *cli_error_json(status st);

/* cli_flush() - flush standard output. Returns ST_NOSPACE or ST_IO, with the reason, where results
 * did not reach it. cli_finish() calls this, too. */
CHECKED status cli_flush(void);

/* cli_finish() - end the progress bar. Print the error, if any, on stderr, and with --json also as
 * JSON on stdout; with -v also the time and memory used. Returns the exit code: 0 ok, 1 failure, 2
 * usage, 3 malformed or unsupported input, 4 out of memory or disk; when signal n stopped the job,
 * 5 if it is resumable, else 128+n. */
int cli_finish(const cli_common *common, status st);

#endif
