#include "render/bench/bench_store.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zstd.h>

#include "formats/base/file.h"
#include "formats/base/partial.h"
#include "formats/base/sequence.h"
#include "formats/base/sibling.h"

enum { NUMBER = 16, KEPT_MAX = 256, FOLDER_MAX = 3000 };

typedef struct bench_volume {
    const char *name;
    const char *data; /* raw samples in the data folder, FILE or FILE.zst; NULL: generated */
    double data_isovalue;
    /* Of generate; where the data is absent, too. type: of samples, tets, or the flag that makes a
     * curvilinear grid, or with 0 samples a plant. */
    const char *field, *type;
    uint32_t side; /* samples an axis of the generated field */
    double field_isovalue;
    uint32_t copies;         /* of a mesh along each axis; 0: a grid */
    uint32_t steps;          /* of a series: `data` is a pattern of its files then; 0: none */
    const char *data_option; /* of convert, for the data; NULL: none */
} bench_volume;

struct bench_store {
    mem *m;
    char folder[PATH_MAX];
    const char *data;
    char threads[NUMBER];
    bool ours; /* the folder goes with the store */
    int lock;  /* of the name that our folder's is made of */
    char lock_name[FOLDER_MAX];
    char kept[KEPT_MAX][PATH_MAX];
    int kept_count;
};

/* ---- opening ---- */

