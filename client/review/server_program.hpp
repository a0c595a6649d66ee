// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

namespace eti::review {

/// Puts eti-server with these arguments in this program's place: the one beside it, or one in the PATH.
/// Returns only where there is none; then it has said so.
void become_server(const std::vector<std::string>& arguments);

/// Runs eti-server to its end, without its standard output. Its exit status, 128 and the signal that ended
/// it, or 127 where there is none.
[[nodiscard]] int run_server(const std::vector<std::string>& arguments);

}  // namespace eti::review
