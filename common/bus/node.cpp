// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <unistd.h>

#include <fmt/ranges.h>
#include <algorithm>
#include <atomic>
#include <charconv>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>

#include "common/bus/codec/convert.hpp"
#include "common/bus/fastdds/settings.hpp"
#include "common/bus/guard/receive_filter.hpp"
#include "common/bus/participant.hpp"
#include "common/bus/security/identity.hpp"
#include "common/bus/transport.hpp"

namespace eti::bus {

namespace {

// Within this lease a crashed process is removed and a late joiner found. With the library's own 20 s and 3
// s, a session looks alive long after it has died.
const Duration participant_lease{1.5L};
const Duration participant_announcement{0.5L};
// On a busy processor announcements are seconds late. A secured participant that only one side has given up
// stays lost: the other side takes it for authenticated still, and answers no new handshake. So does one that
// a discovery server has given up, which skips the endpoints of participants that it does not know.
const Duration longer_lease{20.0L};

void set_up_library() {
    static std::once_flag once;
    std::call_once(once, [] {
        set_up_library_log();
        // Two nodes of one process communicate as two processes do. Tests then exercise the real path, and a
        // writer never runs a reader's code on its own thread.
        turn_off_intraprocess_delivery();
    });
}

void check_names(const Options& options) {
    const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
               c == '_' || c == '.';
    };
    // A partition name with wildcards would join every matching session.
    if (options.session.empty() || options.session.size() > 48 ||
        !std::ranges::all_of(options.session, allowed)) {
        throw BusError(fmt::format("session '{}': expected 1 to 48 letters, digits, '.', '-' or '_'",
                                   options.session.substr(0, 60)));
    }
    if (options.domain < 0 || options.domain > 232) {
        throw BusError(fmt::format(
            "domain {}: expected 0 to 232 (each domain has its own UDP ports); choose another --domain",
            options.domain));
    }
}

std::string field_of(const std::string& text, std::string_view key) {
    const auto at = text.find(key);
    if (at == std::string::npos) {
        return {};
    }
    const auto from = at + key.size();
    return text.substr(from, text.find(';', from) - from);
}

// Bounds memory use on a hostile network.
constexpr std::size_t max_peers = 256;

Reach reach_of(const Options& options) {
    const bool by_server = !options.profile.empty() || !options.discovery_servers.empty();
    return this_machine_only(options) ? Reach::this_machine : by_server ? Reach::relayed : Reach::network;
}

/// Once, as a program may have several nodes. A profile may bind to whatever interfaces it likes.
void say_exposure(const Options& options) {
    static std::atomic<bool> said{false};
    if (this_machine_only(options) || !options.profile.empty() || !options.interface.empty() ||
        !options.identity.empty() || said.exchange(true)) {
        return;
    }
    const std::vector<std::string> addresses = network_addresses();
    bus_log().warn(
        "{}: anyone on the networks of this machine ({}) can read this session and send to it, forces and "
        "commands included. Remedy: a network of the lab's own (make_network.py) and its --interface, or "
        "--identity (docs/security.md)",
        reach(options),
        addresses.empty() ? std::string("none yet") : fmt::format("{}", fmt::join(addresses, ", ")));
}

ParticipantId id_of(const rtps::GuidPrefix_t& prefix) {
    ParticipantId id{};
    std::ranges::copy(prefix.value, id.begin());
    return id;
}

WriterId writer_id(const rtps::GUID_t& guid) {
    WriterId id{id_of(guid.guidPrefix), {}};
    std::ranges::copy(guid.entityId.value, id.entity.begin());
    return id;
}

/// Decodes a participant's user data, if it is a program of this project.
std::optional<Peer> introduced(const std::string& text, std::string name, const ParticipantId& id) {
    if (!text.starts_with("eti;")) {
        return std::nullopt;
    }
    const std::string started = field_of(text, ";started=");
    std::uint64_t started_ns = 0;
    std::from_chars(started.data(), started.data() + started.size(), started_ns);
    // Programs before protocol 2 did not state their protocol.
    const std::string said = field_of(text, ";protocol=");
    int spoken = 1;
    std::from_chars(said.data(), said.data() + said.size(), spoken);
    const std::string version = field_of(text, ";version=");
    Peer peer;
    peer.name = std::move(name);
    peer.session = field_of(text, ";session=");
    peer.process = field_of(text, ";process=");
    peer.protocol = spoken;
    peer.version = version.empty() ? "unknown" : version;
    peer.started = {started_ns, id};
    return peer;
}

}  // namespace

