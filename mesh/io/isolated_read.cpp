// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/isolated_read.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdio_ext.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <sstream>
#include <iterator>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "mesh/error.hpp"
#include "mesh/io/file_bytes.hpp"

#if defined(__has_feature)
#define CELLPROJ_HAS_FEATURE(x) __has_feature(x)
#else
#define CELLPROJ_HAS_FEATURE(x) 0
#endif

namespace cellproj {

namespace {

#if defined(__SANITIZE_ADDRESS__) || CELLPROJ_HAS_FEATURE(address_sanitizer)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

constexpr std::size_t printed_kept = 16384;

// What the child sends through the pipe: percents, and in the end what the memory file holds.
constexpr std::uint8_t result_ready = 200, error_ready = 201;

// ---- What parent and child share ----

class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() { close(); }

    int get() const { return fd_; }
    void close() {
        if (fd_ >= 0) ::close(std::exchange(fd_, -1));
    }

private:
    int fd_;
};

[[noreturn]] void throw_no_child(const std::filesystem::path& file, const char* needed, const char* advice) {
    throw Error({.kind = ErrorKind::environment,
                 .place = file.string(),
                 .expected = std::string(needed) + " for the child process that reads it",
                 .found = std::strerror(errno),
                 .advice = advice});
}

struct Channels {
    // In memory, by size; unlike a pipe they never fill up.
    Descriptor result{memfd_create("cellproj result", MFD_CLOEXEC)};
    Descriptor printed{memfd_create("cellproj printed", MFD_CLOEXEC)};
    std::array<int, 2> pipe{-1, -1};
    int opened = pipe2(pipe.data(), O_CLOEXEC);
    Descriptor events{pipe[0]};
    Descriptor events_out{pipe[1]};

    bool are_open() const { return result.get() >= 0 && printed.get() >= 0 && opened == 0; }
};

std::size_t size_of(const Descriptor& file) {
    struct stat status {};
    return fstat(file.get(), &status) == 0 ? static_cast<std::size_t>(status.st_size) : 0;
}

std::string start_of(const Descriptor& file) {
    std::string text(printed_kept, '\0');
    const ssize_t size = pread(file.get(), text.data(), text.size(), 0);
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return text;
}

// A file in memory as bytes, whose pages are given back to the system as they are read.
class Mapping {
public:
    explicit Mapping(const Descriptor& file) : size_(size_of(file)) {
        if (size_ > 0) memory_ = mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED, file.get(), 0);
        if (memory_ == MAP_FAILED) throw std::bad_alloc();
    }
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;
    ~Mapping() {
        if (memory_) munmap(memory_, size_);
    }

    std::string_view bytes() const { return {static_cast<const char*>(memory_), size_}; }

    // Everything up to the end of `read`, which is a part of `bytes`.
    void release(std::string_view read) {
        const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
        const std::size_t end = static_cast<std::size_t>(read.data() + read.size() - bytes().data()) / page * page;
        if (end <= released_) return;
        madvise(static_cast<char*>(memory_) + released_, end - released_, MADV_REMOVE);
        released_ = end;
    }

private:
    std::size_t size_ = 0;
    std::size_t released_ = 0;
    void* memory_ = nullptr;
};

// ---- The child ----

struct Limits {
    double seconds;                // from start to end
    rlim_t processor_seconds;      // of them on a processor
    std::optional<rlim_t> memory;  // bytes
};

