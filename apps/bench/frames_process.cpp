// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/frames_process.hpp"

#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace cellproj::bench {

namespace {

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

}  // namespace

SharedBytes::SharedBytes() : file_(memfd_create("cellproj_frames", 0)) {
    if (file_ < 0) fail("memfd_create");
}

SharedBytes::~SharedBytes() { close(file_); }

void SharedBytes::write_bytes(const void* bytes, std::size_t count) {
    const auto* from = static_cast<const char*>(bytes);
    for (std::size_t done = 0; done < count;) {
        const ssize_t n = pwrite(file_, from + done, count - done, static_cast<off_t>(position_ + done));
        if (n <= 0) fail("writing shared memory");
        done += static_cast<std::size_t>(n);
    }
    position_ += count;
}

void SharedBytes::read_bytes(void* bytes, std::size_t count) {
    auto* to = static_cast<char*>(bytes);
    for (std::size_t done = 0; done < count;) {
        const ssize_t n = pread(file_, to + done, count - done, static_cast<off_t>(position_ + done));
        if (n <= 0) fail("reading shared memory");
        done += static_cast<std::size_t>(n);
    }
    position_ += count;
}

void Pipe::send_bytes(const void* bytes, std::size_t count) const {
    // A few bytes: less than a pipe takes at once. A child that has died is found when its answer is missing.
    if (::write(out, bytes, count) < 0 && errno != EPIPE) fail("writing to a process");
}

bool Pipe::receive_bytes(void* bytes, std::size_t count) const {
    auto* to = static_cast<char*>(bytes);
    for (std::size_t done = 0; done < count;) {
        const ssize_t n = ::read(in, to + done, count - done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        done += static_cast<std::size_t>(n);
    }
    return true;
}

Child::Child(const std::function<void(const Pipe&)>& body) {
    int to_child[2], from_child[2], words[2];
    if (pipe(to_child) || pipe(from_child) || pipe(words)) fail("pipe");
    std::fflush(nullptr);
    process_ = fork();
    if (process_ < 0) fail("fork");
    if (process_ == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        close(to_child[1]);
        close(from_child[0]);
        close(words[0]);
        Pipe pipe;
        pipe.in = to_child[0];
        pipe.out = from_child[1];
        try {
            body(pipe);
        } catch (const std::exception& error) {
            (void)!::write(words[1], error.what(), std::strlen(error.what()));
            _exit(1);
        }
        _exit(0);  // not exit: what the parent has registered for its own end is not the child's to do
    }
    close(to_child[0]);
    close(from_child[1]);
    close(words[1]);
    pipe_.in = from_child[0];
    pipe_.out = to_child[1];
    message_ = words[0];
}

Child::~Child() {
    close(pipe_.in);
    close(pipe_.out);
    close(message_);
    // Nothing of a child outlives its answers. Not asked to end: its siblings hold copies of its pipe, it would not hear.
    if (process_ > 0 && kill(process_, SIGKILL) == 0) waitpid(process_, nullptr, 0);
}

void Child::receive_bytes(void* bytes, std::size_t count) {
    if (pipe_.receive_bytes(bytes, count)) return;
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    char text[2000];
    const ssize_t n = ::read(message_, text, sizeof text);
    if (n > 0) throw std::runtime_error(std::string(text, static_cast<std::size_t>(n)));
    if (WIFSIGNALED(status)) throw std::runtime_error("died of signal " + std::to_string(WTERMSIG(status)));
    throw std::runtime_error("ended without an answer, exit code " + std::to_string(WEXITSTATUS(status)));
}

VirtualDisplay::VirtualDisplay(bool wanted) {
    if (!wanted) return;
    int number[2];
    if (pipe(number)) fail("pipe");
    const std::string end = std::to_string(number[1]);
    process_ = fork();
    if (process_ < 0) fail("fork");
    if (process_ == 0) {
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        close(number[0]);
        // It finds a free number and tells it.
        execlp("Xvfb", "Xvfb", "-displayfd", end.c_str(), "-screen", "0", "64x64x24", "-nolisten", "tcp", nullptr);
        _exit(127);
    }
    close(number[1]);
    std::string text;
    for (char c = 0; ::read(number[0], &c, 1) == 1 && c != '\n';) text += c;
    close(number[0]);
    if (text.empty()) failure_ = "no display: Xvfb does not start (Debian: apt-get install xvfb)";
    else setenv("DISPLAY", (":" + text).c_str(), 1);
}

VirtualDisplay::~VirtualDisplay() {
    if (process_ > 0 && kill(process_, SIGTERM) == 0) waitpid(process_, nullptr, 0);
}

void use_cpus(int count) {
    cpu_set_t all, some;
    CPU_ZERO(&some);
    if (count <= 0 || sched_getaffinity(0, sizeof all, &all) != 0) return;
    for (int cpu = 0, used = 0; cpu < CPU_SETSIZE && used < count; ++cpu) {
        if (!CPU_ISSET(cpu, &all)) continue;
        CPU_SET(cpu, &some);
        ++used;
    }
    sched_setaffinity(0, sizeof some, &some);
}

void forget_peak_memory() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5;  // proc(5): resets VmHWM to the resident size
}

}  // namespace cellproj::bench
