/* public_header.h - the structs and functions that a public header declares, by name: as much of C
 * as these headers are written in. */
#ifndef TESTS_SUPPORT_PUBLIC_HEADER_H
#define TESTS_SUPPORT_PUBLIC_HEADER_H

enum { PUBLIC_HEADER_MAX = 512, PUBLIC_HEADER_NAME = 64 };

typedef struct public_header {
    /* Members, each with its struct. */
    int members;
    char of[PUBLIC_HEADER_MAX][PUBLIC_HEADER_NAME], member[PUBLIC_HEADER_MAX][PUBLIC_HEADER_NAME];
    int functions; /* those with LEAFCAST_API */
    char function[PUBLIC_HEADER_MAX][PUBLIC_HEADER_NAME];
} public_header;

/* public_header_read() - adds what the file at this path, from the root of the project, declares;
 * fails the test where it cannot be read. */
void public_header_read(public_header *h, const char *path);

#endif
