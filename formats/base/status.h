/* status.h - how every function of leafcast reports success or failure.
 *
 * The function that detects a fault describes it, once, with status_describe(). Everyone above
 * passes the status up untouched. A caller's bug is an assert, never a status.
 *
 * The description belongs to the calling thread (as errno does). A fault found on a worker thread
 * is carried to the thread that waits for it in a status_note.
 */
#ifndef FORMATS_BASE_STATUS_H
#define FORMATS_BASE_STATUS_H

#define CHECKED __attribute__((warn_unused_result))

typedef enum status {
    ST_OK = 0,
    ST_AGAIN,       /* not yet: ask again later; no fault */
    ST_USAGE,       /* arguments that make no sense together */
    ST_CORRUPT,     /* malformed input: names the file, the place and what was expected */
    ST_UNSUPPORTED, /* well-formed input that leafcast does not handle */
    ST_NOMEM,       /* memory or the memory budget does not suffice */
    ST_NOSPACE,     /* the disk is full, or a file may not grow further */
    ST_IO,          /* the operating system refused a file operation */
    ST_EXISTS,      /* an output exists and must not be overwritten */
    ST_STOPPED,     /* the caller asked to stop */
    ST_FAILED       /* anything else: a thread that could not be created, a child that died */
} status;

enum { STATUS_TEXT_MAX = 1024 };

/* A status with its description, to be carried from one thread to another. */
typedef struct status_note {
    status st;
    char text[STATUS_TEXT_MAX];
} status_note;

/* status_describe() - set this thread's description; returns st, so that `return
 * status_describe(...)` reads well. */
status status_describe(status st, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* status_text() - this thread's last description; "" when nothing was described. Valid until the
 * next one. */
const char *status_text(void);

/* status_exit_code() - the exit status of a program that ends with st. A signal handler may call
 * it. */
int status_exit_code(status st);

/* status_note_take() - keep st with this thread's description. */
void status_note_take(status_note *note, status st);

/* status_note_raise() - make the note's description this thread's; returns its status. */
CHECKED status status_note_raise(const status_note *note);

#endif
