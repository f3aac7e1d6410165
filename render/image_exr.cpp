// SPDX-License-Identifier: BSD-3-Clause
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <array>
#include <cassert>
#include <exception>
#include <stdexcept>
#include <string>

#include "mesh/error.hpp"
#include "render/image.hpp"
#include "render/output_file.hpp"

namespace cellproj {

namespace {

struct Channel {
    const char* name;
    std::size_t offset;  // in a pixel
};
constexpr std::array<Channel, 4> channels{
    {{"R", 0}, {"G", sizeof(float)}, {"B", 2 * sizeof(float)}, {"A", 3 * sizeof(float)}}};

// OpenEXR goes back to fill in its table of offsets, so it needs a place to seek in.
class ExrStream : public Imf::OStream {
public:
    explicit ExrStream(OutputFile& out) : Imf::OStream("output"), out_(out) {}

    void write(const char bytes[], int count) override {
        require(out_.write(bytes, static_cast<std::size_t>(count)));
        position_ += static_cast<std::uint64_t>(count);
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override {
        require(out_.seek(position));
        position_ = position;
    }

private:
    static void require(bool done) {
        if (!done) throw std::runtime_error("cannot write");  // stops OpenEXR; OutputFile keeps the reason
    }

    OutputFile& out_;
    std::uint64_t position_ = 0;
};

Imf::Header header_of(const Image& image, const std::map<std::string, std::string>& text) {
    Imf::Header header(image.width, image.height);  // ZIP compression, lossless
    for (const Channel& channel : channels)
        header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    for (const auto& [name, value] : text)
        header.insert(name, Imf::StringAttribute(value));
    return header;
}

// The image's own memory, as it is. OpenEXR only reads it, though its type does not say so.
Imf::FrameBuffer frame_buffer_of(const Image& image) {
    char* const first = const_cast<char*>(reinterpret_cast<const char*>(image.pixels.data()));
    Imf::FrameBuffer buffer;
    for (const Channel& channel : channels)
        buffer.insert(channel.name, Imf::Slice(Imf::FLOAT, first + channel.offset, sizeof(glm::vec4),
                                               sizeof(glm::vec4) * static_cast<std::size_t>(image.width)));
    return buffer;
}

}  // namespace

void write_exr(const Image& image, const std::filesystem::path& file, const std::map<std::string, std::string>& text) {
    assert(image.width > 0 && image.height > 0);
    OutputFile out(file);
    try {
        ExrStream stream(out);
        Imf::OutputFile exr(stream, header_of(image, text));
        exr.setFrameBuffer(frame_buffer_of(image));
        exr.writePixels(image.height);
    } catch (const std::exception& error) {
        if (!out.failed())
            throw Error({.kind = ErrorKind::file,
                         .place = file.string(),
                         .expected = "a picture that OpenEXR can write",
                         .found = error.what(),
                         .advice = "write PNG (.png) instead"});
    }
    out.commit();  // tells, too, what the destructor of Imf::OutputFile could not
}

}  // namespace cellproj
