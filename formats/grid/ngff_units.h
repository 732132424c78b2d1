/* ngff_units.h - units of axes, spelled as in OME-NGFF ("micrometer") and as in leafcast ("um"). */
#ifndef FORMATS_GRID_NGFF_UNITS_H
#define FORMATS_GRID_NGFF_UNITS_H

/* ngff_units_name() - returns NGFF's spelling.
 * ngff_units_symbol() - returns leafcast's. An unknown unit stays as it is. */
const char *ngff_units_name(const char *symbol);
const char *ngff_units_symbol(const char *name);

#endif
