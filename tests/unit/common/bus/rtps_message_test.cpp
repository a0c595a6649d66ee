// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Reference: OMG DDSI-RTPS 2.5, chapter 9.4, which defines the layouts of the messages below.
#include "common/bus/guard/rtps_message.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "common/bus/guard/security_message.hpp"
#include "common/math/random.hpp"

namespace eti::bus {
namespace {

/// Little-endian bytes of an RTPS message.
class Message {
  public:
    Message() { put({'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}); }

    Message& put(std::initializer_list<int> bytes) {
        for (const int byte : bytes) {
            bytes_.push_back(static_cast<std::uint8_t>(byte));
        }
        return *this;
    }
    Message& u16(std::uint32_t value) { return put({int(value & 0xff), int(value >> 8 & 0xff)}); }
    Message& u32(std::uint32_t value) { return u16(value & 0xffff).u16(value >> 16); }
    Message& number(std::int64_t value) {
        return u32(static_cast<std::uint32_t>(value >> 32)).u32(static_cast<std::uint32_t>(value));
    }
    Message& zeros(std::size_t count) {
        bytes_.resize(bytes_.size() + count);
        return *this;
    }
    Message& submessage(int kind, std::uint32_t length, int flags = 1) {
        return put({kind, flags}).u16(length);
    }
    Message& reader() { return put({0, 0, 1, 4}); }
    Message& writer() { return put({0, 0, 1, 3}); }

    Message& data(std::int64_t number_of = 1) {
        return submessage(0x15, 28, 5)
            .u16(0)
            .u16(16)
            .reader()
            .writer()
            .number(number_of)
            .put({0, 1, 0, 0})
            .u32(7);
    }
    Message& heartbeat(std::int64_t first, std::int64_t last) {
        return submessage(0x07, 28).reader().writer().number(first).number(last).u32(1);
    }
    Message& gap(std::int64_t start, std::int64_t base, std::uint32_t bits = 0) {
        submessage(0x08, 28 + 4 * ((bits + 31) / 32)).reader().writer().number(start).number(base).u32(bits);
        return zeros(4 * ((bits + 31) / 32));
    }
    Message& acknack(std::int64_t base, std::uint32_t bits = 0) {
        submessage(0x06, 24 + 4 * ((bits + 31) / 32)).reader().writer().number(base).u32(bits);
        return zeros(4 * ((bits + 31) / 32)).u32(1);
    }
    Message& fragment(std::uint32_t first, std::uint32_t count, std::uint32_t size, std::uint32_t whole,
                      std::uint32_t payload, int flags = 1, std::uint32_t to_inline_qos = 28) {
        submessage(0x16, 32 + payload, flags)
            .u16(0)
            .u16(to_inline_qos)
            .reader()
            .writer()
            .number(1)
            .u32(first)
            .u16(count)
            .u16(size);
        return u32(whole).zeros(payload);
    }

    [[nodiscard]] bool passes() const { return is_well_formed(bytes_); }
    [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

  private:
    std::vector<std::uint8_t> bytes_;
};

TEST(RtpsMessage, LegitimateMessagesAreWellFormed) {
    EXPECT_TRUE(Message().data().heartbeat(1, 5).passes());
    EXPECT_TRUE(Message().heartbeat(8, 7).passes()) << "nothing in the history";
    EXPECT_TRUE(Message().gap(3, 9, 40).passes());
    EXPECT_TRUE(Message().acknack(0).acknack(17, 256).passes());
    EXPECT_TRUE(Message().fragment(1, 1, 100, 150, 100).fragment(2, 1, 100, 150, 50).passes());
    EXPECT_TRUE(Message().submessage(0x0e, 12).zeros(12).submessage(0x09, 8).zeros(8).data().passes());
    EXPECT_TRUE(Message().data().submessage(0x80, 56, 0).zeros(0).passes() == false) << "cut short";
    auto told = Message().data();
    told.put({0x80, 0, 56, 0}).zeros(56);
    EXPECT_FALSE(told.passes()) << "the library writes this length in big-endian order";
    EXPECT_TRUE(Message().data().put({0x80, 0, 0, 56}).zeros(56).passes()) << "statistics are the last";
}

// With security compiled in, Fast DDS 2.9.1 reads the byte behind these 20
// (SecurityManager::decode_rtps_message).
TEST(RtpsMessage, HeaderAloneIsRefused) {
    EXPECT_EQ(Message().bytes().size(), 20u);
    EXPECT_FALSE(Message().passes());
}

// 84 bytes that abort a process with Fast DDS 2.9.1 by an assertion (RTPSStatisticsMessages.hpp).
TEST(RtpsMessage, StatisticsBeforeOtherSubmessagesAreRefused) {
    auto deadly = Message();
    deadly.submessage(0x80, 56).zeros(56).submessage(0x01, 0);
    EXPECT_EQ(deadly.bytes().size(), 84u);
    EXPECT_FALSE(deadly.passes());
    EXPECT_FALSE(Message().submessage(0x80, 60).zeros(60).passes());
}

TEST(RtpsMessage, ExcessiveSequenceRangesAreRefused) {
    EXPECT_TRUE(Message().heartbeat(1, max_sequence_range - 1).passes());
    EXPECT_FALSE(Message().heartbeat(1, max_sequence_range + 1).passes());
    EXPECT_FALSE(Message().heartbeat(0, 3).passes());
    EXPECT_FALSE(Message().heartbeat(9, 3).passes());
    EXPECT_FALSE(Message().gap(1, 2 + max_sequence_range).passes());
    EXPECT_FALSE(Message().gap(5, 4).passes());
    EXPECT_FALSE(Message().gap(1, 2, 257).passes());
    EXPECT_FALSE(Message().acknack(-1).passes());
    EXPECT_FALSE(Message().acknack(max_sequence_number + 1).passes());
    EXPECT_FALSE(Message().acknack(1, 300).passes());
    EXPECT_FALSE(Message().data(0).passes());
    EXPECT_FALSE(Message().data(max_sequence_number + 1).passes());
}

TEST(RtpsMessage, FragmentsOutsideTheirSampleAreRefused) {
    EXPECT_FALSE(Message().fragment(0, 1, 100, 150, 100).passes());
    EXPECT_FALSE(Message().fragment(3, 1, 100, 150, 100).passes());
    EXPECT_FALSE(Message().fragment(1, 2, 100, 150, 100).passes()) << "fewer bytes than fragments";
    EXPECT_FALSE(Message().fragment(1, 1, 0, 150, 100).passes());
    EXPECT_FALSE(Message().fragment(1, 1, 100, max_sample_bytes + 1, 100).passes());
    EXPECT_FALSE(Message().fragment(0xffffffff, 1, 64, 64, 64).passes());
}

// A datagram of 216 bytes with the second of these ended any program with Fast DDS 2.9.1: it copies from a
// null pointer (MessageReceiver::proc_Submsg_DataFrag).
TEST(RtpsMessage, FragmentsOfKeyAreRefused) {
    EXPECT_TRUE(Message().fragment(1, 1, 64, 128, 64).passes());
    EXPECT_FALSE(Message().fragment(1, 1, 64, 128, 64).fragment(2, 1, 64, 128, 64, 1 | 4).passes());
    EXPECT_FALSE(Message().fragment(1, 1, 64, 128, 64, 1 | 8).passes()) << "a payload of its own kind";
}

// The library's length of a payload that begins behind its submessage wraps, and it copies from behind the
// datagram. Found with the library's coverage.
TEST(RtpsMessage, PayloadBehindItsSubmessageIsRefused) {
    EXPECT_TRUE(Message().fragment(1, 1, 64, 128, 68, 1, 32).passes());
    EXPECT_FALSE(Message().fragment(1, 1, 64, 128, 64, 1, 32).passes());
    EXPECT_FALSE(Message().fragment(1, 1, 64, 128, 64, 1, 2048).passes());
    EXPECT_FALSE(
        Message().submessage(0x15, 32, 5).u16(0).u16(2048).reader().writer().number(1).zeros(12).passes());
}

// The library keeps its list of missing fragments inside the sample, at the first multiple of four bytes of
// each fragment (CacheChange_t::next_fragment_pointer).
TEST(RtpsMessage, FragmentsWithoutRoomForTheListAreRefused) {
    EXPECT_FALSE(Message().fragment(1, 1, 1, 2, 4).passes());
    EXPECT_FALSE(Message().fragment(1, 1, 60, 128, 60).passes());
    EXPECT_FALSE(Message().fragment(1, 1, 66, 128, 66).passes());
}

TEST(RtpsMessage, NonRtpsDatagramIsRefused) {
    EXPECT_FALSE(is_well_formed({}));
    auto bytes = Message().data().bytes();
    bytes[0] = 'X';
    EXPECT_FALSE(is_well_formed(bytes));
    bytes[0] = 'R';
    bytes[4] = 3;
    EXPECT_FALSE(is_well_formed(bytes)) << "another major version";
    EXPECT_FALSE(Message().submessage(0x0c, 20).zeros(20).data().passes()) << "speaks for another";
    EXPECT_FALSE(Message().submessage(0x07, 8).zeros(8).passes()) << "too short";
    EXPECT_FALSE(Message().submessage(0x15, 400).zeros(24).passes()) << "longer than the datagram";
}

TEST(RtpsMessage, DiscoveryParameterListMustBeTerminated) {
    const auto announcement = [](std::initializer_list<int> parameters) {
        Message message;
        message.submessage(0x15, static_cast<std::uint32_t>(24 + parameters.size()), 5).u16(0).u16(16);
        message.put({0, 1, 0, 0xc7}).put({0, 1, 0, 0xc2}).number(1).put({0, 3, 0, 0}).put(parameters);
        return message.passes();
    };
    EXPECT_TRUE(announcement({0x15, 0, 4, 0, 2, 3, 0, 0, 1, 0, 0, 0}));
    EXPECT_FALSE(announcement({0x15, 0, 4, 0, 2, 3, 0, 0})) << "no end";
    EXPECT_FALSE(announcement({0x15, 0, 3, 0, 2, 3, 0, 0, 1, 0, 0, 0})) << "not a multiple of four";
    EXPECT_FALSE(announcement({0x15, 0, 200, 0, 2, 3, 0, 0, 1, 0, 0, 0})) << "beyond the end";
}

/// A handshake message of one holder with one property and one binary property (DDS Security 1.1, 7.4.5).
std::vector<std::uint8_t> handshake(std::uint32_t holders, std::uint32_t properties, std::uint32_t octets) {
    Message content;
    content.put({0, 1, 0, 0}).zeros(2 * 24 + 3 * 16);
    content.u32(5).put({'a', 'u', 't', 'h', 0, 0, 0, 0}).u32(holders);
    content.u32(4).put({'r', 'e', 'q', 0}).u32(properties);
    content.u32(2).put({'a', 0, 0, 0}).u32(2).put({'b', 0, 0, 0});
    content.u32(1).u32(2).put({'c', 0, 0, 0}).u32(octets).put({1, 2, 3});
    return {content.bytes().begin() + 20, content.bytes().end()};
}

// 168 bytes that abort a secured program with Fast DDS 2.9.1, which allocates what a message counts.
TEST(RtpsMessage, HandshakeThatCountsTooMuchIsRefused) {
    EXPECT_TRUE(is_valid_stateless_message(handshake(1, 1, 3)));
    EXPECT_FALSE(is_valid_stateless_message(handshake(0xffffffff, 1, 3)));
    EXPECT_FALSE(is_valid_stateless_message(handshake(2, 1, 3))) << "the second is missing";
    EXPECT_FALSE(is_valid_stateless_message(handshake(1, 0x10000, 3)));
    EXPECT_FALSE(is_valid_stateless_message(handshake(1, 1, 0xfffffffc)));
    const auto sent = [](const std::vector<std::uint8_t>& content) {
        Message message;
        message.submessage(0x15, static_cast<std::uint32_t>(20 + content.size()), 5).u16(0).u16(16);
        message.put({0, 2, 1, 0xc4}).put({0, 2, 1, 0xc3}).number(1);
        for (const std::uint8_t byte : content) {
            message.put({byte});
        }
        return message.passes();
    };
    EXPECT_TRUE(sent(handshake(1, 1, 3)));
    EXPECT_FALSE(sent(handshake(0xffffffff, 1, 3)));
}

/// An announcement of a participant with one parameter.
Message announcement_with(std::uint32_t parameter, std::initializer_list<int> content) {
    Message message;
    const auto length = static_cast<std::uint32_t>(content.size());
    message.submessage(0x15, 20 + 4 + 4 + length + 4, 5).u16(0).u16(16);
    message.put({0, 1, 0, 0xc7}).put({0, 1, 0, 0xc2}).number(1).put({0, 3, 0, 0});
    return message.u16(parameter).u16(length).put(content).u32(1);
}

TEST(RtpsMessage, TokenThatCountsTooMuchIsRefused) {
    const auto with_properties = [](int count) {
        return announcement_with(0x1001, {2, 0, 0, 0, 'a', 0, 0, 0, count, 0, 0, 0, 0, 0, 0, 0}).passes();
    };
    EXPECT_TRUE(with_properties(0));
    EXPECT_FALSE(with_properties(1)) << "none follows";
    EXPECT_FALSE(with_properties(255));
}

// Found by fuzz-library: Fast DDS 2.9.1 appends 2^32 numbers for a parameter of four bytes.
TEST(RtpsMessage, ListThatCountsTooMuchIsRefused) {
    EXPECT_TRUE(announcement_with(0x73, {2, 0, 0, 0, 0, 0, 2, 0}).passes()) << "data representations";
    EXPECT_FALSE(announcement_with(0x73, {3, 0, 0, 0, 0, 0, 2, 0}).passes());
    EXPECT_FALSE(announcement_with(0x73, {255, 255, 255, 255}).passes());
    EXPECT_TRUE(announcement_with(0x8006, {1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8}).passes()) << "domains";
    EXPECT_FALSE(announcement_with(0x8006, {2, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8}).passes());
}

// The library goes back in the datagram by a length of 2^32 - 4, and so reads 2^32 names in one place.
TEST(RtpsMessage, PartitionNameBeyondItsEndIsRefused) {
    EXPECT_TRUE(announcement_with(0x29, {0, 0, 0, 0}).passes());
    EXPECT_TRUE(
        announcement_with(0x29, {2, 0, 0, 0, 2, 0, 0, 0, 'a', 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}).passes());
    EXPECT_FALSE(announcement_with(0x29, {2, 0, 0, 0, 2, 0, 0, 0, 'a', 0, 0, 0}).passes())
        << "one is missing";
    EXPECT_FALSE(announcement_with(0x29, {1, 0, 0, 0, 2, 0, 0, 0, 'a', 'b', 0, 0}).passes()) << "no end";
    EXPECT_FALSE(announcement_with(0x29, {1, 0, 0, 0, 9, 0, 0, 0, 'a', 0, 0, 0}).passes());
    EXPECT_FALSE(announcement_with(0x29, {255, 255, 255, 255, 252, 255, 255, 255}).passes());
}

/// The message as the library receives it.
std::vector<std::uint8_t> as_passed_on(const Message& message) {
    std::vector<std::uint8_t> out = message.bytes();
    EXPECT_TRUE(is_well_formed(message.bytes(), [&](const WriterSubmessage& written) {
        for (const Replacement& one : written.replacements) {
            EXPECT_EQ(one.place.size(), one.by.size());
            std::ranges::copy(one.by, out.begin() + (one.place.data() - message.bytes().data()));
        }
        return false;
    }));
    return out;
}

TEST(RtpsMessage, TypeDescriptionsBecomePadding) {
    const Message message = announcement_with(0x75, {1, 2, 3, 4, 5, 6, 7, 8});
    const Message padding = announcement_with(0x00, {1, 2, 3, 4, 5, 6, 7, 8});
    EXPECT_EQ(as_passed_on(message), padding.bytes());
}

// Found by fuzz-library: an assertion of Fast DDS 2.9.1 (DataReaderHistory::update_instance_nts) when the
// bitmap names a sample of which only some fragments have come.
TEST(RtpsMessage, GapIsCutOffAtItsFirstHole) {
    const auto gap = [](std::int64_t base, std::uint32_t bits, std::initializer_list<std::uint32_t> words) {
        Message message;
        message.submessage(0x08, 28 + 4 * static_cast<std::uint32_t>(words.size()));
        message.reader().writer().number(1).number(base).u32(bits);
        for (const std::uint32_t word : words) {
            message.u32(word);
        }
        return message;
    };
    EXPECT_EQ(as_passed_on(gap(3, 8, {0x39000000})), gap(3, 8, {0}).bytes()) << "names 5, 6, 7 and 10";
    EXPECT_EQ(as_passed_on(gap(3, 8, {0xf9000000})), gap(8, 8, {0}).bytes()) << "names 3 to 7, and 10";
    EXPECT_EQ(as_passed_on(gap(3, 40, {0xffffffff, 0xf0000000})), gap(39, 40, {0, 0}).bytes());
    EXPECT_EQ(as_passed_on(gap(3, 0, {})), gap(3, 0, {}).bytes());
    EXPECT_EQ(as_passed_on(gap(3, 8, {0x00ffffff})), gap(3, 8, {0x00ffffff}).bytes())
        << "bits beyond those counted name nothing";
}

TEST(RtpsMessage, GapInBigEndianIsCutOffLikewise) {
    Message message;
    message.put({0x08, 0, 0, 32}).reader().writer();
    const auto big = [&](std::initializer_list<int> words) {
        for (const int word : words) {
            message.put({0, 0, 0, word});
        }
    };
    big({0, 1, 0, 3, 8});
    message.put({0xc0, 0, 0, 0});
    auto expected = message.bytes();
    expected[expected.size() - 9] = 5;
    expected[expected.size() - 4] = 0;
    EXPECT_EQ(as_passed_on(message), expected);
}

TEST(RtpsMessage, LocatorsBeyondThisMachineAreReported) {
    constexpr std::uint32_t unicast = 0x2f, multicast = 0x30, default_unicast = 0x31, metatraffic = 0x32;
    const auto leads_elsewhere = [](std::uint32_t parameter, int kind, int a, int b, int c, int d) {
        const Message message = announcement_with(
            parameter, {kind, 0, 0, 0, 0xe8, 0x1c, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, a, b, c, d});
        bool found = false;
        EXPECT_TRUE(is_well_formed(message.bytes(), [&](const WriterSubmessage& written) {
            found = !written.distant_locators.empty();
            return false;
        }));
        return found;
    };
    for (const std::uint32_t parameter : {unicast, default_unicast, metatraffic}) {
        EXPECT_FALSE(leads_elsewhere(parameter, 1, 127, 0, 0, 1));
        EXPECT_FALSE(leads_elsewhere(parameter, 1, 127, 255, 0, 1));
        EXPECT_TRUE(leads_elsewhere(parameter, 1, 192, 0, 2, 1));
        EXPECT_TRUE(leads_elsewhere(parameter, 1, 239, 255, 0, 1)) << "a group is not one host";
        EXPECT_TRUE(leads_elsewhere(parameter, 2, 0, 0, 0, 1)) << "IPv6";
        EXPECT_TRUE(leads_elsewhere(parameter, 4, 127, 0, 0, 1)) << "TCP";
        EXPECT_FALSE(leads_elsewhere(parameter, 16, 0, 0, 0, 0)) << "shared memory";
    }
    EXPECT_FALSE(leads_elsewhere(multicast, 1, 239, 255, 0, 1));
    EXPECT_TRUE(leads_elsewhere(multicast, 1, 192, 0, 2, 1));
    EXPECT_FALSE(leads_elsewhere(0x15, 1, 192, 0, 2, 1)) << "another parameter";
}

TEST(RtpsMessage, DatagramFromRejectedWriterIsDropped) {
    const auto message = Message().acknack(1).data().bytes();
    const WriterId writer{{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, {0, 0, 1, 3}};
    EXPECT_FALSE(
        is_well_formed(message, [&](const WriterSubmessage& asked) { return asked.writer == writer; }));
    EXPECT_TRUE(
        is_well_formed(message, [&](const WriterSubmessage& asked) { return asked.writer != writer; }));
    EXPECT_TRUE(is_well_formed(Message().acknack(1).bytes(), [](const WriterSubmessage&) { return true; }))
        << "readers are not writers";
}

TEST(RtpsMessage, HeartbeatsAndGapsReportTheirHighestNumber) {
    std::vector<std::int64_t> told;
    const auto note = [&](const WriterSubmessage& written) {
        told.push_back(written.up_to);
        return false;
    };
    EXPECT_TRUE(is_well_formed(Message().data(9).heartbeat(3, 1000).gap(7, 70, 40).acknack(5).bytes(), note));
    EXPECT_EQ(told, (std::vector<std::int64_t>{0, 1000, 70}));
}

// With the address sanitizer this detects any read beyond the datagram.
TEST(RtpsMessage, MutatedDatagramsAreNotReadOutOfBounds) {
    const auto whole =
        Message().data().heartbeat(1, 5).gap(3, 9, 40).acknack(2, 33).fragment(1, 1, 92, 150, 92).bytes();
    Random random(18);
    std::size_t passed = 0;
    for (int i = 0; i < 100'000; ++i) {
        std::vector<std::uint8_t> mutant(
            whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(random.bits() % whole.size()));
        for (std::uint64_t n = random.bits() % 4; n > 0 && !mutant.empty(); --n) {
            mutant[random.bits() % mutant.size()] = static_cast<std::uint8_t>(random.bits());
        }
        passed += is_well_formed(mutant) ? 1 : 0;
    }
    EXPECT_GT(passed, 0u);
    EXPECT_LT(passed, 50'000u);
}

}  // namespace
}  // namespace eti::bus
