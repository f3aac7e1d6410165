// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: what two processes of one machine tell each other, as bytes: numbers as they lie in memory, arrays
// and texts behind their length (u64). Nothing is taken from the other side that is not there: every count is held
// against the bytes that are left.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace cellproj {

class ByteWriter {
public:
    using Sink = std::function<void(std::string_view)>;

    explicit ByteWriter(Sink sink) : sink_(std::move(sink)) {}

    template <class T>
    void value(const T& number) {
        elements(&number, 1);
    }

    template <class T>
    void array(const std::vector<T>& numbers) {
        value(std::uint64_t{numbers.size()});
        elements(numbers.data(), numbers.size());
    }

    void text(const std::string& words) {
        value(std::uint64_t{words.size()});
        sink_(words);
    }

    // Lists of different lengths: all lengths (u32), then all entries.
    template <class T>
    void lists(const std::vector<std::vector<T>>& lists) {
        std::vector<std::uint32_t> sizes;
        std::size_t total = 0;
        for (const std::vector<T>& list : lists) {
            sizes.push_back(static_cast<std::uint32_t>(list.size()));
            total += list.size();
        }
        array(sizes);
        value(std::uint64_t{total});
        for (const std::vector<T>& list : lists)
            elements(list.data(), list.size());
    }

private:
    template <class T>
    void elements(const T* first, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        sink_({reinterpret_cast<const char*>(first), count * sizeof(T)});
    }

    Sink sink_;
};

class ByteReader {
public:
    using Fail = std::function<void(const std::string& expected, const std::string& found)>;
    using Taken = std::function<void(std::string_view bytes)>;

    // `fail` throws; `taken` hears of the bytes of each array after they have been copied, so that they can be given
    // back.
    ByteReader(std::string_view bytes, Fail fail, Taken taken = {})
        : bytes_(bytes), fail_(std::move(fail)), taken_(std::move(taken)) {}

    template <class T>
    T value(const char* what) {
        T number;
        elements(&number, 1, what);
        return number;
    }

    template <class T>
    std::vector<T> array(const char* what) {
        const auto count = value<std::uint64_t>(what);
        require<T>(count, what);  // before so much memory is asked for
        std::vector<T> numbers(static_cast<std::size_t>(count));
        const std::string_view bytes = elements(numbers.data(), numbers.size(), what);
        if (taken_) taken_(bytes);
        return numbers;
    }

    std::string text(const char* what) {
        const auto letters = array<char>(what);
        return {letters.begin(), letters.end()};
    }

    template <class T>
    std::vector<std::vector<T>> lists(const char* what) {
        const auto sizes = array<std::uint32_t>(what);
        const auto entries = array<T>(what);
        std::vector<std::vector<T>> result;
        result.reserve(sizes.size());
        std::size_t first = 0;
        for (const std::size_t size : sizes) {
            if (size > entries.size() - first) fail("sizes of " + std::string(what) + " that add up", "larger ones");
            const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(first);
            result.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(size));
            first += size;
        }
        if (first != entries.size()) fail("sizes of " + std::string(what) + " that add up", "smaller ones");
        return result;
    }

    std::size_t left() const { return bytes_.size(); }
    void fail(const std::string& expected, const std::string& found) const { fail_(expected, found); }

private:
    template <class T>
    void require(std::uint64_t count, const char* what) const {
        static_assert(std::is_trivially_copyable_v<T>);
        // Compared by division: a count from outside may overflow when multiplied.
        if (count <= bytes_.size() / sizeof(T)) return;
        fail(std::to_string(count) + " × " + std::to_string(sizeof(T)) + " bytes of " + what,
             std::to_string(bytes_.size()) + " bytes");
    }

    template <class T>
    std::string_view elements(T* first, std::size_t count, const char* what) {
        require<T>(count, what);
        const std::string_view bytes = bytes_.substr(0, count * sizeof(T));
        if (count > 0) std::memcpy(first, bytes.data(), bytes.size());
        bytes_.remove_prefix(bytes.size());
        return bytes;
    }

    std::string_view bytes_;
    Fail fail_;
    Taken taken_;
};

}  // namespace cellproj
