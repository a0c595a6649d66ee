// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "target.hpp"

#include <optional>
#include <tuple>

#include "memory_network.hpp"
#include "tests/fuzz/reader.hpp"

namespace eti::fuzz {

using namespace bus;

namespace {

template <class Message>
struct Both {
    explicit Both(const Topic<Message>& of) : topic(of) {}

    Topic<Message> topic;
    std::optional<Publisher<Message>> publisher{};
    std::optional<Subscriber<Message>> subscriber{};
    Message message{};
    std::uint32_t published = 0;
};

/// Three datagrams of an object, and small ones of everything else.
void fill(msg::SceneDescription& scene, std::uint32_t number) {
    scene.object("object " + std::to_string(number % 4));
    scene.vertices().assign(900, 0.25F);
}
void fill(msg::SessionStatus& status, std::uint32_t) {
    status.session("fuzz");
}
void fill(auto&, std::uint32_t) {}

}  // namespace

struct Target::Endpoints {
    std::tuple<Both<msg::SceneDescription>, Both<msg::SessionStatus>, Both<msg::DeformationState>,
               Both<msg::ProxyState>, Both<msg::CommandResult>>
        server{topics::scene, topics::session_status, topics::deformation, topics::proxy,
               topics::command_result};
    std::tuple<Both<msg::Command>, Both<msg::EyePose>> client{topics::command, topics::eye_pose};

    template <class Action>
    void for_all(const Action& action) {
        std::apply([&](auto&... one) { (action(one, true), ...); }, server);
        std::apply([&](auto&... one) { (action(one, false), ...); }, client);
    }
};

Target::Target(std::string_view name, Side side, const std::filesystem::path& identity)
    : endpoints_(std::make_unique<Endpoints>()) {
    const auto before = MemoryNetwork::instance().unicast_ports();
    bus::Options options{.session = "fuzz", .name = std::string(name), .network = true};
    options.identity = identity;
    participant_ = std::make_shared<Participant>(options);
    std::vector<std::uint16_t> opened;
    std::ranges::set_difference(MemoryNetwork::instance().unicast_ports(), before,
                                std::back_inserter(opened));
    require(opened.size() == 2,
            "the participant has opened other ports than one for discovery and one for data");
    discovery_ = opened[0];
    user_ = opened[1];
    endpoints_->for_all([&](auto& one, bool of_server) {
        if (side == Side::both || (side == Side::server) == of_server) {
            one.publisher.emplace(participant_, one.topic);
        }
        if (side == Side::both || (side == Side::server) != of_server) {
            one.subscriber.emplace(participant_, one.topic);
        }
    });
}

Target::~Target() = default;

Prefix Target::prefix() const {
    return participant_->started().second;
}

void Target::receive(const Datagram& datagram) const {
    MemoryNetwork::instance().deliver(datagram.to_user_port ? user_ : discovery_, datagram.bytes);
}

void Target::take() {
    endpoints_->for_all([&](auto& one, bool) {
        if (one.subscriber) {
            (void)one.subscriber->take_latest(one.message);
        }
    });
}

void Target::publish() {
    endpoints_->for_all([&](auto& one, bool) {
        if (one.publisher) {
            auto message = decltype(one.message)();
            fill(message, one.published++);
            (void)one.publisher->publish(message);
        }
    });
}

}  // namespace eti::fuzz
