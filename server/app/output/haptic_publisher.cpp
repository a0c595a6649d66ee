// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/haptic_publisher.hpp"

#include <algorithm>

#include "common/bus/codec/convert.hpp"
#include "server/app/output/scene_messages.hpp"

namespace eti::app {

namespace {

using bus::make_header;
using bus::to_msg;

}  // namespace

HapticPublisher::HapticPublisher(bus::Node& node)
    : proxy_(node, bus::topics::proxy),
      contacts_(node, bus::topics::tissue_contacts),
      tube_force_(node, bus::topics::tube_force),
      thread_([this] { run(); }) {}

HapticPublisher::~HapticPublisher() {
    finish();
}

void HapticPublisher::post_proxy(const scene::ProxySnapshot& proxy) {
    skipped_ += newest_proxy_.write(proxy) ? 1 : 0;
    posted_.release();
}

void HapticPublisher::post_visible_proxy(const scene::ProxySnapshot& proxy) {
    scene::ProxySnapshot seen = proxy;
    seen.device.translation += Vec3f(0.0f, -5.0f, 0.0f);
    post_proxy(seen);
}

void HapticPublisher::post_forces(const scene::Snapshot& s) {
    Forces& f = newest_forces_.draft();
    f.step = s.step;
    f.time_ns = s.time_ns;
    f.proxy = s.proxy;
    f.tissue_force = s.tissue_force;
    f.tissue_torque = s.tissue_torque;
    f.tube_force = s.tube_force;
    f.tube_torque = s.tube_torque;
    f.contacts = s.tissue_contacts;
    newest_forces_.post();
    posted_.release();
}

void HapticPublisher::finish() {
    if (thread_.joinable()) {
        ending_.store(true, std::memory_order_release);
        posted_.release();
        thread_.join();
    }
}

void HapticPublisher::run() {
    const scene::ProxySnapshot* proxy = nullptr;
    const Forces* forces = nullptr;
    for (bool ending = false; !ending;) {
        posted_.acquire();
        ending =
            ending_.load(std::memory_order_acquire);  // before the mailboxes, so that none is left unread
        if (newest_proxy_.read(proxy)) {
            publish(*proxy);
        }
        if (newest_forces_.read(forces)) {
            publish(*forces);
        }
    }
}

void HapticPublisher::publish(const scene::ProxySnapshot& s) {
    msg::ProxyState message = proxy_message(s);
    proxy_.publish(message);
}

void HapticPublisher::publish(const Forces& s) {
    msg::TissueContacts contacts;
    contacts.header(make_header(s.time_ns, static_cast<std::uint32_t>(s.step)));
    contacts.proxy(to_msg(s.proxy));
    contacts.force(to_msg(s.tissue_force));
    contacts.torque(to_msg(s.tissue_torque));
    const std::size_t sent = std::min(msg::bound::TissueContacts_contacts, s.contacts.size());
    contacts.dropped(static_cast<std::uint32_t>(s.contacts.size() - sent));
    // A uniform subset of all contacts, so that a bounded message still covers the whole blade.
    for (std::size_t i = 0; i < sent; ++i) {
        const scene::TissueContact& t = s.contacts[i * s.contacts.size() / sent];
        msg::TissueContactPoint c;
        c.position(to_msg(t.position));
        c.rest(to_msg(t.rest));
        c.force(to_msg(t.force));
        c.radius(t.radius);
        c.tissue(static_cast<std::uint32_t>(t.tissue));
        contacts.contacts().push_back(c);
    }
    contacts_.publish(contacts);

    msg::TubeForce tube;
    tube.header(contacts.header());
    tube.force(to_msg(s.tube_force));
    tube.torque(to_msg(s.tube_torque));
    tube_force_.publish(tube);
}

}  // namespace eti::app
