// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "common/hdf5/group.hpp"

namespace eti::hdf5 {

/// Selects what is copied from a file. Paths of groups and data sets are relative to the copied group,
/// without a leading slash; an attribute's path is its object's path, a slash and its name.
struct CopyRules {
    std::function<bool(std::string_view path)> keep;
    /// Replacement for one row of a text data set, or for a text attribute (row 0); nullopt keeps the text.
    std::function<std::optional<std::string>(std::string_view path, std::size_t row, std::string_view text)>
        rewrite;
};

/// Copies attributes, groups and data sets of `from` into `to`. Chunks are copied as stored, with their
/// checksums. Creation times are not copied. Throws Error.
void copy_members(const Group& from, const Group& to, const CopyRules& rules);

}  // namespace eti::hdf5
