// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include "bus_fixture.hpp"
#include "common/bus/fastdds/names.hpp"
#include "common/bus/participant.hpp"
#include "messages.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/scratch_folder.hpp"

namespace eti::bus {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::string failure_of(const Options& wanted) {
    return eti::test::error_of<BusError>([&] { const Node node(wanted); });
}

/// A server that must not stay is refused as soon as it discovers the other; `wait` is the listening time of
/// one that may stay.
std::string refusal_of_node(Node& node, std::chrono::milliseconds wait = 2s) {
    return eti::test::error_of<BusError>([&] { (void)self_check(node, true, wait); });
}

TEST(SelfCheck, ASecondServerIsRefusedByName) {
    Node first(options("eti-server"));
    ASSERT_EQ(refusal_of_node(first), "");
    Publisher<msg::SessionStatus> status(first, topics::session_status);
    auto own = example<msg::SessionStatus>();
    ASSERT_TRUE(status.publish(own));
    Node second(options("eti-server"));
    EXPECT_THAT(refusal_of_node(second, 20s), AllOf(HasSubstr("session 'test'"), HasSubstr(process_name()),
                                                    HasSubstr("--session"), HasSubstr("stop that server")));
    Node elsewhere(options("eti-server", "other"));
    EXPECT_EQ(refusal_of_node(elsewhere), "") << "another session is free";
}

TEST(SelfCheck, OnlyOneOfTwoSimultaneousServersStarts) {
    Node first(options("eti-server"));
    Node second(options("eti-server"));
    std::string first_says;
    std::thread other([&] { first_says = refusal_of_node(first); });
    const std::string second_says = refusal_of_node(second, 20s);
    other.join();
    EXPECT_EQ(first_says, "");
    EXPECT_THAT(second_says, HasSubstr(process_name()));
}

TEST(SelfCheck, ForgedStatusDoesNotBlockServer) {
    Node stranger(options("stranger"));
    Publisher<msg::SessionStatus> status(stranger, topics::session_status);
    ASSERT_TRUE(status.publish(example<msg::SessionStatus>()));
    Node server(options("eti-server"));
    EXPECT_EQ(refusal_of_node(server, 2s), "");
}

TEST(SelfCheck, ASessionIsFreeAfterItsServerLeft) {
    {
        Node first(options("eti-server"));
        Publisher<msg::SessionStatus> status(first, topics::session_status);
        ASSERT_TRUE(status.publish(example<msg::SessionStatus>()));
    }
    Node second(options("eti-server"));
    EXPECT_EQ(refusal_of_node(second), "");
}

TEST(SelfCheck, MissingServerWarningNamesRemedies) {
    Node client(options("eti-client"));
    EXPECT_THAT(
        self_check(client, false, 300ms).warnings,
        Contains(AllOf(HasSubstr("no server found"), HasSubstr("start eti-server"), HasSubstr("--profile"))));
}

TEST(SelfCheck, SuggestsTheRunningSession) {
    Node server(options("eti-server", "morning"));
    Node client(options("eti-client", "mornign"));
    EXPECT_THAT(self_check(client, false, 2s).warnings,
                Contains(AllOf(HasSubstr("'mornign'"), HasSubstr("'morning'"), HasSubstr("--session"))));
}

TEST(SelfCheck, ReturnsEarlyWhenServerIsPresent) {
    Node server(options("eti-server"));
    Publisher<msg::SessionStatus> status(server, topics::session_status);
    Node client(options("eti-client"));
    const auto start = Clock::now();
    EXPECT_THAT(self_check(client, false, 10s).warnings, Not(Contains(HasSubstr("no server"))));
    EXPECT_LT(Clock::now() - start, 5s);
}

// A server that is still building its patient publishes nothing yet.
TEST(SelfCheck, DetectsLoadingServer) {
    Node server(options("eti-server"));
    Node client(options("eti-client"));
    EXPECT_THAT(self_check(client, false, 10s).warnings, Not(Contains(HasSubstr("no server"))));
}

/// A participant that announces another protocol version.
TEST(SelfCheck, ProtocolMismatchNamesBothVersions) {
    for (const std::string theirs :
         {"eti;session=test;process=host:7;started=1;",
          "eti;protocol=999;version=9.8.7;session=test;process=host:7;started=1;"}) {
        dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
        qos.name(std::string(server_name));
        qos.user_data().data_vec({theirs.begin(), theirs.end()});
        // As programs of this machine only are: others' addresses are ignored.
        const auto loopback = std::make_shared<transport::UDPv4TransportDescriptor>();
        loopback->interfaceWhiteList.emplace_back("127.0.0.1");
        qos.transport().use_builtin_transports = false;
        qos.transport().user_transports.push_back(loopback);
        auto* const factory = dds::DomainParticipantFactory::get_instance();
        auto* const other = factory->create_participant(static_cast<std::uint32_t>(options("x").domain), qos);
        ASSERT_NE(other, nullptr);
        Node client(options("eti-client"));
        const std::string refusal =
            eti::test::error_of<BusError>([&] { (void)self_check(client, false, 10s); });
        EXPECT_THAT(refusal,
                    AllOf(HasSubstr("host:7"), HasSubstr(ETI_VERSION),
                          HasSubstr(theirs.find("9.8.7") != std::string::npos ? "9.8.7" : "unknown"),
                          HasSubstr("protocol " + std::to_string(protocol)), HasSubstr("the same version")));
        EXPECT_THROW(refuse_other_protocol(client), BusError);
        factory->delete_participant(other);
        EXPECT_TRUE(eventually([&] {
            try {
                refuse_other_protocol(client);
                return true;
            } catch (const BusError&) {
                return false;
            }
        })) << "it is gone";
    }
}

TEST(NodeOptions, DomainOutOfRange) {
    for (const int domain : {-1, 233, 1'000'000}) {
        Options wanted = options("x");
        wanted.domain = domain;
        EXPECT_THAT(failure_of(wanted), AllOf(HasSubstr(std::to_string(domain)), HasSubstr("0 to 232")));
    }
}

// As a partition, "*" would join every session.
TEST(NodeOptions, InvalidSessionNamesAreRefused) {
    for (const char* session : {"", "*", "a b", "a;b", "../x", "[a-z]"}) {
        EXPECT_THAT(failure_of(options("x", session)), HasSubstr("expected 1 to 48 letters")) << session;
    }
    EXPECT_THAT(failure_of(options("x", std::string(49, 'a'))), HasSubstr("expected 1 to 48 letters"));
    EXPECT_EQ(failure_of(options("x", std::string(48, 'a'))), "");
}

class Profile : public test::ScratchFolderTest {
  protected:
    [[nodiscard]] Options with(const std::string& text) {
        Options wanted = options("x");
        wanted.profile = folder / (std::to_string(++files_) + "profile.xml");
        std::ofstream(wanted.profile) << text;
        return wanted;
    }

