// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/hdf5/group.hpp"

namespace eti::session {

/// Rows of one data set.
struct Length {
    std::string path;
    std::size_t stated = 0;
    std::size_t readable = 0;  ///< before the first damaged chunk
};

/// Data sets that must be of one length.
struct TableState {
    const char* what = "";
    std::vector<Length> lengths;
    std::size_t common = 0;  ///< rows that all have, whole
    [[nodiscard]] bool equal() const;
    [[nodiscard]] bool readable() const;
};

/// Reads every series of a session file. Throws hdf5::Error where a data set is missing.
[[nodiscard]] std::vector<TableState> survey(const hdf5::Group& root);

}  // namespace eti::session
