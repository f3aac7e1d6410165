// SPDX-License-Identifier: BSD-3-Clause
//
// Pictures and texts on disk: what is written is read back with libpng and OpenEXR themselves; failures leave nothing.
#include "render/image.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <csetjmp>
#include <csignal>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <sstream>

#include "mesh/error.hpp"
#include "render/output_file.hpp"
#include "tests/support/folder_test.hpp"

namespace cellproj {
namespace image_test {

namespace fs = std::filesystem;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

struct Png {
    int width = 0, height = 0, bits = 0, channels = 0;
    std::vector<unsigned> samples;  // height · width · channels
    std::map<std::string, std::string> text;
    std::map<std::string, int> text_kind;  // PNG_TEXT_COMPRESSION_NONE: tEXt
};

// Jumps back with nothing to destroy in between; false when libpng refuses the file.
bool decode(png_structp png, png_infop info, std::FILE* stream) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_init_io(png, stream);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    return true;
}

Png read_png(const fs::path& file) {
    Png result;
    std::FILE* stream = std::fopen(file.c_str(), "rb");
    if (!stream) throw std::runtime_error("cannot open " + file.string());
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    const bool decoded = decode(png, info, stream);
    std::fclose(stream);
    if (decoded) {
        result.width = static_cast<int>(png_get_image_width(png, info));
        result.height = static_cast<int>(png_get_image_height(png, info));
        result.bits = png_get_bit_depth(png, info);
        result.channels = png_get_channels(png, info);
        png_bytepp rows = png_get_rows(png, info);
        for (int y = 0; y < result.height; ++y)
            for (int i = 0; i < result.width * result.channels; ++i)
                result.samples.push_back(result.bits == 16 ? rows[y][2 * i] * 256U + rows[y][2 * i + 1] : rows[y][i]);
        png_textp text = nullptr;
        const int count = png_get_text(png, info, &text, nullptr);
        for (int i = 0; i < count; ++i) {
            result.text[text[i].key] = text[i].text;
            result.text_kind[text[i].key] = text[i].compression;
        }
    }
    png_destroy_read_struct(&png, &info, nullptr);
    if (!decoded) throw std::runtime_error("not a PNG file: " + file.string());
    return result;
}

PngOptions with_bits(int bits) {
    PngOptions options;
    options.bits = bits;
    return options;
}

PngOptions with_background(const glm::dvec3& background) {
    PngOptions options;
    options.background = background;
    return options;
}

// A one-pixel picture's sample values.
std::vector<unsigned> written_pixel(const fs::path& file, const glm::vec4& pixel, const PngOptions& options) {
    Image image(1, 1);
    image.at(0, 0) = pixel;
    write_png(image, file, options);
    return read_png(file).samples;
}

// A file system that is full: no file of this process may grow beyond `bytes` while this lives.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
    void (*handler_)(int);
    rlimit before_{};
};

// Standard output leads to `descriptor` while this lives.
class RedirectedOutput {
public:
    explicit RedirectedOutput(int descriptor) : before_((std::fflush(stdout), dup(STDOUT_FILENO))) {
        dup2(descriptor, STDOUT_FILENO);
    }
    ~RedirectedOutput() {
        std::fflush(stdout);
        dup2(before_, STDOUT_FILENO);
        close(before_);
    }
    RedirectedOutput(const RedirectedOutput&) = delete;
    RedirectedOutput& operator=(const RedirectedOutput&) = delete;

private:
    int before_;
};

// The Error that `action` throws; a failure of the test when it throws none.
Error error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no Error was thrown";
    return Error({.kind = ErrorKind::option, .place = "", .expected = "", .found = "", .advice = ""});
}

// Random colours: nothing that compresses, so a picture is about as large as its pixels.
Image noise(int width, int height) {
    std::mt19937_64 random(20240607);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    Image image(width, height);
    for (glm::vec4& pixel : image.pixels)
        pixel = {uniform(random), uniform(random), uniform(random), uniform(random)};
    return image;
}

class ImageFile : public testing_support::FolderTest {
protected:
    // Names of all files in the folder, hidden ones, too.
    std::vector<std::string> names() const {
        std::vector<std::string> found;
        for (const auto& entry : fs::directory_iterator(folder_))
            found.push_back(entry.path().filename().string());
        std::sort(found.begin(), found.end());
        return found;
    }
};

using Names = std::vector<std::string>;
using Samples = std::vector<unsigned>;

