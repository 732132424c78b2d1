/* write_image_main.cpp - the helper process that turns float planes into a picture's bytes.
 *
 *   leafcast-write-image < pictures > files
 *
 * OpenImageIO brings some 250 shared objects, half a second of loading: only this process pays,
 * beside the renderer that feeds it through a pipe and takes the bytes back through another. It
 * opens no file. The stream holds pictures one after another, little endian, nothing aligned:
 *
 *   offset  size  field
 *        0     4  magic "LFIM"
 *        4     4  u32 version, 2
 *        8     8  format, NUL-padded: "exr"
 *       16     4  u32 width   1 .. 65536
 *       20     4  u32 height  1 .. 65536
 *       24     4  u32 nchannels  1 .. 64
 *       28  32*n  channel names, NUL-padded, at most 31 letters each, no two alike
 *        .     4  u32 nmeta, at most 256
 *        .     .  nmeta times: u32 length, key bytes, u32 length, value bytes; each at most 65536
 *        .     .  nchannels planes of height rows of width float32, the top row first
 *
 * Each is answered when it is complete:
 *
 *        0     4  magic "LFOK"
 *        4     8  u64 size
 *       12     .  size bytes, the file
 *
 * EXR takes every channel as float32, bit by bit. Metadata are kept as "leafcast:KEY". The same
 * stream gives the same bytes.
 *
 * Exit codes: 0 when the stream ends between two pictures; 1 cannot write; 2 usage; 3 malformed
 * stream; 4 no memory; 128+n by signal.
 */
#include <cstdint>
#include <cstdio>
#include <cstring>

#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

namespace {

constexpr uint32_t MAX_SIDE = 65536, MAX_CHANNELS = 64, MAX_META = 256, MAX_TEXT = 65536;
constexpr int NAME_BYTES = 32, FORMAT_BYTES = 8;

struct failure : std::runtime_error {
    int code;
    failure(int exit_code, const std::string &what) : std::runtime_error(what), code(exit_code) {}
};

struct picture {
    std::string format;
    uint32_t width = 0, height = 0;
    std::vector<std::string> names;
    std::vector<std::pair<std::string, std::string>> meta;
    std::vector<std::unique_ptr<float[]>> planes;
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

std::string get_format() {
    char raw[FORMAT_BYTES];
    get(raw, sizeof raw, "the format");
    std::string format(raw, strnlen(raw, sizeof raw));
    if (format != "exr")
        throw failure(3, "the format is none that is known here (exr)");
    return format;
}

/* A header that promises more than comes costs address space only: a plane's memory is not touched
 * before its bytes are there. */
picture get_picture() {
    picture p;
    char magic[4];
    get(magic, sizeof magic, "the magic number");
    if (memcmp(magic, "LFIM", sizeof magic) != 0)
        throw failure(3, "this is no LFIM stream");
    get_u32(2, 2, "the version");
    p.format = get_format();
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
    return p;
}

/* ---- the picture --------------------------------------------------------------------------------
 */

/* OpenImageIO keeps the words alone of what OpenEXR throws. */
[[noreturn]] void give_up(const std::string &words) {
    if (words.find("bad_alloc") != std::string::npos)
        throw std::bad_alloc();
    throw failure(1, words);
}

void answer(const std::vector<unsigned char> &bytes) {
    unsigned char head[12] = {'L', 'F', 'O', 'K'};
    for (int i = 0; i < 8; i++)
        head[4 + i] = static_cast<unsigned char>(uint64_t(bytes.size()) >> (8 * i));
    if (fwrite(head, 1, sizeof head, stdout) != sizeof head ||
        fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size() || fflush(stdout) != 0)
        throw failure(1, "the picture's bytes are not taken");
}

/* Written in bands of 64 rows, so that only one band is held twice. */
void write_bands(OIIO::ImageOutput &out, const picture &p) {
    constexpr uint32_t BAND = 64;
    size_t n = p.names.size();
    std::vector<float> band(n * p.width * (p.height < BAND ? p.height : BAND));
    for (uint32_t y = 0; y < p.height; y += BAND) {
        uint32_t end = p.height - y < BAND ? p.height : y + BAND;
        size_t first = size_t(y) * p.width, samples = size_t(end - y) * p.width;
        for (size_t c = 0; c < n; c++)
            for (size_t i = 0; i < samples; i++)
                band[i * n + c] = p.planes[c][first + i];
        if (!out.write_scanlines(int(y), int(end), 0, OIIO::TypeDesc::FLOAT, band.data()))
            give_up(out.geterror());
    }
}

void write_picture(const picture &p) {
    OIIO::ImageSpec spec(int(p.width), int(p.height), int(p.names.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames = p.names;
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("compression", "zip");
    spec.attribute("Software", "leafcast " LEAFCAST_VERSION);
    spec.attribute("DateTime", "1970:01:01 00:00:00"); /* EXR would take the clock's */
    for (const auto &m : p.meta)
        spec.attribute("leafcast:" + m.first, m.second);

    OIIO::Filesystem::IOVecOutput bytes;
    auto out = OIIO::ImageOutput::create(p.format);
    if (!out)
        give_up(OIIO::geterror());
    if (!out->set_ioproxy(&bytes) || !out->open("picture." + p.format, spec))
        give_up(out->geterror());
    write_bands(*out, p);
    if (!out->close())
        give_up(out->geterror());
    answer(bytes.buffer());
}

bool more() {
    int c = getchar();
    if (c != EOF)
        ungetc(c, stdin);
    return c != EOF;
}

} // namespace

int main(int argc, char **argv) {
    const char *usage = "Usage: leafcast-write-image < pictures > files\n"
                        "Turn float planes into pictures' bytes (render's helper).\n";
    if (argc > 1 && strcmp(argv[1], "--help") == 0)
        return fputs(usage, stdout) < 0;
    if (argc > 1 && strcmp(argv[1], "--version") == 0)
        return puts("leafcast-write-image " LEAFCAST_VERSION) < 0;
    if (argc > 1)
        return fputs(usage, stderr), 2;
    try {
        /* No thread pools: they cost more to start than a picture takes to write. */
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);
        while (more())
            write_picture(get_picture());
    } catch (const failure &f) {
        fprintf(stderr, "leafcast-write-image: %s\n", f.what());
        return f.code;
    } catch (const std::bad_alloc &) {
        fputs("leafcast-write-image: no memory for the picture\n", stderr);
        return 4;
    } catch (const std::system_error &e) { /* a thread of OpenImageIO's */
        fprintf(stderr, "leafcast-write-image: %s\n", e.what());
        return e.code() == std::errc::resource_unavailable_try_again ? 4 : 1;
    } catch (const std::exception &e) {
        fprintf(stderr, "leafcast-write-image: %s\n", e.what());
        return 1;
    }
    return 0;
}
