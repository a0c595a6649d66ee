// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>

namespace eti::app {

/// The program's tables as JSON: scenario keys (`scenario`), runtime parameters (`live`) and metrics
/// (`parameters`). The tables in the documents are generated from it.
[[nodiscard]] nlohmann::ordered_json description();

}  // namespace eti::app
