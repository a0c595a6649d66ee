// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <atomic>
#include <cmath>

#include "common/model/pace.hpp"
#include "server/parallel/loops.hpp"
#include "server/pbd/fluid/fluid.hpp"
#include "server/pbd/fluid/fluid_solid.hpp"

namespace eti::pbd {

namespace {

// [spacings], change of a wall's distance that wakes particles resting on it.
constexpr float wall_way = 0.02f;
// Relative change of gravity that wakes all particles: a third of a degree.
constexpr float gravity_way = 0.005f;

// [s], interval between rest tests. Liquid next to sleeping particles wakes them a kernel radius farther each
// time: 0.3 m/s, faster than waves in a few millimetres of depth.
constexpr float settle_time = step_duration;

}  // namespace

std::size_t Fluid::sleeping_count() const {
    return static_cast<std::size_t>(
        std::count_if(rest_.begin(), rest_.end(), [](const Rest& rest) { return rest.awake == 0; }));
}

bool Fluid::wake(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings) {
    const bool all = dt != dt_ || (gravity - gravity_).norm() > gravity_way * gravity_.norm();
    if (all) {
        gravity_ = gravity;
    }
    const bool solid_moved = surroundings.solid_moved && surroundings.solid != nullptr;
    const std::optional<FluidSolid> solid = solid_of(surroundings);
    bool drawn = false;
    for (const FluidSuction& suction : surroundings.suctions) {
        drawn = drawn || suction.strength > 0.0f;
    }
    const float way = wall_way * settings_.spacing;
    bool anybody = false;
    for (std::size_t i = 0; i < count(); ++i) {
        Rest& rest = rest_[i];
        if (rest.awake == 0) {
            bool woken = all;
            if (solid_moved) {
                const float distance = std::min(solid->at(position_[i]).distance, kernel_.radius);
                woken = woken || std::fabs(distance - rest.wall) > way;
            }
            if (capsules_near_[i / capsule_group] != 0 || surroundings.capsules.size() > max_sorted ||
                rest.capsule < kernel_.radius) {
                const float gap = nearest_capsule(i, position_[i], surroundings.capsules).gap;
                woken = woken || std::fabs(gap - rest.capsule) > way;
            }
            if (drawn) {
                for (const FluidSuction& suction : surroundings.suctions) {
                    // Includes particles that lose a neighbour to suction.
                    const float reach = std::max(suction.reach, suction.radius + kernel_.radius);
                    woken = woken || (suction.strength > 0.0f &&
                                      (position_[i] - suction.tip).squaredNorm() < reach * reach);
                }
            }
            if (woken) {
                rest.awake = 1;
                rest.quiet = 0.0f;
            }
        }
        anybody = anybody || rest.awake != 0;
    }
    return anybody;
}

void Fluid::settle(float dt, const FluidSurroundings& surroundings) {
    since_settled_ += dt;
    if (!(settings_.rest_time > 0.0f) || since_settled_ < 0.99f * settle_time) {
        return;
    }
    const float gone = since_settled_;
    since_settled_ = 0.0f;
    const float way = settings_.rest_distance * settings_.spacing;
    const std::size_t n = count();
    stirred_.assign(n, 0);
    parallel::for_each(awake_.size(), grain, [&](std::size_t k) {
        const std::uint32_t i = awake_[k];
        Rest& rest = rest_[i];
        if ((position_[i] - rest.anchor).squaredNorm() > way * way) {
            rest.anchor = position_[i];
            rest.quiet = 0.0f;
        } else {
            rest.quiet += gone;
        }
        if (rest.quiet < settings_.rest_time) {
            const auto stir = [this](std::size_t j) {
                // A benign race: all writers store the same value.
                std::atomic_ref(stirred_[j]).store(1, std::memory_order_relaxed);
            };
            stir(i);
            for (std::uint32_t p = first_pair_[i]; p < first_pair_[i] + neighbours_[i]; ++p) {
                stir(neighbour_[p] / 4);
            }
        }
    });
    const std::optional<FluidSolid> solid = solid_of(surroundings);
    for (std::size_t i = 0; i < n; ++i) {
        Rest& rest = rest_[i];
        const std::uint8_t awake = stirred_[i];
        if (awake == 0 && rest.awake != 0) {
            velocity_[i].setZero();
            rest.wall = solid.has_value() ? std::min(solid->at(position_[i]).distance, kernel_.radius)
                                          : kernel_.radius;
            rest.capsule = nearest_capsule(i, position_[i], surroundings.capsules).gap;
        }
        rest.awake = awake;
    }
}

}  // namespace eti::pbd
