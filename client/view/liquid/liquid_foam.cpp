// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid/liquid_foam.hpp"

#include <algorithm>
#include <cmath>

namespace eti::view {
namespace {

// Neighbours within two spacings of a particle in bulk liquid, and of one at a plane surface.
constexpr float amid = 30.0f, at_surface = 22.0f;
// Lower and upper limits of the paper's potentials.
constexpr float air_least = 0.06f, air_most = 0.5f;         // [m/s], summed over neighbours
constexpr float crest_least = 2.0f, crest_most = 8.0f;      // summed over neighbours, as in the paper
constexpr float outward = 0.6f;                             // cosine, as in the paper
constexpr float energy_least = 5e-5f, energy_most = 1e-3f;  // [J/kg]: 10 to 45 mm/s
// Maximum number of bubbles that a particle entraps per second: by collisions, by a crest.
constexpr float by_air = 60.0f, by_crest = 35.0f;
constexpr float least_radius = 0.1e-3f, most_radius = 0.4e-3f;  // [m]
constexpr float shortest_life = 1.5f, longest_life = 9.0f;      // [s]; small bubbles last longer
constexpr float rise = 6e-3f;                                   // [m/s], towards the surface
constexpr float off_liquid = 4.0f;                              // factor of ageing away from liquid

float clamped(float value, float least, float most) {
    return std::clamp((value - least) / (most - least), 0.0f, 1.0f);
}

}  // namespace

float Bubble::radius_now() const {
    constexpr float grows_in = 0.05f;
    const float grown = std::min(age / grows_in, 1.0f);
    const float left = std::clamp((life - age) / (0.25f * life), 0.0f, 1.0f);
    return radius * grown * std::sqrt(left);
}

void LiquidFoam::clear() {
    bubbles_.clear();
    left_out_ = 0;
    random_ = Random(0x0f0a3);
}

void LiquidFoam::advance(const LiquidTracks& liquid, float spacing, float dt, float foaming) {
    carry(liquid, spacing, dt);
    std::erase_if(bubbles_, [](const Bubble& bubble) { return bubble.age >= bubble.life; });
    for (std::uint32_t i = 0; i < liquid.positions().size(); ++i) {
        // Particles at rest or new ones entrap nothing.
        if (liquid.previous_indices()[i] != LiquidTracks::no_particle &&
            0.5f * liquid.velocities()[i].squaredNorm() > energy_least) {
            entrap(liquid, i, spacing, dt, foaming);
        }
    }
}

/// Advects bubbles with the surrounding liquid, and towards its surface.
void LiquidFoam::carry(const LiquidTracks& liquid, float spacing, float dt) {
    const float h = 2.0f * spacing;
    for (Bubble& bubble : bubbles_) {
        Vec3f motion = Vec3f::Zero(), out = Vec3f::Zero();
        float weights = 0.0f, count = 0.0f;
        liquid.cells().visit_near(bubble.position, [&](std::uint32_t k) {
            const Vec3f apart = bubble.position - liquid.positions()[k];
            const float r = apart.norm();
            if (r < h) {
                const float w = 1.0f - r / h;
                motion += w * liquid.velocities()[k];
                out += w * apart / std::max(r, 1e-6f);
                weights += w;
                count += 1.0f;
            }
        });
        bubble.age += count > 0.0f ? dt : off_liquid * dt;
        if (count > 0.0f) {
            bubble.position += dt * motion / weights;
            bubble.position += dt * rise * clamped(count, at_surface, amid) * out.normalized();
        }
    }
}

void LiquidFoam::entrap(const LiquidTracks& liquid, std::uint32_t i, float spacing, float dt, float foaming) {
    const Vec3f& x = liquid.positions()[i];
    const Vec3f& v = liquid.velocities()[i];
    const float h = 2.0f * spacing;
    float air = 0.0f, count = 0.0f;
    Vec3f out = Vec3f::Zero();
    liquid.cells().visit_near(x, [&](std::uint32_t k) {
        const Vec3f apart = x - liquid.positions()[k];
        const float squared = apart.squaredNorm();
        if (k == i || squared >= h * h || squared < 1e-12f) {
            return;
        }
        const float r = std::sqrt(squared);
        const float w = 1.0f - r / h;
        const Vec3f against = v - liquid.velocities()[k];
        const float speed = against.norm();
        // (1 - cos) |v_ij|: twice the speed where they collide, zero where they separate.
        air += w * (speed - against.dot(apart) / r);
        out += w * apart / r;
        count += 1.0f;
    });
    const float exposed = 1.0f - clamped(count, at_surface, amid);
    // The paper sums angles between normals; here a surface is convex where its neighbours lie to one side.
    const float convex = count > 0.0f ? 20.0f * out.norm() / std::max(count, 8.0f) : 0.0f;
    const bool forward = v.normalized().dot(out.normalized()) >= outward;
    const float crest = forward ? clamped(convex, crest_least, crest_most) : 0.0f;
    const float energy = clamped(0.5f * v.squaredNorm(), energy_least, energy_most);
    const float expected =
        foaming * dt * exposed * energy * (by_air * clamped(air, air_least, air_most) + by_crest * crest);
    float left = expected + random_.uniform();
    for (; left >= 1.0f; left -= 1.0f) {
        const float u = random_.uniform(), a = random_.uniform(), b = random_.uniform(),
                    c = random_.uniform();
        if (bubbles_.size() == max_bubbles) {
            ++left_out_;
            continue;
        }
        const float radius = least_radius + (most_radius - least_radius) * u * u * u;
        const Vec3f aside = 0.7f * spacing * Vec3f(2.0f * a - 1.0f, 2.0f * b - 1.0f, 2.0f * c - 1.0f);
        const float holds = 0.4f + 0.6f * random_.uniform();
        bubbles_.push_back({x + aside, radius, 0.0f,
                            holds * (longest_life + (shortest_life - longest_life) * std::sqrt(u))});
    }
}

}  // namespace eti::view
