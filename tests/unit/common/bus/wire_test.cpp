// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/wire.hpp"

#include <algorithm>
#include <cstring>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <span>

#include "bus_fixture.hpp"
#include "common/bus/participant.hpp"
#include "common/math/random.hpp"
#include "messages.hpp"

namespace eti::bus {
namespace {

using rtps::SerializedPayload_t;

/// The serialised bytes of `message`.
template <class Type>
std::vector<std::uint8_t> bytes_of(typename Type::Message message) {
    Type type;
    SerializedPayload_t payload(type.size_of(&message));
    EXPECT_TRUE(type.write(&message, payload));
    return {payload.data, payload.data + payload.length};
}

template <class Type>
bool reads(const std::vector<std::uint8_t>& bytes) {
    Type type;
    typename Type::Message message;
    SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
    std::ranges::copy(bytes, payload.data);
    payload.length = static_cast<std::uint32_t>(bytes.size());
    return type.read(payload, &message);
}

template <class Generated>
class Malformed : public ::testing::Test {};

/// All message types, without the trailing comma of a macro list.
template <class, class... Generated>
using Listed = ::testing::Types<Generated...>;
#define ETI_GENERATED(name) , msg::name##PubSubType
using Types = Listed<void ETI_MESSAGES(ETI_GENERATED)>;
#undef ETI_GENERATED
TYPED_TEST_SUITE(Malformed, Types);

TYPED_TEST(Malformed, EveryTruncationIsRefused) {
    using Type = WireType<TypeParam>;
    const auto whole = bytes_of<Type>(example<typename Type::Message>());
    ASSERT_TRUE(reads<Type>(whole));
    for (std::size_t length = 0; length < whole.size(); ++length) {
        // Up to three bytes of padding may follow the last member.
        if (length + 4 <= whole.size()) {
            EXPECT_FALSE(reads<Type>({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)}))
                << length;
        }
    }
}

TYPED_TEST(Malformed, NoiseNeitherThrowsNorOverallocates) {
    using Type = WireType<TypeParam>;
    const auto whole = bytes_of<Type>(example<typename Type::Message>());
    Random random(7);
    int refused = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        auto bytes = whole;
        for (int flips = 0; flips < 4; ++flips) {
            bytes[random.bits() % bytes.size()] = static_cast<std::uint8_t>(random.bits());
        }
        // Damaged lengths are the most dangerous: also overwrite a whole word with a huge number.
        const std::uint32_t huge = trial % 2 == 0 ? 0xffffffffu : 0x7fffffffu;
        const std::size_t word = 4 * (random.bits() % (bytes.size() / 4));
        std::memcpy(bytes.data() + word, &huge, sizeof huge);
        refused += reads<Type>(bytes) ? 0 : 1;
    }
    std::vector<std::uint8_t> noise(4096);
    for (int trial = 0; trial < 300; ++trial) {
        for (auto& byte : noise) {
            byte = static_cast<std::uint8_t>(random.bits());
        }
        refused += reads<Type>(noise) ? 0 : 1;
    }
    EXPECT_GT(refused, 0) << "the noise never met a member that can be malformed";
}

TEST(MalformedDescription, ExcessiveKeyCountIsNotAllocated) {
    using Type = WireType<msg::SessionDescriptionPubSubType>;
    auto message = example<msg::SessionDescription>();
    message.live().clear();
    message.parameters().clear();
    message.landmarks().clear();
    message.tissues().clear();
    message.laryngoscope().clear();
    auto bytes = bytes_of<Type>(message);
    ASSERT_TRUE(reads<Type>(bytes));
    const float weight = message.patient_weight_kg();
    const auto found =
        std::ranges::search(bytes, std::span(reinterpret_cast<const std::uint8_t*>(&weight), 4));
    ASSERT_FALSE(found.empty());
    const auto count_at = static_cast<std::size_t>(found.end() - bytes.begin());
    for (const std::uint32_t count : {65u, 0xfffffff0u}) {
        std::memcpy(bytes.data() + count_at, &count, sizeof count);
        EXPECT_FALSE(reads<Type>(bytes)) << count;
    }
}

TEST(MalformedBounds, OverlongSequencesAreRefused) {
    auto contacts = example<msg::TissueContacts>();
    contacts.contacts().emplace_back();
    EXPECT_FALSE(reads<WireType<msg::TissueContactsPubSubType>>(
        bytes_of<WireType<msg::TissueContactsPubSubType>>(contacts)));
    auto fluid = example<msg::FluidState>();
    fluid.places().push_back(0);
    EXPECT_FALSE(
        reads<WireType<msg::FluidStatePubSubType>>(bytes_of<WireType<msg::FluidStatePubSubType>>(fluid)));
    auto status = example<msg::SessionStatus>();
    status.phase(static_cast<msg::SessionPhase>(17));
    EXPECT_FALSE(reads<WireType<msg::SessionStatusPubSubType>>(
        bytes_of<WireType<msg::SessionStatusPubSubType>>(status)));
}

/// Writes bytes as they are under the name of another type: what a hostile or older program may send.
class RawType : public PortableType<msg::SessionStatusPubSubType> {
  public:
    bool write(const void* data, SerializedPayload_t& payload) override {
        const auto& bytes = *static_cast<const std::vector<std::uint8_t>*>(data);
        std::memcpy(payload.data, bytes.data(), bytes.size());
        payload.length = static_cast<std::uint32_t>(bytes.size());
        return true;
    }
    std::uint32_t size_of(const void* data) override {
        return static_cast<std::uint32_t>(static_cast<const std::vector<std::uint8_t>*>(data)->size());
    }
    bool key_of(const void*, rtps::InstanceHandle_t& handle, bool) override {
        handle.value[0] = 1;
        return true;
    }
};

TEST(MalformedSample, IsDroppedAndNextValidSampleIsRead) {
    // A server, because no reader subscribes to any other program's status.
    const Options wanted = options("eti-server");
    Participant hostile(wanted);
    const dds::TypeSupport raw(new RawType);
    dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
    qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.history().depth = 100;
    qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
    qos.liveliness().lease_duration = Duration(0.3L);
    qos.liveliness().announcement_period = Duration(0.1L);
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
    qos.data_sharing().off();
    auto* writer = hostile.publisher->create_datawriter(hostile.topic(topics::session_status.name, raw), qos);
    ASSERT_NE(writer, nullptr);

    Node victim(options("victim"));
    Subscriber<msg::SessionStatus> subscriber(victim, topics::session_status);
    ASSERT_TRUE(eventually([&] { return subscriber.matched() == 1; }));

    const auto good = bytes_of<WireType<msg::SessionStatusPubSubType>>(example<msg::SessionStatus>());
    Random random(3);
    msg::SessionStatus received;
    for (int i = 0; i < 40; ++i) {
        auto bytes = good;
        bytes.resize(8 + random.bits() % (good.size() - 16));
        bytes[random.bits() % bytes.size()] = static_cast<std::uint8_t>(random.bits());
        EXPECT_TRUE(write_sample(*writer, &bytes));
        EXPECT_FALSE(subscriber.take(received));
    }
    std::this_thread::sleep_for(100ms);
    EXPECT_FALSE(subscriber.take(received));
    auto last = good;
    ASSERT_TRUE(write_sample(*writer, &last));
    EXPECT_TRUE(eventually([&] { return subscriber.take(received); }));
    EXPECT_TRUE(received == example<msg::SessionStatus>());
    hostile.publisher->delete_datawriter(writer);
}

}  // namespace
}  // namespace eti::bus
