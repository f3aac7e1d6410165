// SPDX-License-Identifier: BSD-3-Clause
//
// Every format, damaged: one good file each, cut at 20 places and with 200 flipped bytes, through `read` and
// `tetrahedralize` or `read_surface`. Each test runs in a child process, where a crash or a hang is a failure like any
// other, and where the peak of memory belongs to this format alone.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <functional>
#include <random>

#include "mesh/surface.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/damage_samples.hpp"
#include "tests/read_fixtures.hpp"
#include "tests/support/folder_test.hpp"

namespace cellproj {
namespace damage_test {

using testing_support::DamageSample;

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CELLPROJ_TEST_SANITIZED 1
#endif
#endif
#ifdef CELLPROJ_TEST_SANITIZED
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

constexpr double longest_read = 10.0;  // seconds

// ---- What must hold of anything that is read ----

bool fit(const std::vector<Field>& fields, std::size_t rows) {
    return std::all_of(fields.begin(), fields.end(), [&](const Field& f) {
        return f.components >= 1 && f.values.size() == rows * static_cast<std::size_t>(f.components);
    });
}

bool is_consistent(const Dataset& d) {
    const bool listed = d.grid || (d.cells.offsets.size() == d.cells.size() + 1 && d.cells.offsets.front() == 0 &&
                                   d.cells.offsets.back() == d.cells.vertices.size());
    const bool gridded = !d.grid || d.points.size() == d.grid->ni * d.grid->nj * d.grid->nk;
    return d.cell_count() > 0 && listed && gridded && fit(d.point_fields, d.points.size()) &&
           fit(d.cell_fields, d.cell_count());
}

// What came of a file, so that two of them can be compared; NaN equals NaN.
struct Content {
    std::vector<double> numbers;
    std::vector<std::string> names;

    bool operator==(const Content& other) const {
        return names == other.names && numbers.size() == other.numbers.size() &&
               (numbers.empty() ||
                std::memcmp(numbers.data(), other.numbers.data(), numbers.size() * sizeof(double)) == 0);
    }

    void add(const std::vector<glm::dvec3>& points) {
        for (const glm::dvec3& p : points)
            numbers.insert(numbers.end(), {p.x, p.y, p.z});
    }
    void add(const std::vector<Field>& fields) {
        for (const Field& f : fields) {
            names.push_back(f.name);
            numbers.insert(numbers.end(), f.values.begin(), f.values.end());
        }
    }
};

// Reads the sample's entry; throws Error, or std::logic_error for what contradicts itself.
Content content_of(const DamageSample& sample, const fs::path& entry) {
    Content content;
    if (sample.surface) {
        const Surface surface = read_surface(entry);
        validate(surface);
        content.add(surface.points);
        content.add(surface.point_fields);
        for (const auto& polygon : surface.polygons)
            content.numbers.insert(content.numbers.end(), polygon.begin(), polygon.end());
        return content;
    }
    ReadOptions options;
    if (!sample.solution.empty()) options.solution = entry.parent_path() / sample.solution;
    const Dataset dataset = read(entry, options);
    if (!is_consistent(dataset)) throw std::logic_error("a dataset that contradicts itself");
    content.add(dataset.points);
    content.add(dataset.point_fields);
    content.add(dataset.cell_fields);
    content.numbers.insert(content.numbers.end(), dataset.cells.vertices.begin(), dataset.cells.vertices.end());
    validate(tetrahedralize(dataset), "the tetrahedra");
    return content;
}

// ---- Damage ----

struct Findings {
    std::string complaints;
    std::size_t errors = 0, unchanged = 0, changed = 0;
    double slowest = 0;  // seconds

