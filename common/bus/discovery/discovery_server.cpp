// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/discovery/discovery_server.hpp"

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <utility>
#include <vector>

#include "common/bus/guard/receive_filter.hpp"
#include "common/bus/library_log.hpp"
#include "common/bus/transport.hpp"

namespace eti::bus {

struct DiscoveryServer::Impl {
    dds::DomainParticipant* participant = nullptr;

    ~Impl() {
        if (participant != nullptr) {
            dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
        }
    }
};

DiscoveryServer::DiscoveryServer(const Options& options, int number, const std::string& address,
                                 std::uint16_t port)
    : impl_(std::make_unique<Impl>()) {
    set_up_library_log();
    std::vector<std::string> warnings;
    dds::DomainParticipantQos qos = discovery_server_qos(number, address, port, warnings);
    install_receive_filter(qos.transport().user_transports, std::make_shared<Admission>(false),
                           options.profile, Reach::relayed, {}, false);
    qos.name(options.name);
    for (const std::string& warning : warnings) {
        bus_log().warn("{}", warning);
    }
    impl_->participant = dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(options.domain), qos, nullptr, dds::StatusMask::none());
    if (impl_->participant == nullptr) {
        throw BusError(
            fmt::format("cannot listen on {}:{}: the address is not this machine's or the port is in use; "
                        "choose another --address or --port",
                        address.empty() ? "any" : address, port));
    }
}

DiscoveryServer::~DiscoveryServer() = default;

}  // namespace eti::bus
