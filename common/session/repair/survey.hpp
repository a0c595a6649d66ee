// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/hdf5/group.hpp"
#include "common/session/rows.hpp"

namespace eti::session {

/// Data sets that must have the same length.
struct TableState {
    struct Series {
        std::string path;
        Condition condition;
    };
    const char* what = "";
    std::vector<Series> series;
    std::size_t common = 0;  ///< intact rows that all have before the first damage
    std::size_t most = 0;    ///< largest stated number of rows
    [[nodiscard]] bool whole() const;
};

/// Reads every series of a session file.
[[nodiscard]] std::vector<TableState> survey(const hdf5::Group& root);

}  // namespace eti::session
