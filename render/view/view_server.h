/* view_server.h - the viewer's HTTP and WebSocket server, by libwebsockets; see README.md.
 *
 * It serves only the embedded page and pictures that it draws; it opens no file that a request
 * names. Requests must name this host (against DNS rebinding) and come from its own page (Origin).
 * Anything costly needs the token. All sizes, rates and counts are bounded.
 */
#ifndef RENDER_VIEW_VIEW_SERVER_H
#define RENDER_VIEW_VIEW_SERVER_H

#include <stdbool.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/view/view_life.h"
#include "render/view/view_volume.h"

enum {
    VIEW_HEADERS_MAX = 32 << 10 /* bytes of a request's headers and address together */
};

typedef struct view_server view_server;

typedef struct view_server_options {
    const view_file *files;
    int file_count;
    const view_scene *scene; /* whose objects they are; or NULL */
    view_machine machine;
    const char *address; /* the address that it listens at */
    int listener;        /* the socket that it listens with; the server owns it */
    const char *token;
    view_life *life;
} view_server_options;

/* view_server_open() - serve clients of the listener, and draw in a thread of its own.
 * view_server_close() - NULL is allowed. */
CHECKED status view_server_open(mem *m, const view_server_options *options, view_server **out);
void view_server_close(view_server *s);

/* view_server_url() - returns the page's address, token included. */
const char *view_server_url(const view_server *s);

/* view_server_run() - serve until stop() returns true; it is called twice a second and after each
 * signal. */
void view_server_run(view_server *s, bool (*stop)(void *ctx), void *ctx);

#endif
