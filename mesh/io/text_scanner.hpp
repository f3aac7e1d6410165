// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: a file in memory and a position in it, for the readers of our own. Words and numbers do not depend
// on the locale; every failure tells the line (or the byte) at which it was met.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "mesh/error.hpp"

namespace cellproj {

class TextScanner {
public:
    // Reads the whole file. A comment reaches from the character `comment` to the end of its line; '\0': there are
    // none. Throws Error (file) when the file is missing, no regular file or unreadable, Error (format) when it is
    // empty.
    explicit TextScanner(const std::filesystem::path& file, char comment = '\0');

    const std::string& file() const { return file_; }
    std::size_t position() const { return position_; }  // in bytes
    std::size_t remaining() const { return text_.size() - position_; }
    void tell_bytes() { tells_bytes_ = true; }  // messages: bytes instead of lines, for binary files

    // These skip blanks, line ends and comments first. `what` says in messages what was expected there.
    bool at_end();
    std::string_view peek();  // the next word; empty at the end
    std::string_view word(std::string_view what);
    double number(std::string_view what);  // may be infinite or NaN
    double finite(std::string_view what);
    std::int64_t integer(std::string_view what);
    // How many things follow, each of at least `bytes_each` bytes (> 0): no more than the rest of the file can hold.
    std::size_t count(std::string_view what, std::size_t bytes_each);
    void require_room(std::uint64_t things, std::size_t bytes_each, std::string_view what);

    // Within the line:
    bool line_at_end();               // only blanks or a comment are left of it
    std::string_view rest_of_line();  // without comment and line end; goes on to the next line

    // The next bytes as they are.
    template <class T>
    T raw(std::string_view what) {
        mark();
        if (remaining() < sizeof(T)) fail(what, "the end of the file", cut_off);
        T value;
        std::memcpy(&value, text_.data() + position_, sizeof(T));
        position_ += sizeof(T);
        return value;
    }

    // Behind the next occurrence of `marker`.
    void skip_past(std::string_view marker);

    // Throws at the word or number met last, or at a position.
    [[noreturn]] void fail(std::string_view expected, std::string_view found, std::string_view advice = damaged,
                           ErrorKind kind = ErrorKind::format) const;
    [[noreturn]] void fail_at(std::size_t position, std::string_view expected, std::string_view found,
                              std::string_view advice, ErrorKind kind) const;
    // The same with the last word as what was found.
    [[noreturn]] void fail_word(std::string_view expected, std::string_view advice = damaged,
                                ErrorKind kind = ErrorKind::format) const;

    static constexpr std::string_view cut_off = "the file is cut off: write or copy it again";
    static constexpr std::string_view damaged = "the file may be damaged: write or copy it again";

private:
    void mark() { last_ = position_; }
    void skip_blanks();
    bool ends_word(std::size_t position) const;
    template <class Number>
    Number parse(std::string_view what);

    std::string file_;
    std::string text_;
    std::size_t position_ = 0;
    std::size_t last_ = 0;  // where the last word or number began
    char comment_;
    bool tells_bytes_ = false;
};

}  // namespace cellproj
