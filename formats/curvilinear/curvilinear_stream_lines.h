/* curvilinear_stream_lines.h - how the lines of a curvilinear stream's header begin. */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_STREAM_LINES_H
#define FORMATS_CURVILINEAR_CURVILINEAR_STREAM_LINES_H

#define CURVILINEAR_LINE_MAGIC   "LEAFCAST CURVILINEAR "
#define CURVILINEAR_LINE_NAME    "name: "
#define CURVILINEAR_LINE_FIELD   "field: "
#define CURVILINEAR_LINE_ZONE    "zone: "
#define CURVILINEAR_LINE_BLANKED "blanked: "

#endif
