// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/shape_matching.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <numeric>

#include "server/parallel/loops.hpp"
#include "server/pbd/lanes.hpp"
#include "server/pbd/rotation.hpp"

namespace eti::pbd {

namespace {

// Warm-started from the last substep: four iterations leave a thousandth of the rotation since. The number is
// even so that the remainder lags: goals that lead the body would add energy.
constexpr int rotation_steps = 4;
constexpr std::size_t cluster_block_grain = 8;
static_assert(ShapeMatching::block_size == lane_count);
constexpr std::size_t cluster_particle_grain = 512;

[[nodiscard]] std::size_t blocks_of(std::size_t clusters) {
    return (clusters + lane_count - 1) / lane_count;
}

}  // namespace

void ShapeMatching::configure(const Description& description, const Particles& particles) {
    goal_share_ = description.goal_share;
    avx2_ = has_avx2();
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

    movers_.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
        if (inverse_count_[i] > 0.0f) {
            movers_.push_back(i);
        }
    }
    blocks_.resize(blocks_of(clusters));
    std::iota(blocks_.begin(), blocks_.end(), 0u);
    awake_blocks_ = blocks_;
    awake_movers_ = movers_;

    const std::size_t padded = lane_count * blocks_of(clusters);
    moment_.assign(member_.size() + 1, Eigen::Vector4f::Zero());
    rest_centre_.assign(clusters, Vec3f::Zero());
    centre_.assign(clusters, Vec3f::Zero());
    rotation_.assign(padded, Quatf::Identity());
    lever_.assign(padded, Eigen::Vector4f::Zero());
    frame_.assign(padded, {});
    spring_.resize(clusters);
    unit_spring_.resize(clusters);
    mass_.resize(clusters);
    wide_.assign(count + 1, Eigen::Vector4f::Zero());
    wide_rest_.assign(count, Eigen::Vector4f::UnitW());
    for (std::size_t c = 0; c < clusters; ++c) {
        assert(first_[c + 1] > first_[c]);
        float total = 0.0f;
        float volume = 0.0f;
        float overlap = 0.0f;
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            const std::uint32_t i = member_[k];
            const auto n = static_cast<float>(memberships[i]);
            moment_[k].w() = description.fitting_mass[i] / n;
            total += moment_[k].w();
            volume += description.particle_volume[i];
            overlap += n;
        }
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            moment_[k].w() /= total;
        }
        mass_[c] = total / static_cast<float>(first_[c + 1] - first_[c]);
        spring_[c] = description.youngs_modulus[c] * 5.0f * volume / overlap;
    }
    set_rest(particles);
    // k = 5 E V / (n r^2) with r^2 = 5/3 of the mean squared offset.
    for (std::size_t c = 0; c < clusters; ++c) {
        float squared = 0.0f;
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            squared += moment_[k].head<3>().squaredNorm() / moment_[k].w();
        }
        spring_[c] /= std::max(squared * 5.0f / 3.0f, 1e-12f);
        unit_spring_[c] = spring_[c] / description.youngs_modulus[c];
    }
    share_dt_ = 0.0f;
    reset();
}

void ShapeMatching::set_rest(const Particles& particles) {
    origin_ = particles.size() > 0 ? particles.rest[0] : Vec3f::Zero();
    for (std::size_t i = 0; i < particles.size(); ++i) {
        wide_rest_[i].head<3>() = particles.rest[i] - origin_;
    }
    parallel::for_each(rest_centre_.size(), lane_count * cluster_block_grain, [&](std::size_t c) {
        const Vec3f near = particles.rest[member_[first_[c]]];
        Vec3f mean = Vec3f::Zero();
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            mean += moment_[k].w() * (particles.rest[member_[k]] - near);
        }
        rest_centre_[c] = near + mean;
        lever_[c].head<3>() = rest_centre_[c] - origin_;
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
            moment_[k].head<3>() = moment_[k].w() * (particles.rest[member_[k]] - rest_centre_[c]);
        }
    });
}

void ShapeMatching::set_youngs_modulus(std::span<const float> moduli) {
    assert(moduli.size() == size());
    for (std::size_t c = 0; c < size(); ++c) {
        spring_[c] = moduli[c] * unit_spring_[c];
    }
    share_dt_ = 0.0f;  // the next pass computes the shares
}

void ShapeMatching::reset() {
    for (std::size_t c = 0; c < size(); ++c) {
        rotation_[c] = Quatf::Identity();
        centre_[c] = rest_centre_[c];
    }
}

ShapeMatching::GoalSpring ShapeMatching::goal_spring(std::size_t particle) const {
    const Vec3f rest = wide_rest_[particle].head<3>();
    GoalSpring sum;
    for (const std::uint32_t c : clusters_of(particle)) {
        const Vec3f lever = rest - lever_[c].head<3>();
        sum.goal += spring_[c] * (centre_[c] + rotation_[c] * lever);
        sum.stiffness += spring_[c];
    }
    sum.goal /= sum.stiffness;
    return sum;
}

