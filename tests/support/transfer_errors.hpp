// SPDX-License-Identifier: BSD-3-Clause
//
// What the tests of transfer functions say about errors.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "classify/transfer_function.hpp"
#include "mesh/error.hpp"

namespace cellproj {

// The Error that `action` throws; fails the test when it throws none.
template <class Action>
Error error_of(Action action) {
    try {
        action();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no Error was thrown";
    return Error({ErrorKind::environment, "", "", "", ""});
}

inline Error parse_error(const std::string& json) {
    return error_of([&] { parse_transfer_function(json, "tf.json"); });
}

// Every word must be in the message: that is what the user reads.
inline void expect_words(const Error& error, ErrorKind kind, const std::vector<std::string>& words) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    for (const std::string& word : words)
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << '"' << word << "\" in: " << error.what();
}

}  // namespace cellproj
