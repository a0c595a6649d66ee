// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/reports.hpp"

#include <algorithm>
#include <cmath>

#include "common/bus/codec/convert.hpp"

namespace eti::devices {

namespace {

using bus::from_msg;

constexpr float max_force = 1000.0f;  // [N]; a larger one is a sender's fault
constexpr float max_speed = 100.0f;   // [m/s], [rad/s]
// [ns], thirty years; later times are a sender's fault and would overflow where seconds are counted.
constexpr std::uint64_t max_simulation_ns = 1'000'000'000'000'000'000;

bool is_motion(const msg::ProxyState& m) {
    // Written so that NaN is too fast too.
    return bus::valid_pose(m.proxy()) && bus::valid_pose(m.device()) &&
           from_msg(m.velocity()).norm() < max_speed && from_msg(m.angular_velocity()).norm() < max_speed &&
           m.header().simulation_time_ns() < max_simulation_ns &&
           std::ranges::all_of(m.contacts(), [](const msg::ShellContact& c) {
               return bus::is_valid_point(c.position()) && std::isfinite(c.force()) &&
                      std::abs(from_msg(c.normal()).norm() - 1.0f) < 1e-2f;
           });
}

bool is_tissue(const msg::TissueContacts& m) {
    return from_msg(m.force()).norm() < max_force && from_msg(m.torque()).norm() < max_force &&
           std::ranges::all_of(m.contacts(),
                               [](const msg::TissueContactPoint& c) {
                                   return bus::is_valid_point(c.position()) &&
                                          bus::is_valid_point(c.rest()) &&
                                          from_msg(c.force()).norm() < max_force &&
                                          std::isfinite(c.radius()) && c.tissue() < tissue_count;
                               }) &&
           bus::valid_pose(m.proxy());
}

/// Force-weighted centre of the first `count` contacts; the mean where there is no force.
Vec3f centre_of(const std::vector<msg::ShellContact>& contacts, std::size_t count) {
    Vec3f weighted = Vec3f::Zero(), plain = Vec3f::Zero();
    float force = 0.0f;
    for (std::size_t i = 0; i < count; ++i) {
        const float weight = std::max(contacts[i].force(), 0.0f);
        weighted += weight * from_msg(contacts[i].position());
        plain += from_msg(contacts[i].position());
        force += weight;
    }
    return force > 0.0f ? Vec3f(weighted / force)
                        : Vec3f(plain / static_cast<float>(std::max<std::size_t>(count, 1)));
}

}  // namespace

bool read_report(const msg::ProxyState& message, ProxyReport& report) {
    if (!is_motion(message)) {
        return false;
    }
    report.proxy = {from_msg(message.proxy()), from_msg(message.velocity()),
                    from_msg(message.angular_velocity())};
    report.device = from_msg(message.device());
    report.contacts = std::min(message.contacts().size(), ProxyReport::max_contacts);
    for (std::size_t i = 0; i < report.contacts; ++i) {
        report.normals[i] = from_msg(message.contacts()[i].normal()).normalized();
    }
    report.contact_centre = centre_of(message.contacts(), report.contacts);
    return true;
}

bool read_report(const msg::TissueContacts& message, TissueReport& report) {
    if (!is_tissue(message)) {
        return false;
    }
    report.wrench = {from_msg(message.force()), from_msg(message.torque())};
    report.count = std::min(message.contacts().size(), TissueReport::max_points);
    for (std::size_t i = 0; i < report.count; ++i) {
        const msg::TissueContactPoint& c = message.contacts()[i];
        report.points[i] = {from_msg(c.position()), from_msg(c.rest()), c.radius(),
                            static_cast<Tissue>(c.tissue()), from_msg(c.force())};
    }
    report.represents = report.count > 0
                            ? 1.0f + static_cast<float>(message.dropped()) / static_cast<float>(report.count)
                            : 1.0f;
    report.proxy = from_msg(message.proxy());
    return true;
}

bool read_report(const msg::TubeForce& message, TissueReport& report) {
    const Wrench wrench{from_msg(message.force()), from_msg(message.torque())};
    if (!(wrench.force.norm() < max_force && wrench.torque.norm() < max_force)) {
        return false;
    }
    report.wrench = wrench;
    return true;
}

}  // namespace eti::devices
