// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/shape_matching.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cassert>
#include <cmath>

namespace eti::pbd {

namespace {

// Warm-started from the last substep: four steps leave a thousandth of what the cluster turned since. An
// even number, so that what is left lags: goals that lead the body would feed energy into it.
constexpr int rotation_steps = 4;
// Ranges are cut the same way whatever the number of threads; every output has one writer.
constexpr std::size_t cluster_grain = 64;
constexpr std::size_t particle_grain = 512;

template <class Body>
void for_ranges(std::size_t count, std::size_t grain, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              body(i);
                          }
                      });
}

}  // namespace

Quatf extract_rotation(const Mat3f& a, const Quatf& rotation, int iterations) {
    Quatf q = rotation;
    for (int i = 0; i < iterations; ++i) {
        const Mat3f r = q.toRotationMatrix();
        const Vec3f turn = r.col(0).cross(a.col(0)) + r.col(1).cross(a.col(1)) + r.col(2).cross(a.col(2));
        const float scale =
            std::fabs(r.col(0).dot(a.col(0)) + r.col(1).dot(a.col(1)) + r.col(2).dot(a.col(2))) + 1e-20f;
        // Near the solution `turn` is (s_i + s_j) / (s_1 + s_2 + s_3) of the angle left, for principal
        // stretches s: two thirds where they are equal. Three halves of it converge five times a step
        // for stretches of 0.7 to 1.3, and still converge (rate 1/2) for flat and linear clusters.
        const Vec3f omega = 1.5f * turn / scale;
        const float angle = omega.norm();
        if (!(angle > 1e-7f)) {
            break;
        }
        // An inverted or flat cluster can ask for more than a radian; bounded steps still converge.
        q = (quaternion_from(omega * (std::min(angle, 1.0f) / angle)) * q).normalized();
    }
    return q;
}

void ShapeMatching::configure(const Description& description, const Particles& particles) {
    first_ = description.first;
    member_ = description.member;
    const std::size_t clusters = first_.size() - 1;
    const std::size_t count = particles.size();

    std::vector<std::uint32_t> memberships(count, 0);
    for (const std::uint32_t i : member_) {
        ++memberships[i];
    }
    first_of_.assign(count + 1, 0);
    for (std::size_t i = 0; i < count; ++i) {
        first_of_[i + 1] = first_of_[i] + memberships[i];
    }
    cluster_of_.resize(member_.size());
    std::vector<std::uint32_t> cursor(first_of_.begin(), first_of_.end() - 1);
    for (std::size_t c = 0; c < clusters; ++c) {
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            cluster_of_[cursor[member_[k]]++] = static_cast<std::uint32_t>(c);
        }
    }
    inverse_count_.assign(count, 0.0f);
    for (std::size_t i = 0; i < count; ++i) {
        if (memberships[i] > 0 && particles.inverse_mass[i] > 0.0f) {
            inverse_count_[i] = 1.0f / static_cast<float>(memberships[i]);
        }
    }

    weight_.resize(member_.size());
    offset_.resize(member_.size());
    rest_centre_.assign(clusters, Vec3f::Zero());
    centre_.assign(clusters, Vec3f::Zero());
    rotation_.assign(clusters, Quatf::Identity());
    spring_.resize(clusters);
    mass_.resize(clusters);
    share_.resize(clusters);
    for (std::size_t c = 0; c < clusters; ++c) {
        assert(first_[c + 1] > first_[c]);
        float total = 0.0f;
        float free_mass = 0.0f;
        float free_count = 0.0f;
        float volume = 0.0f;
        float overlap = 0.0f;
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            const std::uint32_t i = member_[k];
            const auto n = static_cast<float>(memberships[i]);
            const float share = description.fitting_mass[i] / n;
            weight_[k] = share;
            total += share;
            free_mass += share;
            free_count += 1.0f;
            volume += description.particle_volume[i];
            overlap += n;
        }
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            weight_[k] /= total;
        }
        mass_[c] = free_mass / free_count;
        spring_[c] = description.youngs_modulus[c] * 5.0f * (volume / free_count) / (overlap / free_count);
    }
    set_rest(particles);
    // k = 5 E V / (n r^2) with r^2 = 5/3 of the mean squared offset.
    for (std::size_t c = 0; c < clusters; ++c) {
        float squared = 0.0f;
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            squared += weight_[k] * offset_[k].squaredNorm();
        }
        spring_[c] /= std::max(squared * 5.0f / 3.0f, 1e-12f);
    }
    share_dt_ = 0.0f;
    reset();
}

void ShapeMatching::set_rest(const Particles& particles) {
    for_ranges(rest_centre_.size(), cluster_grain, [&](std::size_t c) {
        const Vec3f origin = particles.rest[member_[first_[c]]];
        Vec3f mean = Vec3f::Zero();
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            mean += weight_[k] * (particles.rest[member_[k]] - origin);
        }
        rest_centre_[c] = origin + mean;
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            offset_[k] = particles.rest[member_[k]] - rest_centre_[c];
        }
    });
}

void ShapeMatching::reset() {
    for (std::size_t c = 0; c < rotation_.size(); ++c) {
        rotation_[c] = Quatf::Identity();
        centre_[c] = rest_centre_[c];
    }
}

void ShapeMatching::fit_cluster(std::size_t c, const std::vector<Vec3f>& positions) {
    // Relative to one member: the products then keep their digits wherever the body is.
    const Vec3f origin = positions[member_[first_[c]]];
    Vec3f mean = Vec3f::Zero();
    Mat3f a = Mat3f::Zero();
    for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
        const Vec3f x = weight_[k] * (positions[member_[k]] - origin);
        mean += x;
        a += x * offset_[k].transpose();  // offsets have zero weighted mean: no correction by the mean
    }
    centre_[c] = origin + mean;
    rotation_[c] = extract_rotation(a, rotation_[c], rotation_steps);
}

void ShapeMatching::fit(const std::vector<Vec3f>& positions) {
    for_ranges(rotation_.size(), cluster_grain, [&](std::size_t c) { fit_cluster(c, positions); });
}

void ShapeMatching::update_stiffness(float dt) {
    for (std::size_t c = 0; c < share_.size(); ++c) {
        const float stiff = spring_[c] * dt * dt;
        share_[c] = stiff / (mass_[c] + stiff);
    }
    share_dt_ = dt;
}

void ShapeMatching::project(Particles& particles, float dt) {
    if (dt != share_dt_) {
        update_stiffness(dt);
    }
    fit(particles.predicted);
    for_ranges(particles.size(), particle_grain, [&](std::size_t i) {
        if (inverse_count_[i] == 0.0f) {
            return;
        }
        const Vec3f x = particles.predicted[i];
        Vec3f move = Vec3f::Zero();
        for (const std::uint32_t c : clusters_of(i)) {
            const Vec3f goal = rotation_[c] * (particles.rest[i] - rest_centre_[c]) + centre_[c];
            move += share_[c] * (goal - x);
        }
        particles.predicted[i] = x + inverse_count_[i] * move;
    });
}

}  // namespace eti::pbd
