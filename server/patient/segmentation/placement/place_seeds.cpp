// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/placement/place_seeds.hpp"
#include "server/patient/mesh/components.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace eti::segmentation {

namespace {

using imaging::Bits;
using imaging::Geometry;

constexpr double midline = 4e-3;         // [m] to either side
constexpr double jaw_thickness = 12e-3;  // [m] from front to back, with a margin
constexpr double lowest_mouth = 2.9;     // in cranial radii below its centre; that of newborns is at 1.6
constexpr double above_joints = 0.6;     // in jaw depths above the mouth

/// Centre of the lowest patch in which the airway opens; patches much smaller than the largest are cracks. An
/// opening at the volume's end, or below the face, is the trachea's.
std::optional<Vec3d> find_mouth(const Geometry& g, const TissueMap& map, const HeadPose& head) {
    Bits opening(map.airway.size(), 0);
    for (std::size_t i = 0; i < opening.size(); ++i) {
        if (map.airway[i] == 0) {
            continue;
        }
        const auto [x, y, z] = g.coordinates(i);
        const auto out = [&](int a, int b, int c) {
            return g.contains(a, b, c) && map.outside[g.index(a, b, c)] != 0 &&
                   (head.shown == nullptr || (*head.shown)[g.index(a, b, c)] != 0);
        };
        opening[i] = out(x - 1, y, z) || out(x + 1, y, z) || out(x, y - 1, z) || out(x, y + 1, z) ||
                             out(x, y, z - 1) || out(x, y, z + 1)
                         ? 1
                         : 0;
    }
    const Components patches = components(g.size, opening);
    std::vector<Vec3d> centre(patches.voxels.size(), Vec3d::Zero());
    for (std::size_t i = 0; i < opening.size(); ++i) {
        if (patches.part[i] != 0) {
            const auto [x, y, z] = g.coordinates(i);
            centre[patches.part[i]] +=
                g.point(x, y, z) / static_cast<double>(patches.voxels[patches.part[i]]);
        }
    }
    std::size_t largest = 0;
    for (std::size_t p = 1; p < centre.size(); ++p) {
        if (centre[p].z() >= head.in_plane.z() - lowest_mouth * head.size) {
            largest = std::max(largest, patches.voxels[p]);
        }
    }
    std::optional<Vec3d> mouth;
    for (std::size_t p = 1; p < centre.size(); ++p) {
        const bool face = centre[p].z() >= head.in_plane.z() - lowest_mouth * head.size;
        if (face && patches.voxels[p] * 5 >= largest && (!mouth || centre[p].z() < mouth->z())) {
            mouth = centre[p];
        }
    }
    return mouth;
}

/// Visits the voxels of `bits` within a box [m], as points.
template <class Visit>
void for_each_in(const Geometry& g, const Bits& bits, const Vec3d& low, const Vec3d& high,
                 const Visit& visit) {
    std::array<int, 3> from{};
    std::array<int, 3> to{};
    const Vec3d a = g.to_index(low);
    const Vec3d b = g.to_index(high);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<int>(k);
        from[k] = static_cast<int>(std::clamp(std::ceil(a[axis]), 0.0, static_cast<double>(g.size[k])));
        to[k] = static_cast<int>(std::clamp(std::floor(b[axis]), -1.0, static_cast<double>(g.size[k] - 1)));
    }
    for (int z = from[2]; z <= to[2]; ++z) {
        for (int y = from[1]; y <= to[1]; ++y) {
            for (int x = from[0]; x <= to[0]; ++x) {
                if (const std::size_t i = g.index(x, y, z); bits[i] != 0) {
                    visit(i, g.point(x, y, z));
                }
            }
        }
    }
}

