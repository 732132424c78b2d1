/* view_listen.h - open the socket at which the viewer listens. */
#ifndef RENDER_VIEW_VIEW_LISTEN_H
#define RENDER_VIEW_VIEW_LISTEN_H

#include "formats/base/status.h"

/* view_listen() - listen at an IPv4 or IPv6 address and a port; port 0: any free one. *out is a
 * non-blocking socket, which the caller owns. ST_IO: no such address, or the port is taken. */
CHECKED status view_listen(const char *address, int port, int *out);

/* view_listen_port() - returns the port of this socket. */
int view_listen_port(int socket);

#endif
