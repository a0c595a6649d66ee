// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/scene_messages.hpp"

#include <algorithm>

#include "common/bus/codec/convert.hpp"
#include "common/bus/codec/fluid_state.hpp"
#include "common/bus/codec/frame_pose.hpp"
#include "common/bus/codec/scene_object.hpp"
#include "common/bus/security/session_keys.hpp"
#include "common/model/pace.hpp"

namespace eti::app {

namespace {

using bus::make_header;
using bus::to_msg;

// Number of states within which every frame is sent again, for late joiners and lost chunks.
constexpr std::uint32_t refresh_states = 45;
// 24 bytes per frame; the first chunk also carries the tube's nodes. Each chunk fits in 1300 bytes.
constexpr std::size_t frames_per_chunk = msg::bound::DeformationState_frames;
constexpr std::size_t frames_in_first_chunk = 24;

}  // namespace

msg::SessionDescription description_message(const std::string& session, const Scenario& scenario,
                                            const patient::Patient& patient, const Laryngoscope& scope,
                                            const RuntimeParameters& start) {
    msg::SessionDescription message;
    message.session(session);
    message.header(make_header(0, 0));
    message.version(ETI_VERSION);
    message.scenario(scenario.name);
    message.description(scenario.description);
    message.scenario_text(scenario.text);
    message.steps_per_second(steps_per_second);
    message.time_limit_s(scenario.time_limit);
    message.patient_weight_kg(patient.weight);
    bus::set_keys(start, message);
    bus::set_tools(scope, scenario.tube, message);
    message.liquid(std::string(name_of(scenario.liquid)));
    for (std::size_t i = 0; i < landmark_count; ++i) {
        msg::LandmarkKey& key = message.landmarks().emplace_back();
        key.name(std::string(landmark_names[i]));
        key.rest(to_msg(patient.landmarks[i].rest));
    }
    return message;
}

std::vector<msg::SceneDescription> scene_messages(const patient::Patient& patient,
                                                  const Laryngoscope& scope) {
    std::vector<msg::SceneDescription> objects{bus::encode_frames(patient.frame_rest_centre)};
    for (const Surface& surface : patient.surfaces) {
        objects.push_back(bus::encode_surface(surface));
    }
    objects.push_back(bus::encode_laryngoscope(laryngoscope_mesh(scope)));
    for (msg::SceneDescription& o : objects) {
        o.object_count(static_cast<std::uint32_t>(objects.size()));
        o.header(make_header(0, 0));
    }
    return objects;
}

msg::LiveMetrics live_message(const scene::Snapshot& snapshot, const AttemptStatus& live) {
    msg::LiveMetrics message;
    message.header(make_header(snapshot.time_ns, static_cast<std::uint32_t>(snapshot.step)));
    message.attempt(live.attempt);
    message.attempt_running(live.attempt_running);
    bus::set_measures(live.measures, message);
    message.tube_place(static_cast<msg::TubePlace>(live.tube_place));
    const std::size_t around =
        std::min(msg::bound::LiveMetrics_glottis_contour, snapshot.glottis_contour.size());
    for (std::size_t i = 0; i < around; ++i) {
        message.glottis_contour().push_back(to_msg(snapshot.glottis_contour[i]));
    }
    message.tube_tip(to_msg(snapshot.tube_nodes.empty() ? Vec3f(Vec3f::Zero()) : snapshot.tube_nodes.back()));
    bus::set_runtime_parameters(snapshot.runtime_parameters, message);
    for (const Vec3f& p : snapshot.landmarks) {
        message.landmarks().push_back(to_msg(p));
    }
    message.parameters(bus::to_msg(live.metrics));
    message.eye_heard(live.eye.has_value());
    message.eye(to_msg(live.eye.value_or(RigidTransform{})));
    message.message(live.message);
    return message;
}

msg::ProxyState proxy_message(const scene::ProxySnapshot& s) {
    msg::ProxyState message;
    message.header(make_header(s.time_ns, static_cast<std::uint32_t>(s.step)));
    message.device(to_msg(s.device));
    message.proxy(to_msg(s.proxy));
    message.velocity(to_msg(s.proxy_velocity));
    message.angular_velocity(to_msg(s.proxy_angular_velocity));
    for (std::size_t i = 0; i < std::min(msg::bound::ProxyState_contacts, s.shell_contacts.size()); ++i) {
        msg::ShellContact c;
        c.position(to_msg(s.shell_contacts[i].position));
        c.normal(to_msg(s.shell_contacts[i].normal));
        c.force(s.shell_contacts[i].force);
        c.tissue(static_cast<std::uint32_t>(s.shell_contacts[i].tissue));
        message.contacts().push_back(c);
    }
    return message;
}

void HandForces::assign(const scene::Snapshot& s) {
    step = s.step;
    time_ns = s.time_ns;
    proxy = s.proxy;
    tissue_force = s.tissue_force;
    tissue_torque = s.tissue_torque;
    tube_force = s.tube_force;
    tube_torque = s.tube_torque;
    contacts = s.tissue_contacts;
}

msg::TissueContacts tissue_message(const HandForces& forces) {
    msg::TissueContacts message;
    message.header(make_header(forces.time_ns, static_cast<std::uint32_t>(forces.step)));
    message.proxy(to_msg(forces.proxy));
    message.force(to_msg(forces.tissue_force));
    message.torque(to_msg(forces.tissue_torque));
    const std::size_t all = forces.contacts.size();
    const std::size_t sent = std::min(msg::bound::TissueContacts_contacts, all);
    message.dropped(static_cast<std::uint32_t>(all - sent));
    for (std::size_t i = 0; i < sent; ++i) {
        const scene::TissueContact& t = forces.contacts[i * all / sent];
        msg::TissueContactPoint c;
        c.position(to_msg(t.position));
        c.rest(to_msg(t.rest));
        c.force(to_msg(t.force));
        c.radius(t.radius);
        c.tissue(static_cast<std::uint32_t>(t.tissue));
        message.contacts().push_back(c);
    }
    return message;
}

msg::TubeForce tube_message(const HandForces& forces) {
    msg::TubeForce message;
    message.header(make_header(forces.time_ns, static_cast<std::uint32_t>(forces.step)));
    message.force(to_msg(forces.tube_force));
    message.torque(to_msg(forces.tube_torque));
    return message;
}

void DeformationMessages::make(const scene::Snapshot& snapshot,
                               const std::function<void(msg::DeformationState&)>& send, bool whole) {
    const std::size_t count = snapshot.frames.size();
    const bool all = whole || sent_.size() != count;
    sent_.resize(count);
    std::vector<std::uint16_t> due;
    const auto per_state = static_cast<std::uint32_t>(count / refresh_states + 1);
    for (std::uint32_t i = 0; i < count; ++i) {
        const bool in_turn = (i + static_cast<std::uint32_t>(count) - refresh_) % count < per_state;
        if (all || in_turn || has_moved(sent_[i], snapshot.frames[i])) {
            due.push_back(static_cast<std::uint16_t>(i));
            sent_[i] = snapshot.frames[i];
        }
    }
    refresh_ = count > 0 ? (refresh_ + per_state) % static_cast<std::uint32_t>(count) : 0;
    const std::size_t beyond_first =
        due.size() > frames_in_first_chunk ? due.size() - frames_in_first_chunk : 0;
    const std::size_t chunks = 1 + (beyond_first + frames_per_chunk - 1) / frames_per_chunk;
    std::size_t next = 0;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        msg::DeformationState state;
        state.header(make_header(snapshot.time_ns, static_cast<std::uint32_t>(snapshot.step)));
        state.chunk(static_cast<std::uint16_t>(chunk));
        state.chunks(static_cast<std::uint16_t>(chunks));
        if (chunk == 0) {
            for (std::size_t i = 0;
                 i < std::min(msg::bound::DeformationState_tube_nodes, snapshot.tube_nodes.size()); ++i) {
                state.tube_nodes().push_back(to_msg(snapshot.tube_nodes[i]));
            }
        }
        const std::size_t end =
            std::min(due.size(), next + (chunk == 0 ? frames_in_first_chunk : frames_per_chunk));
        for (; next < end; ++next) {
            state.frames().push_back(bus::encode_frame_pose(due[next], snapshot.frames[due[next]]));
        }
        send(state);
    }
}

void fluid_messages(const scene::Snapshot& snapshot, const std::function<void(msg::FluidState&)>& send) {
    const scene::SalivaState& saliva = snapshot.saliva;
    if (!saliva.on) {
        return;
    }
    const bus::Liquid liquid{saliva.lower, saliva.upper, saliva.spacing, saliva.positions};
    msg::FluidState state;
    state.header(make_header(snapshot.time_ns, static_cast<std::uint32_t>(snapshot.step)));
    for (std::size_t chunk = 0; chunk < bus::fluid_chunk_count(saliva.positions.size()); ++chunk) {
        bus::encode_fluid_chunk(liquid, chunk, state);
        send(state);
    }
}

}  // namespace eti::app
