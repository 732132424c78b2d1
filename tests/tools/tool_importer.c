/* tool_importer.c - an importer whose library does what none should: tests/cli/import_fence.sh.
 *
 * Built and fenced as importers are. $TRIAL says what its library does: `fence' tries what must be
 * refused, and prints a line for each; others crash, hang, or run out of memory. What is read is a
 * grid of 4 x 4 x 4, whatever is in the file.
 */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "prep/import/importer.h"
#include "prep/import/importer_options.h"

static const char *input, *foreign, *folder; /* folder: where nothing may be written */

static const char *in_folder(const char *name) {
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* ---- what a library may try: 0, or the error ---- */

static int closed(long fd) {
    if (fd < 0)
        return errno;
    close((int)fd);
    return 0;
}

static int failed(long result) {
    return result < 0 ? errno : 0;
}

static int by_call(const char *path, int flags) {
    return closed(syscall(SYS_openat, AT_FDCWD, path, flags, 0666));
}

static int open_input(void) {
    return closed(open(input, O_RDONLY));
}
static int open_input_by_call(void) {
    return by_call(input, O_RDONLY);
}
static int open_foreign(void) {
    return closed(open(foreign, O_RDONLY));
}
static int open_foreign_by_call(void) {
    return by_call(foreign, O_RDONLY);
}
static int open_foreign_stream(void) {
    FILE *f = fopen(foreign, "r");
    if (f)
        fclose(f);
    return f ? 0 : errno;
}
static int list_folder(void) {
    return by_call(folder, O_RDONLY | O_DIRECTORY);
}
static int make_file(void) {
    return closed(open(in_folder("made"), O_WRONLY | O_CREAT, 0666));
}
static int make_file_by_call(void) {
    return by_call(in_folder("made"), O_WRONLY | O_CREAT);
}
static int make_beside_input(void) {
    char path[4096];
    snprintf(path, sizeof path, "%s.made", input);
    return closed(open(path, O_WRONLY | O_CREAT, 0666));
}
static int write_foreign(void) {
    return closed(open(foreign, O_WRONLY | O_APPEND));
}
static int write_input(void) {
    return closed(open(input, O_RDWR));
}
static int make_folder(void) {
    return failed(mkdir(in_folder("made"), 0777));
}
static int make_link(void) {
    return failed(symlink(foreign, in_folder("made")));
}
static int make_pipe(void) {
    return failed(mknod(in_folder("made"), S_IFIFO | 0666, 0));
}
static int remove_foreign(void) {
    return failed(unlink(foreign));
}
static int remove_foreign_by_call(void) {
    return failed(syscall(SYS_unlinkat, AT_FDCWD, foreign, 0));
}
static int remove_input(void) {
    return failed(unlink(input));
}
static int rename_foreign(void) {
    return failed(syscall(SYS_renameat2, AT_FDCWD, foreign, AT_FDCWD, in_folder("made"), 0));
}
static int cut_foreign(void) {
    return failed(truncate(foreign, 0));
}
static int open_to_all(void) {
    return failed(chmod(foreign, 0777));
}
static int give_away(void) {
    return failed(chown(foreign, 1, 1));
}
static int internet(void) {
    return closed(socket(AF_INET, SOCK_STREAM, 0));
}
static int local_socket(void) {
    return closed(socket(AF_UNIX, SOCK_STREAM, 0));
}
static char program[] = "/bin/true", *command[] = {program, NULL};

static int run_program(void) {
    return failed(execve(program, command, command + 1));
}
static int spawn_program(void) {
    pid_t pid;
    const int error = posix_spawn(&pid, program, NULL, NULL, command, NULL);
    if (!error)
        waitpid(pid, NULL, 0);
    return error;
}
static int make_process(void) {
    const pid_t pid = fork();
    if (pid == 0)
        _exit(0);
    return failed(pid);
}
static int trace_parent(void) {
    return failed(ptrace(PTRACE_ATTACH, getppid(), NULL, NULL));
}
static int look_into_parent(void) {
    char byte;
    struct iovec here = {&byte, 1}, there = {&byte, 1};
    return failed(process_vm_readv(getppid(), &here, 1, &there, 1, 0));
}
static int signal_parent(void) {
    return failed(kill(getppid(), 0));
}
static int signal_thread_of_parent(void) {
    return failed(syscall(SYS_tgkill, getppid(), getppid(), 0));
}
static int other_namespace(void) {
    return failed(unshare(CLONE_NEWNS));
}
static int read_own_maps(void) {
    return by_call("/proc/self/maps", O_RDONLY);
}
static int write_nothing(void) {
    return closed(open("/dev/null", O_WRONLY));
}
static void *end_thread(void *unused) {
    return unused;
}
static int start_thread(void) {
    pthread_t t;
    const int error = pthread_create(&t, NULL, end_thread, NULL);
    return error ? error : pthread_join(t, NULL);
}

/* One that runs since before main(), as libraries have them. */
static sem_t asked, answered;
static int early_error;

static void *wait_early(void *unused) {
    sem_wait(&asked);
    early_error = open_foreign_by_call();
    sem_post(&answered);
    return unused;
}

__attribute__((constructor)) static void start_early(void) {
    pthread_t t;
    if (sem_init(&asked, 0, 0) == 0 && sem_init(&answered, 0, 0) == 0 &&
        pthread_create(&t, NULL, wait_early, NULL) == 0)
        pthread_detach(t);
}

static int open_foreign_early(void) {
    sem_post(&asked);
    sem_wait(&answered);
    return early_error;
}

static const struct {
    const char *what;
    int (*attempt)(void);
    bool allowed;
} attempts[] = {
    {"the input is opened", open_input, true},
    {"the input, unannounced", open_input_by_call, false},
    {"a foreign file", open_foreign, false},
    {"a foreign file, by its system call", open_foreign_by_call, false},
    {"a foreign file as a stream", open_foreign_stream, false},
    {"a foreign file, by an early thread", open_foreign_early, false},
    {"a foreign folder's names", list_folder, false},
    {"a new file", make_file, false},
    {"a new file, by its system call", make_file_by_call, false},
    {"a new file beside the input", make_beside_input, false},
    {"a foreign file is written", write_foreign, false},
    {"the input is written", write_input, false},
    {"a new folder", make_folder, false},
    {"a new link", make_link, false},
    {"a new pipe", make_pipe, false},
    {"a foreign file is removed", remove_foreign, false},
    {"a foreign file is removed, by its system call", remove_foreign_by_call, false},
    {"the input is removed", remove_input, false},
    {"a foreign file is renamed", rename_foreign, false},
    {"a foreign file is cut", cut_foreign, false},
    {"a foreign file's mode", open_to_all, false},
    {"a foreign file's owner", give_away, false},
    {"the internet", internet, false},
    {"a local socket", local_socket, false},
    {"another program", run_program, false},
    {"another program beside this", spawn_program, false},
    {"another process", make_process, false},
    {"the parent is traced", trace_parent, false},
    {"the parent's memory", look_into_parent, false},
    {"a signal to the parent", signal_parent, false},
    {"a signal to the parent's thread", signal_thread_of_parent, false},
    {"another namespace", other_namespace, false},
    {"what it is made of", read_own_maps, true},
    {"nothing is written", write_nothing, true},
    {"a thread", start_thread, true},
};

static void try_all(void) {
    for (size_t i = 0; i < sizeof attempts / sizeof *attempts; i++) {
        const int error = attempts[i].attempt();
        fprintf(stderr, "%s: %s: %s\n", (error == 0) == attempts[i].allowed ? "right" : "wrong",
                attempts[i].what, error ? strerror(error) : "done");
    }
}

/* ---- what it does wrong ---- */

static const char *trial = "";
static volatile unsigned sink;

static void crash(void) {
    raise(SIGSEGV);
}
static void give_up(void) {
    abort();
}
static void leave(void) {
    exit(EXIT_FAILURE);
}
static void die(void) {
    raise(SIGKILL);
}
static void stop(void) {
    raise(SIGTERM);
    raise(SIGTERM);
}
static void spin(void) {
    for (;;)
        sink++;
}

/* As a library does that looks at no result. */
static void take_all(void) {
    for (size_t size = (size_t)1 << 24;; size += 1) {
        char *block = malloc(size);
        memset(block ? block : (raise(SIGSEGV), block), 1, block ? 4096 : 0);
    }
}

/* As one does that takes it for the file's fault. */
static void ask_for_more(void) {
    void *volatile more = malloc((size_t)1 << 40);
    free(more);
}

static const struct {
    const char *name;
    void (*act)(void);
} acts[] = {{"crash", crash},       {"abort", give_up},    {"leave", leave},
            {"die", die},           {"stop", stop},        {"spin", spin},
            {"take-all", take_all}, {"ask", ask_for_more}, {"fence", try_all}};

/* $TRIAL: WHEN-WHAT. */
static bool act(const char *when) {
    const size_t length = strlen(when);
    if (strncmp(trial, when, length) != 0 || trial[length] != '-')
        return false;
    for (size_t i = 0; i < sizeof acts / sizeof *acts; i++)
        if (strcmp(trial + length + 1, acts[i].name) == 0)
            acts[i].act();
    return true;
}

/* ---- the importer ---- */

static file *opened;

static status says_malformed(void) {
    return status_describe(ST_CORRUPT, "%s: the library says it is malformed", input);
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    (void)ctx;
    if (act("read") || (first + count == 4 && act("last")))
        return says_malformed();
    memset(slices, (int)first, (size_t)16 * count);
    return ST_OK;
}

static void close_slices(void *ctx) {
    (void)ctx;
    act("close");
    file_close(opened);
}

static void note(const import_request *q) {
    const char *asked_for = getenv("TRIAL");
    trial = asked_for ? asked_for : "";
    foreign = getenv("TRIAL_FOREIGN");
    folder = getenv("TRIAL_FOLDER");
    input = q->paths[0];
}

static status open_trial(mem *m, const import_request *q, slice_source *out) {
    note(q);
    status st = file_open(m, input, &opened);
    if (st != ST_OK)
        return st;
    if (act("open") && strcmp(trial, "open-fence") != 0)
        return says_malformed();
    *out = (slice_source){
        .format = "trial", .name = input, .m = m, .read = read_slices, .close = close_slices};
    grid_init(&out->g, (uint32_t[3]){4, 4, 4}, SAMPLE_U8);
    return ST_OK;
}

static status list_trial(mem *m, const import_request *q, const import_list *to) {
    (void)m;
    note(q);
    act("list");
    return to->take(to->ctx, &(import_item){.name = "all", .type = "u8", .shape = {4, 4, 4}});
}

/* Those that run behind main(). */
__attribute__((destructor)) static void at_end(void) {
    act("end");
}

int main(int argc, char **argv) {
    static const struct argp_option options[] = {IMPORT_FIELD("field"), IMPORT_COMPONENT,
                                                 IMPORT_STEP, IMPORT_LIST("fields"), IMPORT_END};
    static const importer row = {.verb = "import-trial",
                                 .format = "the trial",
                                 .inputs = "FILE",
                                 .doc = "Tries what importers must not.",
                                 .options = options,
                                 .open = open_trial,
                                 .list = list_trial};
    return importer_main(&row, argc, argv);
}
