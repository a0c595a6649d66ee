// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/math/transform.hpp"
#include "common/mesh/skinning.hpp"
#include "common/model/landmark.hpp"
#include "common/model/runtime_parameters.hpp"
#include "common/model/tissue.hpp"
#include "server/rigid/rigid_layer.hpp"

namespace eti::scene {

/// A soft-tissue particle that touches the blade or is about to.
struct TissueContact {
    Vec3f position = Vec3f::Zero();  ///< [m], current
    Vec3f rest = Vec3f::Zero();      ///< [m], in the current posture without the blade
    Vec3f force = Vec3f::Zero();     ///< [N], of the particle on the blade, step mean
    float radius = 0.0f;             ///< [m]
    Tissue tissue = Tissue::soft;
};

/// Liquid in mouth and throat.
struct SalivaState {
    bool on = false;               ///< whether the scenario enables it
    float spacing = 0.0f;          ///< [m], of particles at rest
    Vec3f lower = Vec3f::Zero();   ///< [m], corners of the box
    Vec3f upper = Vec3f::Zero();   ///< that holds all positions
    std::vector<Vec3f> positions;  ///< [liquid particles][m]; indices are not stable from step to step
    std::uint64_t overflow = 0;    ///< particles not created for lack of room, since the last reset
    std::uint64_t left = 0;        ///< particles that left the head, since the last reset
    std::uint64_t aspirated = 0;   ///< particles removed by suction, since the last reset
    /// Neighbours ignored because a particle had more than it may, since the last reset: see pbd::Fluid.
    std::uint64_t dropped_neighbours = 0;
};

/// State of the rigid layer in a step, before the particles have moved. Patient frame.
struct ProxySnapshot {
    std::uint64_t step = 0;
    std::uint64_t time_ns = 0;  ///< simulation time since the session began

    RigidTransform device;                         ///< laryngoscope pose latched from the device
    RigidTransform proxy;                          ///< laryngoscope pose constrained by the shell
    RigidTransform last_free;                      ///< latest proxy pose without penetration
    Vec3f proxy_velocity = Vec3f::Zero();          ///< [m/s], of the tool's origin
    Vec3f proxy_angular_velocity = Vec3f::Zero();  ///< [rad/s]
    Vec3f shell_force = Vec3f::Zero();             ///< [N], total of the shell on the proxy
    Vec3f shell_torque = Vec3f::Zero();            ///< [N m], about the proxy's origin
    std::vector<rigid::Contact> shell_contacts;    ///< [contacts that carry force]
};

/// The scene after a step, a value for any thread: input of metrics, recorder and bus. Patient frame.
struct Snapshot : ProxySnapshot {
    Vec3f tissue_force = Vec3f::Zero();          ///< [N], total of the particles on the blade
    Vec3f tissue_torque = Vec3f::Zero();         ///< [N m], about the proxy's origin
    std::vector<TissueContact> tissue_contacts;  ///< [touched particles]

    RigidTransform tube_grip;           ///< latched pose of the tube's tracked grip
    std::vector<Vec3f> tube_nodes;      ///< [rod segments + 1][m], centre line from connector to tip
    Vec3f tube_force = Vec3f::Zero();   ///< [N], of the tube on the hand, step mean
    Vec3f tube_torque = Vec3f::Zero();  ///< [N m], about the grip
    SalivaState saliva;

    std::vector<FramePose> frames;       ///< [bones | clusters | skull], indexed as in the patient model
    Landmarks landmarks{};               ///< [Landmark][m]
    std::vector<Vec3f> glottis_contour;  ///< [vertices][m], closed polygon

    RuntimeParameters runtime_parameters;  ///< current values
};

}  // namespace eti::scene
