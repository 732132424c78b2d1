/* mesh_volume.h - on which side a tet is turned, or that it is flat. */
#ifndef PREP_MESH_MESH_VOLUME_H
#define PREP_MESH_MESH_VOLUME_H

/* mesh_volume_sign() - of ((b - a) x (c - a)) . (d - a): 1 where d lies on the side from which a,
 * b, c run counter-clockwise, -1 on the other, 0 for a volume of 0. Exact, unless the tet's edges
 * differ by more than 2^40 along the axes: then 0 also where doubles cannot tell. */
int mesh_volume_sign(const float a[3], const float b[3], const float c[3], const float d[3]);

#endif
