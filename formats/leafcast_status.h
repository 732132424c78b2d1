/* leafcast_status.h - what the public headers share: how their functions say what became of it.
 */
#ifndef FORMATS_LEAFCAST_STATUS_H
#define FORMATS_LEAFCAST_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/* The functions of the library; nothing else of it is visible. */
#ifdef __GNUC__
#define LEAFCAST_API __attribute__((visibility("default")))
#else
#define LEAFCAST_API
#endif

typedef enum leafcast_status {
    LEAFCAST_OK = 0,
    LEAFCAST_USAGE = 2,   /* arguments that make no sense, or none together */
    LEAFCAST_CORRUPT = 3, /* a malformed file: the text names file, place and what was expected */
    LEAFCAST_UNSUPPORTED = 4, /* well-formed, but not handled */
    LEAFCAST_NOMEM = 5,   /* memory, or the memory budget, does not suffice; or no more threads */
    LEAFCAST_NOSPACE = 6, /* the disk is full, or a file may not grow further */
    LEAFCAST_IO = 7,      /* the system refused another file operation */
    LEAFCAST_EXISTS = 8,  /* an output is there already, and is not to be replaced */
    LEAFCAST_STOPPED = 9, /* the caller's function said so */
    LEAFCAST_FAILED = 10  /* anything else */
} leafcast_status;

/* Threads that a device or a conversion may have. */
enum { LEAFCAST_THREADS_MAX = 1024 };

/* leafcast_error_text() - more about the calling thread's last error. */
LEAFCAST_API const char *leafcast_error_text(void);

#ifdef __cplusplus
}
#endif

#endif
