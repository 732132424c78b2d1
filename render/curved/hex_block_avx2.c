#include "render/curved/hex_block_template.h"
