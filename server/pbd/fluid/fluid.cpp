// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/fluid/fluid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/pbd/lanes.hpp"

namespace eti::pbd {

namespace {

constexpr float pi_float = std::numbers::pi_v<float>;
// Kernel radius over spacing. The value below was measured for this one.
constexpr float support = 2.0f;
// Settled liquid is not a lattice: at equal particle density its kernel sums are larger by this factor.
// Without it, a lattice would burst as it disorders, and poured liquid would stand 3 % too high.
constexpr float settled_volume = 0.968f;

/// Unit vector normal to `axis`.
Vec3f direction_on_circle(const Vec3f& axis, float turn) {
    const Vec3f across = axis.unitOrthogonal();
    return std::cos(turn) * across + std::sin(turn) * axis.cross(across);
}

Vec3f direction_in_cone(const Vec3f& axis, float angle, Random& random) {
    // Uniform on the spherical cap: the cosine is uniform (Archimedes).
    const float cosine = 1.0f - random.uniform() * (1.0f - std::cos(angle));
    const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f));
    return cosine * axis + sine * direction_on_circle(axis, 2.0f * pi_float * random.uniform());
}

}  // namespace

Fluid::Fluid(const FluidSettings& settings, std::uint64_t seed)
    : settings_(settings),
      kernel_(support * settings.spacing),
      wall_table_(kernel_),
      grid_(settings.lower, settings.upper, kernel_.radius, settings.capacity),
      random_(seed),
      volume_(settings.spacing * settings.spacing * settings.spacing),
      mass_(settings.rest_density * volume_),
      kernel_volume_(settled_volume * kernel_.lattice_volume(settings.spacing)),
      attraction_(cohesion_strength(settings.surface_tension, volume_, kernel_.radius) / mass_),
      // Young-Dupre: 1 + cos(angle) is the work of adhesion over the surface tension, and work scales with
      // pair strength for equal shapes; fluid on fluid has angle 0.
      wall_attraction_(0.5f * (1.0f + std::cos(settings.contact_angle)) * attraction_ / volume_),
      avx2_(has_avx2()) {
    const std::size_t n = settings.capacity;
    for (std::vector<Vec3f>* vectors : {&position_, &predicted_, &velocity_, &vector_scratch_}) {
        vectors->reserve(n);
    }
    for (std::vector<float>* floats : {&multiplier_, &compression_, &float_scratch_}) {
        floats->reserve(n);
    }
    id_.reserve(n);
    id_scratch_.reserve(n);
    rest_.reserve(n);
    rest_scratch_.reserve(n);
    awake_.reserve(n);
    stirred_.reserve(n);
    for (std::vector<Vec4f>* vectors : {&local_, &rate_, &offset_, &displacement_, &push_, &own_gradient_}) {
        vectors->resize(n, Vec4f::Zero());
    }
    for (std::vector<float>& axis : axis_) {
        axis.resize(n + lane_count, 0.0f);
    }
    diagonal_.resize(n, 0.0f);
    wall_.resize(max_walls * n);
    capsules_near_.resize(n / capsule_group + 1, 0);
    slope_.resize(max_neighbours * n, 0.0f);
    neighbour_.resize(max_neighbours * n, 0);
    first_pair_.resize(n, 0);
    neighbours_.resize(n, 0);
}

void Fluid::resize(std::size_t count) {
    for (std::vector<Vec3f>* vectors : {&position_, &predicted_, &velocity_, &vector_scratch_}) {
        vectors->resize(count, Vec3f::Zero());
    }
    for (std::vector<float>* floats : {&multiplier_, &compression_, &float_scratch_}) {
        floats->resize(count, 0.0f);
    }
    id_.resize(count, 0);
    id_scratch_.resize(count, 0);
    rest_.resize(count);
    rest_scratch_.resize(count);
}

void Fluid::reset(std::uint64_t seed) {
    resize(0);
    random_ = Random(seed);
    next_id_ = 0;
    since_settled_ = 0.0f;
    overflow_ = dropped_neighbours_ = left_domain_ = aspirated_ = 0;
    for (Source& source : sources_) {
        source.owed = 0.0;
    }
}

void Fluid::set_emitters(std::span<const FluidEmitter> emitters) {
    sources_.clear();
    for (const FluidEmitter& emitter : emitters) {
        sources_.push_back({emitter, 0.0});
    }
}

