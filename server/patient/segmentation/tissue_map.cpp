// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/tissue_map.hpp"
#include "server/patient/mesh/components.hpp"

#include <fmt/format.h>
#include <cmath>

namespace eti::segmentation {

namespace {

using imaging::Bits;
using imaging::Geometry;
using imaging::Size;
using imaging::VolumeError;

/// The part of `open` that is connected to the left, right, front and back faces of the volume. At top and
/// bottom the scan may cut through the patient.
Bits reached_from_sides(const Size& size, const Bits& open) {
    const Components parts = components(size, open);
    std::vector<std::uint8_t> beside(parts.voxels.size(), 0);
    std::size_t i = 0;
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            for (int x = 0; x < size[0]; ++x, ++i) {
                if (x == 0 || y == 0 || x + 1 == size[0] || y + 1 == size[1]) {
                    beside[parts.part[i]] = 1;
                }
            }
        }
    }
    beside[0] = 0;
    Bits reached(open.size());
    for (std::size_t k = 0; k < open.size(); ++k) {
        reached[k] = beside[parts.part[k]];
    }
    return reached;
}

bool touches(const Geometry& g, const Bits& bits, std::size_t i) {
    const auto [x, y, z] = g.coordinates(i);
    const auto in = [&](int a, int b, int c) { return g.contains(a, b, c) && bits[g.index(a, b, c)] != 0; };
    return in(x - 1, y, z) || in(x + 1, y, z) || in(x, y - 1, z) || in(x, y + 1, z) || in(x, y, z - 1) ||
           in(x, y, z + 1);
}

}  // namespace

void require_ct(const imaging::Volume& ct, const SegmentSettings& settings) {
    constexpr float lowest = -3100.0f;  // some scanners mark voxels outside their field of view by -3024
    constexpr float highest = 4100.0f;  // metal
    std::size_t wild = 0;
    std::size_t air = 0;
    std::size_t tissue = 0;
    for (const float v : ct.value) {
        wild += v < lowest || v > highest ? 1 : 0;
        air += v < settings.air_below ? 1 : 0;
        tissue += v > -150.0f && v < settings.bone_above ? 1 : 0;
    }
    const auto percent = [&](std::size_t part) {
        return 100.0 * static_cast<double>(part) / static_cast<double>(ct.value.size());
    };
    if (percent(wild) > 5.0) {
        throw VolumeError(fmt::format(
            "the volume has {:.0f} % of its values outside {:.0f} to {:.0f}; expected Hounsfield units. "
            "Remedy: check byte order (endian), slope and intercept.",
            percent(wild), lowest, highest));
    }
    if (percent(air) < 0.5 || percent(tissue) < 0.5) {
        throw VolumeError(
            fmt::format("the volume is {:.1f} % air and {:.1f} % soft tissue; expected a CT of head and neck "
                        "in Hounsfield units with some of both. Remedy: check slope, intercept and region.",
                        percent(air), percent(tissue)));
    }
}

TissueMap map_tissues(const imaging::Volume& ct, const SegmentSettings& settings) {
    const Geometry& g = ct.geometry;
    const auto h = static_cast<float>(g.spacing().x());
    const std::size_t n = ct.value.size();

    Bits solid(n);
    for (std::size_t i = 0; i < n; ++i) {
        solid[i] = ct.value[i] >= settings.air_below ? 1 : 0;
    }
    const Components bodies = components(g.size, solid);
    const std::uint32_t patient = bodies.largest();
    Bits body(n);
    for (std::size_t i = 0; i < n; ++i) {
        body[i] = patient != 0 && bodies.part[i] == patient ? 1 : 0;
    }
    Bits open = imaging::morphological_close(g.size, body, settings.closing / h);
    for (std::uint8_t& v : open) {
        v = 1 - v;
    }
    TissueMap map;
    map.outside = reached_from_sides(g.size, open);
    Bits inner_air(n);
    for (std::size_t i = 0; i < n; ++i) {
        inner_air[i] = map.outside[i] == 0 && solid[i] == 0 ? 1 : 0;
    }
    const Components spaces = components(g.size, inner_air);
    std::vector<std::uint8_t> opens(spaces.voxels.size(), 0);
    for (std::size_t i = 0; i < n; ++i) {
        if (inner_air[i] != 0 && opens[spaces.part[i]] == 0 && touches(g, map.outside, i)) {
            opens[spaces.part[i]] = 1;
        }
    }
    std::uint32_t airway = 0;
    for (std::uint32_t p = 1; p < spaces.voxels.size(); ++p) {
        if (opens[p] != 0 && spaces.voxels[p] > spaces.voxels[airway]) {
            airway = p;
        }
    }
    // With closed lips and nostrils the largest enclosed space is taken, unless the only opening is a skin
    // fold.
    const std::uint32_t largest = spaces.largest();
    map.airway_opens = airway != 0 && 4 * spaces.voxels[airway] > spaces.voxels[largest];
    if (!map.airway_opens) {
        airway = largest;
    }
    map.airway.assign(n, 0);
    map.enclosed_air.assign(n, 0);
    map.bone.assign(n, 0);
    map.soft.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        if (map.outside[i] != 0) {
            continue;
        }
        if (inner_air[i] == 0) {
            (ct.value[i] > settings.bone_above ? map.bone : map.soft)[i] = 1;
        } else if (spaces.part[i] == airway) {
            map.airway[i] = 1;
        } else {
            // A skin fold bridged by the closing is air around the patient.
            (opens[spaces.part[i]] != 0 ? map.outside : map.enclosed_air)[i] = 1;
        }
    }
    const auto least =
        static_cast<std::size_t>(static_cast<double>(settings.smallest_bone) / g.voxel_volume());
    const Components bones = components(g.size, map.bone);
    for (std::size_t i = 0; i < n; ++i) {
        if (map.bone[i] != 0 && bones.voxels[bones.part[i]] < least) {
            map.bone[i] = 0;
            map.soft[i] = 1;
        }
    }
    return map;
}

}  // namespace eti::segmentation
