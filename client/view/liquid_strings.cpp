// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid_strings.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace eti::view {
namespace {

// Distances of particles [spacings]: neighbours are nearer, and past it nothing holds them together.
constexpr float together = 1.5f, parted = 1.7f, apart_at_most = 3.0f;
// Of a particle's centre from a tool's surface [spacings].
constexpr float on_tool = 0.9f;
constexpr float parting_speed = 4e-3f;     // [m/s] at least, apart
constexpr float free_about = 1.0f;         // [spacings] about the middle of what may become a thread
constexpr float part_of_particle = 0.12f;  // of a particle's volume that goes into a thread
constexpr float longest = 14e-3f;          // [m]
constexpr float thinnest = 35e-6f;         // [m], radius
constexpr float drains_in = 1.6f;          // [s], until its radius has fallen by a factor of e

constexpr std::uint32_t nobody = LiquidTracks::nobody;

float along_of(const Capsule& capsule, const Vec3f& p) {
    const Vec3f axis = capsule.b - capsule.a;
    const float squared = axis.squaredNorm();
    return squared > 0.0f ? std::clamp((p - capsule.a).dot(axis) / squared, 0.0f, 1.0f) : 0.0f;
}

Vec3f on_axis(const Capsule& capsule, float along) {
    return capsule.a + along * (capsule.b - capsule.a);
}

// Of the capsule's surface, towards `other`.
Vec3f on_surface(const Capsule& capsule, float along, const Vec3f& other) {
    const Vec3f axis = on_axis(capsule, along);
    const Vec3f out = other - axis;
    const float distance = out.norm();
    return distance > 1e-6f ? Vec3f(axis + out * (capsule.radius / distance)) : axis;
}

bool is_free(const LiquidTracks& liquid, const Vec3f& middle, float radius, std::uint32_t i,
             std::uint32_t k) {
    bool free = true;
    liquid.cells().around(middle, [&](std::uint32_t other) {
        free = free && (other == i || other == k ||
                        (liquid.positions()[other] - middle).squaredNorm() > radius * radius);
    });
    return free;
}

}  // namespace

float LiquidString::radius() const {
    return std::sqrt(volume / (std::numbers::pi_v<float> * std::max(length(), 1e-4f)));
}

void LiquidStrings::clear() {
    strings_.clear();
    touched_.clear();
    left_out_ = 0;
}

/// False where what it hung on is lost.
bool LiquidStrings::follow(LiquidString::End& end, const LiquidTracks& liquid,
                           std::span<const Capsule> tools) {
    if (end.particle == nobody) {
        return end.tool < tools.size();
    }
    end.particle = end.particle < liquid.after().size() ? liquid.after()[end.particle] : nobody;
    if (end.particle == nobody) {
        return false;
    }
    end.place = liquid.positions()[end.particle];
    held_[end.particle] = 1;
    return true;
}

void LiquidStrings::advance(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing,
                            float dt, float stringing) {
    held_.assign(liquid.positions().size(), 0);
    std::erase_if(strings_, [&](LiquidString& string) {
        if (!follow(string.from, liquid, tools) || !follow(string.to, liquid, tools)) {
            return true;
        }
        if (string.to.particle == nobody) {
            string.to.place = on_surface(tools[string.to.tool], string.to.along, string.from.place);
        }
        string.age += dt;
        string.volume *= std::exp(-2.0f * dt / drains_in);
        const float length = string.length();
        const float joined = string.to.particle == nobody ? on_tool : together;
        return length < joined * spacing || length > longest || string.radius() < thinnest;
    });
    touch(liquid, tools, spacing);
    if (stringing > 0.0f) {
        part(liquid, tools, spacing, stringing * part_of_particle * spacing * spacing * spacing);
    }
}

void LiquidStrings::touch(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing) {
    touched_before_.swap(touched_);
    touched_.assign(liquid.positions().size(), nobody);
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
        for (std::uint32_t k = 0; k < tools.size() && touched_[i] == nobody; ++k) {
            const float reach = tools[k].radius + on_tool * spacing;
            if ((p - on_axis(tools[k], along_of(tools[k], p))).squaredNorm() < reach * reach) {
                touched_[i] = k;
            }
        }
    }
}

void LiquidStrings::part(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing,
                         float volume) {
    const auto positions = liquid.positions();
    parting_.clear();
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        const std::uint32_t before = liquid.before()[i];
        if (before == nobody || held_[i] != 0) {
            continue;
        }
        const std::uint32_t tool = before < touched_before_.size() ? touched_before_[before] : nobody;
        if (tool < tools.size() && touched_[i] == nobody) {
            const float along = along_of(tools[tool], positions[i]);
            const Vec3f foot = on_surface(tools[tool], along, positions[i]);
            if (is_free(liquid, 0.5f * (foot + positions[i]), 0.6f * free_about * spacing, i, i)) {
                parting_.push_back({(foot - positions[i]).norm(),
                                    {.particle = i, .place = positions[i]},
                                    {.tool = tool, .along = along, .place = foot}});
            }
        }
        // Of two that part one moves, and that one looks.
        const auto moves = [&](std::uint32_t k) {
            return liquid.velocities()[k].squaredNorm() > 0.25f * parting_speed * parting_speed;
        };
        if (!moves(i)) {
            continue;
        }
        liquid.cells().around(positions[i], [&](std::uint32_t k) {
            if (k == i || (k < i && moves(k)) || held_[k] != 0 || liquid.before()[k] == nobody) {
                return;
            }
            const Vec3f apart = positions[i] - positions[k];
            const float distance = apart.norm();
            if (distance < parted * spacing || distance > apart_at_most * spacing) {
                return;
            }
            const float former = (liquid.former()[before] - liquid.former()[liquid.before()[k]]).norm();
            const float speed = (liquid.velocities()[i] - liquid.velocities()[k]).dot(apart) / distance;
            if (former < parted * spacing && speed >= parting_speed &&
                is_free(liquid, 0.5f * (positions[i] + positions[k]), free_about * spacing, i, k)) {
                parting_.push_back({distance,
                                    {.particle = i, .place = positions[i]},
                                    {.particle = k, .place = positions[k]}});
            }
        });
    }
    // One thread a particle, the shortest.
    std::ranges::stable_sort(parting_, {}, &Parting::distance);
    for (const Parting& pair : parting_) {
        std::uint8_t& from = held_[pair.from.particle];
        if (from != 0 || (pair.to.particle != nobody && held_[pair.to.particle] != 0)) {
            continue;
        }
        from = 1;
        if (pair.to.particle != nobody) {
            held_[pair.to.particle] = 1;
        }
        if (strings_.size() == most) {
            ++left_out_;
        } else {
            strings_.push_back({pair.from, pair.to, volume, 0.0f});
        }
    }
}

}  // namespace eti::view
