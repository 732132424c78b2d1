#include "render/frame/laboratory.h"

status laboratory_needed(const laboratory **out) {
    *out = laboratory_find();
    return *out ? ST_OK : status_describe(ST_USAGE, "this library has no experiments");
}
