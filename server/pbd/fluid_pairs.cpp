// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <array>
#include <atomic>

#include "server/pbd/fluid.hpp"
#include "server/pbd/ranges.hpp"

namespace eti::pbd {

namespace {

// Pairs are worked on this many at a time; a literal, so that sums do not depend on the instruction set.
constexpr int lanes = 8;
using Lanes = Eigen::Array<float, lanes, 1>;
// 2 (d + 2) in the literature, for sums that are integrals. No two particles of a liquid come closer than
// about a spacing, where the kernel's steepest part is: a shear wave then decays at 0.58 of its rate.
constexpr float viscous_factor = 10.0f / 0.58f;

}  // namespace

/// The particles in the 27 cells about one, for those in the middle one to choose from.
struct Fluid::Candidates {
    static constexpr std::size_t most = 1024;  // nearly five times what 27 cells hold at rest
    static constexpr std::size_t padded = most_neighbours + lanes;
    std::size_t count = 0;
    std::uint32_t first = 0;  ///< particle of the first candidate, whose run holds those of the middle cell
    std::uint64_t dropped = 0;
    alignas(32) std::array<float, most + lanes> x, y, z, squared;
    std::array<std::uint32_t, most> particle;
    std::array<std::uint32_t, most + 1> chosen;
    alignas(32) std::array<float, padded> dx, dy, dz, du, dv, dw, gradient;
};

void Fluid::collect(float dt, const FluidSurroundings& surroundings) {
    for_ranges(count(), grain, [&](std::size_t begin, std::size_t end) {
        Candidates candidates;
        std::uint32_t cell = 0;
        // Pairs lie one after the other, so that memory is read in one stream; there is room for all.
        std::size_t pair = most_neighbours * begin;
        for (std::size_t i = begin; i != end; ++i) {
            if (i == begin || grid_.cell_at(i) != cell) {
                cell = grid_.cell_at(i);
                gather(cell, candidates);
            }
            find_walls(i, dt, surroundings);
            first_pair_[i] = static_cast<std::uint32_t>(pair);
            add_pair_terms(i, dt, candidates);
            pair += neighbours_[i];
        }
        std::atomic_ref(dropped_neighbours_).fetch_add(candidates.dropped, std::memory_order_relaxed);
    });
}

void Fluid::gather(std::uint32_t cell, Candidates& candidates) {
    const auto runs = grid_.neighbours(cell);
    // Its own run first, so that a crowd cannot displace it.
    std::size_t n = 0;
    candidates.first = runs[4].first;
    for (const std::size_t k : {4, 0, 1, 2, 3, 5, 6, 7, 8}) {
        const auto [first, last] = runs[k];
        for (std::uint32_t j = first; j < last; ++j) {
            if (n == Candidates::most) {
                candidates.dropped += last - j;
                break;
            }
            candidates.x[n] = predicted_[j].x();
            candidates.y[n] = predicted_[j].y();
            candidates.z[n] = predicted_[j].z();
            candidates.particle[n++] = j;
        }
    }
    candidates.count = n;
    for (std::size_t k = n; k < n + lanes; ++k) {
        candidates.x[k] = candidates.y[k] = candidates.z[k] = 0.0f;
    }
}

void Fluid::find_walls(std::size_t i, float dt, const FluidSurroundings& surroundings) {
    const float radius = 0.5f * settings_.spacing;
    Vec4f offset = Vec4f::Zero();
    Vec3f gradient = Vec3f::Zero();
    float density = 0.0f;
    const auto meet = [&](Wall& wall, float distance, const Vec3f& normal, const Vec3f& motion) {
        const WallTerms terms = wall_table_.at(distance);
        density += terms.density;
        gradient += terms.gradient * normal;
        const Vec3f slip = dt * velocity_[i] - motion;
        const float gap = distance - radius;
        wall = {Vec4f(normal.x(), normal.y(), normal.z(), 0.0f), gap, std::max(slip.dot(normal) - gap, 0.0f),
                motion.dot(normal) / dt, true};
        // Backward Euler, so that no viscosity can turn the slip round.
        const float rate = 10.0f * settings_.wall_viscosity * terms.drag * dt;
        offset.head<3>() -= rate / (1.0f + rate) * (slip - slip.dot(normal) * normal) +
                            dt * dt * wall_attraction_ * terms.adhesion * normal;
    };
    Wall* wall = &wall_[most_walls * i];
    wall[0] = wall[1] = {};
    if (surroundings.solid != nullptr) {
        const DistanceSample sample = surroundings.solid->sample(predicted_[i]);
        if (sample.distance < kernel_.radius) {
            meet(wall[0], sample.distance, sample.normal, Vec3f::Zero());
        }
    }
    const MovingCapsule* nearest = nullptr;
    float distance = kernel_.radius;
    Vec3f apart = Vec3f::Zero(), motion = Vec3f::Zero();
    for_capsules(i, surroundings.capsules, [&](const MovingCapsule& capsule) {
        const float t = closest_on_segment(capsule.a, capsule.b, predicted_[i]);
        const Vec3f axis = capsule.a + t * (capsule.b - capsule.a);
        const float gap = (predicted_[i] - axis).norm() - capsule.radius;
        if (gap < distance) {
            nearest = &capsule;
            distance = gap;
            apart = predicted_[i] - axis;
            motion = axis - (capsule.a_before + t * (capsule.b_before - capsule.a_before));
        }
    });
    if (nearest != nullptr) {
        meet(wall[1], distance, apart.normalized(), motion);
    }
    offset_[i] = offset;
    compression_[i] = density;
    own_gradient_[i] = Vec4f(gradient.x(), gradient.y(), gradient.z(), 0.0f);
}

void Fluid::add_pair_terms(std::size_t i, float dt, Candidates& candidates) {
    const float h_squared = kernel_.radius * kernel_.radius;
    const Vec3f at = predicted_[i];
    for (std::size_t k = 0; k < candidates.count; k += lanes) {
        const Lanes x = Lanes::MapAligned(&candidates.x[k]) - at.x();
        const Lanes y = Lanes::MapAligned(&candidates.y[k]) - at.y();
        const Lanes z = Lanes::MapAligned(&candidates.z[k]) - at.z();
        Lanes::MapAligned(&candidates.squared[k]) = x * x + y * y + z * z;
    }
    // Not its own neighbour. No branch below: it would be guessed wrong.
    candidates.squared[std::min<std::size_t>(i - candidates.first, Candidates::most)] = 2.0f * h_squared;
    std::size_t n = 0;
    for (std::size_t k = 0; k < candidates.count; ++k) {
        candidates.chosen[n] = static_cast<std::uint32_t>(k);
        n += candidates.squared[k] < h_squared ? 1 : 0;
    }
    if (n > most_neighbours) {
        candidates.dropped += n - most_neighbours;
        n = most_neighbours;
    }
    std::uint32_t* const neighbour = &neighbour_[first_pair_[i]];
    const Vec3f velocity = velocity_[i];
    for (std::size_t k = 0; k < n; ++k) {
        const std::uint32_t c = candidates.chosen[k];
        const std::uint32_t j = candidates.particle[c];
        neighbour[k] = j;
        candidates.dx[k] = at.x() - candidates.x[c];
        candidates.dy[k] = at.y() - candidates.y[c];
        candidates.dz[k] = at.z() - candidates.z[c];
        candidates.du[k] = velocity.x() - velocity_[j].x();
        candidates.dv[k] = velocity.y() - velocity_[j].y();
        candidates.dw[k] = velocity.z() - velocity_[j].z();
    }
    // What fills the last lanes lies at the kernel's edge, where every term is zero.
    for (std::size_t k = n; k % lanes != 0; ++k) {
        candidates.dx[k] = kernel_.radius;
        candidates.dy[k] = candidates.dz[k] = 0.0f;
        candidates.du[k] = candidates.dv[k] = candidates.dw[k] = 0.0f;
    }
    // The explicit step takes dt nu s of a particle's velocity against its neighbours, with s =
    // viscous_factor V sum of |W'| / r times a squared cosine, about 13 / spacing^2: at most two thirds.
    const float viscosity =
        viscous_factor * std::min(settings_.viscosity, 0.05f * settings_.spacing * settings_.spacing / dt);
    const float softening = 0.01f * h_squared;
    Lanes density = Lanes::Zero(), steep = Lanes::Zero();
    Lanes gx = Lanes::Zero(), gy = Lanes::Zero(), gz = Lanes::Zero();
    Lanes ax = Lanes::Zero(), ay = Lanes::Zero(), az = Lanes::Zero();
    for (std::size_t k = 0; k < n; k += lanes) {
        const Lanes x = Lanes::MapAligned(&candidates.dx[k]);
        const Lanes y = Lanes::MapAligned(&candidates.dy[k]);
        const Lanes z = Lanes::MapAligned(&candidates.dz[k]);
        const Lanes squared = x * x + y * y + z * z;
        const Lanes r = squared.sqrt();
        const Lanes q = (r * kernel_.inverse_radius).min(1.0f);
        const Lanes t = 1.0f - q;
        const Lanes cubed = t * t * t;
        density += cubed * t * (4.0f * q + 1.0f);
        const Lanes g = (-kernel_.slope * kernel_volume_) * cubed;
        Lanes::MapAligned(&candidates.gradient[k]) = g;
        steep += g * g * squared;
        gx += g * x;
        gy += g * y;
        gz += g * z;
        const Lanes closing = x * Lanes::MapAligned(&candidates.du[k]) +
                              y * Lanes::MapAligned(&candidates.dv[k]) +
                              z * Lanes::MapAligned(&candidates.dw[k]);
        const Lanes a = viscosity * closing / (squared + softening) * g -
                        attraction_ * cohesion_shape(q) / (r + 1e-6f * kernel_.radius);
        ax += a * x;
        ay += a * y;
        az += a * z;
    }
    Vec4f* const gradient = &gradient_[first_pair_[i]];
    for (std::size_t k = 0; k < n; ++k) {
        const float g = candidates.gradient[k];
        gradient[k] = Vec4f(g * candidates.dx[k], g * candidates.dy[k], g * candidates.dz[k], 0.0f);
    }
    for (; n % 4 != 0; ++n) {
        gradient[n].setZero();
        neighbour[n] = static_cast<std::uint32_t>(i);
    }
    neighbours_[i] = static_cast<std::uint32_t>(n);

    compression_[i] += kernel_volume_ * kernel_.peak * (1.0f + density.sum()) - 1.0f;
    // Component by component: a vector put together from scalars and read at once stalls the processor.
    Vec4f& own = own_gradient_[i];
    own.x() += gx.sum();
    own.y() += gy.sum();
    own.z() += gz.sum();
    diagonal_[i] = steep.sum() + own.x() * own.x() + own.y() * own.y() + own.z() * own.z();
    Vec4f& offset = offset_[i];
    offset.x() += dt * dt * ax.sum();
    offset.y() += dt * dt * ay.sum();
    offset.z() += dt * dt * az.sum();
}

}  // namespace eti::pbd
