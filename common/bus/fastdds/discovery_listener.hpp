// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <string>
#include <vector>

#include "common/bus/fastdds/names.hpp"

namespace eti::bus {

enum class DiscoveryChange : std::uint8_t {
    discovered,
    changed,
    left,  ///< it said so
    lost,  ///< its lease ended
};

/// A participant as its announcement describes it.
struct DiscoveredParticipant {
    rtps::GuidPrefix_t prefix;
    std::string name;
    std::string user_data;
    DiscoveryChange change = DiscoveryChange::changed;
    [[nodiscard]] bool removed() const {
        return change == DiscoveryChange::left || change == DiscoveryChange::lost;
    }
};

struct DiscoveredWriter {
    rtps::GUID_t guid;
    std::string topic;
    std::vector<std::string> partitions;
    std::vector<rtps::Locator_t> unicast_locators;
    bool own = false;                                   ///< of the listening participant
    DiscoveryChange change = DiscoveryChange::changed;  ///< never lost: its participant is
};

/// Reports discovered participants and writers, on the library's threads.
class DiscoveryListener : public dds::DomainParticipantListener {
  protected:
    virtual void on_participant(const DiscoveredParticipant& participant) = 0;
    virtual void on_writer(const DiscoveredWriter& writer) = 0;

  private:
    template <class Bytes>
    static std::string text(const Bytes& bytes) {
        return {bytes.begin(), bytes.end()};
    }
    template <class Locators>
    static std::vector<rtps::Locator_t> listed(const Locators& locators) {
        return {locators.begin(), locators.end()};
    }

    /// Of the library's status of a participant.
    template <class Status>
    static DiscoveryChange change_of_participant(Status status, Status discovered, Status left, Status lost) {
        return status == discovered ? DiscoveryChange::discovered
               : status == left     ? DiscoveryChange::left
               : status == lost     ? DiscoveryChange::lost
                                    : DiscoveryChange::changed;
    }
    template <class Status>
    static DiscoveryChange change_of_writer(Status status, Status discovered, Status removed) {
        return status == discovered ? DiscoveryChange::discovered
               : status == removed  ? DiscoveryChange::left
                                    : DiscoveryChange::changed;
    }

#if ETI_FASTDDS >= 3
    void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryStatus status,
                                  const rtps::ParticipantBuiltinTopicData& info, bool& /*ignored*/) final {
        using Status = rtps::ParticipantDiscoveryStatus;
        on_participant({info.guid.guidPrefix, info.participant_name.to_string(),
                        text(info.user_data.data_vec()),
                        change_of_participant(status, Status::DISCOVERED_PARTICIPANT,
                                              Status::REMOVED_PARTICIPANT, Status::DROPPED_PARTICIPANT)});
    }
    void on_data_writer_discovery(dds::DomainParticipant* self, rtps::WriterDiscoveryStatus status,
                                  const rtps::PublicationBuiltinTopicData& info, bool& /*ignored*/) final {
        on_writer({info.guid, info.topic_name.to_string(), info.partition.getNames(),
                   listed(info.remote_locators.unicast), info.guid.guidPrefix == self->guid().guidPrefix,
                   change_of_writer(status, rtps::WriterDiscoveryStatus::DISCOVERED_WRITER,
                                    rtps::WriterDiscoveryStatus::REMOVED_WRITER)});
    }
#else
    void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& found) final {
        using Found = rtps::ParticipantDiscoveryInfo;
        const auto& info = found.info;
        on_participant({info.m_guid.guidPrefix, info.m_participantName.to_string(),
                        text(info.m_userData.data_vec()),
                        change_of_participant(found.status, Found::DISCOVERED_PARTICIPANT,
                                              Found::REMOVED_PARTICIPANT, Found::DROPPED_PARTICIPANT)});
    }
    void on_publisher_discovery(dds::DomainParticipant* self, rtps::WriterDiscoveryInfo&& found) final {
        const auto& info = found.info;
        on_writer({info.guid(), info.topicName().to_string(), info.m_qos.m_partition.getNames(),
                   listed(info.remote_locators().unicast), info.guid().guidPrefix == self->guid().guidPrefix,
                   change_of_writer(found.status, rtps::WriterDiscoveryInfo::DISCOVERED_WRITER,
                                    rtps::WriterDiscoveryInfo::REMOVED_WRITER)});
    }
#endif
};

}  // namespace eti::bus