/// The thickest point of each connected piece of a bone in a box: a newborn's jaw need not be connected
/// within one plane.
std::vector<Vec3d> thickest_of_pieces(const Geometry& g, const Bits& bone, const std::vector<float>& depth,
                                      const Vec3d& low, const Vec3d& high) {
    Bits cut(bone.size(), 0);
    for_each_in(g, bone, low, high, [&](std::size_t i, const Vec3d&) { cut[i] = 1; });
    const Components pieces = components(g.size, cut);
    std::vector<std::size_t> best(pieces.voxels.size(), bone.size());
    for (std::size_t i = 0; i < cut.size(); ++i) {
        std::size_t& b = best[pieces.part[i]];
        if (cut[i] != 0 && (b == bone.size() || depth[i] > depth[b])) {
            b = i;
        }
    }
    std::vector<Vec3d> places;
    for (std::size_t p = 1; p < best.size(); ++p) {
        const auto [x, y, z] = g.coordinates(best[p]);
        places.push_back(g.point(x, y, z));
    }
    return places;
}

/// The lowest point of the bone at `start` that is connected to it within a box.
Vec3d lowest_of_piece(const Geometry& g, const Bits& bone, const Vec3d& start, const Vec3d& low,
                      const Vec3d& high) {
    Bits cut(bone.size(), 0);
    for_each_in(g, bone, low, high, [&](std::size_t i, const Vec3d&) { cut[i] = 1; });
    const Components pieces = components(g.size, cut);
    const Vec3d at = g.to_index(start);
    const std::uint32_t own =
        pieces.part[g.index(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                            static_cast<int>(std::lround(at.z())))];
    for (std::size_t i = 0; i < cut.size(); ++i) {  // indices run upwards
        if (pieces.part[i] == own) {
            const auto [x, y, z] = g.coordinates(i);
            return g.point(x, y, z);
        }
    }
    return start;
}

/// Whether the volume covers a point.
bool shows(const Geometry& g, const HeadPose& head, const Vec3d& place) {
    const Vec3d at = g.to_index(place);
    const auto x = static_cast<int>(std::lround(at.x()));
    const auto y = static_cast<int>(std::lround(at.y()));
    const auto z = static_cast<int>(std::lround(at.z()));
    return g.contains(x, y, z) && (head.shown == nullptr || (*head.shown)[g.index(x, y, z)] != 0);
}

/// The lowest of the jaw's points.
Vec3d chin_of(const std::vector<Vec3d>& jaw) {
    return *std::min_element(jaw.begin(), jaw.end(),
                             [](const Vec3d& a, const Vec3d& b) { return a.z() < b.z(); });
}

}  // namespace