// What RLIMIT_DATA counts, in bytes: the sixth number of /proc/self/statm, in pages.
std::optional<rlim_t> writable_memory() {
    std::ifstream statm("/proc/self/statm");
    std::uintmax_t pages = 0;
    for (int number = 0; number < 6; ++number)
        statm >> pages;
    if (!statm) return std::nullopt;
    return rlim_t{pages} * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

Limits limits_for(std::uintmax_t bytes) {
    constexpr rlim_t base = rlim_t{32} << 20, per_byte = 5000;
    const double megabytes = static_cast<double>(bytes) / 1e6;
    Limits limits{8.0 + megabytes, static_cast<rlim_t>(2.0 + megabytes), std::nullopt};
    const std::optional<rlim_t> now = sanitized ? std::nullopt : writable_memory();
    if (!now) return limits;
    const rlim_t machine = static_cast<rlim_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
    // Divided first: the product may overflow.
    limits.memory = *now + (bytes > machine / per_byte ? machine : std::min(machine, base + per_byte * rlim_t{bytes}));
    return limits;
}

void apply(const Limits& limits) {
    const auto set = [](__rlimit_resource resource, rlim_t value) {
        rlimit limit{};
        getrlimit(resource, &limit);
        limit.rlim_cur = std::min(value, limit.rlim_max);
        setrlimit(resource, &limit);
    };
    set(RLIMIT_CORE, 0);
    set(RLIMIT_CPU, limits.processor_seconds);
    if (limits.memory) set(RLIMIT_DATA, *limits.memory);
}

int progress_pipe = -1;  // in a child: where its parent listens

void send_event(std::uint8_t event) {
    [[maybe_unused]] const ssize_t sent = write(progress_pipe, &event, 1);
}

// Throws std::bad_alloc when the system has no more memory for it.
void append(const Descriptor& file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = write(file.get(), bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) throw std::bad_alloc();
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void send_error(const Descriptor& result, const Error& error) {
    [[maybe_unused]] const int cut = ftruncate(result.get(), 0);  // what was written of a result
    lseek(result.get(), 0, SEEK_SET);
    ByteWriter writer([&](std::string_view bytes) { append(result, bytes); });
    put(writer, error);
    send_event(error_ready);
}

Error out_of_memory(const std::filesystem::path& file) {
    return Error({.kind = ErrorKind::format,
                  .place = file.string(),
                  .expected = "a file whose content fits into the memory",
                  .found = "one that asks for more",
                  .advice = "it may be damaged: write or copy it again; otherwise use a machine with more memory"});
}

void work_in_child(const Channels& channels, const std::filesystem::path& file,
                   const std::function<void(ByteWriter&)>& work) {
    try {
        ByteWriter writer([&](std::string_view bytes) { append(channels.result, bytes); });
        work(writer);
        std::fflush(stdout);
        if (size_of(channels.printed) == 0) send_event(result_ready);
    } catch (const Error& error) {
        send_error(channels.result, error);
    } catch (const std::bad_alloc&) {
        send_error(channels.result, out_of_memory(file));
    } catch (const std::exception& failure) {
        append(channels.printed, failure.what());
    }
}

[[noreturn]] void run_child(const Channels& channels, const Limits& limits, const std::filesystem::path& file,
                            const std::function<void(ByteWriter&)>& work) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    __fpurge(stdout);  // what the parent was about to print is the parent's
    dup2(channels.printed.get(), STDOUT_FILENO);
    dup2(channels.printed.get(), STDERR_FILENO);
    progress_pipe = channels.events_out.get();
    std::signal(SIGPIPE, SIG_IGN);
    if (!sanitized) {  // or its reports would be lost
        for (const int number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL})
            std::signal(number, SIG_DFL);
    }
    apply(limits);
    try {
        work_in_child(channels, file, work);
    } catch (...) {  // not even the error could be sent
    }
    _exit(0);
}

// ---- The parent ----

[[noreturn]] void throw_damaged(const std::filesystem::path& file, const std::string& found) {
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "a complete and well-formed file",
                 .found = found,
                 .advice = "it, or a file it names, may be cut off or damaged: write or copy it again"});
}

// A forked process; killed and reaped if it still runs when this goes out of scope.
class Child {
public:
    explicit Child(pid_t pid) : pid_(pid) {}
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        if (pid_ <= 0) return;
        kill(pid_, SIGKILL);
        wait(0);
    }

    // Processor time so far [clock ticks] if it sleeps now; −1 while it works, or where /proc does not tell.
    long ticks_if_asleep() const {
        std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
        std::string text((std::istreambuf_iterator<char>(file)), {});
        const std::size_t name_end = text.rfind(')');  // the name may hold anything
        if (name_end == std::string::npos) return -1;
        std::istringstream fields(text.substr(name_end + 1));
        std::string state, skipped;
        long user = 0, system = 0;
        fields >> state;
        for (int field = 4; field < 14; ++field) fields >> skipped;
        if (!(fields >> user >> system) || state != "S") return -1;
        return user + system;
    }

    // Its status, or none while it runs. A caller that ignores SIGCHLD has its children reaped by the kernel: their
    // status is lost and counts as 0; what the child sent decides.
    std::optional<int> status_if_ended() { return wait(WNOHANG); }

private:
    std::optional<int> wait(int options) {
        int status = 0;
        pid_t ended = -1;
        do {
            ended = waitpid(pid_, &status, options);
        } while (ended < 0 && errno == EINTR);
        if (ended == 0) return std::nullopt;
        pid_ = -1;
        return ended < 0 ? 0 : status;
    }

    pid_t pid_;
};

struct Outcome {
    std::optional<int> status;    // none: it ran too long
    std::uint8_t event = 0;       // the last one
    bool stands_still = false;    // it did nothing at all for a while, and did not end
};

// Tells a child that may wait for a lock for ever. One that waits for slow storage looks the same.
class StandstillWatch {
public:
    explicit StandstillWatch(const Child& child) : child_(child) {}

    // Asleep for 3 s without using the processor. Asks /proc every half second at most.
    bool stands_still() {
        const auto now = std::chrono::steady_clock::now();
        if (now < next_) return false;
        next_ = now + std::chrono::milliseconds(500);
        const long ticks = child_.ticks_if_asleep();
        if (ticks < 0 || ticks != ticks_) {
            ticks_ = ticks;
            since_ = now;
        }
        return ticks >= 0 && now - since_ > std::chrono::seconds(3);
    }

private:
    const Child& child_;
    long ticks_ = -1;
    std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now(), since_ = next_;
};