std::string process_name() {
    char host[256] = "unknown";
    ::gethostname(host, sizeof host - 1);
    const std::string pid = std::to_string(::getpid());
    return std::string(host).substr(0, 63 - pid.size()) + ":" + pid;
}

Participant::Participant(const Options& wanted)
    : options(wanted), admission_(std::make_shared<Admission>(wanted.name == server_name)) {
    check_names(options);
    set_up_library();
    auto qos = participant_qos(options, warnings_);
    apply_identity(options, qos, warnings_);
    const bool secured = !options.identity.empty();
    install_receive_filter(qos.transport().user_transports, admission_, options.profile, reach_of(options),
                           only_addresses(options), secured);
    say_exposure(options);
    auto& discovery = qos.wire_protocol().builtin.discovery_config;
    if (discovery.leaseDuration ==
        dds::PARTICIPANT_QOS_DEFAULT.wire_protocol().builtin.discovery_config.leaseDuration) {
        const bool returns = !secured && options.discovery_servers.empty();
        discovery.leaseDuration = returns ? participant_lease : longer_lease;
        discovery.leaseDuration_announcementperiod = participant_announcement;
    }
    qos.name(options.name);
    started_ns_ = wall_clock_ns();
    const std::string introduction =
        fmt::format("eti;protocol={};version={};session={};process={};started={};", protocol, ETI_VERSION,
                    options.session, process_name(), started_ns_);
    qos.user_data().data_vec({introduction.begin(), introduction.end()});

    participant = dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(options.domain), qos, this, dds::StatusMask::none());
    if (participant == nullptr) {
        throw BusError(fmt::format(
            "cannot join domain {}: its UDP ports from {} on are in use or there is no network; "
            "choose another --domain, or bring up a network interface (ip link set lo up)",
            options.domain, first_port + ports_per_domain * static_cast<std::uint32_t>(options.domain)));
    }
    dds::PublisherQos publisher_qos = dds::PUBLISHER_QOS_DEFAULT;
    const std::string partition = partition_of(options.session);
    publisher_qos.partition().push_back(partition.c_str());
    publisher = participant->create_publisher(publisher_qos);
    dds::SubscriberQos subscriber_qos = dds::SUBSCRIBER_QOS_DEFAULT;
    subscriber_qos.partition().push_back(partition.c_str());
    subscriber = participant->create_subscriber(subscriber_qos);
    if (publisher == nullptr || subscriber == nullptr) {
        close();
        throw BusError(
            fmt::format("cannot join session '{}' on domain {}: the DDS library rejected its partition; see "
                        "the lines above",
                        options.session, options.domain));
    }
    if (!this_machine_only(options) && options.interface.empty()) {
        watch_interfaces();
    }
}

/// Programs may start before the network does, and cables are plugged in later. The library announces the
/// locators that it found at the start, and an endpoint keeps its own (docs/decisions/bus-transport.md).
void Participant::watch_interfaces() {
    interfaces_.emplace([](const std::string& addresses) {
        bus_log().warn(
            "new on the network: {}; programs there do not reach this one. Remedy: restart this program",
            addresses);
    });
}

Participant::~Participant() {
    close();
}

void Participant::close() {
    interfaces_.reset();
    participant->set_listener(nullptr);
    participant->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
}

