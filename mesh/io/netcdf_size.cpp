// SPDX-License-Identifier: BSD-3-Clause
//
// The size that the header of a classic netCDF file announces ("The NetCDF Classic Format Specification", Unidata;
// versions 1, 2 and 5). The library itself does not ask: behind the end of a file it reads zeros.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/error.hpp"
#include "mesh/io/file_bytes.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

namespace {

// Big-endian numbers of a header. Behind its end, and after a number that cannot be, everything is 0 and `good` false.
class Header {
public:
    explicit Header(std::string_view bytes) : bytes_(bytes) {}

    std::uint64_t number(std::size_t width) {
        std::uint64_t value = 0;
        for (const char byte : skip(width))
            value = value << 8U | static_cast<unsigned char>(byte);
        return value;
    }
    std::string_view skip(std::uint64_t count) {
        good_ = good_ && count <= bytes_.size();
        if (!good_) return {};
        const std::string_view skipped = bytes_.substr(0, count);
        bytes_.remove_prefix(count);
        return skipped;
    }
    void skip_padded(std::uint64_t count) { skip(count > bytes_.size() ? count : (count + 3) / 4 * 4); }
    // Never more than the bytes left can hold at 4 bytes each, so that loops over them end.
    std::uint64_t count(std::size_t width) {
        const std::uint64_t value = number(width);
        good_ = good_ && value <= bytes_.size() / 4;
        return good_ ? value : 0;
    }
    bool good() const { return good_; }

private:
    std::string_view bytes_;
    bool good_ = true;
};

std::uint64_t type_size(std::uint64_t type) {
    constexpr std::array<std::uint8_t, 12> sizes{0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    return type < sizes.size() ? sizes[type] : 0;
}

void skip_attributes(Header& header, std::size_t width) {
    header.number(4);  // the mark of the list
    for (std::uint64_t left = header.count(width); left > 0 && header.good(); --left) {
        header.skip_padded(header.number(width));
        const std::uint64_t type = header.number(4);
        header.skip_padded(type_size(type) * header.count(width));
    }
}

struct Variable {
    std::uint64_t begin = 0, bytes = 0;  // bytes: of one record where it has records
    bool has_records = false;
};

Variable read_variable(Header& header, const std::vector<std::uint64_t>& lengths, std::size_t width,
                       std::size_t offset_width) {
    Variable variable{0, 1, false};
    header.skip_padded(header.number(width));
    const std::uint64_t rank = header.count(width);
    for (std::uint64_t d = 0; d < rank; ++d) {
        const std::uint64_t id = header.number(width);
        const std::uint64_t length = id < lengths.size() ? lengths[id] : 0;
        if (d == 0 && length == 0) {
            variable.has_records = true;
        } else {
            variable.bytes *= std::min<std::uint64_t>(length, std::uint64_t{1} << 32U);
        }
    }
    skip_attributes(header, width);
    variable.bytes *= type_size(header.number(4));
    header.number(width);  // the size, which is wrong for variables of 4 GB and more
    variable.begin = header.number(offset_width);
    return variable;
}

std::optional<std::uint64_t> announced_size(std::string_view bytes) {
    Header header(bytes);
    header.skip(3);
    const std::uint64_t version = header.number(1);
    const std::size_t width = version == 5 ? 8 : 4;
    const std::uint64_t records = header.number(width);
    const bool streaming = records == (width == 8 ? ~std::uint64_t{0} : 0xffffffffU);  // not told
    std::vector<std::uint64_t> lengths;
    header.number(4);
    for (std::uint64_t left = header.count(width); left > 0 && header.good(); --left) {
        header.skip_padded(header.number(width));
        lengths.push_back(header.number(width));
    }
    skip_attributes(header, width);
    std::vector<Variable> variables;
    header.number(4);
    for (std::uint64_t left = header.count(width); left > 0 && header.good(); --left)
        variables.push_back(read_variable(header, lengths, width, version == 1 ? 4 : 8));
    if (!header.good()) return std::nullopt;
    std::uint64_t record = 0;  // bytes of one record of all variables
    for (const Variable& v : variables)
        record += v.has_records ? (v.bytes + 3) / 4 * 4 : 0;
    std::uint64_t size = 0;
    for (const Variable& v : variables) {
        if (!v.has_records) size = std::max(size, v.begin + v.bytes);
        if (v.has_records && records > 0 && !streaming)
            size = std::max(size, v.begin + (records - 1) * record + v.bytes);
    }
    return size;
}

}  // namespace

void require_whole_netcdf(const std::filesystem::path& file) {
    constexpr std::size_t largest_header = std::size_t{64} << 20;
    const std::uint64_t size = std::filesystem::file_size(file);
    const std::string bytes = read_bytes(file, 0, std::min<std::uint64_t>(size, largest_header));
    if (!bytes.starts_with("CDF")) return;  // HDF5 inside, whose library compares for itself
    const std::optional<std::uint64_t> announced = announced_size(bytes);
    if (announced && *announced <= size) return;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = announced ? "the " + std::to_string(*announced) + " bytes its header announces"
                                       : "the header of a netCDF file",
                 .found = std::to_string(size) + " bytes",
                 .advice = "the file is cut off or damaged: write or copy it again"});
}

}  // namespace cellproj
