/* plc_table.h - points as a table of text: a line each, columns split by commas, semicolons or
 * blanks.
 *
 * A first line of names tells the columns of x, y and z (also Points:0 .. as ParaView writes);
 * without names they are the first three. Other columns are fields: by name, else column4, .. (also
 * 4, ..). Quotes around a cell are removed; an empty cell of a field is NaN. # begins a comment.
 */
#ifndef FORMATS_SURFACE_PLC_TABLE_H
#define FORMATS_SURFACE_PLC_TABLE_H

#include "formats/surface/plc.h"

CHECKED status plc_table_read(plc_source *s);

#endif
