/* view_access.h - check who may send requests: tokens, hosts, origins. Pure functions, but for
 * making tokens. */
#ifndef RENDER_VIEW_VIEW_ACCESS_H
#define RENDER_VIEW_VIEW_ACCESS_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/status.h"

enum { VIEW_TOKEN_BYTES = 16, VIEW_TOKEN_TEXT = 2 * VIEW_TOKEN_BYTES + 1 };

/* view_access_token() - make a new random token of hexadecimal digits. ST_FAILED. */
CHECKED status view_access_token(char token[VIEW_TOKEN_TEXT]);

/* view_access_same() - returns whether a text is the token. Takes the same time wherever they
 * differ. */
bool view_access_same(const char token[VIEW_TOKEN_TEXT], const char *text);

/* view_access_host() - returns whether a Host header names this server: NAME or NAME:PORT, where
 * NAME is localhost, 127.0.0.1, [::1] or `own` (may be NULL). Any port is allowed: a tunnel has its
 * own. */
bool view_access_host(const char *host, const char *own);

/* view_access_origin() - returns whether an Origin header belongs to a page of this Host. */
bool view_access_origin(const char *origin, const char *host);

#endif
