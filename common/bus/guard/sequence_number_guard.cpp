// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/sequence_number_guard.hpp"

#include <algorithm>

#include "common/bus/guard/writer_table.hpp"

namespace eti::bus {

bool SequenceNumberGuard::plausible(const WriterId& writer, std::int64_t number, bool from_owner,
                                    Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    const auto known = writers_.find(writer);
    if (known == writers_.end()) {
        if (number > (from_owner ? max_first_of_owner : max_first)) {
            return false;
        }
        make_room(writers_, max_writers);
        writers_.emplace(writer, WriterProgress{number, burst, now});
        return true;
    }
    WriterProgress& reached = known->second;
    // Unused allowance accumulates: a writer continues while the network is down.
    reached.left +=
        static_cast<double>(per_second) * std::chrono::duration<double>(now - reached.heard).count();
    reached.heard = now;
    const std::int64_t rise = std::max<std::int64_t>(0, number - reached.number);
    if (static_cast<double>(rise) > reached.left) {
        return false;
    }
    reached.left -= static_cast<double>(rise);
    reached.number += rise;
    return true;
}

}  // namespace eti::bus
