// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <condition_variable>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <mutex>
#include <utility>

#include "common/bus/identity.hpp"
#include "common/bus/participant.hpp"
#include "common/bus/transport.hpp"
#include "common/bus/wire.hpp"

namespace eti::bus {

using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::types::ReturnCode_t;

namespace {

template <class Message>
struct Wire;
#define ETI_WIRE(name)                                \
    template <>                                       \
    struct Wire<msg::name> {                          \
        using Type = WireType<msg::name##PubSubType>; \
    };
ETI_MESSAGES(ETI_WIRE)
#undef ETI_WIRE

const Duration_t liveliness_lease{0.3L};
// A reliable write waits at most this long for a stuck reader.
const Duration_t max_blocking{0.02L};
// Repair of what was lost: the library's 3 s heartbeat would show as a stall. Heartbeats are sent only
// while a reader has not acknowledged everything.
const Duration_t heartbeat_period{0.02L};
const Duration_t repair_delay{0.001L};
// Keys a reader keeps; the library's default of 10 refuses the eleventh object of a scene.
constexpr std::int32_t most_instances = 256;

template <class Qos>
void apply(const Quality& wanted, bool keyed, Qos& quality) {
    quality.reliability().kind =
        wanted.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
    quality.reliability().max_blocking_time = max_blocking;
    quality.durability().kind =
        wanted.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
    quality.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    quality.history().depth = wanted.depth;
    auto& limits = quality.resource_limits();
    limits.max_instances = keyed ? most_instances : 1;
    limits.max_samples_per_instance = wanted.depth;
    limits.max_samples = limits.max_instances * wanted.depth;
    limits.allocated_samples = std::min(limits.max_samples, 16);
    quality.endpoint().history_memory_policy =
        eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    quality.data_sharing().off();  // refuses keyed types, and its files outlive a killed writer
    if (wanted.manual_liveliness) {
        quality.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
        quality.liveliness().lease_duration = liveliness_lease;
    }
}

/// Has a reader take the copy that all who share the topic get, where they can.
void share(const Participant& participant, std::string_view topic, dds::DataReaderQos& quality) {
    const auto place = std::ranges::find(topics::all, topic, &TopicSource::name) - std::begin(topics::all);
    const auto shared = shared_locator(participant.options, static_cast<std::size_t>(place));
    // With a list of its own a reader has no default for when it is the only one.
    const auto alone = participant.own_locators();
    if (!shared || alone.empty()) {
        return;
    }
    quality.endpoint().multicast_locator_list.push_back(*shared);
    for (const auto& locator : alone) {
        quality.endpoint().unicast_locator_list.push_back(locator);
    }
}

}  // namespace

template <class Message>
struct Publisher<Message>::Impl {
    std::shared_ptr<Participant> participant;
    dds::DataWriter* writer = nullptr;

    ~Impl() {
        if (writer != nullptr) {
            participant->publisher->delete_datawriter(writer);
        }
    }
};

template <class Message>
Publisher<Message>::Publisher(Node& node, const Topic<Message>& topic)
    : Publisher(node.impl().participant, topic) {}

template <class Message>
Publisher<Message>::Publisher(std::shared_ptr<Participant> participant, const Topic<Message>& topic)
    : impl_(std::make_unique<Impl>()) {
    impl_->participant = std::move(participant);
    const dds::TypeSupport type(new typename Wire<Message>::Type());
    dds::DataWriterQos quality = dds::DATAWRITER_QOS_DEFAULT;
    apply(topic.quality, type->m_isGetKeyDefined, quality);
    if (topic.quality.manual_liveliness) {
        quality.liveliness().announcement_period = Duration_t{0.1L};
    }
    auto& times = quality.reliable_writer_qos().times;
    times.heartbeatPeriod = heartbeat_period;
    times.nackResponseDelay = repair_delay;
    impl_->writer = impl_->participant->publisher->create_datawriter(
        impl_->participant->topic(topic.name, type), quality, nullptr, dds::StatusMask::none());
    if (impl_->writer == nullptr) {
        throw BusError(endpoint_refused(impl_->participant->options, topic.name, true));
    }
}

template <class Message>
Publisher<Message>::~Publisher() = default;
template <class Message>
Publisher<Message>::Publisher(Publisher&&) noexcept = default;

template <class Message>
bool Publisher<Message>::publish(const Message& message) {
    return within_bounds(message) && impl_->writer->write(const_cast<Message*>(&message));
}

template <class Message>
int Publisher<Message>::matched() const {
    dds::PublicationMatchedStatus status;
    return impl_->writer->get_publication_matched_status(status) == ReturnCode_t::RETCODE_OK
               ? status.current_count
               : 0;
}

template <class Message>
void Publisher<Message>::assert_liveliness() {
    impl_->writer->assert_liveliness();
}

template <class Message>
bool Publisher<Message>::wait_until_received(std::chrono::milliseconds timeout) {
    const Duration_t longest(static_cast<long double>(timeout.count()) * 1e-3L);
    return impl_->writer->wait_for_acknowledgments(longest) == ReturnCode_t::RETCODE_OK;
}

struct Bell::Impl {
    void ring() {
        {
            const std::lock_guard lock(mutex);
            rung = true;
        }
        changed.notify_one();
    }

    std::mutex mutex;
    std::condition_variable changed;
    bool rung = false;
};

Bell::Bell() : impl_(std::make_unique<Impl>()) {}
Bell::~Bell() = default;

bool Bell::wait(std::chrono::milliseconds timeout) {
    std::unique_lock lock(impl_->mutex);
    return impl_->changed.wait_for(lock, timeout, [this] { return std::exchange(impl_->rung, false); });
}

namespace {

/// The library calls it on its own threads, where it does no more than wake the one that waits and pass on
/// who is heard.
class ReaderListener final : public dds::DataReaderListener {
  public:
    explicit ReaderListener(Participant& participant) : participant_(participant) {}

