#include "prep/import/images/image_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <unistd.h>

#include <OpenImageIO/imageio.h>

using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

struct image_file {
    std::string path, description;
    std::unique_ptr<ImageInput> in;
    ImageSpec spec; /* of the current page */
    uint32_t page = 0;
    image_facts facts = {};
};

namespace {

enum { BAND_ROWS = 64 };

/* Formats of still images. The library also reads films, volumes and raw files of cameras. */
const char *const formats[] = {"tiff", "png",  "openexr", "jpeg",     "bmp", "pnm",
                               "hdr",  "webp", "targa",   "jpeg2000", "sgi", "dpx"};

bool is_still(const std::string &format) {
    for (const char *f : formats)
        if (format == f)
            return true;
    return false;
}

/* ---- errors ---- */

std::string without_line_ends(std::string text) {
    for (char &c : text)
        if (c == '\n')
            c = ' ';
    return text;
}

status broken(const image_file *f) {
    const std::string why = without_line_ends(f->in ? f->in->geterror() : OIIO::geterror());
    return status_describe(ST_CORRUPT, "%s: page %u cannot be read: %s", f->path.c_str(), f->page,
                           why.empty() ? "it is malformed" : why.c_str());
}

status thrown(const std::string &path) {
    try {
        throw;
    } catch (const std::bad_alloc &) {
        return status_describe(ST_NOMEM, "%s: no memory to read it", path.c_str());
    } catch (const std::exception &e) {
        return status_describe(ST_CORRUPT, "%s: malformed: %s", path.c_str(), e.what());
    } catch (...) {
        return status_describe(ST_CORRUPT, "%s: malformed", path.c_str());
    }
}

/* ---- facts ---- */

/* Only for formats of measured pictures: the resolution in a JPEG is meant for paper. */
void find_resolution(image_file *f) {
    const std::string format = f->in->format_name();
    const std::string unit = f->spec.get_string_attribute("ResolutionUnit");
    f->facts.unit = unit == "in" || unit == "inch" ? 25.4 : unit == "cm" ? 10 : 0;
    if (format != "tiff" && (format != "png" || !(f->facts.unit > 0)))
        return;
    f->facts.resolution[0] = f->spec.get_float_attribute("XResolution");
    f->facts.resolution[1] = f->spec.get_float_attribute("YResolution");
}

status take_page(image_file *f) {
    f->spec = f->in->spec();
    const ImageSpec &s = f->spec;
    if (s.deep || s.depth > 1)
        return status_describe(ST_UNSUPPORTED, "%s: page %u %s", f->path.c_str(), f->page,
                               s.deep ? "has deep samples" : "is a volume of its own");
    if (s.width < 1 || s.height < 1 || s.nchannels < 1)
        return broken(f);
    const auto named = [&](int c, const char *name) {
        return c < s.nchannels && s.channelnames[c] == name;
    };
    f->facts = {};
    f->facts.width = uint32_t(s.width);
    f->facts.height = uint32_t(s.height);
    f->facts.channels = uint32_t(s.nchannels);
    f->facts.colour = named(0, "R") && named(1, "G") && named(2, "B");
    f->facts.grey = s.nchannels == 1 || (s.nchannels == 2 && s.alpha_channel == 1);
    f->description = s.get_string_attribute("ImageDescription");
    find_resolution(f);
    return ST_OK;
}

status type_of(const image_file *f, TypeDesc from, sample_type *out) {
    switch (from.basetype) {
    case TypeDesc::UINT8: *out = SAMPLE_U8; return ST_OK;
    case TypeDesc::INT8: *out = SAMPLE_I8; return ST_OK;
    case TypeDesc::UINT16: *out = SAMPLE_U16; return ST_OK;
    case TypeDesc::INT16: *out = SAMPLE_I16; return ST_OK;
    case TypeDesc::UINT32: *out = SAMPLE_U32; return ST_OK;
    case TypeDesc::INT32: *out = SAMPLE_I32; return ST_OK;
    case TypeDesc::HALF:
    case TypeDesc::FLOAT: *out = SAMPLE_F32; return ST_OK;
    case TypeDesc::DOUBLE: *out = SAMPLE_F64; return ST_OK;
    default:
        return status_describe(ST_UNSUPPORTED, "%s: page %u has samples of type %s",
                               f->path.c_str(), f->page, from.c_str());
    }
}

TypeDesc desc_of(sample_type type) {
    switch (type) {
    case SAMPLE_U8: return TypeDesc::UINT8;
    case SAMPLE_I8: return TypeDesc::INT8;
    case SAMPLE_U16: return TypeDesc::UINT16;
    case SAMPLE_I16: return TypeDesc::INT16;
    case SAMPLE_U32: return TypeDesc::UINT32;
    case SAMPLE_I32: return TypeDesc::INT32;
    case SAMPLE_F64: return TypeDesc::DOUBLE;
    default: return TypeDesc::FLOAT;
    }
}

TypeDesc stored(const image_file *f, int channel) {
    return channel < 0 ? f->spec.format : f->spec.channelformat(channel);
}

/* ---- samples ---- */

template <typename T> void mix(const void *from, void *to, size_t count) {
    const T *rgb = static_cast<const T *>(from);
    T *out = static_cast<T *>(to);
    const bool whole = std::is_integral<T>::value;
    for (size_t i = 0; i < count; i++, rgb += 3) {
        const double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        out[i] = static_cast<T>(whole ? std::rint(y) : y);
    }
}

void luminance(sample_type type, const void *rgb, void *out, size_t count) {
    switch (type) {
    case SAMPLE_U8: mix<uint8_t>(rgb, out, count); break;
    case SAMPLE_I8: mix<int8_t>(rgb, out, count); break;
    case SAMPLE_U16: mix<uint16_t>(rgb, out, count); break;
    case SAMPLE_I16: mix<int16_t>(rgb, out, count); break;
    case SAMPLE_U32: mix<uint32_t>(rgb, out, count); break;
    case SAMPLE_I32: mix<int32_t>(rgb, out, count); break;
    case SAMPLE_F32: mix<float>(rgb, out, count); break;
    case SAMPLE_F64: mix<double>(rgb, out, count); break;
    default: break; /* images have no other type */
    }
}

/* Colours as numbers (surface_colour.h). T: of bytes, or of 16 bits, of which `one` is 255. */
template <typename T> void pack(const void *from, unsigned one, void *to, size_t count) {
    const T *rgb = static_cast<const T *>(from);
    float *out = static_cast<float *>(to);
    for (size_t i = 0; i < count; i++, rgb += 3) {
        unsigned value = 0;
        for (int c = 0; c < 3; c++)
            value = 256 * value + (rgb[c] + one / 2) / one;
        out[i] = float(value);
    }
}

/* What a pixel of three channels is taken for. */
void join(int channel, sample_type stored, const void *rgb, void *out, size_t count) {
    if (channel == IMAGE_LUMINANCE)
        luminance(stored, rgb, out, count);
    else if (stored == SAMPLE_U8)
        pack<uint8_t>(rgb, 1, out, count);
    else
        pack<uint16_t>(rgb, 257, out, count);
}

status refuse_colours(const image_file *f) {
    return status_describe(ST_UNSUPPORTED,
                           "%s: page %u: expected red, green and blue of 8 or 16 bits: it has %u "
                           "channels of %s",
                           f->path.c_str(), f->page, f->facts.channels, f->spec.format.c_str());
}

/* No type: as they are stored. For samples of a type that is named, also of the one stored, the
 * library (2.4) makes room for 64 MB at each call, and copies. */
TypeDesc asked(const image_file *f, sample_type type) {
    const bool as_stored = f->spec.channelformats.empty() && f->spec.format == desc_of(type);
    return as_stored ? TypeDesc() : desc_of(type);
}

/* Of doubles in a TIFF the library reads whole strips at once. A single row or tile is zeros, and
 * no error. */
int rows_at_once(const ImageSpec &s, sample_type type) {
    return s.tile_width ? s.tile_height : type == SAMPLE_F64 ? s.height : BAND_ROWS;
}

status refuse_double_tiles(const image_file *f) {
    return status_describe(ST_UNSUPPORTED,
                           "%s: page %u has tiles of doubles, of which the library makes zeros; "
                           "strips or floats are read (tiffcp -s)",
                           f->path.c_str(), f->page);
}

/* Read rows [first, end) of channels [c0, c1). Tiled files: whole rows of tiles. */
bool read_rows(image_file *f, int first, int end, int c0, int c1, TypeDesc type, void *to) {
    const ImageSpec &s = f->spec;
    if (s.tile_width)
        return f->in->read_tiles(int(f->page), 0, s.x, s.x + s.width, s.y + first, s.y + end, s.z,
                                 s.z + 1, c0, c1, type, to);
    return f->in->read_scanlines(int(f->page), 0, s.y + first, s.y + end, s.z, c0, c1, type, to);
}

status read_page(image_file *f, int channel, void *samples) {
    sample_type type = SAMPLE_U8, from = SAMPLE_U8;
    status st = image_file_type(f, channel, &type);
    if (st == ST_OK)
        st = type_of(f, stored(f, channel), &from);
    if (st != ST_OK)
        return st;
    const bool mixed = channel < 0;
    const int rows = rows_at_once(f->spec, from), width = f->spec.width;
    const size_t row = size_t(width) * sample_size(type);
    std::vector<char> band(mixed ? 3 * size_t(width) * sample_size(from) * rows : 0);
    for (int y = 0, end; y < f->spec.height; y = end) {
        end = std::min(y + rows, f->spec.height);
        char *to = static_cast<char *>(samples) + row * y;
        if (!read_rows(f, y, end, mixed ? 0 : channel, mixed ? 3 : channel + 1, asked(f, from),
                       mixed ? band.data() : to))
            return broken(f);
        if (mixed)
            join(channel, from, band.data(), to, size_t(width) * (end - y));
    }
    return ST_OK;
}

} // namespace

