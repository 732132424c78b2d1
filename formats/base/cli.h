/* cli.h - what all verbs share: common flags, exit codes, messages, the progress bar, Ctrl-C.
 *
 * A verb describes itself in a cli_verb: its own options, in a table of glibc's argp, and what
 * takes their values. An option's value may start with a minus: --iso -500. Only main programs
 * (*_main.c) include this; the library never does.
 */
#ifndef FORMATS_BASE_CLI_H
#define FORMATS_BASE_CLI_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/cli_json.h"
#include "formats/base/cli_options.h"
#include "formats/base/output_name.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"

typedef struct cli_common {
    const char *verb;    /* set by the verb before parsing, as is */
    const char *without; /* names, divided by blanks, of common options that it refuses; or NULL */
    const char *input;   /* the first of the arguments; NULL when there are none */
    char **inputs;       /* all of them */
    int input_count;
    const char *output; /* -o FILE; NULL when absent */
    int threads;        /* --threads N; default: the CPUs this process may use */
    uint64_t memory;    /* --memory SIZE in bytes; 0 when absent */
    int verbosity;      /* 0 quiet, 1 normal, 2+ verbose */
    bool json;          /* --json */
    bool json_lines;    /* --json gives a line each time: set by the verb, before it prints any */
    bool force;         /* --force: overwrite outputs */
    uint64_t given[2];  /* of the verb's own options: cli_given() */
} cli_common;

typedef struct cli_verb {
    const struct argp_option *options; /* its own; NULL: none */
    const char *args_doc, *doc;        /* as argp's; doc: see cli_options.h */
    const char *input;                 /* what an argument is, for messages: "treelet file" */
    int inputs_max;                    /* 0: one */
    /* One of its options, text NULL where it takes none. ST_AGAIN: it is none of them. own: the
     * struct that begins with the verb's cli_common. NULL: there are none. */
    status (*set_option)(void *own, int key, const char *text);
    status (*check)(void *own); /* what must hold over all of them */
    /* What -o names, behind check(): a name that says another format is a usage error. NULL: it
     * has no -o. */
    const output_kind *(*output)(const void *own);
} cli_verb;

/* cli_parse() - parse argv for a verb, whose options begin with `common`. Options that ask for
 * help, see cli_options.h, and --version print on stdout and exit 0; a usage error prints a line on
 * stderr, and one that says where help is, and exits 2 (this is a main program's function, it may).
 * Sets the defaults of common but for its verb; set_option() and check() return usage errors.
 * Installs the handlers for SIGINT, SIGTERM and SIGHUP that make the progress of cli_progress()
 * stop the job; a second signal kills. Ignores SIGPIPE and SIGXFSZ, so that they come back as
 * errors of the write.
 */
void cli_parse(const cli_verb *verb, cli_common *common, int argc, char **argv);

/* cli_given() - whether an option of the verb's own was given. */
bool cli_given(const cli_common *common, int key);

/* An option that only some inputs can use: bits of the verb's own. */
typedef struct cli_use {
    int key;
    unsigned inputs;
} cli_use;

/* cli_check_uses() - ST_USAGE for an option that was given, and which this input, of a format so
 * called, cannot use: it would change nothing. names: what the inputs of a cli_use are called. */
CHECKED status cli_check_uses(const cli_common *common, const cli_use *uses, size_t count,
                              unsigned input, const char *const *names, const char *format);

/* cli_progress() - bar on a terminal, otherwise a line every few seconds, nothing with -q. Valid
 * for the process's life. */
const progress *cli_progress(cli_common *common);

/* cli_signal() - the signal that has asked the job to stop; 0: none has. */
int cli_signal(void);

/* cli_note() - a message on stderr at this verbosity: "leafcast VERB: ..." */
void cli_note(const cli_common *common, int verbosity, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/* cli_results() - to be called before results are printed on stdout: takes the progress bar away.
 * Whether they are wanted: a summary of what was done is not with -q. */
bool cli_results(const cli_common *common, bool summary);

/* cli_print_json() - the verb's results (takes the reference) on stdout, as one document or as one
 * of several lines. An error where it cannot be; see cli_json_write(). */
CHECKED status cli_print_json(const cli_common *common, json_t *results);

/* cli_error_json() - the described error as --json tells it. */
json_t *cli_error_json(status st);

/* cli_flush() - results that did not reach standard output are a failure: ST_NOSPACE or ST_IO, with
 * the reason. cli_finish() asks it, too. */
CHECKED status cli_flush(void);

/* cli_finish() - end the progress bar; say the error, if any, on stderr, with --json also as JSON
 * on stdout; with -v what it took; return the exit code: 0 ok, 1 failure, 2 usage, 3 malformed or
 * unsupported input, 4 out of memory or disk, 128+n when signal n stopped the job. */
int cli_finish(const cli_common *common, status st);

#endif
