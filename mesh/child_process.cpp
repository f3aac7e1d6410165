// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

#include "mesh/error.hpp"

extern char** environ;

namespace cellproj {

namespace {

constexpr std::size_t messages_kept = 65536;

[[noreturn]] void fail(const std::filesystem::path& program, int error) {
    throw Error({.kind = ErrorKind::environment,
                 .place = program.string(),
                 .expected = "a program that can be started",
                 .found = std::strerror(error),
                 .advice = "install cellproj-mesher, or name it in the environment variable CELLPROJ_MESHER"});
}

class Descriptor {
public:
    Descriptor() = default;
    explicit Descriptor(int fd) : fd_(fd) {}
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }
    ~Descriptor() { close(); }

    int get() const { return fd_; }
    bool is_open() const { return fd_ >= 0; }
    void close() {
        if (fd_ >= 0) ::close(std::exchange(fd_, -1));
    }

private:
    int fd_ = -1;
};

// In a caller with closed standard streams new descriptors would be 0, 1 or 2, which the child is about to replace.
Descriptor above_standard_streams(int fd) {
    const Descriptor low(fd);
    return Descriptor(fcntl(fd, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
}

struct Channel {
    Descriptor ours, childs;
};

// A socket instead of a pipe: only `send` can be told not to raise SIGPIPE when the child is gone.
Channel open_input() {
    std::array<int, 2> ends{-1, -1};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return {};
    return {above_standard_streams(ends[0]), above_standard_streams(ends[1])};
}

Channel open_output() {
    std::array<int, 2> ends{-1, -1};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return {};
    return {above_standard_streams(ends[0]), above_standard_streams(ends[1])};
}

// A running process group; what still runs when this goes out of scope is killed, and its leader is reaped.
class Child {
public:
    explicit Child(pid_t pid) : pid_(pid) {}
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        if (pid_ > 0) kill_and_reap();
    }

    // The status, once it has ended. A caller that ignores SIGCHLD has its children reaped by the kernel: their status
    // is lost, and counts as success; the answer is checked anyway.
    std::optional<int> status_if_ended() {
        int status = 0;
        const pid_t ended = waitpid(pid_, &status, WNOHANG);
        if (ended == 0 || (ended < 0 && errno == EINTR)) return std::nullopt;
        pid_ = -1;
        return ended < 0 ? 0 : status;
    }

    void kill_and_reap() {
        kill(-pid_, SIGKILL);
        while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
        }
        pid_ = -1;
    }

private:
    pid_t pid_;
};

// Attributes of the child: its own process group, so that whatever it starts can be killed with it; and default
// signals, whatever the caller blocks or ignores.
pid_t spawn(const std::filesystem::path& program, const Channel& in, const Channel& out, const Channel& err) {
    posix_spawn_file_actions_t streams;
    posix_spawn_file_actions_init(&streams);
    posix_spawn_file_actions_adddup2(&streams, in.childs.get(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&streams, out.childs.get(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&streams, err.childs.get(), STDERR_FILENO);

    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

    std::string name = program.string();
    std::array<char*, 2> arguments{name.data(), nullptr};
    pid_t pid = -1;
    const int error = posix_spawn(&pid, name.c_str(), &streams, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&streams);
    if (error != 0) fail(program, error);
    return pid;
}

// Sends what fits. Closes the channel at the end of the input, which is how the child learns of it, and when the child
// does not listen any more, which is no failure by itself.
void send_some(Descriptor& channel, std::string_view& input) {
    const ssize_t sent = send(channel.get(), input.data(), input.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) input.remove_prefix(static_cast<std::size_t>(sent));
    const bool later = sent < 0 && (errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK);
    if (input.empty() || (sent < 0 && !later)) channel.close();
}

// Appends what is there; closes the channel at its end.
void receive_some(Descriptor& channel, std::string& text) {
    std::array<char, 65536> buffer;
    const ssize_t received = read(channel.get(), buffer.data(), buffer.size());
    if (received > 0) text.append(buffer.data(), static_cast<std::size_t>(received));
    if (received == 0 || (received < 0 && errno != EINTR && errno != EAGAIN)) channel.close();
}

class Deadline {
public:
    explicit Deadline(double seconds) : seconds_(seconds) {}

    bool passed() const { return left() <= 0.0; }
    // For poll: rounded up, at most a minute at a time, since an int of milliseconds ends after 24 days.
    int milliseconds() const { return static_cast<int>(std::clamp(left() * 1000.0 + 1.0, 0.0, 60000.0)); }

private:
    double left() const {
        return seconds_ - std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    double seconds_;
};

}  // namespace

ChildResult run_child(const std::filesystem::path& program, std::string_view input, double timeout_seconds,
                      const std::function<bool(std::string_view output)>& refuse) {
    Channel in = open_input(), out = open_output(), err = open_output();
    for (const Channel* channel : {&in, &out, &err}) {
        if (!channel->ours.is_open() || !channel->childs.is_open()) fail(program, errno);
    }
    const Deadline deadline(timeout_seconds);
    Child child(spawn(program, in, out, err));
    for (Channel* channel : {&in, &out, &err})
        channel->childs.close();  // or we would never see their end
    if (input.empty()) in.ours.close();

    ChildResult result;
    while (out.ours.is_open() || err.ours.is_open()) {
        // poll passes over negative descriptors, so closed channels may stay in the list.
        std::array<pollfd, 3> ready{
            pollfd{in.ours.get(), POLLOUT, 0}, {out.ours.get(), POLLIN, 0}, {err.ours.get(), POLLIN, 0}};
        if (poll(ready.data(), ready.size(), deadline.milliseconds()) < 0 && errno != EINTR) fail(program, errno);
        if (ready[0].revents != 0) send_some(in.ours, input);
        if (ready[1].revents != 0) receive_some(out.ours, result.output);
        if (ready[2].revents != 0) receive_some(err.ours, result.messages);
        if (result.messages.size() > 2 * messages_kept) {
            result.messages.erase(0, result.messages.size() - messages_kept);
        }
        const bool refused = ready[1].revents != 0 && refuse(result.output);
        if (refused || deadline.passed()) {
            result.end = refused ? ChildResult::End::stopped : ChildResult::End::timed_out;
            return result;
        }
    }
    // Its streams are closed, so it is about to end; nothing portable waits for that with a time limit.
    std::optional<int> status = child.status_if_ended();
    while (!status && !deadline.passed()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        status = child.status_if_ended();
    }
    if (!status) {
        result.end = ChildResult::End::timed_out;
    } else if (WIFSIGNALED(*status)) {
        result.end = ChildResult::End::signalled;
        result.code = WTERMSIG(*status);
    } else {
        result.code = WEXITSTATUS(*status);
    }
    return result;
}

}  // namespace cellproj
