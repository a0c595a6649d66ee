// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid/liquid_filaments.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/mesh/closest_point.hpp"

namespace eti::view {
namespace {

// Particle distances [spacings]: a filament is removed below the first, and forms between the second and
// the third.
constexpr float together = 1.5f, parted = 1.7f, apart_at_most = 3.0f;
// Distance of a particle's centre from a tool's surface [spacings].
constexpr float on_tool = 0.9f;
constexpr float parting_speed = 4e-3f;     // [m/s], minimum separation speed
constexpr float free_about = 1.0f;         // [spacings] free space around the middle of a potential
                                           // filament
constexpr float part_of_particle = 0.12f;  // fraction of a particle's volume that goes into a filament
constexpr float longest = 14e-3f;          // [m]
constexpr float thinnest = 35e-6f;         // [m], radius
constexpr float drains_in = 1.6f;          // [s], time constant of the radius

constexpr std::uint32_t no_particle = LiquidTracks::no_particle;

Vec3f on_axis(const Capsule& capsule, float along) {
    return capsule.a + along * (capsule.b - capsule.a);
}

// On the capsule's surface, towards `other`.
Vec3f on_surface(const Capsule& capsule, float along, const Vec3f& other) {
    const Vec3f axis = on_axis(capsule, along);
    const Vec3f out = other - axis;
    const float distance = out.norm();
    return distance > 1e-6f ? Vec3f(axis + out * (capsule.radius / distance)) : axis;
}

bool is_free(const LiquidTracks& liquid, const Vec3f& middle, float radius, std::uint32_t i,
             std::uint32_t k) {
    bool free = true;
    liquid.cells().visit_near(middle, [&](std::uint32_t other) {
        free = free && (other == i || other == k ||
                        (liquid.positions()[other] - middle).squaredNorm() > radius * radius);
    });
    return free;
}

}  // namespace

float LiquidFilament::radius() const {
    return std::sqrt(volume / (std::numbers::pi_v<float> * std::max(length(), 1e-4f)));
}

void LiquidFilaments::clear() {
    filaments_.clear();
    touched_.clear();
    left_out_ = 0;
}

/// Returns false if its attachment was lost.
bool LiquidFilaments::follow(LiquidFilament::End& end, const LiquidTracks& liquid,
                             std::span<const Capsule> tools) {
    if (end.particle == no_particle) {
        return end.tool < tools.size();
    }
    end.particle =
        end.particle < liquid.next_indices().size() ? liquid.next_indices()[end.particle] : no_particle;
    if (end.particle == no_particle) {
        return false;
    }
    end.place = liquid.positions()[end.particle];
    held_[end.particle] = 1;
    return true;
}

void LiquidFilaments::advance(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing,
                              float dt, float stringing) {
    held_.assign(liquid.positions().size(), 0);
    std::erase_if(filaments_, [&](LiquidFilament& filament) {
        if (!follow(filament.from, liquid, tools) || !follow(filament.to, liquid, tools)) {
            return true;
        }
        if (filament.to.particle == no_particle) {
            filament.to.place = on_surface(tools[filament.to.tool], filament.to.along, filament.from.place);
        }
        filament.age += dt;
        filament.volume *= std::exp(-2.0f * dt / drains_in);
        const float length = filament.length();
        const float joined = filament.to.particle == no_particle ? on_tool : together;
        return length < joined * spacing || length > longest || filament.radius() < thinnest;
    });
    touch(liquid, tools, spacing);
    if (stringing > 0.0f) {
        part(liquid, tools, spacing, stringing * part_of_particle * spacing * spacing * spacing);
    }
}

void LiquidFilaments::touch(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing) {
    touched_before_.swap(touched_);
    touched_.assign(liquid.positions().size(), no_particle);
    Eigen::AlignedBox3f about;
    for (const Capsule& tool : tools) {
        const Vec3f reach = Vec3f::Constant(tool.radius + on_tool * spacing);
        about.extend(Eigen::AlignedBox3f(tool.a.cwiseMin(tool.b) - reach, tool.a.cwiseMax(tool.b) + reach));
    }
    for (std::size_t i = 0; i < touched_.size(); ++i) {
        const Vec3f& p = liquid.positions()[i];
        if (!about.contains(p)) {
            continue;
        }
        for (std::uint32_t k = 0; k < tools.size() && touched_[i] == no_particle; ++k) {
            const float reach = tools[k].radius + on_tool * spacing;
            if (offset_from_segment(tools[k].a, tools[k].b, p).squaredNorm() < reach * reach) {
                touched_[i] = k;
            }
        }
    }
}

void LiquidFilaments::part(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing,
                           float volume) {
    const auto positions = liquid.positions();
    separating_.clear();
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        const std::uint32_t before = liquid.previous_indices()[i];
        if (before == no_particle || held_[i] != 0) {
            continue;
        }
        const std::uint32_t tool = before < touched_before_.size() ? touched_before_[before] : no_particle;
        if (tool < tools.size() && touched_[i] == no_particle) {
            const float along = closest_on_segment(tools[tool].a, tools[tool].b, positions[i]);
            const Vec3f foot = on_surface(tools[tool], along, positions[i]);
            if (is_free(liquid, 0.5f * (foot + positions[i]), 0.6f * free_about * spacing, i, i)) {
                separating_.push_back({(foot - positions[i]).norm(),
                                       {.particle = i, .place = positions[i]},
                                       {.tool = tool, .along = along, .place = foot}});
            }
        }
        // Of two separating particles only one is moving, and that one searches.
        const auto moves = [&](std::uint32_t k) {
            return liquid.velocities()[k].squaredNorm() > 0.25f * parting_speed * parting_speed;
        };
        if (!moves(i)) {
            continue;
        }
        liquid.cells().visit_near(positions[i], [&](std::uint32_t k) {
            if (k == i || (k < i && moves(k)) || held_[k] != 0 ||
                liquid.previous_indices()[k] == no_particle) {
                return;
            }
            const Vec3f apart = positions[i] - positions[k];
            const float distance = apart.norm();
            if (distance < parted * spacing || distance > apart_at_most * spacing) {
                return;
            }
            const float former = (liquid.previous_positions()[before] -
                                  liquid.previous_positions()[liquid.previous_indices()[k]])
                                     .norm();
            const float speed = (liquid.velocities()[i] - liquid.velocities()[k]).dot(apart) / distance;
            if (former < parted * spacing && speed >= parting_speed &&
                is_free(liquid, 0.5f * (positions[i] + positions[k]), free_about * spacing, i, k)) {
                separating_.push_back({distance,
                                       {.particle = i, .place = positions[i]},
                                       {.particle = k, .place = positions[k]}});
            }
        });
    }
    // One filament per particle, the shortest.
    std::ranges::stable_sort(separating_, {}, &Separation::distance);
    for (const Separation& pair : separating_) {
        std::uint8_t& from = held_[pair.from.particle];
        if (from != 0 || (pair.to.particle != no_particle && held_[pair.to.particle] != 0)) {
            continue;
        }
        from = 1;
        if (pair.to.particle != no_particle) {
            held_[pair.to.particle] = 1;
        }
        if (filaments_.size() == max_filaments) {
            ++left_out_;
        } else {
            filaments_.push_back({pair.from, pair.to, volume, 0.0f});
        }
    }
}

}  // namespace eti::view
