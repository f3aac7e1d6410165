// SPDX-License-Identifier: BSD-3-Clause
//
// What a broken mesher does to its caller: nothing but an Error. Shell scripts stand in for mishaps that cannot be
// ordered from the real program.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include "mesh/child_process.hpp"
#include "mesh/error.hpp"
#include "mesh/mesher.hpp"
#include "mesh/mesher_format.hpp"
#include "tests/mesher_fixtures.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scratch_folder.hpp"

namespace cellproj {
namespace mesher_failure_test {

namespace fs = std::filesystem;
using mesher_fixtures::error_of;
using mesher_fixtures::unit_cube;
using testing_support::unit_tet;

class MesherFailure : public testing::Test {
protected:
    void SetUp() override { folder_ = testing_support::scratch_folder(); }

    void TearDown() override {
        EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a child process was left behind";
        EXPECT_EQ(errno, ECHILD);
        fs::remove_all(folder_);
    }

    fs::path script(const std::string& lines) const {
        const fs::path file = folder_ / "mesher.sh";
        std::ofstream(file) << "#!/bin/sh\n" << lines << '\n';
        fs::permissions(file, fs::perms::owner_all);
        return file;
    }

    // A program that answers with these bytes, whatever it is asked.
    fs::path answering(const std::string& bytes) const {
        std::ofstream(folder_ / "answer", std::ios::binary) << bytes;
        return script("exec cat '" + (folder_ / "answer").string() + "'");
    }

    static TetMesh run(const fs::path& program, double timeout_seconds = 60.0) {
        MesherOptions options;
        options.program = program;
        options.timeout_seconds = timeout_seconds;
        return tetrahedralize(unit_cube(), options);
    }

    // The mesher's Error; its text must hold `words`.
    static void expect_failure(const fs::path& program, const std::string& words, double timeout_seconds = 60.0) {
        const Error error = error_of([&] { run(program, timeout_seconds); });
        EXPECT_EQ(error.kind(), ErrorKind::mesher) << error.what();
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        EXPECT_NE(error.place().find(program.string()), std::string::npos) << error.place();
        EXPECT_FALSE(error.advice().empty());
    }

