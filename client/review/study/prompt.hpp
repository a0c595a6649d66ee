// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string>

namespace eti::review {

/// The next line of standard input; nullopt at its end or when the program is asked to stop.
[[nodiscard]] std::optional<std::string> read_line();

}  // namespace eti::review
