/* view_main.c - leafcast view: serve a page that shows volumes, and draw for it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/child.h"
#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "render/app/scene_file.h"
#include "render/view/view_access.h"
#include "render/view/view_listen.h"
#include "render/view/view_server.h"
#include "render/view/view_supervisor.h"
#include "render/view/view_token.h"

enum { FILES_MAX = 64 };

typedef struct view_verb {
    cli_common common;
    int port;
    const char *address, *isa, *token_file;
    bool open, follow_links;
    mem m;
    view_file *files;
    int file_count;
    view_scene *scene; /* whose objects these files are; or NULL */
    int listener;
    char token[VIEW_TOKEN_TEXT];
} view_verb;

enum { PORT = 0x3000, ADDRESS, OPEN, ISA, FOLLOW_LINKS, TOKEN_FILE };

static const struct argp_option OPTIONS[] = {
    {"port", PORT, "N", CLI_BASIC, "where the page is served; 0: any that is free (0)", 0},
    {"address", ADDRESS, "IP", CLI_BASIC,
     "listen there, too far for this machine alone: who knows the token can look (127.0.0.1)", 0},
    {"open", OPEN, NULL, CLI_BASIC, "open the page in the browser, by xdg-open", 0},
    {"follow-links", FOLLOW_LINKS, NULL, 0,
     "a scene file may name files anywhere, not only in its own folder", 0},
    {"token-file", TOKEN_FILE, "FILE", 0,
     "keep the token there, so that the address stays the same when view starts again; made if "
     "missing, for its owner alone",
     0},
    {"isa", ISA, "auto|scalar|sse42|avx2|avx512", CLI_EXPERIMENT,
     "instructions to use: auto, scalar, sse42, avx2, avx512", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static status set_option(void *own, int key, const char *text) {
    view_verb *o = own;
    switch (key) {
    case PORT: return cli_int(text, "--port", 0, 65535, &o->port);
    case ADDRESS: o->address = text; return ST_OK;
    case OPEN: o->open = true; return ST_OK;
    case ISA: o->isa = text; return ST_OK;
    case TOKEN_FILE: o->token_file = text; return ST_OK;
    case FOLLOW_LINKS: o->follow_links = true; return ST_OK;
    default: return ST_AGAIN;
    }
}

static status check_options(void *own) {
    const view_verb *o = own;
    return o->common.input ? ST_OK : status_describe(ST_USAGE, "which treelet file?");
}

static bool is_scene(const view_verb *o) {
    bool is = false;
    for (int i = 0; i < o->common.input_count && !is; i++)
        is = scene_file_is(o->common.inputs[i]);
    return is;
}

/* Open the files of all objects of a scene. */
static status open_scene(view_verb *o, const leafcast_options *options) {
    if (o->common.input_count > 1)
        return status_describe(ST_USAGE, "a scene file is looked at alone");
    status st = view_scene_open(o->common.input, o->follow_links, options, &o->scene);
    if (st != ST_OK)
        return st;
    o->files = mem_array(&o->m, (size_t)o->scene->count, sizeof *o->files);
    if (!o->files)
        return ST_NOMEM;
    for (o->file_count = 0; o->file_count < o->scene->count; o->file_count++)
        o->files[o->file_count] = (view_file){view_scene_path(o->scene, o->file_count),
                                              view_scene_volume(o->scene, o->file_count)};
    return ST_OK;
}

/* Open all files on one device, which closes with them. */
static status open_volumes(view_verb *o, leafcast_options *options) {
    o->files = mem_array(&o->m, (size_t)o->common.input_count, sizeof *o->files);
    if (!o->files)
        return ST_NOMEM;
    status st = (status)leafcast_device_create(options, &options->device);
    options->memory = 0;
    options->threads = 0;
    options->isa = NULL;
    for (int i = 0; i < o->common.input_count && st == ST_OK; i++) {
        o->files[i].path = o->common.inputs[i];
        st = (status)leafcast_open(o->files[i].path, options, &o->files[i].volume);
        o->file_count = i + 1;
    }
    leafcast_device_destroy(options->device);
    return st;
}

static status open_files(view_verb *o) {
    leafcast_options options = {.size = sizeof options,
                                .memory = o->common.memory,
                                .threads = o->common.threads,
                                .isa = o->isa};
    if (is_scene(o))
        return open_scene(o, &options);
    if (o->follow_links)
        return status_describe(ST_USAGE, "--follow-links is of scene files");
    return open_volumes(o, &options);
}

static void close_files(view_verb *o) {
    for (int i = 0; i < o->file_count && !o->scene; i++)
        leafcast_close(o->files[i].volume);
    view_scene_close(o->scene);
    mem_free(&o->m, o->files);
}

/* From this many cells on, media and projections are drawn in few pixels, or late, while a hand
 * moves. */
enum { MANY_CELLS = 1000000 };

static void tell_slow(const view_verb *o, const view_file *f) {
    const leafcast_info info = leafcast_describe(f->volume);
    if (info.cells < MANY_CELLS || info.preview_levels > 1 ||
        (info.abilities & LEAFCAST_ABILITY_GIVEN))
        return;
    if (info.abilities & LEAFCAST_ABILITY_LEVELS)
        cli_note(&o->common, 0,
                 "%s has no coarse levels: its pictures will have few pixels while the hand moves; "
                 "leafcast convert makes them, without --levels 1",
                 f->path);
    else
        cli_note(&o->common, 0,
                 "%s has no coarse grid: media and projections of its %ss will be drawn in few "
                 "pixels while the hand moves; leafcast convert --coarse makes one",
                 f->path, info.cell);
}

/* Open the page in a browser. Do not wait for the browser: it may start slowly and stay open. */
static void open_page(const view_verb *o, const char *url) {
    child browser;
    int code = 0;
    static const char script[] =
        "command -v xdg-open >/dev/null && { xdg-open \"$0\" </dev/null >/dev/null 2>&1 & }";
    char *const argv[] = {(char *)"sh", (char *)"-c", (char *)script, (char *)url, NULL};
    status st = child_start("/bin/sh", argv, false, &browser);
    if (st == ST_OK)
        st = child_end(&browser, &code);
    if (st != ST_OK || code != 0)
        cli_note(&o->common, 0, "no xdg-open here: open the address in a browser");
}

/* Print the address, once: pages that are open need not be told again after a crash. */
static status announce(const view_verb *o, const char *url) {
    cli_results(&o->common, false);
    printf("%s\n", url);
    const status st = cli_flush();
    for (int i = 0; i < o->file_count; i++)
        if (!o->scene || view_scene_keeper(o->scene, i) == i)
            tell_slow(o, &o->files[i]);
    if (st == ST_OK && o->open)
        open_page(o, url);
    return st;
}

/* ---- The process that draws ---- */

static bool stops(void *ctx) {
    return cli_signal() || view_life_alone(ctx);
}

static status serve(view_verb *o, view_life *life) {
    const view_server_options options = {.files = o->files,
                                         .file_count = o->file_count,
                                         .scene = o->scene,
                                         .machine = {o->common.memory, o->common.threads, o->isa},
                                         .address = o->address,
                                         .listener = o->listener,
                                         .token = o->token,
                                         .life = life};
    view_server *server = NULL;
    status st = view_server_open(&o->m, &options, &server);
    if (st != ST_OK)
        return st;
    view_life_tell(life, VIEW_SERVES); /* before the address is printed: its reader may be quick */
    if (life->before < VIEW_ANNOUNCED)
        st = announce(o, view_server_url(server));
    if (st == ST_OK) {
        view_life_tell(life, VIEW_ANNOUNCED);
        view_server_run(server, stops, life);
        st = status_describe(ST_STOPPED, "stopped");
    }
    view_server_close(server);
    return st;
}

static int draw(view_verb *o, view_life *life) {
    status st = open_files(o);
    if (st == ST_OK)
        st = serve(o, life);
    close_files(o);
    return cli_finish(&o->common, st);
}

/* ---- The process that outlives it ---- */

static void tell_crash(const view_verb *o, const view_end *end, bool goes_on) {
    const bool any = end->last.what != VIEW_DOING_NOTHING;
    cli_note(&o->common, 0, "the process that draws has crashed: signal %d (%s)%s%s%s%s%s",
             end->signal, strsignal(end->signal), any ? ", at the " : "",
             any ? view_doing_name(end->last.what) : "", any ? " " : "",
             any ? end->last.told.text : "", goes_on ? "; another one begins" : "");
}

/* Start processes that draw until one ends without a crash. Returns in each of them, too, with the
 * exit status of either. */
static int supervise(view_verb *o, view_supervisor *s) {
    view_life life = {0};
    view_end end = {0};
    bool inside = false;
    status st = ST_OK;
    while (st == ST_OK) {
        st = view_supervisor_begin(s, &life, &inside);
        if (st == ST_OK && inside)
            return draw(o, &life);
        if (st != ST_OK)
            break;
        view_supervisor_wait(s, cli_signal, &life, &end);
        if (end.signal == 0)
            return end.code; /* the child has said why */
        st = cli_signal() ? status_describe(ST_STOPPED, "stopped")
                          : view_supervisor_goes_on(s, &end);
        tell_crash(o, &end, st == ST_OK);
    }
    return cli_finish(&o->common, st);
}

static int run(view_verb *o) {
    view_supervisor s = {.now = NULL};
    status st =
        o->token_file ? view_token_keep(o->token_file, o->token) : view_access_token(o->token);
    if (st == ST_OK)
        st = view_listen(o->address, o->port, &o->listener);
    if (st == ST_OK)
        st = view_supervisor_open(&s);
    const int code = st == ST_OK ? supervise(o, &s) : cli_finish(&o->common, st);
    view_supervisor_close(&s);
    return code;
}

int main(int argc, char **argv) {
    static view_verb o = {.common = {.verb = "view", .without = "output json force"},
                          .address = "127.0.0.1"};
    const cli_verb verb = {
        .options = OPTIONS,
        .set_option = set_option,
        .check = check_options,
        .input = "treelet file",
        .inputs_max = FILES_MAX,
        .args_doc = "F.leaf [G.leaf ...]\nscene.json",
        .doc = "Look at treelet files, or at a scene of many, in a browser: isosurfaces, media, "
               "projections, clips, live; prints the "
               "address of the page, and serves it until Ctrl-C.\v"
               "Example:\n  leafcast view bonsai.leaf --open\v"
               "The page is served on this machine alone, to whoever knows the "
               "address with its token. "
               "From another machine:\n  ssh -L 8080:127.0.0.1:8080 HOST "
               "leafcast view F.leaf --port 8080"};
    mem_init(&o.m, 0);
    cli_parse(&verb, &o.common, argc, argv);
    return run(&o);
}