    void ring(Bell::Impl& bell) { bell_ = &bell; }

    void on_data_available(dds::DataReader* /*reader*/) override { bell_->ring(); }

    void on_liveliness_changed(dds::DataReader* /*reader*/,
                               const dds::LivelinessChangedStatus& status) override {
        const auto writer = eprosima::fastrtps::rtps::iHandle2GUID(status.last_publication_handle);
        participant_.heard(writer, status.alive_count_change > 0);
    }

  private:
    Participant& participant_;
    Bell::Impl* bell_ = nullptr;
};

}  // namespace

template <class Message>
struct Subscriber<Message>::Impl {
    explicit Impl(std::shared_ptr<Participant> its_participant)
        : participant(std::move(its_participant)), listener(*participant) {}

    std::shared_ptr<Participant> participant;
    ReaderListener listener;
    dds::DataReader* reader = nullptr;
    dds::StatusMask mask = dds::StatusMask::none();
    std::string_view topic;
    ParticipantId sender{};
    std::uint64_t received_ns = 0;
    bool manual_liveliness = false;
    Message newest;  // kept to spare allocations

    ~Impl() {
        if (reader != nullptr) {
            reader->set_listener(nullptr, dds::StatusMask::none());
            participant->subscriber->delete_datareader(reader);
        }
    }
};

template <class Message>
Subscriber<Message>::Subscriber(Node& node, const Topic<Message>& topic)
    : Subscriber(node.impl().participant, topic) {}

template <class Message>
Subscriber<Message>::Subscriber(std::shared_ptr<Participant> participant, const Topic<Message>& topic)
    : impl_(std::make_unique<Impl>(std::move(participant))) {
    impl_->topic = topic.name;
    if (topic.quality.manual_liveliness) {
        impl_->mask = dds::StatusMask::liveliness_changed();
    }
    impl_->manual_liveliness = topic.quality.manual_liveliness;
    const dds::TypeSupport type(new typename Wire<Message>::Type());
    dds::DataReaderQos quality = dds::DATAREADER_QOS_DEFAULT;
    apply(topic.quality, type->m_isGetKeyDefined, quality);
    quality.reliable_reader_qos().times.heartbeatResponseDelay = repair_delay;
    if (impl_->participant->options.one_of_many && !topic.quality.reliable) {
        share(*impl_->participant, topic.name, quality);
    }
    impl_->reader = impl_->participant->subscriber->create_datareader(
        impl_->participant->topic(topic.name, type), quality, &impl_->listener, impl_->mask);
    if (impl_->reader == nullptr) {
        throw BusError(endpoint_refused(impl_->participant->options, topic.name, false));
    }
}

template <class Message>
Subscriber<Message>::~Subscriber() = default;
template <class Message>
Subscriber<Message>::Subscriber(Subscriber&&) noexcept = default;

template <class Message>
bool Subscriber<Message>::take(Message& message) {
    dds::SampleInfo info;
    // Samples without data (a writer went away) are passed over.
    while (impl_->reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
        if (info.valid_data) {
            std::ranges::copy(info.sample_identity.writer_guid().guidPrefix.value, impl_->sender.begin());
            impl_->received_ns = static_cast<std::uint64_t>(info.reception_timestamp.to_ns());
            return true;
        }
    }
    return false;
}

template <class Message>
bool Subscriber<Message>::take_latest(Message& message) {
    // Bounded, so that a writer faster than this loop cannot hold it.
    constexpr int most = 4096;
    bool any = false;
    for (int taken = 0; taken < most && take(impl_->newest); ++taken) {
        std::swap(message, impl_->newest);
        any = true;
    }
    return any;
}

template <class Message>
bool Subscriber<Message>::wait(std::chrono::milliseconds timeout) {
    return impl_->reader->wait_for_unread_message(
        Duration_t{static_cast<long double>(timeout.count()) * 1e-3L});
}

template <class Message>
void Subscriber<Message>::ring(Bell& bell) {
    impl_->listener.ring(bell.impl());
    impl_->mask << dds::StatusMask::data_available();
    impl_->reader->set_listener(&impl_->listener, impl_->mask);
}

template <class Message>
const ParticipantId& Subscriber<Message>::sender() const {
    return impl_->sender;
}

template <class Message>
std::uint64_t Subscriber<Message>::received_ns() const {
    return impl_->received_ns;
}

template <class Message>
void Subscriber<Message>::let_go() {
    impl_->participant->let_go(impl_->topic);
}

template <class Message>
int Subscriber<Message>::matched() const {
    dds::SubscriptionMatchedStatus status;
    return impl_->reader->get_subscription_matched_status(status) == ReturnCode_t::RETCODE_OK
               ? status.current_count
               : 0;
}

template <class Message>
bool Subscriber<Message>::alive() const {
    if (!impl_->manual_liveliness) {
        return matched() > 0;
    }
    dds::LivelinessChangedStatus status;
    return impl_->reader->get_liveliness_changed_status(status) == ReturnCode_t::RETCODE_OK &&
           status.alive_count > 0;
}

#define ETI_ENDPOINTS(name)              \
    template class Publisher<msg::name>; \
    template class Subscriber<msg::name>;
ETI_MESSAGES(ETI_ENDPOINTS)
#undef ETI_ENDPOINTS

}  // namespace eti::bus
