#include "formats/base/cli.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <stdnoreturn.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/bus_error.h"
#include "formats/base/clock.h"
#include "formats/base/num.h"
#include "formats/base/pool.h"
#include "formats/base/wait.h"

#ifndef LEAFCAST_VERSION
#define LEAFCAST_VERSION "unknown"
#endif

enum { EXIT_USAGE = 2, EXIT_INPUT = 3, EXIT_RESOURCE = 4, EXIT_SIGNAL = 128, MAX_THREADS = 4096 };

/* ---- signals ---- */

static atomic_int caught; /* lock-free: a handler may write it, any thread read it */

static void on_signal(int number) {
    caught = number;
}

static bool signal_caught(void) {
    return caught != 0;
}

static void install_signals(void) {
    /* The first signal asks the job to stop; a second one of the kind ends the process as usual. It
     * also ends a write of results that waits for their reader, hence no SA_RESTART. */
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND};
    const int stopping[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < sizeof stopping / sizeof stopping[0]; i++) {
        struct sigaction before;
        /* What the caller had ignored (nohup) stays ignored. */
        if (sigaction(stopping[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(stopping[i], &action, NULL);
    }
    /* A file that may not grow and a reader that went away are errors of a write, described like
     * the others. */
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
    wait_stop_when(signal_caught);
}

/* ---- exit codes ---- */

static int exit_code(status st) {
    switch (st) {
    case ST_OK: return 0;
    case ST_USAGE: return EXIT_USAGE;
    case ST_CORRUPT:
    case ST_UNSUPPORTED: return EXIT_INPUT;
    case ST_NOMEM:
    case ST_NOSPACE: return EXIT_RESOURCE;
    default: return 1;
    }
}

/* Results that did not reach standard output are a failure too. */
static status flush_results(void) {
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return ST_OK;
    return status_describe(errno == ENOSPC ? ST_NOSPACE : ST_IO,
                           "standard output: cannot write: %s", strerror(errno ? errno : EIO));
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

static void usage_unless(struct argp_state *state, status st) {
    if (st != ST_OK)
        argp_error(state, "%s", status_text());
}

/* What is being parsed, for its help. */
static const struct argp *parsed;
static char command[128]; /* "leafcast VERB" */

static noreturn void tell(const cli_common *c, int key) {
    /* Without the remark that short options take arguments, too. */
    setenv("ARGP_HELP_FMT", "no-dup-args-note", 0);
    switch (key) {
    case 'h': cli_options_help(parsed, c->without, command, CLI_VIEW_BASIC, stdout); break;
    case KEY_HELP_ALL: cli_options_help(parsed, c->without, command, CLI_VIEW_ALL, stdout); break;
    case KEY_USAGE: cli_options_help(parsed, c->without, command, CLI_VIEW_USAGE, stdout); break;
    case KEY_LIST: cli_options_list(parsed, c->without, stdout); break;
    default: printf("leafcast %s\n", LEAFCAST_VERSION);
    }
    const status st = flush_results();
    if (st != ST_OK)
        fprintf(stderr, "%s: %s\n", command, status_text());
    exit(exit_code(st));
}

/* An option that this verb does not have. */
static void refuse_option(struct argp_state *state, const cli_common *c, int key) {
    for (const struct argp_option *o = common_options; o->name || o->doc; o++)
        if (o->key == key && o->name && cli_options_listed(c->without, o->name))
            argp_error(state, "there is no --%s: it would change nothing", o->name);
}

static error_t parse_common(int key, char *arg, struct argp_state *state) {
    cli_common *c = state->input;
    int64_t threads = 0;
    if (c)
        refuse_option(state, c, key);
    switch (key) {
    case 'o': c->output = arg; break;
    case 'q': c->verbosity = 0; break;
    case 'v': c->verbosity++; break;
    case KEY_THREADS:
        usage_unless(state, num_int(arg, "--threads", 1, MAX_THREADS, &threads));
        c->threads = (int)threads;
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
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

const struct argp cli_common_argp = {.options = common_options, .parser = parse_common};

void cli_parse(const struct argp *table, cli_common *common, int argc, char **argv, void *input) {
    /* Messages start with the command as it is typed: argp takes it from argv[0]. */
    snprintf(command, sizeof command, "leafcast %s", common->verb);
    if (argc > 0)
        argv[0] = command;
    install_signals();
    bus_error_install(command);
    common->threads = pool_default_threads();
    common->verbosity = 1;
    argp_err_exit_status = EXIT_USAGE;
    parsed = table;
    error_t error = argp_parse(table, argc, argv, ARGP_NO_HELP, NULL, input);
    if (error) {
        fprintf(stderr, "%s: %s\n", command, strerror(error));
        exit(EXIT_USAGE);
    }
}

/* ---- progress ---- */

static struct {
    pthread_mutex_t lock;
    progress interface;
    const char *verb;
    bool bar;
    bool drawn;      /* a bar stands on the current line */
    double start;    /* when the job began, seconds */
    double next;     /* not before this is anything printed again */
    double fraction; /* never goes back */
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

static void report(void *ctx, const char *stage, double fraction) {
    (void)ctx;
    pthread_mutex_lock(&meter.lock);
    double t = clock_seconds();
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

const progress *cli_progress(cli_common *common) {
    pthread_mutex_lock(&meter.lock);
    meter.verb = common->verb;
    meter.bar = bar_wanted();
    meter.start = clock_seconds();
    /* Short jobs draw nothing. */
    meter.next = meter.start + (meter.bar ? 0.3 : 5);
    meter.fraction = 0;
    meter.interface =
        (progress){.report = common->verbosity > 0 ? report : NULL, .stop = stop_asked};
    pthread_mutex_unlock(&meter.lock);
    return &meter.interface;
}

static void clear_bar(void) {
    pthread_mutex_lock(&meter.lock);
    if (meter.drawn)
        fputs("\r\033[K", stderr);
    meter.drawn = false;
    pthread_mutex_unlock(&meter.lock);
}

/* ---- messages and the end ---- */

void cli_note(const cli_common *common, int verbosity, const char *fmt, ...) {
    if (common->verbosity < verbosity)
        return;
    clear_bar();
    va_list args;
    va_start(args, fmt);
    flockfile(stderr);
    fprintf(stderr, "leafcast %s: ", common->verb);
    vfprintf(stderr, fmt, args);
    fputc('\n', stderr);
    funlockfile(stderr);
    va_end(args);
}

int cli_finish(const cli_common *common, status st) {
    clear_bar();
    if (st == ST_OK)
        st = flush_results();
    if (st == ST_OK)
        return 0;
    if (caught) {
        cli_note(common, 0, "stopped by signal %d (%s)", caught, strsignal(caught));
        return EXIT_SIGNAL + caught;
    }
    cli_note(common, 0, "%s", status_text());
    return exit_code(st);
}