PlacedSeeds place_seeds(const Geometry& g, const TissueMap& map, const std::vector<float>& bone_depth,
                        const HeadPose& head, const Points& given) {
    PlacedSeeds placed;
    placed.points = given;
    const auto has = [&](const char* name) { return placed.points.contains(name); };
    const Vec3d low = g.point(0, 0, 0);
    const Vec3d high = g.point(g.size[0] - 1, g.size[1] - 1, g.size[2] - 1);

    if (!has("mouth")) {
        if (const auto mouth = find_mouth(g, map, head)) {
            placed.points["mouth"] = {*mouth};
        }
    }
    if (std::find(map.bone.begin(), map.bone.end(), 1) == map.bone.end()) {
        placed.no_mandible = "there is no bone in the volume";
        return placed;
    }
    if (!has("mouth")) {
        placed.no_mandible = "the airway has no opening, so the mouth was not found";
        return placed;
    }
    const Vec3d mouth = placed.points["mouth"].front();
    const double middle = head.middle(mouth.y(), mouth.z());

    constexpr double reach = 60e-3;  // an adult's lips are about 40 mm above the chin's lower edge
    if (!has("mandible")) {
        std::optional<Vec3d> chin;
        for_each_in(g, map.bone, {middle - midline, low.y(), mouth.z() - reach},
                    {middle + midline, high.y(), mouth.z()}, [&](std::size_t, const Vec3d& p) {
                        if (!chin || p.y() < chin->y()) {
                            chin = p;
                        }
                    });
        if (!chin) {
            placed.no_mandible = "there is no bone in the midline below the mouth";
        } else {
            const Vec3d front = *chin;
            const std::vector<Vec3d> pieces =
                thickest_of_pieces(g, map.bone, bone_depth, {middle - midline, front.y(), mouth.z() - reach},
                                   {middle + midline, front.y() + jaw_thickness, mouth.z()});
            const Vec3d box(midline, jaw_thickness, reach);
            const Vec3d lowest = lowest_of_piece(g, map.bone, front, front - box, front + box);
            if (!shows(g, head, lowest - Vec3d(0.0, 0.0, 2e-3))) {
                placed.no_mandible = "the volume ends in the jaw, above the chin's lower edge";
            } else {
                placed.points["mandible"] = pieces;
            }
        }
    }
    if (has("mandible")) {
        const Vec3d chin = chin_of(placed.points["mandible"]);
        placed.chin = chin;
        double back = -1e9;
        for_each_in(g, map.airway, {middle - midline, chin.y(), chin.z()},
                    {middle + midline, high.y(), mouth.z()},
                    [&](std::size_t, const Vec3d& p) { back = std::max(back, p.y()); });
        if (back > chin.y() + 10e-3) {
            placed.jaw_depth = back - chin.y();
        }
    }
    const double scale = placed.jaw_depth.value_or(45e-3);
    if (placed.jaw_depth && !given.contains("mandible")) {
        // Below the cheekbones, bone beside the mouth is the ramus. Seeds there assign it to the mandible,
        // even if the joint with the skull is as thick as the ramus.
        const Vec3d chin = *placed.chin;
        for (const double side : {-1.0, 1.0}) {
            for (double z = chin.z() + 0.3 * scale; z < mouth.z() + 0.25 * scale; z += 0.1 * scale) {
                const double near = middle + side * 0.45 * scale;
                const double beyond = middle + side * 1.5 * scale;
                std::optional<Vec3d> thickest;
                float depth = 0.0f;
                for_each_in(g, map.bone, {std::min(near, beyond), chin.y(), z - 0.5 * g.spacing().z()},
                            {std::max(near, beyond), chin.y() + scale, z + 0.5 * g.spacing().z()},
                            [&](std::size_t i, const Vec3d& p) {
                                if (bone_depth[i] > depth) {
                                    depth = bone_depth[i];
                                    thickest = p;
                                }
                            });
                if (thickest) {
                    placed.points["mandible"].push_back(*thickest);
                }
            }
        }
    }
    if (!has("spine")) {
        const double slice = g.spacing().z();
        for (double z = low.z() + slice; z < mouth.z(); z += std::max(slice, 2e-3)) {
            double back = -1e9;
            const Vec3d a(middle - midline, low.y(), z - 0.5 * slice);
            const Vec3d b(middle + midline, high.y(), z + 0.5 * slice);
            for_each_in(g, map.airway, a, b,
                        [&](std::size_t, const Vec3d& p) { back = std::max(back, p.y()); });
            std::optional<Vec3d> first;
            for_each_in(g, map.bone, {a.x(), back, a.z()}, {b.x(), back + 0.6 * scale, b.z()},
                        [&](std::size_t, const Vec3d& p) {
                            if (!first || p.y() < first->y()) {
                                first = p;
                            }
                        });
            if (first) {
                placed.points["spine"].push_back(*first);
            }
        }
    }
    if (!has("skull")) {
        // Above the jaw joints. Face and cranium of a newborn need not be connected.
        const auto pieces = thickest_of_pieces(g, map.bone, bone_depth,
                                               {low.x(), low.y(), mouth.z() + above_joints * scale}, high);
        if (!pieces.empty()) {
            placed.points["skull"] = pieces;
        }
    }
    if (!has("tongue") && placed.jaw_depth) {
        const Vec3d chin = *placed.chin;
        placed.points["tongue"] = {{middle, chin.y() + 0.42 * scale, chin.z() + 0.15 * scale}};
    }
    return placed;
}

}  // namespace eti::segmentation