    int files_ = 0;
};

constexpr const char* good_profile = R"(<?xml version="1.0" encoding="UTF-8" ?>
<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"><profiles>
  <transport_descriptors><transport_descriptor>
    <transport_id>udp</transport_id><type>UDPv4</type><maxInitialPeersRange>100</maxInitialPeersRange>
    <interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>
  </transport_descriptor></transport_descriptors>
  <participant profile_name="eti"><rtps>
    <userTransports><transport_id>udp</transport_id></userTransports>
    <useBuiltinTransports>false</useBuiltinTransports>
    <builtin><initialPeersList><locator><udpv4><address>127.0.0.1</address></udpv4></locator></initialPeersList></builtin>
  </rtps></participant></profiles></dds>)";

TEST_F(Profile, MissingFile) {
    Options wanted = options("x");
    wanted.profile = folder / "none.xml";
    EXPECT_THAT(failure_of(wanted), AllOf(HasSubstr("none.xml"), HasSubstr("no such file")));
    wanted.profile = folder;
    EXPECT_THAT(failure_of(wanted), HasSubstr("no such file")) << "a folder is no profile";
}

TEST_F(Profile, NotXml) {
    for (const char* text : {"", "domain: 3\n", "<dds><profiles>", "<?xml version=\"1.0\"?><html></html>"}) {
        EXPECT_THAT(failure_of(with(text)), AllOf(HasSubstr("profile.xml"), HasSubstr("not a valid")))
            << text;
    }
}

/// The valid profile with `old` replaced by `by`, and its transport renamed: the library keeps the transports
/// of every file it has read.
std::string changed_profile(const std::string& old, const std::string& by, const std::string& transport) {
    std::string text = good_profile;
    text.replace(text.find(old), old.size(), by);
    const std::string shared = "transport_id>udp";
    for (std::size_t at = text.find(shared); at != std::string::npos; at = text.find(shared)) {
        text.replace(at, shared.size(), "transport_id>" + transport);
    }
    return text;
}

TEST_F(Profile, WrongName) {
    const std::string text = changed_profile("\"eti\"", "\"lab\"", "other");
    EXPECT_THAT(failure_of(with(text)), AllOf(HasSubstr("profile.xml"), HasSubstr("profile_name=\"eti\"")));
}

// Programs crashed because of it in one connection of seven (docs/decisions/bus-transport.md).
TEST_F(Profile, TcpIsRefused) {
    const std::string text = changed_profile("UDPv4", "TCPv4", "tcp");
    EXPECT_THAT(
        failure_of(with(text)),
        AllOf(HasSubstr("profile.xml"), HasSubstr("neither UDP nor shared memory"), HasSubstr("tunnel")));
}

void expect_connects(const Options& wanted) {
    Node first(wanted);
    Node second(wanted);
    Publisher<msg::Command> publisher(first, topics::command);
    Subscriber<msg::Command> subscriber(second, topics::command);
    ASSERT_TRUE(eventually([&] { return publisher.matched() == 1 && subscriber.matched() == 1; }));
    ASSERT_TRUE(publisher.publish(example<msg::Command>()));
    msg::Command received;
    EXPECT_TRUE(eventually([&] { return subscriber.take(received); }));
}

TEST_F(Profile, ConnectsThroughItsTransport) {
    expect_connects(with(good_profile));
}

// Must run early in the program: the library numbers a process's participants consecutively, and discovers
// the first ones of a machine.
TEST(ShippedProfile, SharedMemoryConnectsTwoLocalPrograms) {
    Options wanted = options("x");
    wanted.profile = std::filesystem::path(ETI_SOURCE_DIR) / "deploy/data/dds/shared_memory.xml";
    expect_connects(wanted);
}

}  // namespace
}  // namespace eti::bus
