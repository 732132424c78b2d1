#include "formats/public_status.h"

_Static_assert((int)LEAFCAST_USAGE == (int)ST_USAGE && (int)LEAFCAST_CORRUPT == (int)ST_CORRUPT &&
                   (int)LEAFCAST_UNSUPPORTED == (int)ST_UNSUPPORTED &&
                   (int)LEAFCAST_NOMEM == (int)ST_NOMEM &&
                   (int)LEAFCAST_NOSPACE == (int)ST_NOSPACE && (int)LEAFCAST_IO == (int)ST_IO &&
                   (int)LEAFCAST_EXISTS == (int)ST_EXISTS &&
                   (int)LEAFCAST_STOPPED == (int)ST_STOPPED &&
                   (int)LEAFCAST_FAILED == (int)ST_FAILED,
               "public and internal status agree");

const char *leafcast_error_text(void) {
    return status_text();
}

leafcast_status public_status(status st) {
    return st == ST_AGAIN ? LEAFCAST_FAILED : (leafcast_status)st;
}

status public_size(const char *name, size_t given, size_t here) {
    if (given == here)
        return ST_OK;
    return status_describe(ST_USAGE,
                           "%s.size is %zu, and %zu in version %s of the library: set it to the "
                           "size of the struct, and build with the header of that version",
                           name, given, here, LEAFCAST_VERSION);
}
