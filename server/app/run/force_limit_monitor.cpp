// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/force_limit_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/metrics/attempt.hpp"

namespace eti::app {

namespace {

std::string when(const scene::Snapshot& snapshot, std::string_view stage) {
    const double time = 1e-9 * static_cast<double>(snapshot.time_ns);
    return stage.empty() ? fmt::format("at {:.1f} s", time)
                         : fmt::format("at {:.1f} s, in stage '{}' of the laryngoscope,", time, stage);
}

/// [N], of the shell's contacts on the lower gum.
float on_lower_gum(const scene::Snapshot& snapshot) {
    float force = 0.0f;
    for (const rigid::Contact& contact : snapshot.shell_contacts) {
        force += contact.tissue == Tissue::lower_gum ? contact.force : 0.0f;
    }
    return force;
}

}  // namespace

std::string ForceLimitMonitor::check(const scene::Snapshot& s, std::string_view stage) {
    // Without contact, a distance only means that the hand is faster than the scene.
    const float apart = (s.device.translation - s.proxy.translation).norm();
    if (!parted_ && apart > farthest && !s.shell_contacts.empty()) {
        parted_ = true;
        const auto& most = *std::ranges::max_element(s.shell_contacts, {}, &rigid::Contact::force);
        return fmt::format(
            "{} the hand is {:.0f} mm from the constrained laryngoscope ({}, {:.0f} N), expected at most "
            "{:.0f} mm: the path leads through the patient; add earlier stages that go around",
            when(s, stage), 1e3f * apart, name_of(most.tissue), most.force, 1e3f * farthest);
    }
    const double gum = metrics::tissue_forces(s).gum;
    if (!pressed_ && gum > hardest) {
        pressed_ = true;
        return fmt::format(
            "{} the force is {:.0f} N on the upper gum and {:.0f} N on the lower gum, expected at most "
            "{:.0f} N: the blade levers between them; lift along the handle, and rotate the blade only where "
            "it is clear of the gums",
            when(s, stage), gum, on_lower_gum(s), hardest);
    }
    return {};
}

}  // namespace eti::app
