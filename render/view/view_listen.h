/* view_listen.h - the socket that the viewer listens at. */
#ifndef RENDER_VIEW_VIEW_LISTEN_H
#define RENDER_VIEW_VIEW_LISTEN_H

#include "formats/base/status.h"

/* view_listen() - at an address, of IPv4 or IPv6, and a port, 0: any. *out: a socket, the caller's,
 * which never waits. ST_IO: no such address, or the port is taken. */
CHECKED status view_listen(const char *address, int port, int *out);

/* view_listen_port() - the port of such a socket. */
int view_listen_port(int socket);

#endif
