// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Anyone can send announcements in another participant's name (CVE-2023-50257). A stranger's datagrams go
// through real sockets; without the filter each of these ends the connection of two nodes for a while.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <initializer_list>
#include <vector>

#include "bus_fixture.hpp"
#include "common/bus/discovery/peers.hpp"
#include "common/process/files/descriptor.hpp"

namespace eti::bus {
namespace {

/// DATA of SPDP (DDSI-RTPS 2.5, 9.4.5.3), little-endian.
class Forgery {
  public:
    explicit Forgery(const ParticipantId& victim) : victim_(victim) {}

    /// "I leave": disposed and unregistered, with the key.
    [[nodiscard]] std::vector<std::uint8_t> goodbye() const {
        std::vector<std::uint8_t> inline_qos;
        parameter(inline_qos, 0x71, {0, 0, 0, 3});
        parameter(inline_qos, 0x70, guid());
        parameter(inline_qos, 1, {});
        std::vector<std::uint8_t> key = {0, 3, 0, 0};
        parameter(key, 0x50, guid());
        parameter(key, 1, {});
        return datagram(0x01 | 0x02 | 0x08, inline_qos, key);
    }

    /// "My lease is 0.1 s, I am at a port where nobody listens, and in another session."
    [[nodiscard]] std::vector<std::uint8_t> other_announcement() const {
        std::vector<std::uint8_t> content = {0, 3, 0, 0};
        parameter(content, 0x15, {2, 3, 0, 0});
        parameter(content, 0x16, {1, 15, 0, 0});
        parameter(content, 0x50, guid());
        parameter(content, 0x32, {1, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 127, 0, 0, 1});
        parameter(content, 0x31, {1, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 127, 0, 0, 1});
        parameter(content, 0x02, {0, 0, 0, 0, 0x99, 0x99, 0x99, 0x19});
        parameter(content, 0x58, {0x3f, 0x0c, 0, 0});
        parameter(content, 0x2c, {17,  0,   0,   0,   'e', 't', 'i', ';', 's', 'e', 's', 's',
                                  'i', 'o', 'n', '=', 'e', 'v', 'i', 'l', ';', 0,   0,   0});
        parameter(content, 1, {});
        return datagram(0x01 | 0x04, {}, content);
    }

  private:
    [[nodiscard]] std::vector<std::uint8_t> guid() const {
        std::vector<std::uint8_t> out(victim_.begin(), victim_.end());
        out.insert(out.end(), {0, 0, 1, 0xc1});
        return out;
    }
    static void parameter(std::vector<std::uint8_t>& list, std::uint8_t id,
                          const std::vector<std::uint8_t>& content) {
        list.insert(list.end(), {id, 0, static_cast<std::uint8_t>(content.size()), 0});
        list.insert(list.end(), content.begin(), content.end());
    }
    [[nodiscard]] std::vector<std::uint8_t> datagram(int flags, const std::vector<std::uint8_t>& inline_qos,
                                                     const std::vector<std::uint8_t>& payload) const {
        std::vector<std::uint8_t> out = {'R', 'T', 'P', 'S', 2, 3, 1, 15};
        out.insert(out.end(), victim_.begin(), victim_.end());
        const std::size_t size = 20 + inline_qos.size() + payload.size();
        out.insert(out.end(), {0x15, static_cast<std::uint8_t>(flags), static_cast<std::uint8_t>(size),
                               static_cast<std::uint8_t>(size >> 8)});
        out.insert(out.end(), {0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 0, 0, 0, 0, 99, 0, 0, 0});
        out.insert(out.end(), inline_qos.begin(), inline_qos.end());
        out.insert(out.end(), payload.begin(), payload.end());
        return out;
    }

    ParticipantId victim_;
};

/// To every participant of this test's domain on this machine.
void send_to_all(const std::vector<std::uint8_t>& datagram) {
    const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ASSERT_TRUE(socket);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (int participant = 0; participant < 16; ++participant) {
        to.sin_port = htons(static_cast<std::uint16_t>(7410 + 250 * test::own_domain() + 2 * participant));
        (void)::sendto(socket.get(), datagram.data(), datagram.size(), 0,
                       reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
}

/// Two nodes stay connected while a stranger speaks for one of them.
void expect_stay_connected(std::vector<std::uint8_t> (Forgery::*forged)() const) {
    Node server(options("eti-server")), client(options("eti-client"));
    Publisher<msg::SessionStatus> publisher(server, topics::session_status);
    Subscriber<msg::SessionStatus> subscriber(client, topics::session_status);
    ASSERT_TRUE(eventually([&] { return publisher.matched() == 1 && subscriber.matched() == 1; }));
    ASSERT_TRUE(eventually([&] { return !discovered_peers(client).empty(); }));
    const Forgery forgery(discovered_peers(client).front().started.second);
    for (const auto end = Clock::now() + 2s; Clock::now() < end;) {
        send_to_all((forgery.*forged)());
        std::this_thread::sleep_for(20ms);
        ASSERT_EQ(subscriber.matched(), 1);
        ASSERT_EQ(discovered_peers(client).front().session, "test");
    }
    const Rediscoveries counts = rediscoveries(client);
    EXPECT_EQ(counts.after_departure + counts.after_silence, 0u);
}

TEST(ForgedAnnouncement, GoodbyeIsIgnored) {
    expect_stay_connected(&Forgery::goodbye);
}

TEST(ForgedAnnouncement, OtherAddressesAndLeaseAreIgnored) {
    expect_stay_connected(&Forgery::other_announcement);
}

// Without their goodbye, participants are missed when their lease of 1.5 s ends; writers are taken back at
// once.
TEST(ForgedAnnouncement, TrueDepartureIsNoticed) {
    Node client(options("eti-client"));
    Subscriber<msg::SessionStatus> subscriber(client, topics::session_status);
    {
        Node server(options("eti-server"));
        Publisher<msg::SessionStatus> publisher(server, topics::session_status);
        ASSERT_TRUE(eventually([&] { return subscriber.matched() == 1; }));
    }
    EXPECT_TRUE(eventually([&] { return subscriber.matched() == 0; }));
    EXPECT_TRUE(eventually([&] { return discovered_peers(client).empty(); }));
}

}  // namespace
}  // namespace eti::bus
