// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

namespace eti {

/// Logs to standard error under the program's name, since standard output is for results. Control characters
/// in names and files are escaped.
void set_up_log(const std::string& program);

}  // namespace eti
