// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/discovery/peers.hpp"
#include "deploy/doctor/finding.hpp"

namespace eti::doctor {

/// Counts lost messages of a topic by their numbers: those of one state share a number, and consecutive
/// states are `steps` apart.
class ChunkLossCounter {
  public:
    explicit ChunkLossCounter(std::uint32_t steps) : steps_(steps) {}
    void note(std::uint32_t number, std::uint32_t chunks);
    [[nodiscard]] std::uint64_t arrived() const { return arrived_; }
    /// From the first state on, excluding the last one, which may be incomplete.
    [[nodiscard]] std::uint64_t lost() const { return lost_; }
    [[nodiscard]] double percent() const;

  private:
    std::uint32_t steps_, last_ = 0, chunks_ = 0, of_last_ = 0;
    std::uint64_t arrived_ = 0, lost_ = 0, settled_ = 0;
};

/// A program of the session and its echo statistics.
struct PeerReport {
    std::string name, process, version;
    int protocol = 0;
    bool serves = false;
    std::vector<double> round_trips_ms;
    double clock_offset_ms = 0.0;  ///< its clock minus this one's, from the fastest answer
    double error_ms = 0.0;         ///< largest error of the offset: half of that round trip
};

struct TopicReport {
    std::string topic;
    std::uint64_t arrived = 0, lost = 0;
    double lost_percent = 0.0;
    double arrived_mbit_per_s = 0.0;  ///< of the link, headers included

    /// What the server sends to this program on the topic.
    [[nodiscard]] double sent_mbit_per_s() const {
        return arrived == 0
                   ? 0.0
                   : arrived_mbit_per_s * static_cast<double>(arrived + lost) / static_cast<double>(arrived);
    }
};

struct SessionReport {
    bool server = false;
    bool contested = false;  ///< two programs serve it
    std::vector<PeerReport> peers;
    std::vector<std::string> elsewhere;  ///< sessions of other names on the domain
    std::vector<TopicReport> topics;
    bus::Rediscoveries rediscoveries;
    double seconds = 0.0;  ///< of observation
};

/// Joins the session for `duration` and sends echo requests ten times a second. Throws bus::BusError on
/// failure.
[[nodiscard]] SessionReport observe(const bus::Options& options, std::chrono::duration<double> duration);

[[nodiscard]] Findings diagnose_session(const SessionReport& report, const bus::Options& options);

/// The value that a share of the others does not exceed; 0 without any.
[[nodiscard]] double percentile(std::vector<double> values, double share);

}  // namespace eti::doctor