void ShapeMatching::update_shares(float dt) {
    for (std::size_t c = 0; c < size(); ++c) {
        const float stiff = spring_[c] * dt * dt;
        lever_[c].w() = goal_share_ > 0.0f ? goal_share_ : stiff / (mass_[c] + stiff);
    }
    share_dt_ = dt;
}

// Adds w (x - origin) (q, 1)^T of a member to its cluster's sums: columns 0 and 1, and columns 2 and 3.
[[gnu::always_inline]] inline void add_moment(const float* position, const float* moment,
                                              const Lanes& origins, Lanes& low, Lanes& high) {
    Float4 x;
    Float4 m;
    std::memcpy(&x, position, sizeof x);
    std::memcpy(&m, moment, sizeof m);
    const Lanes apart = __builtin_shufflevector(x, x, 0, 1, 2, 3, 0, 1, 2, 3) - origins;
    low += __builtin_shufflevector(m, m, 0, 0, 0, 0, 1, 1, 1, 1) * apart;
    high += __builtin_shufflevector(m, m, 2, 2, 2, 2, 3, 3, 3, 3) * apart;
}

[[gnu::always_inline]] inline void ShapeMatching::fit_blocks(Indices blocks) {
    const float* wide = wide_.front().data();
    const float* moment = moment_.front().data();
    constexpr std::uint32_t row[lane_count] = {0, 16, 32, 48, 64, 80, 96, 112};
    for (const std::uint32_t block : blocks) {
        const std::size_t first = lane_count * block;
        const std::size_t count = std::min(lane_count, size() - first);
        // Per cluster: the three columns of A = sum w (x - near) q^T and the mean of x - near; then near.
        alignas(64) float sums[16 * lane_count];
        alignas(64) float near[16 * lane_count];
        if (count < lane_count) {
            std::ranges::fill(sums, 0.0f);
            std::ranges::fill(near, 0.0f);
        }
        for (std::size_t lane = 0; lane < count; ++lane) {
            const std::uint32_t from = first_[first + lane];
            const std::uint32_t to = first_[first + lane + 1];
            // Relative to one member, so that products keep their precision wherever the body is.
            Float4 origin;
            std::memcpy(&origin, wide + 4 * member_[from], sizeof origin);
            const Lanes origins = __builtin_shufflevector(origin, origin, 0, 1, 2, 3, 0, 1, 2, 3);
            Lanes low{}, high{}, low_odd{}, high_odd{};  // two accumulators each, to hide latency
            std::uint32_t k = from;
            for (; k + 1 < to; k += 2) {
                add_moment(wide + 4 * member_[k], moment + 4 * k, origins, low, high);
                add_moment(wide + 4 * member_[k + 1], moment + 4 * (k + 1), origins, low_odd, high_odd);
            }
            if (k < to) {
                add_moment(wide + 4 * member_[k], moment + 4 * k, origins, low, high);
            }
            low += low_odd;
            high += high_odd;
            std::memcpy(sums + row[lane], &low, sizeof low);
            std::memcpy(sums + row[lane] + 8, &high, sizeof high);
            std::memcpy(near + row[lane], &origin, sizeof origin);
        }
        Lanes a[3][3];
        Lanes centre[3];
        Lanes place[3];
        Lanes unused;
        for (int c = 0; c < 3; ++c) {
            gather(sums + 4 * c, row, a[c], unused);
        }
        gather(sums + 12, row, centre, unused);
        gather(near, row, place, unused);

        constexpr std::uint32_t quadruple[lane_count] = {0, 4, 8, 12, 16, 20, 24, 28};
        Lanes vector[3];
        Lanes scalar;
        float* rotation = rotation_[first].coeffs().data();
        gather(rotation, quadruple, vector, scalar);
        Lanes q[4] = {vector[0], vector[1], vector[2], scalar};
        extract_rotation(a, q, rotation_steps);
        Lanes length = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        sqrt_in_place(length);
        for (Lanes& part : q) {
            part /= length;
        }
        const Lanes unit[3] = {q[0], q[1], q[2]};
        scatter(rotation, quadruple, unit, q[3]);

        Lanes r[3][3];
        rotation_columns(q, r);
        Lanes lever[3];
        Lanes share;
        gather(lever_[first].data(), quadruple, lever, share);
        float* frame = frame_[first].packed;
        Lanes moved[3];
        for (int i = 0; i < 3; ++i) {
            centre[i] += place[i];
            moved[i] = share * (centre[i] - (r[0][i] * lever[0] + r[1][i] * lever[1] + r[2][i] * lever[2]));
        }
        for (int c = 0; c < 3; ++c) {
            const Lanes column[3] = {share * r[c][0], share * r[c][1], share * r[c][2]};
            scatter(frame + 4 * c, row, column, Lanes{});
        }
        scatter(frame + 12, row, moved, share);
        for (std::size_t lane = 0; lane < count; ++lane) {
            centre_[first + lane] = Vec3f(centre[0][lane], centre[1][lane], centre[2][lane]);
        }
    }
}

