// SPDX-License-Identifier: BSD-3-Clause
//
// A process for each contender. In one process they could not be compared: OSMesa and the GL behind a display share Mesa's libglapi
// and take each other's context, memory that one frees is reused by the next, and a crash of one would end the run.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace cellproj::bench {

// Memory without a name that children of this process share, for what is too much for a pipe. Writing and reading go on behind what was
// last written or read in the same process; a child starts where its parent was.
class SharedBytes {
public:
    SharedBytes();
    ~SharedBytes();
    SharedBytes(const SharedBytes&) = delete;
    SharedBytes& operator=(const SharedBytes&) = delete;

    template <typename T>
    void write(const std::vector<T>& values) {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::size_t count = values.size();
        write_bytes(&count, sizeof count);
        write_bytes(values.data(), count * sizeof(T));
    }
    template <typename T>
    std::vector<T> read() {
        std::size_t count = 0;
        read_bytes(&count, sizeof count);
        std::vector<T> values(count);
        read_bytes(values.data(), count * sizeof(T));
        return values;
    }

private:
    void write_bytes(const void* bytes, std::size_t count);
    void read_bytes(void* bytes, std::size_t count);

    int file_;
    std::size_t position_ = 0;
};

// What the body of a child talks through.
class Pipe {
public:
    template <typename T>
    void send(const T& value) const {
        static_assert(std::is_trivially_copyable_v<T>);
        send_bytes(&value, sizeof value);
    }
    // False when the other end is closed.
    template <typename T>
    bool receive(T& value) const {
        static_assert(std::is_trivially_copyable_v<T>);
        return receive_bytes(&value, sizeof value);
    }

    void send_bytes(const void* bytes, std::size_t count) const;
    bool receive_bytes(void* bytes, std::size_t count) const;

    int in = -1, out = -1;
};

// A forked child. The caller must have no other threads (they would be missing in the child): whatever computes does so in a
// child. It ends when its body does, when `end` is called, or with its parent.
class Child {
public:
    explicit Child(const std::function<void(const Pipe&)>& body);
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    template <typename T>
    void send(const T& value) const {
        pipe_.send(value);
    }
    // Throws std::runtime_error with the message of what the body threw, or with the signal that the child died of.
    template <typename T>
    T receive() {
        T value;
        receive_bytes(&value, sizeof value);
        return value;
    }

private:
    void receive_bytes(void* bytes, std::size_t count);

    int process_ = -1;
    Pipe pipe_;    // the parent's ends
    int message_;  // where the child's last words arrive
};

// Xvfb, the X server without a screen, for GL that wants one; DISPLAY names it while this lives. Of its own even where there is a
// display, so that it is software that draws.
class VirtualDisplay {
public:
    explicit VirtualDisplay(bool wanted);
    ~VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    // Why there is none though it was wanted; else empty.
    const std::string& failure() const { return failure_; }

private:
    int process_ = -1;
    std::string failure_;
};

// This process's CPUs: the first `count` of those it may use; 0: all. Threads that start afterwards share them.
void use_cpus(int count);

// Gives back what was freed, and makes the resident memory of now the peak (peak_memory_bytes).
void forget_peak_memory();

}  // namespace cellproj::bench
