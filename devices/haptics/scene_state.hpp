// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>

#include "common/device/coupling.hpp"
#include "common/model/tissue.hpp"
#include "common/model/tools/tools.hpp"
#include "common/operator/operator.hpp"
#include "idl/eti_wire.hpp"

namespace eti::devices {

/// Eigen leaves vectors uninitialised.
template <std::size_t count>
[[nodiscard]] std::array<Vec3f, count> all_zero() {
    std::array<Vec3f, count> out;
    out.fill(Vec3f::Zero());
    return out;
}

/// The proxy as the server last reported it.
struct ProxyReport {
    static constexpr std::size_t max_contacts = msg::bound::ProxyState_contacts;
    Motion proxy;           ///< velocities per simulation second
    RigidTransform device;  ///< the device's pose that the proxy answers
    std::array<Vec3f, max_contacts> normals =
        all_zero<max_contacts>();  ///< from the shell to the proxy, unit
    std::size_t contacts = 0;
    Vec3f contact_centre = Vec3f::Zero();  ///< [m], of the contacts, weighted by their forces

    [[nodiscard]] std::span<const Vec3f> contact_normals() const { return {normals.data(), contacts}; }
};

/// A particle near the blade.
struct TissuePoint {
    Vec3f position = Vec3f::Zero();  ///< [m], now
    Vec3f rest = Vec3f::Zero();      ///< [m], without the blade
    float radius = 0.0f;             ///< [m]
    Tissue tissue = Tissue::soft;
    Vec3f force = Vec3f::Zero();  ///< [N], of the particle on the blade
};

/// The tissue's load on the blade, as last reported.
struct TissueReport {
    static constexpr std::size_t max_points = msg::bound::TissueContacts_contacts;
    Wrench wrench;  ///< on the blade, about the proxy's origin; or of a tube on the hand, about its grip
    RigidTransform proxy;  ///< the blade's pose for all of this
    std::array<TissuePoint, max_points> points{};
    std::size_t count = 0;
    float represents = 1.0f;  ///< number of contacts per point, where the message could not hold all

    [[nodiscard]] std::span<const TissuePoint> touching() const { return {points.data(), count}; }
};

/// The newest scene data for the 1 kHz loop. Arrival times are CLOCK_MONOTONIC [ns]; 0: nothing has arrived
/// yet, or the last message was invalid.
struct SceneState {
    ProxyReport proxy;
    std::int64_t proxy_arrived = 0;
    TissueReport tissue;
    std::int64_t tissue_arrived = 0;
    Observation seen;                ///< its time is that of the last ProxyState
    float pace = 1.0f;               ///< simulation seconds per second, below 1 when the server is late
    std::uint32_t session = 0;       ///< counts sessions: changes when another one begins
    std::array<Capsule, 3> blade{};  ///< the laryngoscope's capsules, in its frame
};
static_assert(std::is_trivially_destructible_v<SceneState>, "copied into a mailbox, never allocating");

}  // namespace eti::devices
