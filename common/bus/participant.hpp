// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/discovery/interface_watcher.hpp"
#include "common/bus/discovery/peers.hpp"
#include "common/bus/discovery/rediscovery_counter.hpp"
#include "common/bus/echo.hpp"
#include "common/bus/fastdds/discovery_listener.hpp"
#include "common/bus/guard/admission.hpp"
#include "common/bus/library_log.hpp"

namespace eti::bus {

/// State shared by a node's publishers and subscribers. The last of them deletes it, so the order in which
/// they and the node are destroyed does not matter.
class Participant final : public DiscoveryListener {
  public:
    explicit Participant(const Options& options);
    ~Participant() override;
    Participant(const Participant&) = delete;
    Participant& operator=(const Participant&) = delete;

    /// The topic of that name; created, and its type registered, on first use.
    [[nodiscard]] dds::Topic* topic(std::string_view name, dds::TypeSupport type);

    [[nodiscard]] std::vector<Peer> peers() const;
    [[nodiscard]] Rediscoveries rediscoveries() const;
    /// Liveliness of a writer that matches a reader here.
    void on_writer_liveliness(const rtps::GUID_t& writer, bool alive);
    void release_ownership(std::string_view topic);
    /// Unicast locators of this participant; known once it has a writer.
    [[nodiscard]] std::vector<rtps::Locator_t> own_locators() const;
    [[nodiscard]] bool contested() const { return admission_->contested(); }
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
    /// Comparable with Peer::started.
    [[nodiscard]] std::pair<std::uint64_t, ParticipantId> started() const;

    const Options options;
    dds::DomainParticipant* participant = nullptr;
    dds::Publisher* publisher = nullptr;
    dds::Subscriber* subscriber = nullptr;

  private:
    void on_participant(const DiscoveredParticipant& found) override;
    void on_writer(const DiscoveredWriter& found) override;
    [[nodiscard]] bool in_session(const std::vector<std::string>& partitions) const;
    void watch_interfaces();
    void close();

    std::shared_ptr<Admission> admission_;
    std::mutex topics_mutex_;
    std::map<std::string, dds::Topic*, std::less<>> topics_;
    mutable std::mutex peers_mutex_;
    std::map<ParticipantId, Peer> peers_;
    RediscoveryCounter<ParticipantId> gone_participants_;
    RediscoveryCounter<WriterId> gone_writers_;
    std::vector<rtps::Locator_t> own_locators_;
    std::vector<std::string> warnings_;
    std::uint64_t started_ns_ = 0;
    std::optional<InterfaceWatcher> interfaces_;
};

struct Node::Impl {
    std::shared_ptr<Participant> participant;
    EchoResponder echo;
};

}  // namespace eti::bus
