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

#include "common/bus/codec/wire.hpp"
#include "common/bus/participant.hpp"
#include "common/bus/security/identity.hpp"
#include "common/bus/transport.hpp"

namespace eti::bus {

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

const Duration liveliness_lease{0.3L};
// Longest time that a reliable write waits for a stuck reader.
const Duration max_blocking{0.02L};
// Repair of lost samples: the library's heartbeat period of 3 s would show as a stall. Heartbeats are sent
// only while a reader has not acknowledged everything.
const Duration heartbeat_period{0.02L};
const Duration repair_delay{0.001L};
// Instances that a reader keeps; the library's default of 10 rejects the eleventh object of a scene.
constexpr std::int32_t max_instances_kept = 256;

template <class EndpointQos>
void apply(const Qos& wanted, bool keyed, EndpointQos& qos) {
    qos.reliability().kind =
        wanted.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.reliability().max_blocking_time = max_blocking;
    qos.durability().kind =
        wanted.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
    qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = wanted.depth;
    auto& limits = qos.resource_limits();
    limits.max_instances = keyed ? max_instances_kept : 1;
    limits.max_samples_per_instance = wanted.depth;
    limits.max_samples = limits.max_instances * wanted.depth;
    limits.allocated_samples = std::min(limits.max_samples, 16);
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    qos.data_sharing().off();  // rejects keyed types, and its files outlive a killed writer
    if (wanted.manual_liveliness) {
        qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
        qos.liveliness().lease_duration = liveliness_lease;
    }
}

/// Lets a reader receive the multicast copy that all readers of the topic share, where possible.
void share(const Participant& participant, std::string_view topic, dds::DataReaderQos& qos) {
    const auto place =
        std::ranges::find(topics::all, topic, &TopicWriterPolicy::name) - std::begin(topics::all);
    const auto shared = multicast_locator(participant.options, static_cast<std::size_t>(place));
    // A reader with its own locator list has no default locator for when it is the only reader.
    const auto alone = participant.own_locators();
    if (!shared || alone.empty()) {
        return;
    }
    qos.endpoint().multicast_locator_list.push_back(*shared);
    for (const auto& locator : alone) {
        qos.endpoint().unicast_locator_list.push_back(locator);
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
    dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
    apply(topic.qos, is_keyed(*type.get()), qos);
    if (topic.qos.manual_liveliness) {
        qos.liveliness().announcement_period = Duration{0.1L};
    }
    set_repair(qos.reliable_writer_qos().times, heartbeat_period, repair_delay);
    impl_->writer = impl_->participant->publisher->create_datawriter(
        impl_->participant->topic(topic.name, type), qos, nullptr, dds::StatusMask::none());
    if (impl_->writer == nullptr) {
        throw BusError(endpoint_creation_error(impl_->participant->options, topic.name, true));
    }
}

template <class Message>
Publisher<Message>::~Publisher() = default;
template <class Message>
Publisher<Message>::Publisher(Publisher&&) noexcept = default;

template <class Message>
bool Publisher<Message>::publish(const Message& message) {
    return within_bounds(message) && write_sample(*impl_->writer, &message);
}

template <class Message>
int Publisher<Message>::matched() const {
    dds::PublicationMatchedStatus status;
    return succeeded(impl_->writer->get_publication_matched_status(status)) ? status.current_count : 0;
}

template <class Message>
void Publisher<Message>::assert_liveliness() {
    impl_->writer->assert_liveliness();
}

template <class Message>
bool Publisher<Message>::wait_until_received(std::chrono::milliseconds timeout) {
    const Duration longest(static_cast<long double>(timeout.count()) * 1e-3L);
    return succeeded(impl_->writer->wait_for_acknowledgments(longest));
}

struct WaitSet::Impl {
    void notify() {
        {
            const std::lock_guard lock(mutex);
            notified = true;
        }
        changed.notify_one();
    }

    std::mutex mutex;
    std::condition_variable changed;
    bool notified = false;
};

WaitSet::WaitSet() : impl_(std::make_unique<Impl>()) {}
WaitSet::~WaitSet() = default;

bool WaitSet::wait(std::chrono::milliseconds timeout) {
    std::unique_lock lock(impl_->mutex);
    return impl_->changed.wait_for(lock, timeout, [this] { return std::exchange(impl_->notified, false); });
}

namespace {

/// Called on the library's threads, where it only wakes the waiting thread and forwards liveliness changes.
class ReaderListener final : public dds::DataReaderListener {
  public:
    explicit ReaderListener(Participant& participant) : participant_(participant) {}

    void notify(WaitSet::Impl& wait_set) { wait_set_ = &wait_set; }

    void on_data_available(dds::DataReader* /*reader*/) override { wait_set_->notify(); }

    void on_liveliness_changed(dds::DataReader* /*reader*/,
                               const dds::LivelinessChangedStatus& status) override {
        const auto writer = rtps::iHandle2GUID(status.last_publication_handle);
        participant_.on_writer_liveliness(writer, status.alive_count_change > 0);
    }

  private:
    Participant& participant_;
    WaitSet::Impl* wait_set_ = nullptr;
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
    Message newest;  // kept to save allocations

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
    if (topic.qos.manual_liveliness) {
        impl_->mask = dds::StatusMask::liveliness_changed();
    }
    impl_->manual_liveliness = topic.qos.manual_liveliness;
    const dds::TypeSupport type(new typename Wire<Message>::Type());
    dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
    apply(topic.qos, is_keyed(*type.get()), qos);
    set_repair(qos.reliable_reader_qos().times, repair_delay);
    if (impl_->participant->options.shared_multicast && !topic.qos.reliable) {
        share(*impl_->participant, topic.name, qos);
    }
    impl_->reader = impl_->participant->subscriber->create_datareader(
        impl_->participant->topic(topic.name, type), qos, &impl_->listener, impl_->mask);
    if (impl_->reader == nullptr) {
        throw BusError(endpoint_creation_error(impl_->participant->options, topic.name, false));
    }
}

template <class Message>
Subscriber<Message>::~Subscriber() = default;
template <class Message>
Subscriber<Message>::Subscriber(Subscriber&&) noexcept = default;

template <class Message>
bool Subscriber<Message>::take(Message& message) {
    dds::SampleInfo info;
    // Skip samples without data (a writer left).
    while (succeeded(impl_->reader->take_next_sample(&message, &info))) {
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
    // Bounded, so that a writer faster than this loop cannot block it.
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
        Duration{static_cast<long double>(timeout.count()) * 1e-3L});
}

template <class Message>
void Subscriber<Message>::notify(WaitSet& wait_set) {
    impl_->listener.notify(wait_set.impl());
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
void Subscriber<Message>::release_ownership() {
    impl_->participant->release_ownership(impl_->topic);
}

template <class Message>
int Subscriber<Message>::matched() const {
    dds::SubscriptionMatchedStatus status;
    return succeeded(impl_->reader->get_subscription_matched_status(status)) ? status.current_count : 0;
}

template <class Message>
bool Subscriber<Message>::alive() const {
    if (!impl_->manual_liveliness) {
        return matched() > 0;
    }
    dds::LivelinessChangedStatus status;
    return succeeded(impl_->reader->get_liveliness_changed_status(status)) && status.alive_count > 0;
}

#define ETI_ENDPOINTS(name)              \
    template class Publisher<msg::name>; \
    template class Subscriber<msg::name>;
ETI_MESSAGES(ETI_ENDPOINTS)
#undef ETI_ENDPOINTS

}  // namespace eti::bus
