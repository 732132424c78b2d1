#include "render/bench/peer_vtk.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/base/num.h"
#include "formats/base/sibling.h"

static const char HELPER[] = "leafcast-peer-vtk";
enum { FIELD_AT = 3, PICTURE_AT, NO_VTK = 77, LINE = 256 };

struct peer_vtk {
    pid_t pid;
    FILE *ask, *answer;
    char version[32];
    mem *m;
    int picture;    /* a file without a name that the child writes */
    size_t numbers; /* of it */
};

/* The samples as a file without a name. */
static status share_field(const peer_field *f, int *out) {
    const char *at = (const char *)f->samples;
    size_t left = (size_t)f->dims[0] * f->dims[1] * f->dims[2] * sizeof *f->samples;
    *out = memfd_create(HELPER, MFD_CLOEXEC);
    if (*out < 0)
        return file_failed(errno, HELPER, "cannot share the field");
    while (left > 0) {
        const ssize_t n = write(*out, at, left);
        if (n < 0 && errno != EINTR)
            return file_failed(errno, HELPER, "cannot share the field");
        at += n > 0 ? n : 0;
        left -= n > 0 ? (size_t)n : 0;
    }
    return ST_OK;
}

enum { FDS = 4 };
static int spawn(const char *program, char *const arguments[], const int fds[FDS], pid_t *pid) {
    static const int targets[FDS] = {STDIN_FILENO, STDOUT_FILENO, FIELD_AT, PICTURE_AT};
    posix_spawn_file_actions_t actions;
    int error = posix_spawn_file_actions_init(&actions);
    if (error)
        return error;
    for (int i = 0; i < FDS && !error; i++)
        error = posix_spawn_file_actions_adddup2(&actions, fds[i], targets[i]);
    if (!error)
        error = posix_spawn(pid, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

/* Start the child between two pipes. */
static status start(peer_vtk *v, const char *program, char *const arguments[], int field) {
    int in[2] = {-1, -1}, out[2] = {-1, -1};
    int error = pipe2(in, O_CLOEXEC) || pipe2(out, O_CLOEXEC) ? errno : 0;
    if (!error) {
        const int fds[FDS] = {in[0], out[1], field, v->picture};
        error = spawn(program, arguments, fds, &v->pid);
    }
    close(in[0]);
    close(out[1]);
    v->ask = fdopen(in[1], "w");
    v->answer = fdopen(out[0], "r");
    return error ? file_failed(error, program, "cannot start") : ST_OK;
}

/* The child ended instead of answering. */
static status ended(peer_vtk *v) {
    int state = 0;
    while (waitpid(v->pid, &state, 0) < 0 && errno == EINTR)
        continue;
    v->pid = 0;
    if (WIFEXITED(state) && (WEXITSTATUS(state) == NO_VTK || WEXITSTATUS(state) == 127))
        return status_describe(ST_UNSUPPORTED, "install python3-vtk9");
    return status_describe(ST_FAILED, "%s failed", HELPER);
}

static status greet(peer_vtk *v, const peer_field *f, int threads) {
    char program[SIBLING_PATH], text[7][NUM_TEXT_MAX];
    if (!sibling_find(HELPER, program))
        return status_describe(ST_UNSUPPORTED, "%s is not there", HELPER);
    for (int a = 0; a < 3; a++) {
        snprintf(text[a], sizeof text[a], "%u", f->dims[a]);
        num_print(affine_unit(&f->space, a), text[3 + a]);
    }
    snprintf(text[6], sizeof text[6], "%d", threads);
    char *arguments[] = {program, text[0], text[1], text[2], text[3],
                         text[4], text[5], text[6], NULL};
    int field = -1;
    status st = share_field(f, &field);
    v->picture = memfd_create(HELPER, MFD_CLOEXEC);
    if (st == ST_OK && v->picture < 0)
        st = file_failed(errno, HELPER, "cannot share a picture");
    if (st == ST_OK)
        st = start(v, program, arguments, field);
    if (field >= 0)
        close(field);
    if (st)
        return st;
    char line[LINE];
    if (!fgets(line, sizeof line, v->answer))
        return ended(v);
    snprintf(v->version, sizeof v->version, "%.*s", (int)strcspn(line, "\n"), line);
    return ST_OK;
}

status peer_vtk_start(mem *m, const peer_field *field, int threads, peer_vtk **out) {
    peer_vtk *v = *out = mem_zalloc(m, sizeof *v);
    if (!v)
        return ST_NOMEM;
    v->m = m;
    v->picture = -1;
    status st = greet(v, field, threads);
    if (st) {
        peer_vtk_stop(v);
        *out = NULL;
    }
    return st;
}

/* At the end of its input the child ends. */
void peer_vtk_stop(peer_vtk *v) {
    if (!v)
        return;
    if (v->ask)
        fclose(v->ask);
    if (v->answer)
        fclose(v->answer);
    if (v->picture >= 0)
        close(v->picture);
    while (v->pid > 0 && waitpid(v->pid, NULL, 0) < 0 && errno == EINTR)
        continue;
    mem_free(v->m, v);
}

status peer_vtk_extract(peer_vtk *v, double isovalue, double *seconds, uint64_t *triangles) {
    char line[LINE], number[NUM_TEXT_MAX];
    num_print(isovalue, number);
    fprintf(v->ask, "%s\n", number);
    fflush(v->ask);
    if (!fgets(line, sizeof line, v->answer))
        return ended(v);
    char *end = strchr(line, ' ');
    if (!end)
        return status_describe(ST_FAILED, "%s: an answer that is none", HELPER);
    *end = 0;
    int64_t count = 0;
    end[1 + strcspn(end + 1, "\n")] = 0;
    status st = num_double(line, HELPER, seconds);
    if (st == ST_OK)
        st = num_int(end + 1, HELPER, 0, INT64_MAX, &count);
    *triangles = (uint64_t)count;
    return st;
}

/* ---- Pictures ---- */

static void say_numbers(peer_vtk *v, const double *x, int count) {
    char text[NUM_TEXT_MAX];
    for (int i = 0; i < count; i++) {
        num_print(x[i], text);
        fprintf(v->ask, " %s", text);
    }
}

status peer_vtk_fill(peer_vtk *v, const peer_vtk_scene *s) {
    const leafcast_camera *c = &s->camera;
    fprintf(v->ask, "medium %s %d", s->type, s->count);
    say_numbers(v, &s->length, 1);
    fprintf(v->ask, "\n");
    for (int i = 0; i < s->count; i++) {
        const leafcast_transfer_point *p = &s->points[i];
        const double x[] = {p->value, p->rgb[0], p->rgb[1], p->rgb[2], p->extinction};
        say_numbers(v, x, 5);
        fprintf(v->ask, "\n");
    }
    fprintf(v->ask, "view %s %u %u", s->type, c->width, c->height);
    say_numbers(v, c->eye, 3);
    say_numbers(v, c->look_at, 3);
    say_numbers(v, c->up, 3);
    say_numbers(v, &c->fov, 1);
    say_numbers(v, &c->ortho_height, 1);
    fprintf(v->ask, "\n");
    v->numbers = (size_t)4 * c->width * c->height;
    return fflush(v->ask) == 0 ? ST_OK : ended(v);
}

/* What is in the file. */
static status read_picture(peer_vtk *v, double *rgba) {
    enum { PART = 4096 };
    uint16_t part[PART];
    for (size_t at = 0; at < v->numbers;) {
        const size_t left = v->numbers - at, want = left < PART ? left : PART;
        const ssize_t n = pread(v->picture, part, want * sizeof *part, (off_t)(at * sizeof *part));
        if (n < (ssize_t)sizeof *part)
            return status_describe(ST_FAILED, "%s: a picture that is too short", HELPER);
        for (size_t i = 0; i < (size_t)n / sizeof *part; i++)
            rgba[at++] = part[i] / 32767.0;
    }
    return ST_OK;
}

status peer_vtk_cast(peer_vtk *v, const char *type, double distance, double *seconds,
                     double *rgba) {
    char line[LINE];
    fprintf(v->ask, "cast %s", type);
    say_numbers(v, &distance, 1);
    fprintf(v->ask, "\n");
    if (fflush(v->ask) != 0 || !fgets(line, sizeof line, v->answer))
        return ended(v);
    line[strcspn(line, "\n")] = 0;
    const status st = num_double(line, HELPER, seconds);
    return st == ST_OK ? read_picture(v, rgba) : st;
}

const char *peer_vtk_version(const peer_vtk *v) {
    return v->version;
}
