/* ngff_units.h - units of axes as OME-NGFF spells them ("micrometer"), and as leafcast does ("um").
 */
#ifndef FORMATS_GRID_NGFF_UNITS_H
#define FORMATS_GRID_NGFF_UNITS_H

/* ngff_units_name() - as NGFF spells it. ngff_units_symbol() - as leafcast does. A unit that is not
 * known stays as it is. */
const char *ngff_units_name(const char *symbol);
const char *ngff_units_symbol(const char *name);

#endif
