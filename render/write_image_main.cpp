/* write_image_main.cpp - the helper process that turns float planes into a picture.
 *
 *   leafcast-write-image OUT.png|OUT.exr [--force] < planes
 *
 * OpenImageIO brings some 250 shared objects, half a second of loading: only this process pays,
 * beside the renderer that feeds it through a pipe. The stream, little endian, nothing aligned:
 *
 *   offset  size  field
 *        0     4  magic "LFIM"
 *        4     4  u32 version, 1
 *        8     4  u32 width   1 .. 65536
 *       12     4  u32 height  1 .. 65536
 *       16     4  u32 nchannels  1 .. 64
 *       20  32*n  channel names, NUL-padded, at most 31 letters each, no two alike
 *        .     4  u32 nmeta, at most 256
 *        .     .  nmeta times: u32 length, key bytes, u32 length, value bytes; each at most 65536
 *        .     .  nchannels planes of height rows of width float32, the top row first
 *
 * and not a byte more. PNG takes the channels R G B and A (opaque where there is none) as 8 bits,
 * sRGB encoded unless the metadata hold colour=linear; nothing is composited. EXR takes every
 * channel as float32, bit by bit. Metadata are kept as "leafcast:KEY". The same stream gives the
 * same bytes.
 *
 * The picture appears under its name when it is complete. Exit codes: 0; 1 cannot write; 2 usage; 3
 * malformed stream; 128+n by signal.
 */
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include <OpenImageIO/imageio.h>

namespace {

constexpr uint32_t MAX_SIDE = 65536, MAX_CHANNELS = 64, MAX_META = 256, MAX_TEXT = 65536;
constexpr int NAME_BYTES = 32;

struct failure : std::runtime_error {
    int code;
    failure(int exit_code, const std::string &what) : std::runtime_error(what), code(exit_code) {}
};

struct picture {
    uint32_t width = 0, height = 0;
    std::vector<std::string> names;
    std::vector<std::pair<std::string, std::string>> meta;
    std::vector<std::unique_ptr<float[]>> planes;

