#include "render/mesh_packet_template.h"
