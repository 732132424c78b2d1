/* vtk_xml.h - one pass over a VTK XML file, to find its elements and the places of its arrays.
 *
 * A data set's reader gives a table of the elements that it knows and gets their attributes. No
 * array is held. The XML ends where appended data begin. Arrays in them have offsets, and get their
 * places when the pass is over.
 */
#ifndef FORMATS_VTK_VTK_XML_H
#define FORMATS_VTK_VTK_XML_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/input/byte_stream.h"
#include "formats/vtk/vtk_array.h"
#include "formats/vtk/vtk_extent.h"
#include "formats/vtk/vtk_fields.h"

typedef struct vtk_xml vtk_xml;

/* Kinds of elements, by which their children are read. A reader's own kinds follow. */
enum { VTK_XML_OTHER, VTK_XML_FILE, VTK_XML_OWN };

/* attributes: name, value, name, .., NULL */
typedef struct vtk_xml_element {
    int parent;
    const char *name;
    int element;
    status (*start)(vtk_xml *x, const char **attributes); /* NULL: nothing to do */
} vtk_xml_element;

typedef struct vtk_xml_reader {
    const char *type;                /* type of the VTKFile: "UnstructuredGrid" */
    const vtk_xml_element *elements; /* ends with an element without a name */
    /* Called for an array in an element of the table. Its name ("": none) is not kept; a->name is
     * NULL. */
    status (*array)(vtk_xml *x, int element, const char *name, const vtk_array *a);
} vtk_xml_reader;

/* Where the appended arrays lie. */
typedef struct vtk_appended {
    bool base64;
    uint64_t at; /* the byte that offsets are counted from */
} vtk_appended;

/* vtk_xml_type() - find the type of a VTKFile from its first bytes. Returns false when there is no
 * such tag, or its type is absent ("") or too long. */
enum { VTK_XML_TYPE_MAX = 32 };
bool vtk_xml_type(const uint8_t *start, size_t size, char type[VTK_XML_TYPE_MAX]);

/* vtk_xml_scan() - scan the file `path`, which must outlive the arrays; data stands at its start.
 * out: for vtk_xml_locate(), which must be called for every array found. ST_CORRUPT,
 * ST_UNSUPPORTED, ST_IO, ST_NOMEM, naming file and line. */
CHECKED status vtk_xml_scan(mem *m, const char *path, byte_stream *data, const vtk_xml_reader *r,
                            void *user, vtk_appended *out);
void vtk_xml_locate(const vtk_appended *p, vtk_array *a);
void vtk_xml_locate_fields(const vtk_appended *p, const vtk_fields *f);

/* ---- for a reader, during the pass ---- */

void *vtk_xml_user(const vtk_xml *x);

/* vtk_xml_fault() - describe what is wrong: "file: line 7: ..."; returns st. */
status vtk_xml_fault(const vtk_xml *x, status st, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/* vtk_xml_attribute() - returns the value of an attribute; NULL when it is not there. */
const char *vtk_xml_attribute(const char **attributes, const char *name);

/* vtk_xml_count() - read a whole number from `least` on, below 2^47. An absent attribute gives
 * `absent`, or ST_CORRUPT if that is negative. */
CHECKED status vtk_xml_count(const vtk_xml *x, const char **attributes, const char *name,
                             int64_t absent, int64_t least, uint64_t *out);

/* vtk_xml_numbers() - read exactly count numbers. If the attribute is absent, *found (may be NULL)
 * is false and out stays as it is.
 * vtk_xml_whole() - read whole numbers in lo .. hi, which must be there. vtk_xml_extent() - six, of
 * VTK_EXTENT_MAX at most. */
CHECKED status vtk_xml_numbers(const vtk_xml *x, const char **attributes, const char *name,
                               int count, double *out, bool *found);
CHECKED status vtk_xml_whole(const vtk_xml *x, const char **attributes, const char *name, int count,
                             int64_t lo, int64_t hi, int64_t *out);
CHECKED status vtk_xml_extent(const vtk_xml *x, const char **attributes, const char *name,
                              vtk_extent *out);

#endif