TEST_F(ImageFile, PngKeepsRowsColumnsAndChannelsInPlace) {
    Image image(3, 2);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x)
            image.at(x, y) = {float(x) / 255, float(y) / 255, float(10 * y + x) / 255, 1};
    write_png(image, folder_ / "a.png");
    const Png png = read_png(folder_ / "a.png");
    EXPECT_EQ(png.width, 3);
    EXPECT_EQ(png.height, 2);
    EXPECT_EQ(png.bits, 8);
    EXPECT_EQ(png.channels, 3);
    EXPECT_EQ(png.samples, (Samples{0, 0, 0, 1, 0, 1, 2, 0, 2, 0, 1, 10, 1, 1, 11, 2, 1, 12}));
    EXPECT_EQ(names(), Names{"a.png"});
}

TEST_F(ImageFile, EverySampleValueOf16BitsIsReached) {
    Image image(256, 256);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = {float(i) / 65535, 1 - float(i) / 65535, 0.5F, 1};
    write_png(image, folder_ / "a.png", with_bits(16));
    const Png png = read_png(folder_ / "a.png");
    ASSERT_EQ(png.bits, 16);
    for (unsigned i = 0; i < 65536; ++i) {
        ASSERT_EQ(png.samples[3 * i], i);
        ASSERT_EQ(png.samples[3 * i + 1], 65535 - i);
        ASSERT_EQ(png.samples[3 * i + 2], 32768U);  // 32767.5 rounds up
    }
}

TEST_F(ImageFile, SamplesAreRoundedToNearest) {
    const fs::path file = folder_ / "a.png";
    // On both sides of the half-way point; 1e-4 of a step is far above float32's 6e-8 · 255.
    EXPECT_EQ(written_pixel(file, {99.4999F / 255, 99.5001F / 255, 0.4999F / 255, 1}, {}), (Samples{99, 100, 0}));
    EXPECT_EQ(written_pixel(file, {0.5001F / 255, 254.4999F / 255, 254.5001F / 255, 1}, {}), (Samples{1, 254, 255}));
}

TEST_F(ImageFile, SamplesAreClampedHoweverLarge) {
    const float huge = std::numeric_limits<float>::max();
    EXPECT_EQ(written_pixel(folder_ / "a.png", {-0.1F, 1.1F, huge, 1}, {}), (Samples{0, 255, 255}));
    EXPECT_EQ(written_pixel(folder_ / "a.png", {-huge, huge, 2, 1}, with_bits(16)), (Samples{0, 65535, 65535}));
    EXPECT_EQ(written_pixel(folder_ / "a.png", {0, 0, 0, huge}, {}), (Samples{0, 0, 0}));
    EXPECT_EQ(written_pixel(folder_ / "a.png", {0, 0, 0, -huge}, {}), (Samples{255, 255, 255}));
}

TEST_F(ImageFile, BackgroundShowsThroughByOneMinusAlpha) {
    const PngOptions options = with_background({1, 0.5, 0});
    const fs::path file = folder_ / "a.png";
    EXPECT_EQ(written_pixel(file, {0, 0, 0, 0}, options), (Samples{255, 128, 0}));
    EXPECT_EQ(written_pixel(file, {0.25F, 0, 0.125F, 0.5F}, options), (Samples{191, 64, 32}));  // .75, .25, .125 · 255
    EXPECT_EQ(written_pixel(file, {0.25F, 0, 0.125F, 1}, options), (Samples{64, 0, 32}));
    EXPECT_EQ(written_pixel(file, {0, 0, 0, 0}, {}), (Samples{255, 255, 255})) << "white unless told otherwise";
}

TEST_F(ImageFile, PixelsThatAreNotFiniteShowTheBackground) {
    const PngOptions options = with_background({0.2, 0.4, 0.6});
    const Samples background{51, 102, 153};
    const fs::path file = folder_ / "a.png";
    for (const float bad : {nan, inf, -inf})
        for (int channel = 0; channel < 4; ++channel) {
            glm::vec4 pixel{0.9F, 0.8F, 0.7F, 1};
            pixel[channel] = bad;
            EXPECT_EQ(written_pixel(file, pixel, options), background) << bad << " in channel " << channel;
        }
    EXPECT_EQ(written_pixel(file, {0, 0, 0, 0}, with_background({nan, inf, 0.2})), (Samples{0, 255, 51}));
}