    void complain(const std::string& about, const std::string& what) {
        if (complaints.size() < 4000) complaints += about + ": " + what + "\n";
    }
};

enum class Damage { cut, flip };

// Reads a damaged sample and looks at what comes of it. A cut file must not look like a good one with less
// in it, if its format lets that be known.
void try_damaged(const DamageSample& sample, const fs::path& entry, const std::string& about, Damage damage,
                 const Content& whole, Findings& findings) {
    const auto start = std::chrono::steady_clock::now();
    try {
        const bool same = content_of(sample, entry) == whole;
        ++(same ? findings.unchanged : findings.changed);
        if (!same && damage == Damage::cut && !sample.open_ended)
            findings.complain(about, "less is read without a word");
    } catch (const Error& error) {
        ++findings.errors;
        const std::string text = error.what();
        const auto is_named = [&](const fs::path& file) {
            return text.find(file.filename().string()) != std::string::npos;
        };
        if (!is_named(entry) && std::none_of(sample.files.begin(), sample.files.end(), is_named)) {
            findings.complain(about, "no name of the file in \"" + text + "\"");
        }
    } catch (const std::exception& error) {
        findings.complain(about, error.what());
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    findings.slowest = std::max(findings.slowest, seconds);
    if (seconds > longest_read) findings.complain(about, "took " + std::to_string(seconds) + " s");
}

void set_bytes(const fs::path& file, std::string_view bytes) {
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void try_cuts(const DamageSample& sample, const fs::path& entry, const Content& whole, Findings& findings) {
    constexpr std::size_t cuts = 20;
    for (const std::string& name : sample.files) {
        const fs::path file = entry.parent_path() / name;
        const std::string bytes = testing_support::bytes_of(file);
        for (std::size_t cut = 0; cut < cuts; ++cut) {
            const std::size_t size = bytes.size() * cut / cuts;
            set_bytes(file, std::string_view(bytes).substr(0, size));
            try_damaged(sample, entry, name + " cut to " + std::to_string(size) + " of " + std::to_string(bytes.size()),
                        Damage::cut, whole, findings);
        }
        set_bytes(file, bytes);
    }
}

// VTK's readers, where most formats spend their time, are not instrumented: the sanitizers see 20 flips of each format only.
constexpr std::size_t flips = CELLPROJ_SANITIZED ? 10 : 200;

// All flips, spread over the files; `at_once` of them in each try.
void try_flips(const DamageSample& sample, const fs::path& entry, const Content& whole, Findings& findings) {
    std::mt19937_64 random(20261122);
    for (std::size_t flip = 0; flip < flips; flip += sample.flips_at_once) {
        const std::string& name = sample.files[flip / sample.flips_at_once % sample.files.size()];
        const fs::path file = entry.parent_path() / name;
        const std::string bytes = testing_support::bytes_of(file);
        std::string damaged = bytes;
        std::string about = name + " with byte";
        for (std::size_t n = 0; n < sample.flips_at_once; ++n) {
            const std::size_t at = random() % bytes.size();
            damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1 + random() % 255));
            about += " " + std::to_string(at) + " = " + std::to_string(static_cast<unsigned char>(damaged[at]));
        }
        set_bytes(file, damaged);
        try_damaged(sample, entry, about, Damage::flip, whole, findings);
        set_bytes(file, bytes);
    }
}

// Of this process and the children it has waited for: what the machine had to provide [KiB].
long peak_memory() {
    rusage own{}, children{};
    getrusage(RUSAGE_SELF, &own);
    getrusage(RUSAGE_CHILDREN, &children);
    return std::max(own.ru_maxrss, children.ru_maxrss);
}

Findings examine(const DamageSample& sample, const fs::path& entry) {
    Findings findings;
    const Content whole = content_of(sample, entry);
    if (whole.numbers.empty()) findings.complain("the good file", "nothing in it");
    const long good = peak_memory();
    try_cuts(sample, entry, whole, findings);
    try_flips(sample, entry, whole, findings);
    // AddressSanitizer keeps freed memory for a while, which would be counted.
    if (!sanitized && peak_memory() > 4 * good) {
        findings.complain("memory", std::to_string(peak_memory()) + " KiB, for the good file " + std::to_string(good));
    }
    return findings;
}

// ---- The child ----

// What `work` returns in a fork of this process; a word about its end when that is not a normal one. Its output is
// returned behind a word, too.
std::string in_child(const std::function<std::string()>& work) {
    const int result = memfd_create("result", 0), printed = memfd_create("printed", 0);
    const pid_t child = fork();
    if (child == 0) {
        dup2(printed, STDOUT_FILENO);
        dup2(printed, STDERR_FILENO);
        alarm(250);
        std::string text;
        try {
            text = work();
        } catch (const std::exception& error) {
            text = std::string("the good file: ") + error.what();
        }
        _exit(::write(result, text.data(), text.size()) == static_cast<ssize_t>(text.size()) ? 0 : 1);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    const auto content = [](int file) {
        std::string text(8000, '\0');
        text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, pread(file, text.data(), text.size(), 0))));
        close(file);
        return text;
    };
    std::string text = content(result);
    if (status != 0) text += "the test ended with status " + std::to_string(status) + "\n";
    if (const std::string words = content(printed); !words.empty()) text += "printed: " + words;
    return text;
}

class Damaged : public testing::TestWithParam<DamageSample> {};

TEST_P(Damaged, FileGivesAnErrorOrAValidDataset) {
    const DamageSample& sample = GetParam();
    if (!sample.source.empty() && !fs::exists(fs::path(CELLPROJ_SHARED_DATA) / sample.source)) {
        GTEST_SKIP() << "no " << sample.source << " in " << CELLPROJ_SHARED_DATA;
    }
    const fs::path folder = scratch_folder() / sample.name;
    fs::remove_all(folder);
    fs::create_directories(folder);
    // In a child, too: writing through VTK starts threads, and a lock that one of them held while this process forks
    // would stay locked for ever in the child that examines, and in each child of that one.
    const fs::path entry = in_child([&] { return sample.prepare(folder, CELLPROJ_SHARED_DATA).string(); });
    ASSERT_TRUE(fs::exists(entry)) << entry.string();
    const std::string complaints = in_child([&] {
        const Findings found = examine(sample, entry);
        const bool any_error = found.errors > 0;  // or the damage did not reach the file
        return found.complaints + (any_error ? "" : "no damage was noticed\n");
    });
    EXPECT_EQ(complaints, "");
    fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Formats, Damaged, testing::ValuesIn(testing_support::damage_samples()),
                         [](const auto& sample) { return sample.param.name; });

}  // namespace
}  // namespace cellproj
