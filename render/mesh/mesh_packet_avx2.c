#include "render/mesh/mesh_packet_template.h"
