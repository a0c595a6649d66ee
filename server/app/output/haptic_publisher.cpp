// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/haptic_publisher.hpp"

namespace eti::app {

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
    newest_forces_.draft().assign(s);
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
    const HandForces* forces = nullptr;
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

void HapticPublisher::publish(const HandForces& forces) {
    msg::TissueContacts contacts = tissue_message(forces);
    contacts_.publish(contacts);
    msg::TubeForce tube = tube_message(forces);
    tube_force_.publish(tube);
}

}  // namespace eti::app