TEST(Image, CountsPixelsThatAreNotFinite) {
    Image image = noise(4, 4);
    EXPECT_EQ(count_non_finite(image), 0U);
    image.at(1, 2).a = nan;
    image.at(3, 0).g = inf;
    image.at(3, 0).b = -inf;
    EXPECT_EQ(count_non_finite(image), 2U);
    EXPECT_EQ(count_non_finite(Image()), 0U);
}

TEST_F(ImageFile, PngCarriesTexts) {
    const std::string utf8 = "τ = 1/Å";
    PngOptions options;
    options.text = {{"Software", "cellproj"}, {"method", ""}, {"transfer", utf8}};
    write_png(noise(2, 2), folder_ / "a.png", options);
    const Png png = read_png(folder_ / "a.png");
    EXPECT_EQ(png.text, options.text);
    EXPECT_EQ(png.text_kind.at("Software"), PNG_TEXT_COMPRESSION_NONE);
    EXPECT_EQ(png.text_kind.at("transfer"), PNG_ITXT_COMPRESSION_NONE) << "tEXt would be read as Latin-1";
}

TEST_F(ImageFile, ExrKeepsEveryBit) {
    Image image = noise(5, 3);
    image.at(0, 0) = {nan, inf, -inf, 0};
    image.at(1, 0) = {1e-42F, -0.0F, 3e38F, -2.5F};  // subnormal, signed zero, large, negative
    write_exr(image, folder_ / "a.exr", {{"method", "preint3d:64"}, {"note", "τ"}});

    Imf::InputFile exr((folder_ / "a.exr").c_str());
    const Imath::Box2i window = exr.header().dataWindow();
    ASSERT_EQ(window.max.x - window.min.x + 1, 5);
    ASSERT_EQ(window.max.y - window.min.y + 1, 3);
    Image read(5, 3);
    Imf::FrameBuffer buffer;
    const char* names_of_channels[] = {"R", "G", "B", "A"};
    for (std::size_t c = 0; c < 4; ++c) {
        ASSERT_EQ(exr.header().channels()[names_of_channels[c]].type, Imf::FLOAT);
        buffer.insert(names_of_channels[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&read.pixels[0]) + 4 * c,
                                                       sizeof(glm::vec4), 5 * sizeof(glm::vec4)));
    }
    exr.setFrameBuffer(buffer);
    exr.readPixels(window.min.y, window.max.y);
    for (std::size_t i = 0; i < read.pixels.size(); ++i)
        for (int c = 0; c < 4; ++c)
            EXPECT_EQ(std::bit_cast<std::uint32_t>(read.pixels[i][c]), std::bit_cast<std::uint32_t>(image.pixels[i][c]))
                << "pixel " << i << ", channel " << c;
    EXPECT_EQ(exr.header().typedAttribute<Imf::StringAttribute>("method").value(), "preint3d:64");
    EXPECT_EQ(exr.header().typedAttribute<Imf::StringAttribute>("note").value(), "τ");
    EXPECT_EQ(names(), Names{"a.exr"});
}

TEST_F(ImageFile, ExrAttributeOfAnotherTypeIsAnErrorThatNamesIt) {
    const Error error = error_of([&] { write_exr(noise(2, 2), folder_ / "a.exr", {{"channels", "none"}}); });
    EXPECT_EQ(error.kind(), ErrorKind::file);
    EXPECT_NE(error.found().find("channels"), std::string::npos) << error.what();
    EXPECT_EQ(names(), Names{});
}

TEST_F(ImageFile, APictureOfOneNameReplacesTheOlder) {
    for (const char* name : {"a.png", "a.exr"}) {
        std::ofstream(folder_ / name) << "older";
        name == std::string("a.png") ? write_png(noise(4, 4), folder_ / name) : write_exr(noise(4, 4), folder_ / name);
        EXPECT_GT(fs::file_size(folder_ / name), 64U) << name;
    }
    EXPECT_EQ(names(), (Names{"a.exr", "a.png"}));
}