dds::Topic* Participant::topic(std::string_view name, dds::TypeSupport type) {
    const std::lock_guard lock(topics_mutex_);
    if (const auto known = topics_.find(name); known != topics_.end()) {
        return known->second;
    }
    if (participant->find_type(type.get_type_name()).empty()) {
        type.register_type(participant);
    }
    auto* made = participant->create_topic(std::string(name), type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
    if (made == nullptr) {
        throw BusError(
            fmt::format("cannot create topic {}: the DDS library rejected it; see the lines above", name));
    }
    topics_.emplace(name, made);
    return made;
}

std::pair<std::uint64_t, ParticipantId> Participant::started() const {
    return {started_ns_, id_of(participant->guid().guidPrefix)};
}

std::vector<Peer> Participant::peers() const {
    const std::lock_guard lock(peers_mutex_);
    std::vector<Peer> all;
    for (const auto& [id, peer] : peers_) {
        all.push_back(peer);
        all.back().serves = admission_->serves(id);
    }
    return all;
}

Rediscoveries Participant::rediscoveries() const {
    const std::lock_guard lock(peers_mutex_);
    const Rediscoveries& participants = gone_participants_.counts();
    return {participants.after_departure + gone_writers_.counts().after_departure,
            participants.after_silence};
}

void Participant::on_writer_liveliness(const rtps::GUID_t& writer, bool alive) {
    admission_->on_liveliness_changed(writer_id(writer), alive);
    admission_->log_changes();
}

std::vector<rtps::Locator_t> Participant::own_locators() const {
    const std::lock_guard lock(peers_mutex_);
    return own_locators_;
}

void Participant::release_ownership(std::string_view topic) {
    admission_->release_ownership(topic);
    admission_->log_changes();
}

void Participant::on_participant(const DiscoveredParticipant& found) {
    const ParticipantId id = id_of(found.prefix);
    if (found.removed()) {
        {
            const std::lock_guard lock(peers_mutex_);
            peers_.erase(id);
            gone_participants_.on_gone(id, found.change == DiscoveryChange::left);
            // The library has just reported its writers as removed; they are counted as one with it.
            gone_writers_.forget([&](const WriterId& writer) { return writer.participant == id; });
        }
        admission_->on_removed(id);
        admission_->log_changes();
        return;
    }
    const std::optional<Peer> peer = introduced(found.user_data, found.name, id);
    const bool as_server =
        peer && peer->name == server_name && peer->session == options.session && peer->protocol == protocol;
    if (found.change == DiscoveryChange::discovered) {
        const std::lock_guard lock(peers_mutex_);
        gone_participants_.on_discovered(id);
    }
    if (peer) {
        const std::lock_guard lock(peers_mutex_);
        // A newly found server takes the place of a program that is none.
        if (peers_.size() >= max_peers && as_server && !peers_.contains(id)) {
            const auto other =
                std::ranges::find_if(peers_, [](const auto& one) { return one.second.name != server_name; });
            if (other != peers_.end()) {
                peers_.erase(other);
            }
        }
        if (peers_.size() < max_peers) {
            peers_.insert_or_assign(id, *peer);
        }
    }
    admission_->on_discovered(id, peer ? fmt::format("'{}' {}", peer->name, peer->process) : "", as_server);
    admission_->log_changes();
}

bool Participant::in_session(const std::vector<std::string>& partitions) const {
    const std::string own = partition_of(options.session);
    // Partitions may be patterns; matched by fnmatch, as in the library.
    return std::ranges::any_of(partitions, [&](const std::string& name) {
        return name == own || name.find_first_of("*?[") != std::string::npos;
    });
}

void Participant::on_writer(const DiscoveredWriter& found) {
    if (found.own) {
        // The library also reports its own participant, and so the port that it found free.
        const std::lock_guard lock(peers_mutex_);
        own_locators_ = found.unicast_locators;
        return;
    }
    const WriterId writer = writer_id(found.guid);
    {
        const std::lock_guard lock(peers_mutex_);
        if (found.change == DiscoveryChange::left) {
            gone_writers_.on_gone(writer, true);
        } else if (found.change == DiscoveryChange::discovered) {
            gone_writers_.on_discovered(writer);
        }
    }
    if (found.change == DiscoveryChange::left) {
        admission_->on_removed(writer);
    } else if (in_session(found.partitions)) {
        admission_->on_discovered(writer, found.topic);
    }
    admission_->log_changes();
}

Node::Node(const Options& options) {
    auto participant = std::make_shared<Participant>(options);
    impl_.reset(new Impl{participant, {participant, options.name}});
}
Node::~Node() = default;
const Options& Node::options() const {
    return impl_->participant->options;
}
bool Node::contested() const {
    return impl_->participant->contested();
}

}  // namespace eti::bus
