// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>

namespace eti::app {

/// The tables of this program: what a scenario sets (`scenario`), what commands change while a session runs
/// (`live`), what is measured (`parameters`). The documents' tables are made of it.
[[nodiscard]] nlohmann::ordered_json description();

}  // namespace eti::app