/* A folder of that name, ours while its lock is held: a killed run left it, with its volumes. */
static status empty_folder(const char *folder) {
    const int fd = open(folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    struct stat info;
    if (fd < 0 || fstat(fd, &info) != 0 || info.st_uid != geteuid()) {
        const int error = fd < 0 ? errno : EEXIST;
        if (fd >= 0)
            close(fd);
        return file_failed(error, folder, "cannot make the folder");
    }
    DIR *d = fdopendir(fd);
    if (!d) {
        close(fd);
        return file_failed(ENOMEM, folder, "cannot read");
    }
    for (struct dirent *e; (e = readdir(d)) != NULL;)
        (void)unlinkat(fd, e->d_name, 0); /* "." and "..", too, in vain */
    closedir(d);
    return ST_OK;
}

/* $TMPDIR/leafcast-bench-UID.partial-N.d, where .partial-N is locked as long as we live. */
static status own_folder(bench_store *s) {
    const char *parent = getenv("TMPDIR");
    char path[FOLDER_MAX];
    if (snprintf(path, sizeof path, "%s/leafcast-bench-%ld", parent && *parent ? parent : "/tmp",
                 (long)geteuid()) > FOLDER_MAX - PARTIAL_ROOM)
        return status_describe(ST_USAGE, "$TMPDIR: too long a path");
    s->lock = partial_open(path, s->lock_name);
    if (s->lock < 0)
        return file_failed(errno, path, "cannot create");
    s->ours = true;
    snprintf(s->folder, sizeof s->folder, "%s.d", s->lock_name);
    if (mkdir(s->folder, 0700) == 0)
        return ST_OK;
    return errno == EEXIST ? empty_folder(s->folder)
                           : file_failed(errno, s->folder, "cannot make the folder");
}

static void leave_folder(bench_store *s) {
    if (!s->ours)
        return;
    if (empty_folder(s->folder) == ST_OK)
        (void)rmdir(s->folder);
    (void)unlink(s->lock_name);
    close(s->lock);
}

status bench_store_open(mem *m, const char *folder, const char *data, int threads,
                        bench_store **out) {
    bench_store *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->data = data;
    snprintf(s->threads, sizeof s->threads, "%d", threads);
    status st = ST_OK;
    if (data && access(data, R_OK | X_OK) != 0)
        st = file_failed(errno, data, "cannot read the data folder");
    else if (!folder)
        st = own_folder(s);
    else if (snprintf(s->folder, sizeof s->folder, "%s", folder) > FOLDER_MAX)
        st = status_describe(ST_USAGE, "%s: too long a path", folder);
    else if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        st = file_failed(errno, folder, "cannot make the folder");
    if (st != ST_OK) {
        leave_folder(s);
        mem_free(m, s);
        return st;
    }
    *out = s;
    return ST_OK;
}

void bench_store_close(bench_store *s) {
    if (!s)
        return;
    leave_folder(s);
    mem_free(s->m, s);
}

/* ---- running verbs ---- */

/* Start a verb; its standard input and output as given, -1: none of its own. */
static status start(const char *name, char *const arguments[], int in, int out, pid_t *pid) {
    char program[SIBLING_PATH];
    posix_spawn_file_actions_t actions;
    if (!sibling_find(name, program))
        return status_describe(ST_UNSUPPORTED, "%s is not there: it makes the volumes to measure",
                               name);
    int error = posix_spawn_file_actions_init(&actions);
    if (error)
        return file_failed(error, name, "cannot start");
    if (in >= 0)
        error = posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
    if (!error && out >= 0)
        error = posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    if (!error)
        error = posix_spawn(pid, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return error ? file_failed(error, program, "cannot start") : ST_OK;
}

/* Its complaint, if any, is on standard error already. */
static status await(const char *name, pid_t pid) {
    int state = 0;
    while (waitpid(pid, &state, 0) < 0)
        if (errno != EINTR)
            return file_failed(errno, name, "cannot wait for its end");
    if (WIFEXITED(state) && WEXITSTATUS(state) == 0)
        return ST_OK;
    if (WIFSIGNALED(state) && (WTERMSIG(state) == SIGINT || WTERMSIG(state) == SIGTERM))
        return status_describe(ST_STOPPED, "%s was stopped", name);
    return status_describe(ST_FAILED, "%s failed", name);
}

static const char GENERATE[] = "leafcast-generate", CONVERT[] = "leafcast-convert";

/* What is converted: one file, or a file for each step. */
typedef struct steps {
    char (*path)[PATH_MAX];
    uint32_t count;
    const char *option; /* of convert; NULL: none */
    int in;             /* standard input of convert, where that is the path; -1: none */
    bool ours;          /* the files go afterwards */
} steps;

enum { OPTIONS = 16 };

/* Its own output ("converted in ...") belongs to no table. */
static status run_convert(char *arguments[], int in) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    pid_t pid;
    status st = nowhere < 0 ? file_failed(errno, "/dev/null", "cannot open")
                            : start(CONVERT, arguments, in, nowhere, &pid);
    if (nowhere >= 0)
        close(nowhere);
    return st == ST_OK ? await(CONVERT, pid) : st;
}

/* The steps from `first` on as one file. */
static status convert(const bench_store *s, const steps *from, uint32_t first, uint32_t count,
                      const char *codec, const char *leaf) {
    const char *const options[] = {CONVERT,     "-o",       leaf,         "-q", "--force",
                                   "--threads", s->threads, "--compress", codec};
    char **arguments = mem_array(s->m, count + OPTIONS, sizeof *arguments);
    size_t n = 0;
    if (!arguments)
        return ST_NOMEM;
    for (; n < sizeof options / sizeof *options; n++)
        arguments[n] = (char *)options[n];
    if (from->option)
        arguments[n++] = (char *)from->option;
    for (uint32_t i = 0; i < count; i++)
        arguments[n++] = from->path[first + i];
    arguments[n] = NULL;
    status st = run_convert(arguments, from->in);
    mem_free(s->m, arguments);
    return st;
}

static status generate(const bench_store *s, const bench_volume *v, const char *codec,
                       const char *leaf) {
    char side[NUMBER], copies[NUMBER];
    int ends[2];
    pid_t pid;
    snprintf(side, sizeof side, "%u", v->side);
    snprintf(copies, sizeof copies, "%u", v->copies);
    char *grid[] = {(char *)GENERATE, (char *)v->field,    (char *)"--dims",   side,
                    (char *)"--type", (char *)v->type,     (char *)"-o",       (char *)"-",
                    (char *)"-q",     (char *)"--threads", (char *)s->threads, NULL};
    char *tets[] = {(char *)GENERATE,
                    (char *)v->field,
                    (char *)"--dims",
                    side,
                    (char *)"--tets",
                    (char *)"--replicate",
                    copies,
                    (char *)"-o",
                    (char *)"-",
                    (char *)"-q",
                    NULL};
    char *const *arguments = v->copies ? tets : grid;
    if (pipe2(ends, O_CLOEXEC) != 0)
        return file_failed(errno, GENERATE, "cannot make a pipe");
    status st = start(GENERATE, arguments, -1, ends[1], &pid);
    close(ends[1]);
    if (st == ST_OK) {
        char input[1][PATH_MAX] = {"-"};
        const steps one = {.path = input, .count = 1, .in = ends[0]};
        st = convert(s, &one, 0, 1, codec, leaf);
        close(ends[0]); /* so that it does not wait for a reader that is gone */
        const status other = await(GENERATE, pid);
        return st == ST_OK ? other : st;
    }
    close(ends[0]);
    return st;
}

static bool goes_by_file(const bench_volume *v) {
    return v->type[0] == '-';
}

/* By way of a file in our folder: convert reads such a grid, or a surface, from no pipe. */
static status generate_by_file(const bench_store *s, const bench_volume *v, const char *codec,
                               const char *leaf) {
    char side[NUMBER], path[1][PATH_MAX];
    const steps one = {.path = path, .count = 1, .in = -1};
    pid_t pid;
    snprintf(side, sizeof side, "%u", v->side);
    snprintf(path[0], PATH_MAX, "%.3000s/%s.%s", s->folder, v->name, v->side ? "vts" : "ply");
    const char *const all[] = {GENERATE, v->field, v->type,   "-o",
                               path[0],  "-q",     "--force", v->side ? "--dims" : NULL,
                               side,     NULL};
    status st = start(GENERATE, (char *const *)all, -1, -1, &pid);
    if (st == ST_OK)
        st = await(GENERATE, pid);
    if (st == ST_OK)
        st = convert(s, &one, 0, 1, codec, leaf);
    (void)unlink(path[0]);
    return st;
}

/* ---- the data folder ---- */

/* Where a data set lies: FILE.zst or FILE; false when neither is there. */
static bool find_data(const bench_store *s, const char *name, char path[PATH_MAX], bool *packed) {
    if (!s->data || !name)
        return false;
    for (int i = 0; i < 2; i++) {
        const int n = snprintf(path, PATH_MAX, "%s/%s%s", s->data, name, i ? "" : ".zst");
        *packed = i == 0;
        if (n < PATH_MAX && access(path, R_OK) == 0)
            return true;
    }
    return false;
}

/* The whole of a file. */
static status read_all(mem *m, const char *path, void **bytes, size_t *size) {
    file *f = NULL;
    *bytes = NULL;
    status st = file_open(m, path, &f);
    if (st == ST_OK) {
        *size = (size_t)file_size(f);
        *bytes = mem_alloc(m, *size);
        st = *bytes ? file_read_at(f, 0, *bytes, *size) : ST_NOMEM;
    }
    file_close(f);
    return st;
}

static status write_all(mem *m, const char *path, const void *bytes, size_t size) {
    out_file *f = NULL;
    status st = out_file_create(m, path, true, &f);
    if (st != ST_OK)
        return st;
    st = out_file_append(f, bytes, size);
    if (st == ST_OK)
        return out_file_commit(f);
    out_file_discard(f);
    return st;
}

static status unpack(mem *m, const char *from, const char *to) {
    void *packed = NULL, *samples = NULL;
    size_t size = 0;
    status st = read_all(m, from, &packed, &size);
    if (st == ST_OK) {
        const unsigned long long raw = ZSTD_getFrameContentSize(packed, size);
        if (raw == ZSTD_CONTENTSIZE_UNKNOWN || raw == ZSTD_CONTENTSIZE_ERROR)
            st = status_describe(ST_CORRUPT, "%s: not a zstd frame of known size", from);
        else if (!(samples = mem_alloc(m, (size_t)raw)))
            st = ST_NOMEM;
        else if (ZSTD_decompress(samples, (size_t)raw, packed, size) != raw)
            st = status_describe(ST_CORRUPT, "%s: a damaged zstd frame", from);
        else
            st = write_all(m, to, samples, (size_t)raw);
    }
    mem_free(m, samples);
    mem_free(m, packed);
    return st;
}

/* Raw samples say their dimensions and type by their name, which the unpacked file keeps. */
static status unpack_into(const bench_store *s, const char *from, char raw[PATH_MAX]) {
    const char *slash = strrchr(from, '/'), *name = slash ? slash + 1 : from;
    const size_t length = strlen(name) - strlen(".zst");
    snprintf(raw, PATH_MAX, "%.3000s/%.*s", s->folder, (int)length, name);
    return unpack(s->m, from, raw);
}

static status convert_data(bench_store *s, const bench_volume *v, const char *from, bool packed,
                           const char *codec, const char *leaf) {
    char path[1][PATH_MAX];
    const steps one = {.path = path, .count = 1, .option = v->data_option, .in = -1};
    snprintf(path[0], PATH_MAX, "%s", from);
    status st = packed ? unpack_into(s, from, path[0]) : ST_OK;
    if (st == ST_OK)
        st = convert(s, &one, 0, 1, codec, leaf);
    if (packed)
        (void)unlink(path[0]);
    return st;
}

/* ---- volumes ---- */

/* M08's data sets where they are to be had, else the nearest there is: an angiogram for the
 * aneurism, CT heads for the MR brain and the torso. */
static const bench_volume VOLUMES[] = {
    {"bonsai", "bonsai/bonsai_256x256x256_uint8.raw", 37, "buckyball", "u8", 256, 102, 0, 0, NULL},
    {"engine", "engine/engine_256x256x128_uint8.raw", 80, "sphere", "u8", 192, 153, 0, 0, NULL},
    {"angiogram", "ct_avm/ct_avm_256x242x154_uint8.raw", 60, "attractor", "u8", 192, 10, 0, 0,
     NULL},
    {"ch2better", "ch2better/ch2better_301x370x316_uint8.raw", 60, "noise", "u8", 320, 127.5, 0, 0,
     NULL},
    {"teapot", "boston_teapot/boston_teapot_256x256x178_uint8.raw", 25, "gyroid", "u8", 224, 127.5,
     0, 0, NULL},
    {"ct-head-u16", "ct_head_128/ct_head_128_128x128x112_uint16.raw", 500, "noise", "u16", 128,
     32767.5, 0, 0, NULL},
    {"cranium-i16", "cranium_ct/cranium_ct_256x256x108_int16.raw", 226, "buckyball", "u16", 192,
     26214, 0, 0, NULL},
    {"stent-f32", "stent/stent_128x128x256_float32.raw", 0.15, "orbital", "f32", 160, 0.04, 0, 0,
     NULL},
    {"fingers-f32", "viscous_fingers/run01_045_64x64x64_float32.raw", 20, "noise", "f32", 64, 0, 0,
     0, NULL},
    {"ml-32", NULL, 0, "marschner-lobb", "u8", 32, 127.5, 0, 0, NULL},
    {"ml-64", NULL, 0, "marschner-lobb", "u8", 64, 127.5, 0, 0, NULL},
    {"ml-128", NULL, 0, "marschner-lobb", "u8", 128, 127.5, 0, 0, NULL},
    {"ml-256", NULL, 0, "marschner-lobb", "u8", 256, 127.5, 0, 0, NULL},
    {"ml-512", NULL, 0, "marschner-lobb", "u8", 512, 127.5, 0, 0, NULL},
    {"ml-1024", NULL, 0, "marschner-lobb", "u8", 1024, 127.5, 0, 0, NULL},
    {"gyroid-96", NULL, 0, "gyroid", "u8", 96, 127.5, 0, 0, NULL},
    {"noise-48", NULL, 0, "noise", "u16", 48, 32767.5, 0, 0, NULL},
    {"orbital-64", NULL, 0, "orbital", "f32", 64, 0.04, 0, 0, NULL},
    {"attractor-1024", NULL, 0, "attractor", "u8", 1024, 10, 0, 0, NULL},
    {"bucky-12", NULL, 0, "buckyball", "tets", 12, 0.3, 1, 0, NULL},
    {"bucky-32", NULL, 0, "buckyball", "tets", 32, 0.3, 1, 0, NULL},
    {"bucky-2x32", NULL, 0, "buckyball", "tets", 32, 0.3, 2, 0, NULL},
    {"bucky-4x32", NULL, 0, "buckyball", "tets", 32, 0.3, 4, 0, NULL},
    {"hexes-warp-12", NULL, 0, "sphere", "--curvilinear=warp", 12, 0.6, 0, 0, NULL},
    {"hexes-annulus-12", NULL, 0, "sphere", "--curvilinear=annulus", 12, 0.6, 0, 0, NULL},
    {"hexes-warp-40", NULL, 0, "buckyball", "--curvilinear=warp", 40, 0.3, 0, 0, NULL},
    {"hexes-annulus-40", NULL, 0, "buckyball", "--curvilinear=annulus", 40, 0.3, 0, 0, NULL},
    {"conifer", NULL, 0, "plant", "--shape=conifer", 0, 0, 0, 0, NULL},
    {"broadleaf", NULL, 0, "plant", "--shape=broadleaf", 0, 0, 0, 0, NULL},
    {"bush", NULL, 0, "plant", "--shape=bush", 0, 0, 0, 0, NULL},
    {"grass", NULL, 0, "plant", "--shape=grass", 0, 0, 0, 0, NULL},
    {"drop-64", NULL, 0, "drop", "u8", 64, 127.5, 0, 5, NULL},
    {"jets-64", NULL, 0, "jets", "u8", 64, 160.3, 0, 5, NULL},
    {"vortex-64", NULL, 0, "vortex", "u8", 64, 85, 0, 5, NULL},
    {"drop-128", NULL, 0, "drop", "u8", 128, 127.5, 0, 16, NULL},
    {"jets-128", NULL, 0, "jets", "u8", 128, 160.3, 0, 16, NULL},
    {"vortex-128", NULL, 0, "vortex", "u8", 128, 85, 0, 16, NULL},
    {"drop-100", NULL, 0, "drop", "u8", 128, 127.5, 0, 100, NULL},
    {"jets-100", NULL, 0, "jets", "u8", 128, 160.3, 0, 100, NULL},
    {"vortex-100", NULL, 0, "vortex", "u8", 128, 85, 0, 100, NULL},
    {"vortex-256", NULL, 0, "vortex", "u8", 256, 85, 0, 4, NULL},
    {"vortex-512", NULL, 0, "vortex", "u8", 512, 85, 0, 3, NULL},
    {"fingers", "viscous_fingers/run01_*_64x64x64_float32.raw", 40, "jets", "f32", 64, 0.6, 0, 10,
     NULL},
    {"isabel", "isabel_wind/isabel_*_125x125x25_float32.raw", 20, "vortex", "f32", 96, 0.5, 0, 12,
     NULL},
    {"ocean", "ocean_monthly/ocean_temp_m*_180x90x19_float32.raw", 20, "drop", "f32", 96, 0.5, 0,
     12, "--missing=-1e34"},
    {"fluid", "vdb_sequence/fluid_data_*.vdb", 0.1, "drop", "f32", 32, 0.5, 0, 11,
     "--field=density"},
    {"ball-12", NULL, 0, "buckyball", "tets", 12, 0.3, 1, 4, NULL},
    {"ball-32", NULL, 0, "buckyball", "tets", 32, 0.3, 1, 16, NULL},
};

static const bench_volume *find(const char *name) {
    for (size_t i = 0; i < sizeof VOLUMES / sizeof *VOLUMES; i++)
        if (strcmp(VOLUMES[i].name, name) == 0)
            return &VOLUMES[i];
    return NULL;
}

/* Remember the path that was written behind those kept. */
static const char *keep_path(bench_store *s) {
    char *path = s->kept[s->kept_count];
    for (int i = 0; i < s->kept_count; i++)
        if (strcmp(s->kept[i], path) == 0)
            return s->kept[i];
    assert(s->kept_count + 1 < KEPT_MAX);
    s->kept_count++;
    return path;
}

/* The path of a volume's file, remembered. */
static const char *keep(bench_store *s, const bench_volume *v, bool data, const char *suffix) {
    char *path = s->kept[s->kept_count];
    if (v->steps > 0)
        snprintf(path, PATH_MAX, "%.3000s/%s-%s-%s%s", s->folder, v->name, data ? "data" : v->field,
                 "steps", suffix);
    else if (data || goes_by_file(v))
        snprintf(path, PATH_MAX, "%.3000s/%s%s", s->folder, v->name, suffix);
    else if (v->copies > 1)
        snprintf(path, PATH_MAX, "%.3000s/%s-tets-%ux%u%s", s->folder, v->field, v->copies, v->side,
                 suffix);
    else
        snprintf(path, PATH_MAX, "%.3000s/%s-%s-%u%s", s->folder, v->field, v->type, v->side,
                 suffix);
    return keep_path(s);
}

/* ---- series ---- */

/* The files of a data set's steps, by their pattern: PATTERN.zst or PATTERN. */
static bool find_steps(const bench_store *s, const bench_volume *v, glob_t *found, bool *packed) {
    char pattern[PATH_MAX];
    for (int i = 0; i < 2 && s->data && v->data; i++) {
        *packed = i == 0;
        if (snprintf(pattern, PATH_MAX, "%s/%s%s", s->data, v->data, i ? "" : ".zst") < PATH_MAX &&
            glob(pattern, 0, NULL, found) == 0)
            return true;
        globfree(found);
        *found = (glob_t){0};
    }
    return false;
}

/* One file a step, in our folder. */
static status generate_files(const bench_store *s, const bench_volume *v, steps *to) {
    char side[NUMBER], count[NUMBER], pattern[PATH_MAX];
    pid_t pid;
    snprintf(side, sizeof side, "%u", v->side);
    snprintf(count, sizeof count, "%u", v->steps);
    snprintf(pattern, PATH_MAX, "%.3000s/%s_%%04d.%s", s->folder, v->name,
             v->copies ? "mesh" : "nrrd");
    const char *const mesh[] = {"--tets", "--deform", "0.5"}, *const grid[] = {"--type", v->type};
    const char *const *own = v->copies ? mesh : grid;
    const char *const all[] = {
        GENERATE,    v->field,   "--dims", side,   "--steps",
        count,       "-o",       pattern,  "-q",   "--force",
        "--threads", s->threads, own[0],   own[1], v->copies ? mesh[2] : NULL,
        NULL};
    status st = start(GENERATE, (char *const *)all, -1, -1, &pid);
    if (st == ST_OK)
        st = await(GENERATE, pid);
    for (uint32_t i = 0; i < to->count && st == ST_OK; i++)
        st = sequence_name(pattern, (int)i, to->path[i], PATH_MAX);
    return st;
}

static status take_files(const bench_store *s, const glob_t *found, steps *to) {
    status st = ST_OK;
    for (uint32_t i = 0; i < to->count && st == ST_OK; i++) {
        snprintf(to->path[i], PATH_MAX, "%s", found->gl_pathv[i]);
        if (to->ours)
            st = unpack_into(s, found->gl_pathv[i], to->path[i]);
    }
    return st;
}

/* The series, and each step alone beside it. found: files of the data; NULL: they are generated. */
static status make_series(bench_store *s, const bench_volume *v, const glob_t *found, bool packed,
                          const char *codec, const char *leaf) {
    char alone[PATH_MAX];
    steps from = {.count = found ? (uint32_t)found->gl_pathc : v->steps,
                  .option = found ? v->data_option : NULL,
                  .in = -1,
                  .ours = !found || packed};
    from.path = mem_array(s->m, from.count, sizeof *from.path);
    if (!from.path)
        return ST_NOMEM;
    memset(from.path, 0, from.count * sizeof *from.path);
    status st = found ? take_files(s, found, &from) : generate_files(s, v, &from);
    for (uint32_t i = 0; i < from.count && st == ST_OK; i++) {
        bench_store_alone(leaf, i, alone);
        st = convert(s, &from, i, 1, codec, alone);
    }
    if (st == ST_OK)
        st = convert(s, &from, 0, from.count, codec, leaf);
    for (uint32_t i = 0; i < from.count && from.ours; i++)
        (void)unlink(from.path[i]);
    mem_free(s->m, from.path);
    return st;
}

/* The series' file comes last: where it is, the steps are. */
static status get_series(bench_store *s, const bench_volume *v, const glob_t *found, bool packed,
                         const char *codec, const char *leaf) {
    return access(leaf, R_OK) == 0 ? ST_OK : make_series(s, v, found, packed, codec, leaf);
}

void bench_store_alone(const char *leaf, uint32_t step, char path[PATH_MAX]) {
    snprintf(path, PATH_MAX, "%.3500s.%04u", leaf, step);
}

/* A volume as a file by this codec, whose name ends in suffix. */
static status get(bench_store *s, const char *name, const char *codec, const char *suffix,
                  bench_stored *out) {
    const bench_volume *v = find(name);
    char from[PATH_MAX];
    glob_t found = {0};
    bool packed = false;
    assert(v);
    const bool data =
        v->steps > 0 ? find_steps(s, v, &found, &packed) : find_data(s, v->data, from, &packed);
    snprintf(out->label, sizeof out->label, data || !v->data ? "%s" : "%s (%s)", v->name, v->field);
    out->isovalue = data ? v->data_isovalue : v->field_isovalue;
    out->path = keep(s, v, data, suffix);
    status st = ST_OK;
    if (v->steps > 0)
        st = get_series(s, v, data ? &found : NULL, packed, codec, out->path);
    else if (access(out->path, R_OK) != 0)
        st = data              ? convert_data(s, v, from, packed, codec, out->path)
             : goes_by_file(v) ? generate_by_file(s, v, codec, out->path)
                               : generate(s, v, codec, out->path);
    globfree(&found);
    return st;
}

status bench_store_get(bench_store *s, const char *name, bench_stored *out) {
    return get(s, name, "none", ".leaf", out);
}

status bench_store_compressed(bench_store *s, const char *name, bench_stored *out) {
    return get(s, name, "zstd:1", "-zstd.leaf", out);
}

void bench_store_forget(const char *path) {
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return;
    (void)posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED);
    close(fd);
}