void Fluid::place_emitter(std::size_t which, const Vec3f& position, const Vec3f& direction) {
    sources_[which].emitter.position = position;
    sources_[which].emitter.direction = direction;
}

void Fluid::set_flow(float flow) {
    for (Source& source : sources_) {
        source.emitter.flow = flow;
    }
}

bool Fluid::add(const Vec3f& position, const Vec3f& velocity) {
    const std::size_t i = count();
    if (i == settings_.capacity) {
        ++overflow_;
        return false;
    }
    resize(i + 1);
    position_[i] = predicted_[i] = position;
    velocity_[i] = velocity;
    rest_[i] = {.anchor = position};
    id_[i] = next_id_++;
    return true;
}

float Fluid::pressure(std::size_t i) const {
    return settings_.rest_density * multiplier_[i] / (dt_ * dt_);
}

void Fluid::emit(float dt) {
    for (Source& source : sources_) {
        const FluidEmitter& e = source.emitter;
        source.owed += static_cast<double>(e.flow) * static_cast<double>(dt);
        while (source.owed >= static_cast<double>(volume_)) {
            source.owed -= static_cast<double>(volume_);
            const float speed = e.speed * (1.0f + e.speed_spread * (2.0f * random_.uniform() - 1.0f));
            const Vec3f direction = direction_in_cone(e.direction, e.cone, random_);
            // Uniform on the disc. Randomness also keeps particles from coinciding, which would leave no
            // direction to separate them.
            const float away = e.opening * std::sqrt(random_.uniform());
            const Vec3f aside = direction_on_circle(e.direction, 2.0f * pi_float * random_.uniform());
            add(e.position + away * aside, speed * direction);
        }
    }
}

void Fluid::remove(const FluidSurroundings& surroundings) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count(); ++i) {
        // Also false for NaN.
        if (!grid_.contains(predicted_[i])) {
            ++left_domain_;
            continue;
        }
        const bool sucked = std::any_of(
            surroundings.suctions.begin(), surroundings.suctions.end(), [&](const FluidSuction& suction) {
                return suction.strength > 0.0f &&
                       (predicted_[i] - suction.tip).squaredNorm() < suction.radius * suction.radius;
            });
        if (sucked) {
            ++aspirated_;
            continue;
        }
        if (kept++ == i) {
            continue;
        }
        const std::size_t to = kept - 1;
        position_[to] = position_[i];
        predicted_[to] = predicted_[i];
        velocity_[to] = velocity_[i];
        multiplier_[to] = multiplier_[i];
        compression_[to] = compression_[i];
        id_[to] = id_[i];
        rest_[to] = rest_[i];
    }
    resize(kept);
}

void Fluid::sort() {
    grid_.sort(predicted_);
    const auto reorder = [this](auto& values, auto& scratch) {
        const auto order = grid_.order();
        for (std::size_t i = 0; i < order.size(); ++i) {
            scratch[i] = values[order[i]];
        }
        values.swap(scratch);
    };
    if (!grid_.was_sorted()) {
        reorder(position_, vector_scratch_);
        reorder(predicted_, vector_scratch_);
        reorder(velocity_, vector_scratch_);
        reorder(multiplier_, float_scratch_);
        reorder(compression_, float_scratch_);
        reorder(id_, id_scratch_);
        reorder(rest_, rest_scratch_);
    }
    awake_.clear();
    const Vec3f middle = grid_.middle();
    for (std::size_t i = 0; i < count(); ++i) {
        const Vec3f& p = predicted_[i];
        const Vec3f& v = velocity_[i];
        local_[i] = Vec4f(p.x() - middle.x(), p.y() - middle.y(), p.z() - middle.z(), 1.0f);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            axis_[axis][i] = local_[i][static_cast<Eigen::Index>(axis)];
        }
        rate_[i] = Vec4f(v.x(), v.y(), v.z(), 0.0f);
        if (rest_[i].awake != 0) {
            awake_.push_back(static_cast<std::uint32_t>(i));
        } else {
            // Seen by its neighbours; the particle itself does not move.
            displacement_[i].setZero();
            push_[i] = multiplier_[i] * local_[i];
        }
    }
}

}  // namespace eti::pbd
