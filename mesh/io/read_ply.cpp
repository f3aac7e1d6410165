// SPDX-License-Identifier: BSD-3-Clause
//
// PLY, ascii and binary, after Turk, The PLY Polygon File Format, 1994. By itself, since VTK's reader writes outside
// its memory on damaged files.
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "mesh/error.hpp"
#include "mesh/surface.hpp"
#include "mesh/text_file.hpp"

namespace cellproj {

namespace {

enum class Encoding { ascii, little_endian, big_endian };

struct Type {
    char kind;  // i: signed, u: unsigned, f: floating point
    std::size_t size;
};

struct Property {
    std::string name;
    std::optional<Type> count;  // of a list
    Type value;
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::size_t size = 0;  // bytes, up to the first of the data
};

[[noreturn]] void fail(const std::string& place, const std::string& expected, const std::string& found) {
    throw Error({.kind = ErrorKind::format,
                 .place = place,
                 .expected = expected,
                 .found = found,
                 .advice = "the file may be cut off or damaged: write or copy it again"});
}

std::string quoted(std::string text) {
    text.resize(std::min<std::size_t>(text.size(), 40));
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return std::isprint(c) == 0; }, '.');
    return "\"" + text + "\"";
}

Type type_of(const std::string& name, const std::string& place) {
    struct Named {
        std::string_view old_name, new_name;
        Type type;
    };
    static constexpr std::array<Named, 8> known{{{"char", "int8", {'i', 1}},
                                                 {"uchar", "uint8", {'u', 1}},
                                                 {"short", "int16", {'i', 2}},
                                                 {"ushort", "uint16", {'u', 2}},
                                                 {"int", "int32", {'i', 4}},
                                                 {"uint", "uint32", {'u', 4}},
                                                 {"float", "float32", {'f', 4}},
                                                 {"double", "float64", {'f', 8}}}};
    for (const Named& entry : known) {
        if (name == entry.old_name || name == entry.new_name) return entry.type;
    }
    fail(place, "a PLY type such as float or uchar", quoted(name));
}

Encoding encoding_of(const std::string& name, const std::string& place) {
    if (name == "ascii") return Encoding::ascii;
    if (name == "binary_little_endian") return Encoding::little_endian;
    if (name == "binary_big_endian") return Encoding::big_endian;
    fail(place, "ascii, binary_little_endian or binary_big_endian", quoted(name));
}

void read_declaration(std::istringstream& words, const std::string& keyword, Header& header, const std::string& place) {
    std::string word, name;
    if (keyword == "format") {
        words >> word;
        header.encoding = encoding_of(word, place);
    } else if (keyword == "element") {
        Element& element = header.elements.emplace_back();
        if (!(words >> element.name >> element.count)) fail(place, "an element's name and count", "something else");
    } else if (keyword == "property") {
        if (header.elements.empty()) fail(place, "an element before its properties", "none");
        std::optional<Type> count;
        words >> word;
        if (word == "list") {
            words >> word;
            count = type_of(word, place);
            words >> word;
        }
        const Type value = type_of(word, place);
        if (!(words >> name)) fail(place, "a property's name", "the end of the line");
        header.elements.back().properties.push_back({name, count, value});
    } else if (keyword != "comment" && keyword != "obj_info" && keyword != "ply") {
        fail(place, "a line of a PLY header", quoted(keyword));
    }
}

Header read_header(std::string_view text, const std::string& file) {
    Header header;
    for (std::size_t number = 1;; ++number) {
        const std::string place = file + ", line " + std::to_string(number);
        const std::size_t end = text.find('\n', header.size);
        if (end == std::string_view::npos) fail(place, "end_header", "the end of the file");
        std::istringstream words{std::string(text.substr(header.size, end - header.size))};
        header.size = end + 1;
        std::string keyword;
        words >> keyword;
        if (keyword == "end_header") return header;
        read_declaration(words, keyword, header, place);
    }
}

// The numbers after the header, one after another.
class Numbers {
public:
    Numbers(std::string_view data, Encoding encoding, const std::string& file)
        : data_(data), size_(data.size()), encoding_(encoding), file_(file) {}

    double next(Type type) { return encoding_ == Encoding::ascii ? next_word() : next_bytes(type); }

