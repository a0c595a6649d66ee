// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "common/hdf5/group.hpp"

namespace eti::hdf5 {

/// What of a file is copied. Paths are those of groups and data sets below the copied group, without a slash
/// before them; an attribute's is its object's, a slash and its name.
struct CopyRules {
    std::function<bool(std::string_view path)> keep;
    /// The text to write for a row of a data set of texts, or (row 0) for an attribute of one; nothing: as it
    /// was.
    std::function<std::optional<std::string>(std::string_view path, std::size_t row, std::string_view text)>
        rewrite;
};

/// Copies attributes, groups and data sets of `from` into `to`. Chunks go over as they are stored, checksums
/// included. The times at which objects were made are left out. Throws Error.
void copy_members(const Group& from, const Group& to, const CopyRules& rules);

}  // namespace eti::hdf5
