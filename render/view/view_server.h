/* view_server.h - HTTP and WebSocket of the viewer, by libwebsockets: see README.md.
 *
 * Nothing is served but the packed page and what is drawn; nothing that a request names is opened.
 * Requests must name this host (against DNS rebinding) and come from its own page (Origin); what
 * costs something needs the token. Sizes, rates and counts of everything are bounded.
 */
#ifndef RENDER_VIEW_VIEW_SERVER_H
#define RENDER_VIEW_VIEW_SERVER_H

#include <stdbool.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/view/view_life.h"
#include "render/view/view_volume.h"

enum {
    VIEW_HEADERS_MAX = 32 << 10 /* of a request's headers and address together */
};

typedef struct view_server view_server;

typedef struct view_server_options {
    const view_file *files;
    int file_count;
    view_machine machine;
    const char *address; /* that it listens at, */
    int listener;        /* by this socket, which becomes the server's */
    const char *token;
    view_life *life;
} view_server_options;

/* view_server_open() - serves whoever comes to the listener, and draws by a thread of its own.
 * view_server_close() - NULL is fine. */
CHECKED status view_server_open(mem *m, const view_server_options *options, view_server **out);
void view_server_close(view_server *s);

/* view_server_url() - where the page is, token included. */
const char *view_server_url(const view_server *s);

/* view_server_run() - serve until stop() says so, asked twice a second and after each signal. */
void view_server_run(view_server *s, bool (*stop)(void *ctx), void *ctx);

#endif
