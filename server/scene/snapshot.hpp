// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/math/transform.hpp"
#include "common/mesh/skinning.hpp"
#include "common/model/landmark.hpp"
#include "common/model/live.hpp"
#include "common/model/tissue.hpp"

namespace eti::scene {

/// Contact of the laryngoscope's proxy with the shell.
struct RigidContact {
    Vec3f position = Vec3f::Zero();  ///< [m]
    Vec3f normal = Vec3f::UnitZ();   ///< unit, from the shell to the proxy
    float force = 0.0f;              ///< [N], along the normal
    Tissue tissue = Tissue::soft;
};

/// A soft-tissue particle touching, or about to touch, the blade.
struct TissueContact {
    Vec3f position = Vec3f::Zero();  ///< [m], now
    Vec3f rest = Vec3f::Zero();      ///< [m], where it would be without the blade (posture included)
    Vec3f force = Vec3f::Zero();     ///< [N], of the particle on the blade, mean over the step
    float radius = 0.0f;             ///< [m]
    Tissue tissue = Tissue::soft;
};

/// Liquid in mouth and throat.
struct SalivaState {
    bool on = false;               ///< whether the scenario asks for it
    float spacing = 0.0f;          ///< [m], of particles at rest
    Vec3f lower = Vec3f::Zero();   ///< [m], of the box that
    Vec3f upper = Vec3f::Zero();   ///< all positions are in
    std::vector<Vec3f> positions;  ///< [m]; an index is not the same particle from one step to the next
    std::uint64_t overflow = 0;    ///< particles that found no room, since the last reset
    std::uint64_t left = 0;        ///< particles that ran out of the head, since the last reset
    std::uint64_t aspirated = 0;   ///< particles that suction took, since the last reset
};

/// What the rigid layer knows of a step, before the particles have moved. Patient frame.
struct ProxySnapshot {
    std::uint64_t step = 0;
    std::uint64_t time_ns = 0;  ///< simulation time since the session began

    RigidTransform device;                         ///< laryngoscope as latched from the hand
    RigidTransform proxy;                          ///< laryngoscope as stopped by the shell
    RigidTransform last_free;                      ///< the proxy's last pose that did not penetrate the shell
    Vec3f proxy_velocity = Vec3f::Zero();          ///< [m/s], of the tool origin
    Vec3f proxy_angular_velocity = Vec3f::Zero();  ///< [rad/s]
    Vec3f shell_force = Vec3f::Zero();             ///< [N], sum of the shell's forces on the proxy
    Vec3f shell_torque = Vec3f::Zero();            ///< [N m], about the proxy's origin
    std::vector<RigidContact> shell_contacts;
};

/// The state of the scene after one step: all that metrics, recorder and bus may look at.
/// Patient frame throughout.
struct Snapshot : ProxySnapshot {
    Vec3f tissue_force = Vec3f::Zero();   ///< [N], sum of the particles' forces on the blade
    Vec3f tissue_torque = Vec3f::Zero();  ///< [N m], about the proxy's origin
    std::vector<TissueContact> tissue_contacts;

    RigidTransform tube_grip;           ///< the tube's tracked grip as latched
    std::vector<Vec3f> tube_nodes;      ///< [m], centre line from connector to tip
    Vec3f tube_force = Vec3f::Zero();   ///< [N], of the tube on the hand that holds it, mean over the step
    Vec3f tube_torque = Vec3f::Zero();  ///< [N m], about the grip
    SalivaState saliva;

    std::vector<FramePose> frames;  ///< bones, clusters, the head's; index as in the patient model
    Landmarks landmarks{};
    std::vector<Vec3f> glottis_contour;  ///< [m], closed polygon

    LiveValues live;  ///< what commands change, as it is
};

}  // namespace eti::scene
