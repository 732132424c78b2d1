#include "render/experiments/mesh_packet_template.h"
