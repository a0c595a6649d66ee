// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/skin/value_noise.hpp"

#include <cmath>
#include <cstdint>

#include "common/math/random.hpp"

namespace eti::render {
namespace {

float lattice(int x, int y, int z) {
    const auto mix = [](int v, std::uint64_t prime) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)) * prime;
    };
    return Random(mix(x, 0x8da6b343) ^ mix(y, 0xd8163841) ^ mix(z, 0xcb1ab31f)).uniform();
}

}  // namespace

float value_noise(const Vec3f& p) {
    const Vec3f base(std::floor(p.x()), std::floor(p.y()), std::floor(p.z()));
    const Vec3f t = p - base;
    const int x = static_cast<int>(base.x()), y = static_cast<int>(base.y()), z = static_cast<int>(base.z());
    const Vec3f s = t.cwiseProduct(t).cwiseProduct(Vec3f::Constant(3.0f) - 2.0f * t);
    float sum = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        const int i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
        const float weight = (i != 0 ? s.x() : 1.0f - s.x()) * (j != 0 ? s.y() : 1.0f - s.y()) *
                             (k != 0 ? s.z() : 1.0f - s.z());
        sum += weight * lattice(x + i, y + j, z + k);
    }
    return sum;
}

}  // namespace eti::render
