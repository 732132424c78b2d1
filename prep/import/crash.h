/* crash.h - turns a crash of a library on a malformed file into a message and an exit code.
 *
 * Lack of memory or of time ends as other lacks of a resource do. Other crashes end as malformed
 * input does. After crash_done() the result stands, and a crash does not change it.
 */
#ifndef PREP_IMPORT_CRASH_H
#define PREP_IMPORT_CRASH_H

/* crash_begin() - call it before libraries start. A crash from here on ends the program with a
 * message, and exit code 1 or 4. */
void crash_begin(void);

/* crash_watch() - from now on SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT and SIGXCPU print "leafcast
 * VERB: PATH: LIBRARY crashed while reading it; ..", or another reason. They end the program with
 * exit code 3 or 4. Incomplete outputs stay under their temporary names. */
void crash_watch(const char *verb, const char *library, const char *path);

/* crash_done() - from now on the same signals print a warning and end the program with this exit
 * code. */
void crash_done(int code);

#endif
