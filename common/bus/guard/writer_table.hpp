// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstddef>

namespace eti::bus {

/// Before another writer is added to a table that holds `most`: drops the one heard longest ago, by the
/// entries' `heard`.
template <class Writers>
void make_room(Writers& writers, std::size_t most) {
    if (writers.size() >= most) {
        writers.erase(
            std::ranges::min_element(writers, {}, [](const auto& one) { return one.second.heard; }));
    }
}

}  // namespace eti::bus