/* ---- what C calls ---- */

status image_file_open(const char *path, image_file **out) {
    try {
        if (access(path, R_OK) != 0)
            return status_describe(ST_IO, "%s: cannot open: %s", path, strerror(errno));
        auto f = std::make_unique<image_file>();
        ImageSpec config;
        config.attribute("oiio:UnassociatedAlpha", 1);
        f->path = path;
        f->in = ImageInput::open(path, &config);
        if (!f->in) {
            const std::string why = without_line_ends(OIIO::geterror());
            return status_describe(ST_CORRUPT, "%s: no image that can be read: %s", path,
                                   why.c_str());
        }
        if (!is_still(f->in->format_name()))
            return status_describe(ST_UNSUPPORTED, "%s: %s is no format of images that is read",
                                   path, f->in->format_name());
        const status st = take_page(f.get());
        if (st == ST_OK)
            *out = f.release();
        return st;
    } catch (...) {
        return thrown(path);
    }
}

void image_file_close(image_file *f) {
    delete f;
}

status image_file_seek(image_file *f, uint32_t page, bool *there) {
    try {
        *there = page == f->page || f->in->seek_subimage(int(page), 0);
        if (!*there || page == f->page) {
            f->in->geterror();
            return ST_OK;
        }
        f->page = page;
        return take_page(f);
    } catch (...) {
        return thrown(f->path);
    }
}

