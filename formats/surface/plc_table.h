/* plc_table.h - points as a table of text: a line each, columns split by commas, semicolons or
 * blanks.
 *
 * A first line of names says which columns x, y and z are (also Points:0 .. as ParaView writes);
 * else they are the first three. The others are fields: by name, else column4, .. (also 4, ..).
 * Quotes around a cell are taken off; a cell of a field that is empty is NaN. # begins a comment.
 */
#ifndef FORMATS_SURFACE_PLC_TABLE_H
#define FORMATS_SURFACE_PLC_TABLE_H

#include "formats/surface/plc.h"

CHECKED status plc_table_read(plc_source *s);

#endif
