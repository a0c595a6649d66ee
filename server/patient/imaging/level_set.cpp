// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/level_set.hpp"

#include <algorithm>
#include <cmath>

#include "common/mesh/distance.hpp"
#include "server/parallel/loops.hpp"

namespace eti::imaging {

namespace {

constexpr float half_band = 4.0f;  // [voxels]
constexpr int steps_between = 5;   // fronts move by at most 2 voxels, within the band

/// Rate of change of phi [m] per unit of time (in which a speed of 1 moves the front by one voxel).
float rate(const DistanceGrid& phi, std::size_t i, const std::array<std::size_t, 3>& stride, float speed,
           float curvature) {
    const std::vector<float>& v = phi.value;
    const float h = phi.spacing;
    float grow = 0.0f;    // |grad phi| for a growing front
    float shrink = 0.0f;  // the same for a shrinking one
    Vec3f central;
    Vec3f second;
    for (std::size_t k = 0; k < 3; ++k) {
        const float back = (v[i] - v[i - stride[k]]) / h;
        const float forth = (v[i + stride[k]] - v[i]) / h;
        const auto square = [](float a) { return a * a; };
        grow += std::max(square(std::max(back, 0.0f)), square(std::min(forth, 0.0f)));
        shrink += std::max(square(std::min(back, 0.0f)), square(std::max(forth, 0.0f)));
        central[static_cast<int>(k)] = 0.5f * (back + forth);
        second[static_cast<int>(k)] = (forth - back) / h;
    }
    const auto mixed = [&](std::size_t a, std::size_t b) {
        return (v[i + stride[a] + stride[b]] - v[i + stride[a] - stride[b]] - v[i - stride[a] + stride[b]] +
                v[i - stride[a] - stride[b]]) /
               (4.0f * h * h);
    };
    const Vec3f g = central;
    const float squared = g.squaredNorm();
    float bend = 0.0f;
    if (squared > 1e-6f) {
        const float numerator =
            (second.y() + second.z()) * g.x() * g.x() + (second.x() + second.z()) * g.y() * g.y() +
            (second.x() + second.y()) * g.z() * g.z() -
            2.0f * (g.x() * g.y() * mixed(0, 1) + g.x() * g.z() * mixed(0, 2) + g.y() * g.z() * mixed(1, 2));
        bend = numerator / (squared * std::sqrt(squared));
        bend = std::clamp(bend, -1.0f / h, 1.0f / h);
    }
    const float advance = speed > 0.0f ? speed * std::sqrt(grow) : speed * std::sqrt(shrink);
    return h * (curvature * bend * std::sqrt(squared) - advance);
}

}  // namespace

DistanceGrid evolve(DistanceGrid start, std::span<const float> speed, const LevelSetSettings& settings,
                    const std::function<bool(int)>& progress) {
    const float h = start.spacing;
    const std::array<std::size_t, 3> stride = {
        1, static_cast<std::size_t>(start.size[0]),
        static_cast<std::size_t>(start.size[0]) * static_cast<std::size_t>(start.size[1])};
    // Stability limit of speed 1 and curvature diffusion: dt (1 / h * h + 6 b / h) <= 1.
    const float step = std::min(0.4f, 1.0f / (1.0f + 6.0f * settings.curvature / h));
    DistanceGrid phi = redistance(start, half_band * h);
    std::vector<std::size_t> band;
    std::vector<float> next;
    int resting = 0;
    for (int done = 0; done < settings.max_steps && resting < 2; done += steps_between) {
        band.clear();
        for (int z = 1; z + 1 < phi.size[2]; ++z) {
            for (int y = 1; y + 1 < phi.size[1]; ++y) {
                for (int x = 1; x + 1 < phi.size[0]; ++x) {
                    const std::size_t i = phi.index(x, y, z);
                    if (std::fabs(phi.value[i]) < 0.9f * half_band * h) {
                        band.push_back(i);
                    }
                }
            }
        }
        next.resize(band.size());
        const std::vector<float> before = phi.value;
        for (int k = 0; k < steps_between; ++k) {
            parallel::for_each(band.size(), 4096, [&](std::size_t b) {
                next[b] = phi.value[band[b]] +
                          step * rate(phi, band[b], stride, speed[band[b]], settings.curvature);
            });
            for (std::size_t b = 0; b < band.size(); ++b) {
                phi.value[band[b]] = next[b];
            }
        }
        std::size_t changed = 0;
        std::size_t inside = 0;
        for (const std::size_t i : band) {
            changed += (phi.value[i] < 0.0f) != (before[i] < 0.0f) ? 1 : 0;
            inside += phi.value[i] < 0.0f ? 1 : 0;
        }
        resting = static_cast<float>(changed) <= settings.rest * static_cast<float>(inside) ? resting + 1 : 0;
        phi = redistance(phi, half_band * h);
        if (inside == 0 || !progress(done + steps_between)) {
            break;
        }
    }
    return phi;
}

}  // namespace eti::imaging
