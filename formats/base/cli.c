#include "formats/base/cli.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <stdnoreturn.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "formats/base/bus_error.h"
#include "formats/base/cli_value.h"
#include "formats/base/clock.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "formats/base/partial.h"
#include "formats/base/pool.h"
#include "formats/base/text.h"
#include "formats/base/wait.h"

#ifndef LEAFCAST_VERSION
#define LEAFCAST_VERSION "unknown"
#endif

enum { EXIT_RESUMABLE = 5, EXIT_SIGNAL = 128, MAX_THREADS = 4096 };

/* ---- signals ---- */

static atomic_int caught; /* lock-free: a handler may write it, and any thread read it */

static void on_signal(int number) {
    caught = number;
}

static bool signal_caught(void) {
    return caught != 0;
}

int cli_signal(void) {
    return caught;
}

static void install_signals(void) {
    /* The first signal asks the job to stop; a second one of the same kind ends the process as
     * usual. A signal also ends a write of results that waits for its reader, hence no
     * SA_RESTART. */
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND};
    const int stopping[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < sizeof stopping / sizeof stopping[0]; i++) {
        struct sigaction before;
        /* Signals that the caller ignored (nohup) stay ignored. */
        if (sigaction(stopping[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(stopping[i], &action, NULL);
    }
    /* A file that may not grow and a reader that went away become errors of the write, described
     * like any other. */
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
    wait_stop_when(signal_caught);
}

/* ---- results and errors ---- */

/* Results that did not reach standard output are a failure, too. */
status cli_flush(void) {
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return ST_OK;
    return status_describe(errno == ENOSPC ? ST_NOSPACE : ST_IO,
                           "standard output: cannot write: %s", strerror(errno ? errno : EIO));
}

json_t *cli_error_json(status st) {
    return cli_json_error(st, status_exit_code(st), status_text());
}

/* ---- flags ---- */

enum {
    KEY_THREADS = 0x1000,
    KEY_MEMORY,
    KEY_JSON,
    KEY_FORCE,
    KEY_HELP_ALL,
    KEY_USAGE,
    KEY_VERSION,
    KEY_LIST
};

static const struct argp_option common_options[] = {
    {NULL, 0, NULL, 0, "Common options:", 90},
    {"output", 'o', "FILE", CLI_BASIC, "write to FILE", 0},
    {"quiet", 'q', NULL, 0, "say nothing but errors", 0},
    {"verbose", 'v', NULL, 0, "say more (-vv: even more)", 0},
    {"threads", KEY_THREADS, "N", 0, "use N threads (default: all CPUs this process may use)", 0},
    {"memory", KEY_MEMORY, "SIZE", 0, "stay below SIZE bytes of memory, such as 256M or 2G", 0},
    {"json", KEY_JSON, NULL, 0, "results and errors as JSON", 0},
    {"force", KEY_FORCE, NULL, CLI_BASIC, "overwrite existing outputs", 0},
    {"help", 'h', NULL, CLI_BASIC, "what most people need", 0},
    {"help-all", KEY_HELP_ALL, NULL, CLI_BASIC, "all options, experiments last", 0},
    {"usage", KEY_USAGE, NULL, 0, "all options in a few lines", 0},
    {"version", KEY_VERSION, NULL, 0, "the version", 0},
    {"list-options", KEY_LIST, NULL, OPTION_HIDDEN, "for completion: a line an option", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

/* End the process unless st is ST_OK. */
static void usage_unless(struct argp_state *state, status st) {
    if (st != ST_OK)
        argp_error(state, "%s", status_text());
}

/* The table being parsed, for its help. */
static const struct argp *parsed;
static char command[128];       /* "leafcast VERB" */
static const cli_common *sayer; /* whose verbosity say_leftover() obeys */

static noreturn void tell(const cli_common *c, int key) {
    /* Leave out the remark that short options take arguments, too. */
    setenv("ARGP_HELP_FMT", "no-dup-args-note", 0);
    switch (key) {
    case 'h': cli_options_help(parsed, c->without, command, CLI_VIEW_BASIC, stdout); break;
    case KEY_HELP_ALL: cli_options_help(parsed, c->without, command, CLI_VIEW_ALL, stdout); break;
    case KEY_USAGE: cli_options_help(parsed, c->without, command, CLI_VIEW_USAGE, stdout); break;
    case KEY_LIST: cli_options_list(parsed, c->without, stdout); break;
    default: printf("leafcast %s\n", LEAFCAST_VERSION);
    }
    const status st = cli_flush();
    if (st != ST_OK)
        fprintf(stderr, "%s: %s\n", command, status_text());
    exit(status_exit_code(st));
}

/* Refuse the hidden --list-options when abbreviated: people try --list. */
static void refuse_hidden(struct argp_state *state, int key) {
    if (key == KEY_LIST && strcmp(state->argv[state->next - 1], "--list-options") != 0)
        argp_error(state,
                   "there is no option %s; `leafcast info INPUT' tells what there is in a file",
                   state->argv[state->next - 1]);
}

/* Refuse a common option that this verb does not have. */
static void refuse_option(struct argp_state *state, const cli_common *c, int key) {
    for (const struct argp_option *o = common_options; o->name || o->doc; o++)
        if (o->key == key && o->name && cli_options_listed(c->without, o->name))
            argp_error(state, "there is no --%s: it would change nothing", o->name);
}

static error_t parse_common(int key, char *arg, struct argp_state *state) {
    cli_common *c = state->input;
    refuse_option(state, c, key);
    refuse_hidden(state, key);
    switch (key) {
    case 'o': c->output = arg; break;
    case 'q': c->verbosity = 0; break;
    case 'v': c->verbosity++; break;
    case KEY_THREADS:
        usage_unless(state, cli_int(arg, "--threads", 1, MAX_THREADS, &c->threads));
        break;
    case KEY_MEMORY:
        usage_unless(state, num_size(arg, "--memory", &c->memory));
        if (c->memory == 0)
            argp_error(state, "--memory: a size above 0 is needed");
        break;
    case KEY_JSON: c->json = true; break;
    case KEY_FORCE: c->force = true; break;
    case 'h':
    case KEY_HELP_ALL:
    case KEY_USAGE:
    case KEY_VERSION:
    case KEY_LIST: tell(c, key);
    case ARGP_KEY_END:
        if (c->json && c->output && strcmp(c->output, "-") == 0)
            argp_error(state, "--json: standard output is taken by -o -");
        break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static const struct argp common_argp = {.options = common_options, .parser = parse_common};

static const cli_verb *parsed_verb;

/* The row of an option in the verb's table. */
static int row_of(int key) {
    int row = 0;
    while (parsed_verb->options[row].key != key)
        row++;
    return row;
}

bool cli_given(const cli_common *common, int key) {
    const int row = row_of(key);
    return common->given[row / 64] >> row % 64 & 1;
}

static void note_given(cli_common *c, int row) {
    assert(row < (int)(8 * sizeof c->given));
    c->given[row / 64] |= (uint64_t)1 << row % 64;
}

status cli_check_uses(const cli_common *common, const cli_use *uses, size_t count, unsigned input,
                      const char *const *names, const char *format) {
    for (size_t i = 0; i < count; i++) {
        assert(names[uses[i].inputs]);
        if (cli_given(common, uses[i].key) && !(uses[i].inputs & input))
            return status_describe(
                ST_USAGE, "--%s is for %s, and %s is %s: it would change nothing",
                parsed_verb->options[row_of(uses[i].key)].name, names[uses[i].inputs],
                strcmp(common->input, "-") ? common->input : "standard input", format);
    }
    return ST_OK;
}

static error_t parse_verb(int key, char *arg, struct argp_state *state) {
    const cli_verb *verb = parsed_verb;
    cli_common *c = state->input;
    const int most = verb->inputs_max ? verb->inputs_max : 1;
    status st = ST_AGAIN;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = c; return 0;
    case ARGP_KEY_ARGS:
        c->inputs = state->argv + state->next;
        c->input_count = state->argc - state->next;
        c->input = c->inputs[0];
        if (c->input_count > most && most > 1)
            argp_error(state, "more than %d arguments", most);
        else if (c->input_count > most)
            argp_error(state, "%s: one %s is enough", c->inputs[1], verb->input);
        return 0;
    case ARGP_KEY_END:
        usage_unless(state, verb->check ? verb->check(c) : ST_OK);
        usage_unless(state, verb->output ? output_name_check(c->output, verb->output(c)) : ST_OK);
        return 0;
    default:
        if (verb->set_option && key > 0 && key < ARGP_KEY_END)
            st = verb->set_option(c, key, arg);
        if (st == ST_AGAIN)
            return ARGP_ERR_UNKNOWN;
        usage_unless(state, st);
        note_given(c, row_of(key));
        return 0;
    }
}

/* ---- usage errors ---- */

/* argp and getopt write to stderr and exit. While they parse, stderr is a buffer. It is printed
 * when the program ends, with a suggestion, and as JSON where that was asked for. */
static struct {
    FILE *stream, *real; /* stream: NULL once parsing is over */
    char text[8192];
    bool json, cut; /* cut: the buffer or the memory did not suffice */
} said;

static void stop_listening(void) {
    said.cut = ferror(said.stream) != 0;
    said.cut |= fclose(said.stream) != 0;
    stderr = said.real;
    said.stream = NULL;
}

/* Reduce an error to its message: the first line, without the command. */
static void cut_message(char *message) {
    const size_t prefix = strlen(command);
    message[strcspn(message, "\n")] = 0;
    if (strncmp(message, command, prefix) == 0 && message[prefix] == ':')
        memmove(message, message + prefix + 2, strlen(message + prefix + 2) + 1);
}

static void at_exit(void) {
    char message[STATUS_TEXT_MAX], near[64] = "";
    if (!said.stream)
        return;
    stop_listening();
    if (!said.text[0] && !said.cut)
        return;
    snprintf(message, sizeof message, "%.*s", (int)sizeof message - 1, said.text);
    const bool slip = strstr(message, "unrecognized option '--") != NULL;
    if (slip && cli_options_nearest(parsed, strstr(message, "'--") + 3, near, sizeof near))
        fprintf(stderr, "%.*s; did you mean '--%s'?%s", (int)strcspn(said.text, "\n"), said.text,
                near, said.text + strcspn(said.text, "\n"));
    else
        fputs(said.text, stderr);
    if (said.cut)
        fprintf(stderr, "...\n%s: that message is longer, and was cut\n", command);
    cut_message(message);
    const int code = status_exit_code(ST_USAGE);
    if (said.json && cli_json_write(stdout, cli_json_error(ST_USAGE, code, message), false))
        fprintf(stderr, "%s: %s\n", command, status_text());
}

static void listen_in(int argc, char **argv) {
    /* Look for --json before parsing: it may stand behind the faulty option. */
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        said.json |= strlen(argv[i]) > 2 && strncmp("--json", argv[i], strlen(argv[i])) == 0;
    said.real = stderr;
    said.stream = fmemopen(said.text, sizeof said.text - 1, "w");
    if (said.stream && atexit(at_exit) == 0)
        stderr = said.stream;
}

/* ---- parsing ---- */

static double started; /* when the verb began, in clock_seconds() */

/* An output must never be opened as descriptor 0, 1 or 2: messages would be written into it. A
 * closed one is filled with a descriptor that stays useless: it cannot be written (0: read). */
static void fill_standard(void) {
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        if (fcntl(fd, F_GETFD) < 0 && errno == EBADF &&
            open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) != fd)
            _exit(status_exit_code(ST_NOSPACE));
}

static void say_leftover(const char *name, uint64_t bytes, bool removed) {
    cli_note(sayer, 1,
             removed ? "removed %s, which a killed run left (%.1f MiB)"
                     : "%s may be what a killed run left (%.1f MiB); remove it if no other machine "
                       "writes it",
             name, (double)bytes / 0x1p20);
}

void cli_parse(const cli_verb *verb, cli_common *common, int argc, char **argv) {
    static struct argp table;
    static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {NULL, 0, NULL, 0}};
    /* Messages start with the command as typed: argp takes it from argv[0]. */
    snprintf(command, sizeof command, "leafcast %s", common->verb);
    if (argc > 0)
        argv[0] = command;
    fill_standard();
    install_signals();
    bus_error_install(command);
    cli_json_watch();
    started = clock_seconds();
    sayer = common;
    partial_on_leftover(say_leftover);
    common->threads = pool_default_threads();
    common->verbosity = 1;
    argp_err_exit_status = status_exit_code(ST_USAGE);
    parsed_verb = verb;
    const struct argp_option *spelt = cli_options_spelt(verb->options);
    table = (struct argp){.options = spelt ? spelt : verb->options,
                          .parser = parse_verb,
                          .args_doc = verb->args_doc,
                          .doc = verb->doc,
                          .children = children};
    parsed = &table;
    listen_in(argc, argv);
    error_t error = argp_parse(parsed, argc, argv, ARGP_NO_HELP, NULL, common);
    if (error) {
        fprintf(stderr, "%s: %s\n", command, strerror(error));
        exit(status_exit_code(ST_USAGE));
    }
    if (said.stream)
        stop_listening();
    cli_note(common, 3, "%d threads; memory: %.1f MiB (0: the verb's own measure)", common->threads,
             (double)common->memory / 0x1p20);
}

/* ---- progress ---- */

static struct {
    pthread_mutex_t lock;
    progress interface;
    const char *verb;
    bool bar;
    bool stages;       /* -v: print each stage as it begins */
    const char *stage; /* the stage of the last report */
    bool drawn;        /* a bar stands on the current line */
    double start;      /* when the job began, seconds */
    double next;       /* print nothing before this time, seconds */
    double fraction;   /* never goes back */
} meter = {.lock = PTHREAD_MUTEX_INITIALIZER};

static void print_duration(char *text, size_t room, double seconds) {
    if (!(seconds < 360000))
        snprintf(text, room, "--:--");
    else if (seconds >= 3600)
        snprintf(text, room, "%d:%02d:%02d", (int)seconds / 3600, (int)seconds / 60 % 60,
                 (int)seconds % 60);
    else
        snprintf(text, room, "%d:%02d", (int)seconds / 60, (int)seconds % 60);
}

static void draw_bar(const char *stage, const char *eta) {
    enum { WIDTH = 30 };
    char cells[WIDTH + 1];
    int filled = (int)(meter.fraction * WIDTH);
    for (int i = 0; i < WIDTH; i++)
        cells[i] = i < filled ? '#' : '.';
    cells[WIDTH] = 0;
    fprintf(stderr, "\r\033[K[%s] %3d%%  %s left  %s", cells, (int)(meter.fraction * 100), eta,
            stage);
    fflush(stderr);
    meter.drawn = true;
}

static void erase_bar(void) {
    if (meter.drawn)
        fputs("\r\033[K", stderr);
    meter.drawn = false;
}

static void tell_stage(const char *stage, double t) {
    if (!meter.stages || (meter.stage && strcmp(meter.stage, stage) == 0))
        return;
    erase_bar();
    fprintf(stderr, "leafcast %s: at %.2f s: %s\n", meter.verb, t - started, stage);
    meter.stage = stage;
}

static void report(void *ctx, const char *stage, double fraction) {
    (void)ctx;
    pthread_mutex_lock(&meter.lock);
    double t = clock_seconds();
    tell_stage(stage, t);
    if (fraction > meter.fraction)
        meter.fraction = fraction < 1 ? fraction : 1;
    if (t >= meter.next) {
        char eta[32];
        double left = (t - meter.start) * (1 - meter.fraction) / meter.fraction;
        print_duration(eta, sizeof eta, meter.fraction > 0 ? left : INFINITY);
        if (meter.bar)
            draw_bar(stage, eta);
        else
            fprintf(stderr, "leafcast %s: %s: %d%%, %s left\n", meter.verb, stage,
                    (int)(meter.fraction * 100), eta);
        meter.next = t + (meter.bar ? 0.1 : 5);
    }
    pthread_mutex_unlock(&meter.lock);
}

static bool stop_asked(void *ctx) {
    (void)ctx;
    return signal_caught();
}

static bool bar_wanted(void) {
    const char *term = getenv("TERM");
    return isatty(STDERR_FILENO) && term && strcmp(term, "dumb") != 0;
}

status cli_check_files(const cli_common *common, mem *m, const char *const *outputs, int count) {
    file_guard_watch();
    status st = file_guard_input(common->input);
    for (int i = 0; i < count && st == ST_OK; i++) {
        st = file_guard_output(outputs[i]);
        if (st == ST_OK && outputs[i])
            st = out_file_check(m, outputs[i], common->force);
    }
    return st;
}

const progress *cli_progress(cli_common *common) {
    pthread_mutex_lock(&meter.lock);
    meter.verb = common->verb;
    meter.bar = bar_wanted();
    meter.stages = common->verbosity > 1;
    meter.start = clock_seconds();
    /* Draw nothing for short jobs. */
    meter.next = meter.start + (meter.bar ? 0.3 : 5);
    meter.fraction = 0;
    meter.interface =
        (progress){.report = common->verbosity > 0 ? report : NULL, .stop = stop_asked};
    pthread_mutex_unlock(&meter.lock);
    return &meter.interface;
}

static void clear_bar(void) {
    pthread_mutex_lock(&meter.lock);
    erase_bar();
    pthread_mutex_unlock(&meter.lock);
}

/* ---- messages and the end ---- */

void cli_note(const cli_common *common, int verbosity, const char *fmt, ...) {
    if (common->verbosity < verbosity)
        return;
    clear_bar();
    va_list args;
    char text[2 * STATUS_TEXT_MAX], line[4 * STATUS_TEXT_MAX];
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    fprintf(stderr, "leafcast %s: %s\n", common->verb, text_printable(line, sizeof line, text));
}

bool cli_results(const cli_common *common, bool summary) {
    clear_bar();
    return !summary || common->verbosity > 0;
}

status cli_print_json(const cli_common *common, json_t *results) {
    clear_bar();
    status st = cli_json_write(stdout, results, common->json_lines);
    /* A reader of lines waits for each, so flush. */
    return st == ST_OK && common->json_lines ? cli_flush() : st;
}

/* Print the time and memory that the job took, for -v. */
static void tell_costs(const cli_common *common) {
    struct rusage used;
    if (common->verbosity < 2 || getrusage(RUSAGE_SELF, &used) != 0)
        return;
    const double cpu = (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                       1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
    cli_note(common, 2, "%.2f s, %.2f s of CPU, at most %.1f MiB of memory, %d threads asked for",
             clock_seconds() - started, cpu, (double)used.ru_maxrss / 1024.0, common->threads);
}

/* Print the same error as JSON, for programs. */
static void print_error(const cli_common *common, status st, int code) {
    if (common->json &&
        cli_json_write(stdout, cli_json_error(st, code, status_text()), common->json_lines))
        cli_note(common, 0, "%s", status_text());
    fflush(stdout);
}

int cli_finish(const cli_common *common, status st) {
    clear_bar();
    if (st == ST_OK)
        st = cli_flush();
    tell_costs(common);
    if (st == ST_OK)
        return 0;
    if (caught)
        st = status_describe(ST_STOPPED, "stopped by signal %d (%s)%s", caught, strsignal(caught),
                             common->resumable ? ": the same command with --resume goes on" : "");
    const int code = !caught             ? status_exit_code(st)
                     : common->resumable ? EXIT_RESUMABLE
                                         : EXIT_SIGNAL + caught;
    cli_note(common, 0, "%s", status_text());
    print_error(common, st, code);
    return code;
}
