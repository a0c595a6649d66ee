// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/fragment_guard.hpp"

#include <algorithm>

#include "common/bus/guard/security_message.hpp"
#include "common/bus/guard/writer_table.hpp"

namespace eti::bus {

namespace {

/// Entities of the protocol itself (DDSI-RTPS 2.5, 9.3.1.2).
bool is_built_in(const WriterId& writer) {
    return (writer.entity[3] & 0xc0) == 0xc0;
}

}  // namespace

/// The sample's entry, or null where its sizes differ from those of its first fragment or it is too old.
FragmentGuard::Sample* FragmentGuard::sample_of(Writers& writers, std::size_t most, const WriterId& id,
                                                const Fragments& fragments, Clock::time_point now) {
    if (!writers.contains(id)) {
        make_room(writers, most);
    }
    Writer& writer = writers[id];
    writer.heard = now;
    if (fragments.sequence_number <= writer.forgotten) {
        return nullptr;
    }
    const auto [sample, is_new] = writer.samples.try_emplace(
        fragments.sequence_number, Sample{fragments.size, fragments.sample, false, {}, {}});
    if (is_new && writer.samples.size() > max_samples) {
        const auto oldest = writer.samples.begin();
        writer.forgotten = oldest->first;
        const bool itself = oldest == sample;
        writer.samples.erase(oldest);
        if (itself) {
            return nullptr;
        }
    }
    const bool same =
        sample->second.fragment_bytes == fragments.size && sample->second.bytes == fragments.sample;
    return same ? &sample->second : nullptr;
}

/// Adds fragments to a handshake message; false if it is whole and not valid. As in the library, the first
/// arrival of a fragment counts.
bool FragmentGuard::is_valid_so_far(Sample& message, const Fragments& fragments) {
    const std::size_t count = (message.bytes + message.fragment_bytes - 1) / message.fragment_bytes;
    message.content.resize(message.bytes);
    message.arrived.resize(count);
    const std::size_t index = fragments.first - 1;
    if (!message.arrived[index]) {
        message.arrived[index] = true;
        std::ranges::copy(fragments.payload, message.content.begin() +
                                                 static_cast<std::ptrdiff_t>(index * message.fragment_bytes));
    }
    if (std::ranges::find(message.arrived, false) == message.arrived.end()) {
        message.refused = !is_valid_stateless_message(message.content);
    }
    return !message.refused;
}

bool FragmentGuard::plausible(const WriterId& writer, const Fragments& fragments, bool from_owner,
                              Clock::time_point now) {
    const bool handshake = writer.entity == stateless_message_writer;
    const std::uint32_t most = handshake    ? max_handshake_bytes
                               : from_owner ? max_sample_bytes
                                            : max_foreign_sample_bytes;
    // Discovery data fit a datagram.
    if (fragments.sample > most || (is_built_in(writer) && !(handshake && fragments.count == 1))) {
        return false;
    }
    any_.store(true, std::memory_order_release);
    const std::lock_guard lock(mutex_);
    Sample* const sample = handshake ? sample_of(handshakes_, max_handshakes, writer, fragments, now)
                                     : sample_of(writers_, max_writers, writer, fragments, now);
    return sample != nullptr && !sample->refused && (!handshake || is_valid_so_far(*sample, fragments));
}

bool FragmentGuard::plausible(const WriterId& id, std::int64_t whole_sample) {
    if (!any_.load(std::memory_order_acquire)) {
        return true;
    }
    const std::lock_guard lock(mutex_);
    const auto free_in = [&](const Writers& writers) {
        const auto known = writers.find(id);
        return known == writers.end() ||
               (whole_sample > known->second.forgotten && !known->second.samples.contains(whole_sample));
    };
    return free_in(writers_) && free_in(handshakes_);
}

}  // namespace eti::bus