    fs::path folder_;
};

TEST_F(MesherFailure, SignalIsToldByName) {
    expect_failure(script("kill -SEGV $$"), "cellproj-mesher died of SIGSEGV");
    expect_failure(script("echo assertion lost >&2; kill -ABRT $$"), "died of SIGABRT (it said: assertion lost)");
}

TEST_F(MesherFailure, ExitStatusComesWithTheLastMessage) {
    expect_failure(script("echo first >&2; echo out of cheese >&2; exit 3"), "out of cheese (exit status 3)");
    expect_failure(script("exit 3"), "no message (exit status 3)");
}

TEST_F(MesherFailure, SlowMesherIsKilledWithItsChildren) {
    const fs::path pid_file = folder_ / "pid";
    expect_failure(script("sleep 600 & echo $! > '" + pid_file.string() + "'; wait"), "no answer after 0.5 s", 0.5);
    pid_t grandchild = 0;
    std::ifstream(pid_file) >> grandchild;
    ASSERT_GT(grandchild, 1);
    // Killed, it is gone or a zombie of whoever inherited it; a signal takes a moment to arrive.
    const auto runs = [&] {
        std::string pid, name, state;
        return bool(std::ifstream("/proc/" + std::to_string(grandchild) + "/stat") >> pid >> name >> state) &&
               state != "Z";
    };
    for (int i = 0; i < 500 && runs(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_FALSE(runs());
}

TEST_F(MesherFailure, MesherThatHidesIsKilled) {
    expect_failure(script("exec >&- 2>&-; sleep 600"), "no answer after 0.5 s", 0.5);
}

TEST_F(MesherFailure, GarbageIsRefused) {
    expect_failure(script("echo Opening mesh.poly."), "a message that starts with \"cpmesher\"");
    expect_failure(script(""), "a message that starts with \"cpmesher\", found 0 other bytes");
    expect_failure(script("exec yes"), "a message that starts with \"cpmesher\"");  // and is not waited for
}

TEST_F(MesherFailure, EndlessAnswerIsCutOff) {
    std::string answer = encode_answer(unit_tet());
    std::ofstream(folder_ / "answer", std::ios::binary) << answer;
    expect_failure(script("cat '" + (folder_ / "answer").string() + "'; exec yes"), "expected a body of");
}

TEST_F(MesherFailure, AnswerIsCheckedBeforeUse) {
    EXPECT_EQ(run(answering(encode_answer(unit_tet()))).tets.size(), 1U);  // the fixture itself is sound

    TetMesh mesh = unit_tet();
    mesh.tets[0] = {0, 1, 2, 4};
    expect_failure(answering(encode_answer(mesh)), "4");
    mesh = unit_tet();
    mesh.points[2].z = std::numeric_limits<double>::quiet_NaN();
    expect_failure(answering(encode_answer(mesh)), "finite");
    mesh = unit_tet();
    mesh.tets.clear();
    expect_failure(answering(encode_answer(mesh)), "no cells");
}

TEST_F(MesherFailure, InvertedCellsAreTurned) {
    TetMesh mesh = unit_tet();
    mesh.tets[0] = {0, 2, 1, 3};
    const TetMesh turned = run(answering(encode_answer(mesh)));
    EXPECT_EQ(signed_volume(turned, 0), 1.0 / 6.0);
}

TEST_F(MesherFailure, DeafMesherDoesNotKillTheCallerBySigpipe) {
    PiecewiseLinearComplex complex = unit_cube();
    complex.points.resize(200000, glm::dvec3(0.5));  // a request of 4.8 MB: far more than any pipe or socket buffers
    MesherOptions options;
    options.program = script("echo not listening >&2; exit 1");
    const Error error = error_of([&] { tetrahedralize(complex, options); });
    EXPECT_EQ(error.kind(), ErrorKind::mesher);
    EXPECT_NE(error.found().find("not listening"), std::string::npos) << error.what();
}

TEST_F(MesherFailure, MissingProgramIsAnEnvironmentError) {
    for (const fs::path& program : {folder_ / "nothing", folder_}) {  // a folder is no program either
        const Error error = error_of([&] { run(program); });
        EXPECT_EQ(error.kind(), ErrorKind::environment) << error.what();
        EXPECT_EQ(error.place(), program.string());
        EXPECT_NE(error.advice().find("CELLPROJ_MESHER"), std::string::npos);
    }
}

// Sets an environment variable for the length of a scope.
class ScopedVariable {
public:
    ScopedVariable(const char* name, const std::string& value) : name_(name) {
        if (const char* old = std::getenv(name)) old_ = old;
        setenv(name, value.c_str(), 1);
    }
    ~ScopedVariable() { old_.empty() ? unsetenv(name_) : setenv(name_, old_.c_str(), 1); }
    ScopedVariable(const ScopedVariable&) = delete;
    ScopedVariable& operator=(const ScopedVariable&) = delete;

private:
    const char* name_;
    std::string old_;
};

TEST_F(MesherFailure, FindMesherLooksWhereItIsTold) {
    const fs::path program = script("exit 0");
    {
        const ScopedVariable named("CELLPROJ_MESHER", program.string());
        EXPECT_EQ(find_mesher(), program);
    }
    {
        const ScopedVariable named("CELLPROJ_MESHER", (folder_ / "nothing").string());
        const Error error = error_of([] { find_mesher(); });
        EXPECT_EQ(error.kind(), ErrorKind::environment);
        EXPECT_NE(std::string(error.what()).find("nothing"), std::string::npos);
    }
}

// --- The child process itself ---

TEST_F(MesherFailure, ChildGetsItsInputAndItsOutputComesBack) {
    std::string input(1 << 20, 'x');  // more than pipes buffer: both directions must be served at once
    input += "end";
    const ChildResult result = run_child("/bin/cat", input, 60.0, [](std::string_view) { return false; });
    EXPECT_EQ(result.end, ChildResult::End::exited);
    EXPECT_EQ(result.code, 0);
    EXPECT_TRUE(result.output == input);
}

TEST_F(MesherFailure, ChildHasDefaultSignals) {
    // A caller may ignore SIGPIPE; its child must not inherit that: `yes | head` would run for ever.
    const auto old = std::signal(SIGPIPE, SIG_IGN);
    const ChildResult result =
        run_child(script("kill -PIPE $$; echo ignored"), "", 60.0, [](std::string_view) { return false; });
    std::signal(SIGPIPE, old);
    EXPECT_EQ(result.end, ChildResult::End::signalled);
    EXPECT_EQ(result.code, SIGPIPE);
    EXPECT_EQ(result.output, "");
}

// --- The exchange format ---

PiecewiseLinearComplex full_complex() {
    PiecewiseLinearComplex complex = unit_cube();
    complex.facets.push_back({0, 3, 5});
    complex.holes = {{0.1, 0.2, 0.3}};
    complex.regions = {{{0.5, 0.6, 0.7}, 7.0, 0.25}, {{0.2, 0.2, 0.2}, -1.0, 0.0}};
    return complex;
}

TEST(MesherFormat, RequestComesBackAsItWas) {
    const PiecewiseLinearComplex sent = full_complex();
    const MeshingRequest got = decode_request(encode_request(sent, 0.5, 1.5), "test");
    EXPECT_EQ(got.max_volume, 0.5);
    EXPECT_EQ(got.radius_edge_ratio, 1.5);
    EXPECT_EQ(got.complex.points, sent.points);
    EXPECT_EQ(got.complex.facets, sent.facets);
    EXPECT_EQ(got.complex.holes, sent.holes);
    ASSERT_EQ(got.complex.regions.size(), 2U);
    EXPECT_EQ(got.complex.regions[0].seed, sent.regions[0].seed);
    EXPECT_EQ(got.complex.regions[0].attribute, 7.0);
    EXPECT_EQ(got.complex.regions[0].max_volume, 0.25);
}

TEST(MesherFormat, AnswerComesBackAsItWas) {
    TetMesh sent = unit_tet();
    EXPECT_TRUE(decode_answer(encode_answer(sent), "test").cell_fields.empty());
    sent.cell_fields = {{"region", 1, {4.0}}};
    const TetMesh got = decode_answer(encode_answer(sent), "test");
    EXPECT_EQ(got.points, sent.points);
    EXPECT_EQ(got.tets, sent.tets);
    ASSERT_EQ(got.cell_fields.size(), 1U);
    EXPECT_EQ(got.cell_fields[0].name, "region");
    EXPECT_EQ(got.cell_fields[0].values, std::vector<double>{4.0});
}

TEST(MesherFormat, EveryTruncationIsRefused) {
    const std::string request = encode_request(full_complex(), 0.0, 0.0), answer = encode_answer(unit_tet());
    for (std::size_t n = 0; n < request.size(); ++n)
        EXPECT_THROW(decode_request(request.substr(0, n), "test"), Error) << n;
    for (std::size_t n = 0; n < answer.size(); ++n)
        EXPECT_THROW(decode_answer(answer.substr(0, n), "test"), Error) << n;
    EXPECT_THROW(decode_request(request + 'x', "test"), Error);
    EXPECT_THROW(decode_answer(answer + 'x', "test"), Error);
}

// Whatever eight bytes of a message are overwritten with, the decoders answer with a message or an Error, and never
// reach beyond their bytes (the sanitizers watch) or ask for more memory than the message could fill.
TEST(MesherFormat, WildNumbersDoNoHarm) {
    const auto decodes_or_throws = [](const auto& decode, std::string message) {
        for (const std::uint64_t wild : {0ULL, 1ULL, 1ULL << 31, 1ULL << 61, ~0ULL}) {
            for (std::size_t at = 0; at + 8 <= message.size(); at += 4) {
                std::string changed = message;
                std::memcpy(changed.data() + at, &wild, sizeof(wild));
                try {
                    decode(changed);
                } catch (const Error& error) {
                    ASSERT_EQ(error.kind(), ErrorKind::mesher);
                }
            }
        }
    };
    decodes_or_throws([](const std::string& m) { decode_request(m, "test"); },
                      encode_request(full_complex(), 0.0, 0.0));
    decodes_or_throws([](const std::string& m) { decode_answer(m, "test"); }, encode_answer(unit_tet()));
}

TEST(MesherFormat, ForeignVersionsAndKindsAreNamed) {
    std::string answer = encode_answer(unit_tet());
    EXPECT_NE(std::string(error_of([&] { decode_request(answer, "test"); }).what()).find("found kind 2"),
              std::string::npos);
    answer[8] = 9;
    EXPECT_NE(std::string(error_of([&] { decode_answer(answer, "test"); }).what()).find("found version 9"),
              std::string::npos);
}

TEST(MesherFormat, AnswersAnnounceTheirSize) {
    const std::string answer = encode_answer(unit_tet());
    for (std::size_t n = 0; n < 24; ++n)
        EXPECT_FALSE(announced_answer_size(answer.substr(0, n)).has_value()) << n;
    EXPECT_EQ(announced_answer_size(answer.substr(0, 24)), answer.size());
    EXPECT_EQ(announced_answer_size("cpm?"), 0U);
}

}  // namespace
}  // namespace cellproj