TEST_F(ImageFile, ADiskThatFillsUpIsAnErrorAndTheOlderFileStays) {
    const Image image = noise(64, 64);  // 12 KiB and more as PNG, beyond the buffer of any stream
    const std::map<std::string, std::function<void(const fs::path&)>> writers{
        {"a.png", [&](const fs::path& file) { write_png(image, file); }},
        {"a.exr", [&](const fs::path& file) { write_exr(image, file); }},
        {"a.json", [&](const fs::path& file) { write_text_file(file, std::string(20000, 'x')); }},
        {"b.json", [&](const fs::path& file) { write_text_file(file, std::string(2000, 'x')); }}};  // fails at closing
    for (const auto& [name, write] : writers) {
        const fs::path file = folder_ / name;
        std::ofstream(file) << "older";
        const Error error = error_of([&, &write = write] {
            const FileSizeLimit limit(1000);
            write(file);
        });
        EXPECT_EQ(error.kind(), ErrorKind::file) << name;
        EXPECT_EQ(error.place(), file.string());
        EXPECT_NE(error.found().find("File too large"), std::string::npos) << error.what();
        EXPECT_EQ(testing_support::bytes_of(file), "older") << name;
    }
    EXPECT_EQ(names(), (Names{"a.exr", "a.json", "a.png", "b.json"})) << "nothing else is left behind";
}

TEST_F(ImageFile, AFullDeviceIsAnErrorAndStaysADevice) {
    const fs::path full = "/dev/full";
    if (!fs::is_character_file(full)) GTEST_SKIP() << "no /dev/full on this machine";
    for (const auto& write : std::vector<std::function<void()>>{[&] { write_png(noise(64, 64), full); },
                                                                [&] { write_exr(noise(64, 64), full); },
                                                                [&] { write_text_file(full, "text"); }}) {
        const Error error = error_of(write);
        EXPECT_EQ(error.kind(), ErrorKind::file);
        EXPECT_NE(error.found().find("No space left"), std::string::npos) << error.what();
        EXPECT_NE(error.advice().find("free some space"), std::string::npos) << error.what();
        ASSERT_TRUE(fs::is_character_file(full));
    }
}

TEST_F(ImageFile, PlacesThatCannotBeWrittenAreToldBeforeLongWork) {
    std::ofstream(folder_ / "regular") << "older";
    const Error below = error_of([&] { require_writable_image(folder_ / "regular" / "a.png"); });
    EXPECT_EQ(below.kind(), ErrorKind::file);
    EXPECT_EQ(below.place(), (folder_ / "regular" / "a.png").string());
    EXPECT_NE(below.expected().find((folder_ / "regular").string()), std::string::npos) << below.what();
    EXPECT_EQ(below.found(), "something else of that name");

    const Error missing = error_of([&] { require_writable_image(folder_ / "missing" / "a.png"); });
    EXPECT_EQ(missing.kind(), ErrorKind::file);
    EXPECT_EQ(missing.found(), "none");
    EXPECT_EQ(missing.advice(), "create the folder first");

    fs::create_directory(folder_ / "folder.png");
    EXPECT_EQ(error_of([&] { require_writable_image(folder_ / "folder.png"); }).found(), "a folder");
    EXPECT_EQ(error_of([&] { require_writable(folder_ / ""); }).found(), "a folder");
    EXPECT_EQ(error_of([&] { require_writable(""); }).found(), "an empty name");
    EXPECT_EQ(names(), (Names{"folder.png", "regular"}));
}

TEST_F(ImageFile, TheWritersRefuseTheSamePlaces) {
    const Image image = noise(2, 2);
    EXPECT_EQ(error_of([&] { write_png(image, folder_ / "missing" / "a.png"); }).found(), "none");
    EXPECT_EQ(error_of([&] { write_exr(image, folder_ / "missing" / "a.exr"); }).found(), "none");
    EXPECT_EQ(error_of([&] { write_text_file(folder_ / "missing" / "a.json", ""); }).found(), "none");
}

TEST_F(ImageFile, AWriteProtectedFileOrFolderIsRespected) {
    if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    std::ofstream(folder_ / "a.png") << "older";
    fs::permissions(folder_ / "a.png", fs::perms::owner_read);
    EXPECT_EQ(error_of([&] { require_writable_image(folder_ / "a.png"); }).found(), "Permission denied");
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_EQ(error_of([&] { require_writable_image(folder_ / "b.png"); }).found(), "Permission denied");
    fs::permissions(folder_, fs::perms::owner_all);
    EXPECT_EQ(testing_support::bytes_of(folder_ / "a.png"), "older");
}

