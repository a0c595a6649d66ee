// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

namespace eti {

/// The program's log goes to standard error under its name, since standard output belongs to its result. What
/// names and files hold is shown, never obeyed: control characters are escaped.
void set_up_log(const std::string& program);

}  // namespace eti
