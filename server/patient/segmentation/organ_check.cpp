// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/organ_check.hpp"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <map>

namespace eti::segmentation {

OrganCheck::OrganCheck(const imaging::Geometry& geometry, const HeadPose& head, const imaging::Bits& airway)
    : geometry_(geometry), head_(head), airway_(extent(airway)) {}

OrganCheck::Extent OrganCheck::extent(const imaging::Bits& organ) const {
    Extent e;
    double count = 0.0;
    double left = 0.0;
    for (std::size_t i = 0; i < organ.size(); ++i) {
        if (organ[i] != 0) {
            const auto [x, y, z] = geometry_.coordinates(i);
            const Vec3d p = geometry_.point(x, y, z);
            e.middle += p;
            count += 1.0;
            left += p.x() > head_.middle(p.y(), p.z()) ? 1.0 : 0.0;
        }
    }
    if (count > 0.0) {
        e.middle /= count;
        e.volume = count * geometry_.voxel_volume();
        e.left = left / count;
    }
    return e;
}

std::string OrganCheck::implausibility(const imaging::Bits& organ, const OrganLimits& limits) const {
    const Extent e = extent(organ);
    if (e.volume == 0.0 || head_.size == 0.0) {
        return {};
    }
    const double cube = head_.size * head_.size * head_.size;
    if (e.volume < limits.min_volume * cube || e.volume > limits.max_volume * cube) {
        return fmt::format("{:.1f} ml were found; expected {:.1f} to {:.1f} ml in a head of this size",
                           1e6 * e.volume, 1e6 * limits.min_volume * cube, 1e6 * limits.max_volume * cube);
    }
    const double beside = std::fabs(e.middle.x() - head_.middle(e.middle.y(), e.middle.z()));
    if (beside > limits.max_beside * head_.size) {
        return fmt::format("it lies {:.0f} mm beside the mirror plane; expected at most {:.0f} mm",
                           1e3 * beside, 1e3 * limits.max_beside * head_.size);
    }
    const double smaller = std::min(e.left, 1.0 - e.left);
    if (smaller < limits.min_side) {
        return fmt::format("{:.0f} % of it lie on one side; expected at most {:.0f} %",
                           100.0 * (1.0 - smaller), 100.0 * (1.0 - limits.min_side));
    }
    const double below = head_.in_plane.z() - e.middle.z();
    if (below < limits.min_below * head_.size) {
        return fmt::format("it lies {:.0f} mm below the cranium's centre; expected at least {:.0f} mm",
                           1e3 * below, 1e3 * limits.min_below * head_.size);
    }
    if (airway_.volume > 0.0) {
        const double behind = e.middle.y() - airway_.middle.y();
        if ((limits.before_airway && behind > 0.0) || (limits.behind_airway && behind < 0.0)) {
            return fmt::format("it lies {:.0f} mm {} the airway's middle; expected on the other side",
                               1e3 * std::fabs(behind), behind > 0.0 ? "behind" : "in front of");
        }
    }
    return {};
}

std::string OrganCheck::out_of_order(const imaging::Bits& mandible, const imaging::Bits& tongue,
                                     const imaging::Bits& spine) const {
    const std::array<std::pair<const char*, Extent>, 3> all = {
        {{"mandible", extent(mandible)}, {"tongue", extent(tongue)}, {"spine", extent(spine)}}};
    for (std::size_t a = 0; a < all.size(); ++a) {
        for (std::size_t b = a + 1; b < all.size(); ++b) {
            const auto& [front, one] = all[a];
            const auto& [back, other] = all[b];
            // A mandible surrounds the tongue: its centre may be slightly behind the tongue's.
            const double room = b == 1 ? 0.3 * head_.size : 0.0;
            if (one.volume > 0.0 && other.volume > 0.0 && one.middle.y() > other.middle.y() + room) {
                return fmt::format("the {} lies {:.0f} mm behind the {}; expected in front of it", front,
                                   1e3 * (one.middle.y() - other.middle.y()), back);
            }
        }
    }
    return {};
}

void find_stray_seeds(const imaging::Mask& labels, const Points& points, const Points& given,
                      std::vector<std::string>& contradictions) {
    const std::map<std::string, Label> own = {{"mandible", Label::mandible},
                                              {"spine", Label::spine},
                                              {"tongue", Label::tongue},
                                              {"skull", Label::bone}};
    const imaging::Geometry& g = labels.geometry;
    std::array<bool, label_count> present{};
    for (const std::uint8_t v : labels.value) {
        present[v] = true;
    }
    const auto reach = static_cast<int>(std::ceil(8e-3 / g.spacing().x()));
    /// The organ nearest to a point, and whether its own organ is within reach, too.
    struct Place {
        Label nearest = Label::soft;
        bool near_own = false;
    };
    const auto place_of = [&](const Vec3d& point, Label own_label) {
        const Vec3d at = g.to_index(point);
        Place place;
        int nearest = reach * reach + 1;
        for (int dz = -reach; dz <= reach; ++dz) {
            for (int dy = -reach; dy <= reach; ++dy) {
                for (int dx = -reach; dx <= reach; ++dx) {
                    const int squared = dx * dx + dy * dy + dz * dz;
                    const int x = static_cast<int>(std::lround(at.x())) + dx;
                    const int y = static_cast<int>(std::lround(at.y())) + dy;
                    const int z = static_cast<int>(std::lround(at.z())) + dz;
                    if (squared > reach * reach || !g.contains(x, y, z)) {
                        continue;
                    }
                    const auto label = static_cast<Label>(labels.at(x, y, z));
                    place.near_own = place.near_own || label == own_label;
                    if (squared < nearest && (label == Label::mandible || label == Label::spine ||
                                              label == Label::tongue || label == Label::bone)) {
                        place.nearest = label;
                        nearest = squared;
                    }
                }
            }
        }
        return place;
    };
    for (const auto& [name, label] : own) {
        const auto it = points.find(name);
        const bool by_hand = given.contains(name);
        if (it == points.end() || (!by_hand && !present[value_of(label)])) {
            continue;  // organs that were not found, or were withdrawn, have no label
        }
        if (!present[value_of(label)]) {
            contradictions.push_back(
                fmt::format("points '{}' ({} given) resulted in no label. Remedy: see the reason in the line "
                            "of '{}', and move them in 3D Slicer (--landmarks), or omit them.",
                            name, it->second.size(), name));
            continue;
        }
        std::size_t stray = 0;
        bool far = false;  // in another distinguishable organ, or not even at the border of its own
        std::string where;
        for (const Vec3d& p : it->second) {
            if (const Place at = place_of(p, label); at.nearest != label) {
                ++stray;
                far = far || !at.near_own || (at.nearest != Label::bone && at.nearest != Label::soft);
                where = fmt::format("{}", label_names[value_of(at.nearest)]);
            }
        }
        if ((by_hand && far) || 5 * stray > it->second.size()) {
            contradictions.push_back(
                fmt::format("{} of {} points '{}' {} lie outside its label, in {}; expected inside. Remedy: "
                            "look at the picture and {} them in 3D Slicer (--landmarks).",
                            stray, it->second.size(), name, by_hand ? "that were given" : "that were placed",
                            where, by_hand ? "move" : "place"));
        }
    }
}

}  // namespace eti::segmentation
