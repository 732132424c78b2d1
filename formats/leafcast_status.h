/* leafcast_status.h - what the public headers share: the status that their functions return. */
#ifndef FORMATS_LEAFCAST_STATUS_H
#define FORMATS_LEAFCAST_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/* Marks the functions of the library; nothing else of it is visible. */
#ifdef __GNUC__
#define LEAFCAST_API __attribute__((visibility("default")))
#else
#define LEAFCAST_API
#endif

typedef enum leafcast_status {
    LEAFCAST_OK = 0,
    LEAFCAST_USAGE = 2,       /* an argument makes no sense, by itself or with the others */
    LEAFCAST_CORRUPT = 3,     /* malformed file; the text names file, place and what was expected */
    LEAFCAST_UNSUPPORTED = 4, /* well-formed, but not handled */
    LEAFCAST_NOMEM = 5,       /* too little memory, or memory budget; or no more threads */
    LEAFCAST_NOSPACE = 6,     /* the disk is full, or a file may not grow further */
    LEAFCAST_IO = 7,          /* the system refused another file operation */
    LEAFCAST_EXISTS = 8,      /* an output exists already, and must not be replaced */
    LEAFCAST_STOPPED = 9,     /* the caller's function asked to stop */
    LEAFCAST_FAILED = 10      /* anything else */
} leafcast_status;

/* Most threads of a device or a conversion. */
enum { LEAFCAST_THREADS_MAX = 1024 };

/* leafcast_error_text() - a description of the calling thread's last error. */
LEAFCAST_API const char *leafcast_error_text(void);

#ifdef __cplusplus
}
#endif

#endif
