// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

namespace eti::test {

/// The message of the `Error` that `action` throws; empty if it throws nothing.
template <class Error, class Action>
[[nodiscard]] std::string error_of(const Action& action) {
    try {
        (void)action();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace eti::test
