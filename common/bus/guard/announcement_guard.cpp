// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/announcement_guard.hpp"

#include <algorithm>

#include "common/bus/guard/writer_table.hpp"

namespace eti::bus {

bool AnnouncementGuard::plausible(const ParticipantId& participant, const Announcement& announcement,
                                  Clock::time_point now) {
    if (announcement.goodbye || announcement.of_another) {
        return false;
    }
    const std::lock_guard lock(mutex_);
    const auto known = participants_.find(participant);
    if (known == participants_.end()) {
        make_room(participants_, max_participants);
        const Bytes content = announcement.content;
        participants_.emplace(participant, Participant{{content.begin(), content.end()}, now});
        return true;
    }
    Participant& first = known->second;
    if (!std::ranges::equal(first.content, announcement.content)) {
        if (now - first.heard < stands_for) {
            return false;
        }
        first.content.assign(announcement.content.begin(), announcement.content.end());
    }
    first.heard = now;
    return true;
}

}  // namespace eti::bus