    std::uint64_t next_count(Type type, std::uint64_t limit, const char* what) {
        const double number = next(type);
        if (number >= 0.0 && number <= static_cast<double>(limit)) return static_cast<std::uint64_t>(number);
        refuse(std::string(what) + " from 0 to " + std::to_string(limit), std::to_string(number));
    }

    std::size_t left() const { return data_.size(); }

    [[noreturn]] void refuse(const std::string& expected, const std::string& found) const {
        fail(file_ + ", byte " + std::to_string(size_ - data_.size()) + " of the data", expected, found);
    }

private:
    double next_word() {
        constexpr std::string_view blanks = " \t\r\n";
        data_.remove_prefix(std::min(data_.find_first_not_of(blanks), data_.size()));
        const std::string_view word = data_.substr(0, data_.find_first_of(blanks));
        double value = 0.0;
        const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (word.empty()) refuse("a number", "the end of the file");
        if (error != std::errc() || rest != word.data() + word.size()) refuse("a number", quoted(std::string(word)));
        data_.remove_prefix(word.size());
        return value;
    }

    double next_bytes(Type type) {
        if (data_.size() < type.size) refuse("a number", "the end of the file");
        std::array<char, 8> bytes{};
        std::copy_n(data_.begin(), type.size, bytes.begin());
        data_.remove_prefix(type.size);
        const bool little = std::endian::native == std::endian::little;
        if ((encoding_ == Encoding::little_endian) != little) {
            std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(type.size));
        }
        if (type.kind == 'f') return type.size == 4 ? as<float>(bytes) : as<double>(bytes);
        if (type.size == 1) return type.kind == 'u' ? as<std::uint8_t>(bytes) : as<std::int8_t>(bytes);
        if (type.size == 2) return type.kind == 'u' ? as<std::uint16_t>(bytes) : as<std::int16_t>(bytes);
        return type.kind == 'u' ? as<std::uint32_t>(bytes) : as<std::int32_t>(bytes);
    }

    template <class T>
    static double as(const std::array<char, 8>& bytes) {
        T value;
        std::memcpy(&value, bytes.data(), sizeof(value));
        return static_cast<double>(value);
    }

    std::string_view data_;
    std::size_t size_;
    Encoding encoding_;
    const std::string& file_;
};

void read_vertex_property(const Property& property, double number, glm::dvec3& point) {
    for (int axis = 0; axis < 3; ++axis) {
        if (property.name.size() == 1 && property.name[0] == "xyz"[axis]) point[axis] = number;
    }
}

// One vertex, face or other element; what is neither a coordinate nor a vertex of a face is passed over.
void read_element(const Element& element, Numbers& numbers, Surface& surface) {
    if (element.name == "vertex") surface.points.emplace_back(0.0);
    for (const Property& property : element.properties) {
        if (!property.count) {
            const double number = numbers.next(property.value);
            if (element.name == "vertex") read_vertex_property(property, number, surface.points.back());
            continue;
        }
        const bool is_face = element.name == "face" && property.name.starts_with("vertex_ind");
        const std::uint64_t count = numbers.next_count(*property.count, numbers.left(), "a list of a length");
        if (is_face) surface.polygons.emplace_back();
        for (std::uint64_t i = 0; i < count; ++i) {
            if (is_face) {
                const std::uint64_t id = numbers.next_count(property.value, max_elements, "a vertex id");
                surface.polygons.back().push_back(static_cast<VertexId>(id));
            } else {
                numbers.next(property.value);
            }
        }
    }
}

}  // namespace

Surface read_ply(const std::filesystem::path& file) {
    const std::string text = read_text_file(file, "a surface file");
    const std::string name = file.string();
    const Header header = read_header(text, name);
    Numbers numbers(std::string_view(text).substr(header.size), header.encoding, name);
    Surface surface;
    surface.name = name;
    for (const Element& element : header.elements) {
        // Every element takes a byte at least, so that a damaged count cannot keep this loop running on nothing.
        if (element.properties.empty() || element.count > numbers.left()) {
            numbers.refuse("room for " + std::to_string(element.count) + " times \"" + element.name + "\"",
                           std::to_string(numbers.left()) + " bytes");
        }
        for (std::uint64_t i = 0; i < element.count; ++i)
            read_element(element, numbers, surface);
    }
    validate(surface);
    return surface;
}

}  // namespace cellproj
