// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/liquid_boundary.hpp"

#include <algorithm>
#include <cmath>

#include "server/parallel/loops.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::scene {

namespace {

constexpr std::size_t max_near_balls = 1024;  // balls near a block; four times the number of a fine lattice

}  // namespace

struct LiquidBoundary::Near {
    using Numbers = std::array<float, max_near_balls + pbd::lane_count>;
    std::size_t count = 0;
    alignas(32) Numbers x, y, z, radius;
};

Eigen::Vector3i LiquidBoundary::block_of(const Vec3f& point) const {
    const Vec3f scaled = (point - grid_.origin) / (static_cast<float>(block) * grid_.spacing);
    // Clamped as float: a distant point would overflow an integer.
    const Vec3f last = (blocks_along_ - Eigen::Vector3i::Ones()).cast<float>();
    return scaled.cwiseMin(last).cwiseMax(0.0f).cast<int>();
}

void LiquidBoundary::reset(const DistanceGrid& shell) {
    grid_ = shell;
    current_.clear();
    known_.clear();
}

void LiquidBoundary::update(const DistanceGrid& shell, std::uint64_t revision, const pbd::Particles& tissue,
                            std::span<const Vec3f> liquid) {
    if (revision != revision_) {
        reset(shell);
        revision_ = revision;
    }
    for (int axis = 0; axis < 3; ++axis) {
        blocks_along_[axis] = (shell.size[static_cast<std::size_t>(axis)] + block - 1) / block;
    }
    find_blocks(liquid);
    find_balls(tissue);
    find_outdated();
    parallel::for_each(outdated_.size(), 8, [&](std::size_t k) { fill(outdated_[k], shell); });
}

void LiquidBoundary::find_blocks(std::span<const Vec3f> liquid) {
    wanted_.assign(static_cast<std::size_t>(blocks_along_.prod()), 0);
    blocks_.clear();
    // One node more than the displacement: interpolation uses the eight nodes around a point.
    const Vec3f margin = Vec3f::Constant(way_ + grid_.spacing);
    for (const Vec3f& point : liquid) {
        const Eigen::Vector3i low = block_of(point - margin);
        const Eigen::Vector3i high = block_of(point + margin);
        for (int z = low.z(); z <= high.z(); ++z) {
            for (int y = low.y(); y <= high.y(); ++y) {
                for (int x = low.x(); x <= high.x(); ++x) {
                    const int which = (z * blocks_along_.y() + y) * blocks_along_.x() + x;
                    if (wanted_[static_cast<std::size_t>(which)] == 0) {
                        wanted_[static_cast<std::size_t>(which)] = 1;
                        blocks_.push_back(static_cast<std::uint32_t>(which));
                    }
                }
            }
        }
    }
}

void LiquidBoundary::find_balls(const pbd::Particles& tissue) {
    Eigen::Vector3i low = Eigen::Vector3i::Constant(1 << 30);
    Eigen::Vector3i high = Eigen::Vector3i::Constant(-1);
    for (const std::uint32_t which : blocks_) {
        const int w = static_cast<int>(which);
        const Eigen::Vector3i place(w % blocks_along_.x(), w / blocks_along_.x() % blocks_along_.y(),
                                    w / blocks_along_.x() / blocks_along_.y());
        low = low.cwiseMin(place);
        high = high.cwiseMax(place);
    }
    const float side = static_cast<float>(block) * grid_.spacing;
    unsorted_.clear();
    ball_block_.clear();
    moved_.assign(wanted_.size(), 0);
    first_ball_.assign(wanted_.size() + 1, 0);
    largest_ = 0.0f;
    if (blocks_.empty()) {
        ball_.clear();
        return;
    }
    for (std::size_t i = 0; i < tissue.size(); ++i) {
        largest_ = std::max(largest_, ball_size * tissue.radius[i]);
    }
    const Vec3f margin = Vec3f::Constant(largest_ + reach_);
    const Vec3f from = grid_.origin + side * low.cast<float>() - margin;
    const Vec3f to = grid_.origin + side * (high + Eigen::Vector3i::Ones()).cast<float>() + margin;
    current_.resize(wanted_.size(), 0);
    if (known_.size() != tissue.size()) {
        known_ = tissue.position;
    }
    const auto inside = [&](const Vec3f& point) {
        return (point.array() >= from.array()).all() && (point.array() <= to.array()).all();
    };
    const auto index_of = [&](const Vec3f& point) {
        const Eigen::Vector3i place = block_of(point);
        return static_cast<std::size_t>((place.z() * blocks_along_.y() + place.y()) * blocks_along_.x() +
                                        place.x());
    };
    for (std::size_t i = 0; i < tissue.size(); ++i) {
        const Vec3f& p = tissue.position[i];
        if ((p - known_[i]).squaredNorm() > quantum * quantum) {
            for (const Vec3f& place : {known_[i], p}) {
                const std::size_t which = inside(place) ? index_of(place) : moved_.size();
                if (which < moved_.size() && moved_[which] == 0) {
                    moved_[which] = 1;
                    touch(which);
                }
            }
            known_[i] = p;
        }
        if (inside(p)) {
            const std::size_t which = index_of(p);
            unsorted_.push_back({p, ball_size * tissue.radius[i]});
            ball_block_.push_back(static_cast<std::uint32_t>(which));
            ++first_ball_[which];
        }
    }
    // Stable counting sort: backwards, so that each start ends up at its block's first position.
    std::uint32_t sum = 0;
    for (std::uint32_t& first : first_ball_) {
        sum += first;
        first = sum;
    }
    ball_.resize(unsorted_.size());
    for (std::size_t i = unsorted_.size(); i-- > 0;) {
        ball_[--first_ball_[ball_block_[i]]] = unsorted_[i];
    }
}