// Passes the child's percents on until it ends, its time is over or, where it can be tried again, it stands still.
Outcome follow(Child& child, const Descriptor& events, double seconds, const ProgressCallback& progress, bool can_try_again) {
    const auto start = std::chrono::steady_clock::now();
    Outcome outcome;
    const auto receive = [&] {
        std::array<std::uint8_t, 256> news;
        const ssize_t size = read(events.get(), news.data(), news.size());
        if (size <= 0) return size < 0 && errno == EINTR;
        outcome.event = news[static_cast<std::size_t>(size) - 1];
        if (progress && outcome.event <= 100) progress(outcome.event / 100.0);
        return true;
    };
    bool open = true;
    StandstillWatch watch(child);
    while (!(outcome.status = child.status_if_ended())) {
        if (can_try_again && (outcome.stands_still = watch.stands_still())) return outcome;
        if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > seconds) return outcome;
        // The end of the pipe tells of the child's end at once; only a child of another thread's read, forked while
        // this pipe was open, can keep it open, so it is not waited for.
        pollfd ready{open ? events.get() : -1, POLLIN, 0};
        if (poll(&ready, 1, open ? 20 : 1) > 0) open = receive();
    }
    for (pollfd ready{events.get(), POLLIN, 0}; open && poll(&ready, 1, 0) > 0;)
        open = receive();
    return outcome;
}

// Whether a sanitizer found fault with our own code (UndefinedBehaviorSanitizer sees nothing else; AddressSanitizer
// names functions, innermost first): no damage of the file explains that away.
bool blames_us(const std::string& report) {
    if (report.find("runtime error:") != std::string::npos) return true;
    if (report.find("AddressSanitizer") == std::string::npos) return false;
    const std::size_t ours = report.find("in cellproj::");
    return ours != std::string::npos && ours < report.find("libvtk");
}

[[noreturn]] void throw_failure(const std::filesystem::path& file, const Outcome& outcome, const std::string& printed) {
    if (sanitized && blames_us(printed)) {
        std::fputs(printed.c_str(), stderr);
        std::abort();
    }
    if (!outcome.status) throw_damaged(file, "one that keeps its reader busy without end");
    if (WIFSIGNALED(*outcome.status)) {
        const int number = WTERMSIG(*outcome.status);
        if (number == SIGXCPU) throw_damaged(file, "one that keeps its reader busy without end");
        if (number == SIGKILL) throw out_of_memory(file);
        throw_damaged(file, "one that crashes its reader (signal " + std::to_string(number) + ")");
    }
    if (printed.empty()) throw_damaged(file, "one that its reader gives up on");
    const std::string line = printed.substr(0, std::min<std::size_t>(printed.find('\n'), 200));
    throw_damaged(file, "what its reader calls \"" + printable(line) + "\"");
}

}  // namespace

void run_isolated(const std::filesystem::path& file, std::uintmax_t bytes, const ProgressCallback& progress,
                  const std::function<void(ByteWriter&)>& work, const std::function<void(ByteReader&)>& take) {
    constexpr int tries = 2;
    for (int attempt = 1;; ++attempt) {
        Channels channels;
        if (!channels.are_open()) throw_no_child(file, "files in memory", "close some files or programs");
        const Limits limits = limits_for(bytes);
        const pid_t pid = fork();
        if (pid < 0) throw_no_child(file, "a place", "end other processes or free memory");
        if (pid == 0) run_child(channels, limits, file, work);
        Child child(pid);
        channels.events_out.close();  // or the end of the child's would not be seen
        const Outcome outcome = follow(child, channels.events, limits.seconds, progress, attempt < tries);
        if (outcome.stands_still) continue;  // forked at a bad moment: some lock was held
        const bool ended_well = outcome.status && WIFEXITED(*outcome.status) && WEXITSTATUS(*outcome.status) == 0;
        if (!ended_well || (outcome.event != result_ready && outcome.event != error_ready))
            throw_failure(file, outcome, start_of(channels.printed));
        Mapping mapping(channels.result);
        ByteReader reader(
            mapping.bytes(),
            [&](const std::string&, const std::string&) { throw_damaged(file, "one that confuses its reader"); },
            [&](std::string_view read) { mapping.release(read); });
        if (outcome.event == error_ready) throw take_error(reader);
        return take(reader);
    }
}

void report_progress(double fraction) {
    static int last = -1;
    const int percent = static_cast<int>(100.0 * std::clamp(fraction, 0.0, 1.0));
    if (progress_pipe < 0 || percent == last) return;
    last = percent;
    send_event(static_cast<std::uint8_t>(percent));
}

}  // namespace cellproj
