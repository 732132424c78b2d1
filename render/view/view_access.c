#include "render/view/view_access.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/random.h>

status view_access_token(char token[VIEW_TOKEN_TEXT]) {
    unsigned char bytes[VIEW_TOKEN_BYTES];
    if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes)
        return status_describe(ST_FAILED, "no random numbers for a token");
    for (int i = 0; i < VIEW_TOKEN_BYTES; i++)
        snprintf(token + 2 * i, 3, "%02x", bytes[i]);
    return ST_OK;
}

bool view_access_same(const char token[VIEW_TOKEN_TEXT], const char *text) {
    const size_t length = strlen(text);
    unsigned differ = length != VIEW_TOKEN_TEXT - 1;
    for (size_t i = 0; i < VIEW_TOKEN_TEXT - 1; i++)
        differ |= (unsigned)(token[i] ^ text[length ? i % length : 0]);
    return differ == 0;
}

/* Returns the length of the name in a Host header, without the port; 0: not a valid Host. */
static size_t name_length(const char *host) {
    const char *end = *host == '[' ? strchr(host, ']') : NULL;
    const size_t n = end ? (size_t)(end - host) + 1 : strcspn(host, ":");
    const char *port = host + n;
    if (*port == 0)
        return n;
    const size_t digits = strspn(port + 1, "0123456789");
    return *port == ':' && digits >= 1 && digits <= 5 && port[1 + digits] == 0 ? n : 0;
}

bool view_access_host(const char *host, const char *own) {
    const char *const names[] = {"localhost", "127.0.0.1", "[::1]", own};
    const size_t n = name_length(host);
    for (size_t i = 0; n > 0 && i < sizeof names / sizeof *names; i++)
        if (names[i] && strlen(names[i]) == n && strncasecmp(host, names[i], n) == 0)
            return true;
    return false;
}

bool view_access_origin(const char *origin, const char *host) {
    static const char scheme[] = "http://";
    return strncasecmp(origin, scheme, sizeof scheme - 1) == 0 &&
           strcasecmp(origin + sizeof scheme - 1, host) == 0;
}
