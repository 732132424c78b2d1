/* plot3d_flow.h - the fields of a PLOT3D solution: its five numbers, and functions of them.
 *
 * The numbers are density r, momentum r v (three) and energy e a volume, in units of the free
 * stream's density and speed of sound: of a perfect gas with gamma = 1.4 and R = 1. Pure.
 * Source: NASA TM-101067 (see plot3d_layout.h), appendix of functions, the number in brackets:
 *
 *   pressure    [110]  (gamma - 1) (e - r |v|^2 / 2); 1 / gamma in the free stream
 *   temperature [120]  pressure / (r R)
 *   mach        [154]  |v| / sqrt(gamma pressure / r)
 *   entropy     [170]  R / (gamma - 1) ln(gamma pressure / r^gamma); 0 in the free stream
 */
#ifndef FORMATS_CURVILINEAR_PLOT3D_FLOW_H
#define FORMATS_CURVILINEAR_PLOT3D_FLOW_H

#include <stdint.h>

enum { PLOT3D_FLOW_NUMBERS = 5 };

typedef struct plot3d_flow {
    const char *name;
    uint32_t components; /* 1 or 3 */
    /* Computes the field at a node. Components that are not finite where the flow has none: density
     * of 0, negative pressure. */
    void (*of)(const double q[PLOT3D_FLOW_NUMBERS], double out[3]);
} plot3d_flow;

enum { PLOT3D_FLOWS = 9 };
extern const plot3d_flow plot3d_flows[PLOT3D_FLOWS];

#endif