    const float *plane(const std::string &name) const {
        for (size_t c = 0; c < names.size(); c++)
            if (names[c] == name)
                return planes[c].get();
        return nullptr;
    }
    bool says(const std::string &key, const std::string &value) const {
        for (const auto &m : meta)
            if (m.first == key && m.second == value)
                return true;
        return false;
    }
};

/* ---- the stream ---------------------------------------------------------------------------------
 */

void get(void *to, size_t bytes, const char *what) {
    if (fread(to, 1, bytes, stdin) != bytes)
        throw failure(3, std::string("the stream ends within ") + what);
}

uint32_t get_u32(uint32_t lo, uint32_t hi, const char *what) {
    unsigned char b[4];
    get(b, sizeof b, what);
    uint32_t v = b[0] | uint32_t(b[1]) << 8 | uint32_t(b[2]) << 16 | uint32_t(b[3]) << 24;
    if (v < lo || v > hi)
        throw failure(3, std::string(what) + " is " + std::to_string(v) + ", expected " +
                             std::to_string(lo) + " to " + std::to_string(hi));
    return v;
}

std::string get_text(const char *what) {
    std::string s(get_u32(0, MAX_TEXT, what), '\0');
    get(&s[0], s.size(), what);
    return s;
}

std::string get_name(const picture &p) {
    char raw[NAME_BYTES];
    get(raw, sizeof raw, "the channel names");
    std::string name(raw, strnlen(raw, sizeof raw));
    if (name.empty() || name.size() == sizeof raw)
        throw failure(3, "a channel name is empty or not terminated");
    for (char c : name)
        if (c <= ' ' || c > '~')
            throw failure(3, "a channel name holds more than printable letters");
    for (const auto &other : p.names)
        if (other == name)
            throw failure(3, "two channels are named " + name);
    return name;
}

/* A header that promises more than comes costs address space only: a plane's memory is not touched
 * before its bytes are there. */
picture get_picture() {
    picture p;
    char magic[4];
    get(magic, sizeof magic, "the magic number");
    if (memcmp(magic, "LFIM", sizeof magic) != 0)
        throw failure(3, "this is no LFIM stream");
    get_u32(1, 1, "the version");
    p.width = get_u32(1, MAX_SIDE, "the width");
    p.height = get_u32(1, MAX_SIDE, "the height");
    uint32_t channels = get_u32(1, MAX_CHANNELS, "the number of channels");
    for (uint32_t c = 0; c < channels; c++)
        p.names.push_back(get_name(p));
    uint32_t pairs = get_u32(0, MAX_META, "the number of metadata");
    for (uint32_t i = 0; i < pairs; i++) {
        std::string key = get_text("a metadata key");
        p.meta.emplace_back(key, get_text("a metadata value"));
    }
    size_t samples = size_t(p.width) * p.height;
    for (uint32_t c = 0; c < channels; c++) {
        p.planes.emplace_back(new float[samples]);
        get(p.planes.back().get(), samples * sizeof(float), "the planes");
    }
    if (getchar() != EOF)
        throw failure(3, "the stream goes on after its last plane");
    return p;
}

/* ---- the picture --------------------------------------------------------------------------------
 */

struct layout {
    const char *format; /* OpenImageIO's name */
    OIIO::TypeDesc type;
    std::vector<std::string> channels;
};

layout layout_for(const picture &p, const std::string &file) {
    auto ends = [&](const char *tail) {
        size_t n = strlen(tail);
        return file.size() > n && file.compare(file.size() - n, n, tail) == 0;
    };
    if (ends(".exr"))
        return {"openexr", OIIO::TypeDesc::FLOAT, p.names};
    if (!ends(".png"))
        throw failure(2, file + ": the name must end in .png or .exr");
    for (const char *name : {"R", "G", "B"})
        if (!p.plane(name))
            throw failure(3, std::string("a PNG needs the channel ") + name);
    return {"png", OIIO::TypeDesc::UINT8, {"R", "G", "B", "A"}};
}

unsigned char to_byte(float v, bool srgb) {
    double x = v > 0 ? (v < 1 ? v : 1) : 0; /* NaN becomes 0 */
    if (srgb)
        x = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    return static_cast<unsigned char>(x * 255 + 0.5);
}

/* Write in bands of 64 rows, so that only one band is held twice. */
template <typename T, typename Convert>
bool write_bands(OIIO::ImageOutput &out, const picture &p, const layout &to, Convert convert) {
    constexpr uint32_t BAND = 64;
    size_t n = to.channels.size();
    std::vector<T> band(n * p.width * std::min(BAND, p.height));
    for (uint32_t y = 0; y < p.height; y += BAND) {
        uint32_t end = std::min(y + BAND, p.height);
        size_t first = size_t(y) * p.width, samples = size_t(end - y) * p.width;
        for (size_t c = 0; c < n; c++) {
            const float *plane = p.plane(to.channels[c]);
            for (size_t i = 0; i < samples; i++)
                band[i * n + c] = convert(plane ? plane[first + i] : 1, to.channels[c] == "A");
        }
        if (!out.write_scanlines(int(y), int(end), 0, to.type, band.data()))
            return false;
    }
    return true;
}

void write_file(const picture &p, const layout &to, const std::string &file) {
    OIIO::ImageSpec spec(int(p.width), int(p.height), int(to.channels.size()), to.type);
    spec.channelnames = to.channels;
    bool linear = to.type == OIIO::TypeDesc::FLOAT || p.says("colour", "linear");
    spec.attribute("oiio:ColorSpace", linear ? "Linear" : "sRGB");
    if (to.type == OIIO::TypeDesc::UINT8)
        spec.attribute("oiio:UnassociatedAlpha", 1); /* as they come: nothing is divided */
    spec.attribute("compression", "zip");
    spec.attribute("Software", "leafcast " LEAFCAST_VERSION);
    spec.attribute("DateTime", "1970:01:01 00:00:00"); /* EXR would take the clock's */
    for (const auto &m : p.meta)
        spec.attribute("leafcast:" + m.first, m.second);

    auto out = OIIO::ImageOutput::create(to.format);
    if (!out)
        throw failure(1, OIIO::geterror());
    bool ok = out->open(file, spec);
    if (ok && to.type == OIIO::TypeDesc::FLOAT)
        ok = write_bands<float>(*out, p, to, [](float v, bool) { return v; });
    else if (ok)
        ok = write_bands<unsigned char>(
            *out, p, to, [linear](float v, bool alpha) { return to_byte(v, !linear && !alpha); });
    if (!ok || !out->close())
        throw failure(1, out->geterror());
}

/* ---- under its name when it is complete ---------------------------------------------------------
 */

char unfinished[4096]; /* the temporary file, for the signal handler; "" when there is none */

void on_signal(int n) {
    if (unfinished[0])
        unlink(unfinished);
    _exit(128 + n);
}

void publish(const std::string &file, bool force) {
    if (renameat2(AT_FDCWD, unfinished, AT_FDCWD, file.c_str(), force ? 0 : RENAME_NOREPLACE) == 0)
        return;
    if (errno == EINVAL && access(file.c_str(), F_OK) != 0 && rename(unfinished, file.c_str()) == 0)
        return; /* a file system that cannot refuse to replace */
    throw failure(1, file + ": " + strerror(errno));
}

void write_image(const std::string &file, bool force) {
    if (!force && access(file.c_str(), F_OK) == 0)
        throw failure(1, file + " exists (--force overwrites)");
    picture p = get_picture();
    layout to = layout_for(p, file);
    int n = snprintf(unfinished, sizeof unfinished, "%s.%ld.tmp", file.c_str(), long(getpid()));
    if (n < 0 || size_t(n) >= sizeof unfinished) {
        unfinished[0] = '\0';
        throw failure(1, "the file's name is too long");
    }
    try {
        write_file(p, to, unfinished);
        publish(file, force);
    } catch (...) {
        unlink(unfinished);
        throw;
    }
}

} // namespace

int main(int argc, char **argv) {
    const char *usage = "Usage: leafcast-write-image OUT.png|OUT.exr [--force] < planes\n"
                        "Write float planes from standard input as a picture (render's helper).\n";
    std::string file;
    bool force = false;
    for (int i = 1; i < argc; i++) {
        std::string arg = argv[i];
        if (arg == "--help")
            return fputs(usage, stdout) < 0;
        if (arg == "--version")
            return puts("leafcast-write-image " LEAFCAST_VERSION) < 0;
        if (arg == "--force")
            force = true;
        else if (file.empty() && arg[0] != '-')
            file = arg;
        else
            return fputs(usage, stderr), 2;
    }
    if (file.empty())
        return fputs(usage, stderr), 2;
    for (int n : {SIGINT, SIGTERM, SIGHUP})
        signal(n, on_signal);
    /* No thread pools: they cost more to start than a picture takes to write. */
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    try {
        write_image(file, force);
    } catch (const failure &f) {
        fprintf(stderr, "leafcast-write-image: %s\n", f.what());
        return f.code;
    } catch (const std::exception &e) {
        fprintf(stderr, "leafcast-write-image: %s\n", e.what());
        return 1;
    }
    return 0;
}