void LiquidBoundary::find_outdated() {
    outdated_.clear();
    current_.swap(before_);
    current_.assign(wanted_.size(), 0);
    before_.resize(wanted_.size(), 0);
    for (const std::uint32_t which : blocks_) {
        if (before_[which] == 0) {
            outdated_.push_back(which);
        }
        current_[which] = 1;
    }
}

/// Marks as outdated what is within reach of a block in which a ball moved.
void LiquidBoundary::touch(std::size_t which) {
    const int w = static_cast<int>(which);
    const Eigen::Vector3i place(w % blocks_along_.x(), w / blocks_along_.x() % blocks_along_.y(),
                                w / blocks_along_.x() / blocks_along_.y());
    const int far = static_cast<int>((largest_ + reach_) / (static_cast<float>(block) * grid_.spacing)) + 1;
    const Eigen::Vector3i low = (place - Eigen::Vector3i::Constant(far)).cwiseMax(0);
    const Eigen::Vector3i high =
        (place + Eigen::Vector3i::Constant(far)).cwiseMin(blocks_along_ - Eigen::Vector3i::Ones());
    for (int z = low.z(); z <= high.z(); ++z) {
        for (int y = low.y(); y <= high.y(); ++y) {
            for (int x = low.x(); x <= high.x(); ++x) {
                current_[static_cast<std::size_t>((z * blocks_along_.y() + y) * blocks_along_.x() + x)] = 0;
            }
        }
    }
}

void LiquidBoundary::find_near(const Vec3f& low, const Vec3f& high, Near& near) const {
    std::size_t count = 0;
    const float far = largest_ + reach_;
    const Eigen::Vector3i first = block_of(low - Vec3f::Constant(far));
    const Eigen::Vector3i last = block_of(high + Vec3f::Constant(far));
    for (int bz = first.z(); bz <= last.z(); ++bz) {
        for (int by = first.y(); by <= last.y(); ++by) {
            const auto row = static_cast<std::size_t>((bz * blocks_along_.y() + by) * blocks_along_.x());
            const std::uint32_t stop = first_ball_[row + static_cast<std::size_t>(last.x()) + 1];
            for (std::uint32_t k = first_ball_[row + static_cast<std::size_t>(first.x())]; k < stop; ++k) {
                const Ball& ball = ball_[k];
                const float within = ball.radius + reach_;
                const Vec3f closest = ball.centre.cwiseMax(low).cwiseMin(high);
                if ((ball.centre - closest).squaredNorm() < within * within && count < max_near_balls) {
                    near.x[count] = ball.centre.x();
                    near.y[count] = ball.centre.y();
                    near.z[count] = ball.centre.z();
                    near.radius[count++] = ball.radius;
                }
            }
        }
    }
    near.count = count;
    // Padding lanes are too far to be the nearest.
    for (std::size_t k = count; k < count + pbd::lane_count; ++k) {
        near.x[k] = near.y[k] = near.z[k] = 1e3f;
        near.radius[k] = 0.0f;
    }
}

[[gnu::always_inline]] inline float LiquidBoundary::nearest(const Near& near, const Vec3f& point) {
    using pbd::Lanes;
    Lanes least = Lanes{} + 1.0f;
    for (std::size_t n = 0; n < near.count; n += pbd::lane_count) {
        Lanes x;
        Lanes y;
        Lanes z;
        Lanes radius;
        pbd::load(&near.x[n], x);
        pbd::load(&near.y[n], y);
        pbd::load(&near.z[n], z);
        pbd::load(&near.radius[n], radius);
        x -= point.x();
        y -= point.y();
        z -= point.z();
        Lanes distance = x * x + y * y + z * z;
        pbd::sqrt_in_place(distance);
        distance -= radius;
        least = distance < least ? distance : least;
    }
    float result = least[0];
    for (std::size_t lane = 1; lane < pbd::lane_count; ++lane) {
        result = std::min(result, least[lane]);
    }
    return result;
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] float LiquidBoundary::nearest_avx2(const Near& near, const Vec3f& point) {
    return nearest(near, point);
}
#else
float LiquidBoundary::nearest_avx2(const Near& near, const Vec3f& point) {
    return nearest(near, point);
}
#endif

void LiquidBoundary::fill(std::uint32_t which, const DistanceGrid& shell) {
    const int w = static_cast<int>(which);
    const Eigen::Vector3i place(w % blocks_along_.x(), w / blocks_along_.x() % blocks_along_.y(),
                                w / blocks_along_.x() / blocks_along_.y());
    const Eigen::Vector3i begin = block * place;
    Eigen::Vector3i end;
    for (int axis = 0; axis < 3; ++axis) {
        end[axis] = std::min(begin[axis] + block, shell.size[static_cast<std::size_t>(axis)]);
    }
    const Vec3f low = shell.node(begin.x(), begin.y(), begin.z());
    const Vec3f high = shell.node(end.x() - 1, end.y() - 1, end.z() - 1);

    Near near;
    find_near(low, high, near);
    static const bool avx2 = pbd::has_avx2();
    for (int k = begin.z(); k < end.z(); ++k) {
        for (int j = begin.y(); j < end.y(); ++j) {
            for (int i = begin.x(); i < end.x(); ++i) {
                const Vec3f node = shell.node(i, j, k);
                const std::size_t at = shell.index(i, j, k);
                grid_.value[at] =
                    std::min(shell.value[at], avx2 ? nearest_avx2(near, node) : nearest(near, node));
            }
        }
    }
}

}  // namespace eti::scene
