// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "common/bus/guard/rtps_message.hpp"

namespace eti::bus {

/// Compares the fragments of one sample, which is_well_formed() checks one by one. Fast DDS 2.9.1 copies a
/// sample's last fragment by the sizes of its first and so reads past a datagram that names others; it
/// reserves a whole sample for its first fragment; it counts on whatever a reassembled handshake message
/// counts; and it delivers the fragments of a sample that also comes as a whole (an assertion on a keyed
/// topic). Thread-safe.
class FragmentGuard {
  public:
    using Clock = std::chrono::steady_clock;

    /// Whether the library may have these fragments of a sample of `writer`. `from_owner`: the writer belongs
    /// to the session's server, which alone sends large samples.
    [[nodiscard]] bool plausible(const WriterId& writer, const Fragments& fragments, bool from_owner,
                                 Clock::time_point now = Clock::now());

    /// Whether the library may have a sample of this number as a whole: no fragments of it have come.
    [[nodiscard]] bool plausible(const WriterId& writer, std::int64_t whole_sample);

    /// Largest fragmented sample of other participants [bytes]: an annotation of 48 places has 1.5 kB.
    static constexpr std::uint32_t max_foreign_sample_bytes = 1u << 16;
    /// Largest handshake message [bytes]; a certificate and its permissions have 5 kB.
    static constexpr std::uint32_t max_handshake_bytes = 1u << 15;
    /// Samples of a writer whose sizes are remembered. Fragments of older ones are refused.
    static constexpr std::size_t max_samples = 64;
    /// Writers; beyond this number, those heard longest ago are dropped.
    static constexpr std::size_t max_writers = 256;
    /// Writers of handshake messages, likewise; they are authenticated one after another.
    static constexpr std::size_t max_handshakes = 32;

  private:
    struct Sample {
        std::uint16_t fragment_bytes = 0;
        std::uint32_t bytes = 0;
        bool refused = false;
        // Of a handshake message: its content so far, and which fragments of it have arrived.
        std::vector<std::uint8_t> content;
        std::vector<bool> arrived;
    };
    struct Writer {
        std::map<std::int64_t, Sample> samples;  // by sequence number
        std::int64_t forgotten = 0;              // greatest sequence number of a sample dropped
        Clock::time_point heard;
    };
    using Writers = std::map<WriterId, Writer>;

    [[nodiscard]] static Sample* sample_of(Writers& writers, std::size_t most, const WriterId& writer,
                                           const Fragments& fragments, Clock::time_point now);
    [[nodiscard]] static bool is_valid_so_far(Sample& message, const Fragments& fragments);

    std::atomic<bool> any_{false};  // fragments have come
    std::mutex mutex_;
    Writers writers_, handshakes_;
};

}  // namespace eti::bus