[[gnu::always_inline]] inline void ShapeMatching::move_particles(Particles& particles, Indices which) const {
    const std::uint32_t* const first_of = first_of_.data();
    const std::uint32_t* const cluster_of = cluster_of_.data();
    const Frame* const frames = frame_.data();
    const float* const wide_rest = wide_rest_.front().data();
    const float* const wide = wide_.front().data();
    const float* const inverse_count = inverse_count_.data();
    float* const predicted = particles.predicted.front().data();
    for (const std::uint32_t i : which) {
        Lanes low{};
        Lanes high{};
        for (std::uint32_t k = first_of[i]; k < first_of[i + 1]; ++k) {
            const float* frame = frames[cluster_of[k]].packed;
            Lanes part;
            load(frame, part);
            low += part;
            load(frame + 8, part);
            high += part;
        }
        const Float4 rest = load_float4(wide_rest + 4 * std::size_t{i});
        Float4 x = load_float4(wide + 4 * std::size_t{i});
        const Lanes goals = low * __builtin_shufflevector(rest, rest, 0, 0, 0, 0, 1, 1, 1, 1) +
                            high * __builtin_shufflevector(rest, rest, 2, 2, 2, 2, 3, 3, 3, 3);
        const Float4 goal = __builtin_shufflevector(goals, goals, 0, 1, 2, 3) +
                            __builtin_shufflevector(goals, goals, 4, 5, 6, 7);
        x += inverse_count[i] * (goal - high[7] * x);
        std::memcpy(predicted + 3 * std::size_t{i}, &x, sizeof(Vec3f));
    }
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void ShapeMatching::fit_blocks_avx2(Indices blocks) {
    fit_blocks(blocks);
}
[[gnu::target("avx2")]] void ShapeMatching::move_particles_avx2(Particles& particles, Indices which) const {
    move_particles(particles, which);
}
#else
void ShapeMatching::fit_blocks_avx2(Indices blocks) {
    fit_blocks(blocks);
}
void ShapeMatching::move_particles_avx2(Particles& particles, Indices which) const {
    move_particles(particles, which);
}
#endif

void ShapeMatching::select(std::span<const std::uint8_t> block_asleep, const Particles& particles) {
    const auto pick = [](const std::vector<std::uint32_t>& all, std::span<const std::uint8_t> asleep,
                         std::vector<std::uint32_t>& awake) {
        awake.clear();
        std::ranges::copy_if(all, std::back_inserter(awake),
                             [&](std::uint32_t which) { return asleep[which] == 0; });
    };
    pick(blocks_, block_asleep, awake_blocks_);
    pick(movers_, particles.asleep, awake_movers_);
}

void ShapeMatching::read(const std::vector<Vec3f>& positions, std::size_t first, std::size_t last) {
    if (first == last) {
        return;
    }
    parallel::for_ranges(last - first, 8 * cluster_particle_grain, [&](std::size_t from, std::size_t to) {
        const std::size_t begin = first + from;
        const std::size_t end = first + to;
        const float* const position = positions.front().data();
        float* const wide = wide_.front().data();
        // Whole loads, whose last number is that of the next particle; no kernel reads it.
        for (std::size_t i = begin; i + 1 < end; ++i) {
            put(load_float4(position + 3 * i), wide + 4 * i);
        }
        wide_[end - 1].head<3>() = positions[end - 1];
    });
}

void ShapeMatching::fit(Indices blocks) {
    if (blocks.empty()) {
        return;
    }
    parallel::for_ranges(blocks.size(), cluster_block_grain, [&](std::size_t begin, std::size_t end) {
        const Indices part = blocks.subspan(begin, end - begin);
        avx2_ ? fit_blocks_avx2(part) : fit_blocks(part);
    });
}

void ShapeMatching::move(Particles& particles, Indices which) const {
    if (which.empty()) {
        return;
    }
    parallel::for_ranges(which.size(), cluster_particle_grain, [&](std::size_t begin, std::size_t end) {
        const Indices part = which.subspan(begin, end - begin);
        avx2_ ? move_particles_avx2(particles, part) : move_particles(particles, part);
    });
}

void ShapeMatching::fit(const std::vector<Vec3f>& positions) {
    read(positions, 0, positions.size());
    fit(Indices(blocks_));
}

void ShapeMatching::project(Particles& particles, float dt) {
    if (dt != share_dt_) {
        update_shares(dt);
    }
    for (const auto& [begin, end] : particles.awake) {
        read(particles.predicted, begin, end);
    }
    fit(Indices(awake_blocks_));
    move(particles, awake_movers_);
}

}  // namespace eti::pbd
