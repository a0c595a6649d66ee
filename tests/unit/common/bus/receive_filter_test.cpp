// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/receive_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "common/bus/fastdds/forwarding_transport.hpp"

namespace eti::bus {
namespace {

using namespace std::chrono_literals;

/// Keeps each thread that brings a datagram until a second one has come, or for a while.
class Library final : public transport::TransportReceiverInterface {
  public:
    void OnDataReceived(const rtps::octet*, std::uint32_t, const rtps::Locator_t&,
                        const rtps::Locator_t&) override {
        ++inside_;
        const auto until = std::chrono::steady_clock::now() + 300ms;
        while (most_ < 2 && std::chrono::steady_clock::now() < until) {
            most_ = std::max(most_.load(), inside_.load());
            std::this_thread::sleep_for(1ms);
        }
        --inside_;
    }
    [[nodiscard]] int most() const { return most_; }

  private:
    std::atomic<int> inside_{0}, most_{0};
};

/// How many datagrams to this port the library gets at once when two arrive.
int at_once(bool secured, std::uint32_t port) {
    std::vector<std::shared_ptr<transport::TransportDescriptorInterface>> transports{
        std::make_shared<transport::UDPv4TransportDescriptor>()};
    install_receive_filter(transports, std::make_shared<Admission>(false), "", Reach::network, {}, secured);
    const std::unique_ptr<transport::TransportInterface> made(transports.front()->create_transport());
    auto* const filter = dynamic_cast<ForwardingTransport*>(made.get());
    // A header and a timestamp (DDSI-RTPS 2.5, 9.4.1 and 9.4.5.9).
    const std::array<rtps::octet, 32> datagram = {'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8,
                                                  9,   10,  11,  12,  9, 1, 8, 0,  0, 0, 0, 0, 0, 0, 0, 0};
    rtps::Locator_t local, remote;
    local.kind = remote.kind = LOCATOR_KIND_UDPv4;
    local.port = port;
    Library library;
    const auto receive = [&] {
        filter->receive(&library, datagram.data(), static_cast<std::uint32_t>(datagram.size()), local,
                        remote);
    };
    {
        const std::jthread other(receive);
        receive();
    }
    return library.most();
}

// By the formula of ports (DDSI-RTPS 2.5, 9.6.2.3) discovery has even ones.
TEST(ReceiveFilter, SecuredDiscoveryComesOneAtATime) {
    EXPECT_EQ(at_once(true, 7400), 1);
    EXPECT_EQ(at_once(true, 7400 + 250 * 232 + 10), 1) << "of the last domain";
    EXPECT_EQ(at_once(true, 7411), 2) << "samples of a session";
    EXPECT_EQ(at_once(true, 7502), 2) << "samples by multicast";
    EXPECT_EQ(at_once(false, 7410), 2) << "without security";
}

}  // namespace
}  // namespace eti::bus
