/* view_token.h - the token of a server that is started again: kept in a file. */
#ifndef RENDER_VIEW_VIEW_TOKEN_H
#define RENDER_VIEW_VIEW_TOKEN_H

#include "render/view/view_access.h"

/* view_token_keep() - read the token from a file. Where there is no such file, make a new token,
 * and write it to a new file that its owner alone may read. ST_USAGE: others may read or write the
 * file, or it is another user's; ST_CORRUPT: no token is in it; ST_IO, ST_FAILED. */
CHECKED status view_token_keep(const char *path, char token[VIEW_TOKEN_TEXT]);

#endif
