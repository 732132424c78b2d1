#include "render/view/view_token.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { DIGITS = VIEW_TOKEN_TEXT - 1 };

static status refused(const char *path) {
    return status_describe(ST_IO, "%s: %s", path, strerror(errno));
}

/* Who can read the token can look; who can write it can put in one that is known. */
static status check_owner(const char *path, int fd) {
    struct stat s;
    if (fstat(fd, &s) != 0)
        return refused(path);
    if (!S_ISREG(s.st_mode))
        return status_describe(ST_USAGE, "%s: a token is kept in a regular file", path);
    if (s.st_uid != geteuid())
        return status_describe(ST_USAGE, "%s: it is another user's, who can read the token", path);
    if ((s.st_mode & (S_IRWXG | S_IRWXO)) != 0)
        return status_describe(
            ST_USAGE, "%s: others may read or write it: keep it to yourself by chmod 600", path);
    return ST_OK;
}

/* Returns whether the text is a token, and at most the end of a line. */
static bool is_token(const char *text, size_t length) {
    static const char digits[] = "0123456789abcdef";
    return (length == DIGITS || (length == DIGITS + 1 && text[DIGITS] == '\n')) &&
           strspn(text, digits) == DIGITS;
}

static status read_token(const char *path, int fd, char token[VIEW_TOKEN_TEXT]) {
    char text[DIGITS + 3] = {0};
    status st = check_owner(path, fd);
    if (st != ST_OK)
        return st;
    const ssize_t got = read(fd, text, sizeof text - 1);
    if (got < 0)
        return refused(path);
    if (!is_token(text, (size_t)got))
        return status_describe(ST_CORRUPT,
                               "%s: no token: expected %d digits 0 to 9, a to f; "
                               "without the file a new one is made",
                               path, (int)DIGITS);
    memcpy(token, text, DIGITS);
    token[DIGITS] = 0;
    return ST_OK;
}

static status write_token(const char *path, int fd, char token[VIEW_TOKEN_TEXT]) {
    char line[VIEW_TOKEN_TEXT];
    status st = view_access_token(token);
    if (st == ST_OK) {
        memcpy(line, token, DIGITS);
        line[DIGITS] = '\n';
        if (write(fd, line, sizeof line) != (ssize_t)sizeof line)
            st = refused(path);
    }
    if (st != ST_OK)
        unlink(path);
    return st;
}

status view_token_keep(const char *path, char token[VIEW_TOKEN_TEXT]) {
    /* Of two servers that start at once, one makes the file. O_NONBLOCK: a pipe does not wait. */
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
    const bool made = fd >= 0;
    if (!made && errno == EEXIST)
        fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        return refused(path);
    status st = made ? write_token(path, fd, token) : read_token(path, fd, token);
    if (close(fd) != 0 && made && st == ST_OK)
        st = refused(path);
    return st;
}
