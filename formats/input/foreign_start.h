/* foreign_start.h - recognise formats without a magic number by a file's first bytes.
 *
 * start: as many bytes as foreign.h looks at, or all there are. Each function follows the format's
 * own description, which the comment names.
 */
#ifndef FORMATS_INPUT_FOREIGN_START_H
#define FORMATS_INPUT_FOREIGN_START_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

bool foreign_is_abaqus(const uint8_t *start, size_t size);  /* keywords behind a star */
bool foreign_is_ucd(const uint8_t *start, size_t size);     /* AVS: five counts on a line */
bool foreign_is_nastran(const uint8_t *start, size_t size); /* BEGIN BULK */
bool foreign_is_medit(const uint8_t *start, size_t size);   /* libMeshb: text, or a cookie of 1 */
bool foreign_is_su2(const uint8_t *start, size_t size);     /* NDIME= */
bool foreign_is_tecplot(const uint8_t *start, size_t size); /* TITLE=, VARIABLES= or ZONE */
bool foreign_is_foam(const uint8_t *start, size_t size);    /* the dictionary FoamFile */
bool foreign_is_amrex(const uint8_t *start, size_t size);   /* Header: the version, HyperCLaw */
bool foreign_is_cube(const uint8_t *start, size_t size);    /* Gaussian: atoms, three axes */
bool foreign_is_gadget(const uint8_t *start, size_t size);  /* a Fortran record of 256 bytes */

#endif