TEST_F(ImageFile, OnlyPngAndExrAreSuffixesOfPictures) {
    for (const char* name : {"a.png", "a.exr", "a.b.exr"})
        EXPECT_NO_THROW(require_writable_image(folder_ / name)) << name;
    const Error wrong = error_of([&] { require_writable_image(folder_ / "a.jpg"); });
    EXPECT_EQ(wrong.kind(), ErrorKind::file);
    EXPECT_EQ(wrong.found(), "the suffix .jpg");
    EXPECT_EQ(wrong.advice(), "name the picture " + (folder_ / "a.png").string());
    EXPECT_EQ(error_of([&] { require_writable_image(folder_ / "png"); }).found(), "no suffix");
    EXPECT_EQ(error_of([&] { require_writable_image(folder_ / "a.PNG"); }).found(), "the suffix .PNG");
    EXPECT_EQ(names(), Names{}) << "asking leaves nothing behind";
}

TEST_F(ImageFile, AskingLeavesAnOlderFileAlone) {
    std::ofstream(folder_ / "a.png") << "older";
    require_writable_image(folder_ / "a.png");
    EXPECT_EQ(testing_support::bytes_of(folder_ / "a.png"), "older");
    EXPECT_EQ(names(), Names{"a.png"});
}

TEST_F(ImageFile, NamesMayBeAsLongAsTheFileSystemAllows) {
    const std::string longest = std::string(251, 'a') + ".png";
    write_png(noise(2, 2), folder_ / longest);
    EXPECT_EQ(names(), Names{longest});
}

TEST_F(ImageFile, SymbolicLinksAreFollowed) {
    fs::create_directory(folder_ / "real");
    std::ofstream(folder_ / "real" / "a.json") << "older";
    fs::create_symlink(fs::path("real") / "a.json", folder_ / "link.json");
    write_text_file(folder_ / "link.json", "newer");
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.json"));
    EXPECT_EQ(testing_support::bytes_of(folder_ / "real" / "a.json"), "newer");
}

TEST_F(ImageFile, StandardOutputIsWrittenInTurnIntoAFile) {
    const int descriptor = open((folder_ / "log").c_str(), O_WRONLY | O_CREAT, 0600);
    {
        const RedirectedOutput redirected(descriptor);
        std::printf("before\n");
        require_writable("/dev/stdout");
        write_text_file("/dev/stdout", "text\n");
        std::printf("after\n");
    }
    close(descriptor);
    EXPECT_EQ(testing_support::bytes_of(folder_ / "log"), "before\ntext\nafter\n");
    EXPECT_EQ(names(), Names{"log"});
}

TEST_F(ImageFile, StandardOutputMayBeAPipe) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    {
        const RedirectedOutput redirected(ends[1]);
        require_writable("/dev/stdout");
        write_text_file("/dev/stdout", "text\n");
    }
    close(ends[1]);
    char read_back[16] = {};
    EXPECT_EQ(read(ends[0], read_back, sizeof read_back - 1), 5);
    EXPECT_STREQ(read_back, "text\n");
    close(ends[0]);
}

TEST_F(ImageFile, APipeWithANameStaysAPipe) {
    const fs::path name = folder_ / "pipe";
    ASSERT_EQ(mkfifo(name.c_str(), 0600), 0);
    require_writable(name);  // does not wait for a reader
    const int reader = open(name.c_str(), O_RDONLY | O_NONBLOCK);
    write_text_file(name, "text\n");
    char read_back[16] = {};
    EXPECT_EQ(read(reader, read_back, sizeof read_back - 1), 5);
    EXPECT_STREQ(read_back, "text\n");
    EXPECT_TRUE(fs::is_fifo(name));
    close(reader);
}

TEST_F(ImageFile, TextsAreWrittenAsTheyAre) {
    const std::string text("{\n\"τ\": 1\r\n}\0end", 17);
    write_text_file(folder_ / "a.json", text);
    EXPECT_EQ(testing_support::bytes_of(folder_ / "a.json"), text);
    write_text_file(folder_ / "a.json", "");
    EXPECT_EQ(testing_support::bytes_of(folder_ / "a.json"), "");
}

TEST_F(ImageFile, AnOutputThatIsNotCommittedNeverAppears) {
    {
        OutputFile out(folder_ / "a.json");
        EXPECT_TRUE(out.write("half", 4));
        EXPECT_EQ(names().size(), 1U);
        EXPECT_NE(names().front(), "a.json");
    }
    EXPECT_EQ(names(), Names{});
}

}  // namespace
}  // namespace cellproj
