// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

namespace eti::review {

/// Replaces this process by eti-server with these arguments: the one in the same folder, or one in the
/// PATH. Returns only if none was found, after reporting it.
void exec_server(const std::vector<std::string>& arguments);

/// Runs eti-server to completion, discarding its standard output. Returns its exit status, 128 plus the
/// signal that ended it, or 127 if it was not found.
[[nodiscard]] int run_server(const std::vector<std::string>& arguments);

}  // namespace eti::review