const image_facts *image_file_facts(const image_file *f) {
    return &f->facts;
}

const char *image_file_channel(const image_file *f, uint32_t channel) {
    return f->spec.channelnames[channel].c_str();
}

const char *image_file_format(const image_file *f) {
    return f->in->format_name();
}

const char *image_file_description(const image_file *f) {
    return f->description.c_str();
}

status image_file_type(const image_file *f, int channel, sample_type *out) {
    const status st = type_of(f, stored(f, channel), out);
    if (st == ST_OK && channel == IMAGE_COLOURS) {
        const bool bytes = *out == SAMPLE_U8 || *out == SAMPLE_U16;
        *out = SAMPLE_F32;
        return bytes && f->facts.colour ? ST_OK : refuse_colours(f);
    }
    const bool doubles = st == ST_OK && *out == SAMPLE_F64 && f->spec.tile_width;
    return doubles && strcmp(f->in->format_name(), "tiff") == 0 ? refuse_double_tiles(f) : st;
}

status image_file_read(image_file *f, int channel, void *samples) {
    try {
        return read_page(f, channel, samples);
    } catch (...) {
        return thrown(f->path);
    }
}

bool image_file_known(const char *path) {
    static const auto suffixes = OIIO::get_extension_map();
    const char *dot = strrchr(path, '.');
    std::string suffix = dot && !strchr(dot, '/') ? dot + 1 : "";
    for (char &c : suffix)
        c = char(tolower(c));
    for (const char *format : formats) {
        const auto found = suffixes.find(format);
        if (found == suffixes.end())
            continue;
        for (const std::string &s : found->second)
            if (s == suffix)
                return true;
    }
    return false;
}
