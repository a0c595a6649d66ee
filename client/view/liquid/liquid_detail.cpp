// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid/liquid_detail.hpp"

namespace eti::view {
namespace {

// States arrive at 90 Hz. After a longer gap particles cannot be matched.
constexpr std::uint64_t longest_gap_ns = 100'000'000;

}  // namespace

void LiquidDetail::advance(std::uint64_t time_ns, std::span<const Vec3f> positions, float spacing,
                           std::span<const Capsule> tools) {
    if (positions.empty() || positions.size() > max_particles) {
        if (!tracks_.positions().empty()) {
            clear();
        }
        return;
    }
    const bool later = time_ns_ != 0 && time_ns > time_ns_;
    const bool followed = later && time_ns - time_ns_ < longest_gap_ns;
    const float dt = later ? 1e-9f * static_cast<float>(time_ns - time_ns_) : 0.0f;
    time_ns_ = time_ns;
    tracks_.advance(positions, spacing, followed ? dt : 0.0f);
    if (!later) {
        foam_.clear();
    }
    foam_.advance(tracks_, spacing, dt, liquid_.foaming);
    if (!followed) {
        filaments_.clear();
        return;
    }
    filaments_.advance(tracks_, tools, spacing, dt, liquid_.stringing);
}

void LiquidDetail::clear() {
    time_ns_ = 0;
    tracks_.advance({}, 1e-3f, 0.0f);
    foam_.clear();
    filaments_.clear();
}

}  // namespace eti::view
