// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/grids/own_grid.hpp"

#include <cmath>

#include "server/parallel/loops.hpp"
#include "server/patient/imaging/filter.hpp"
#include "server/patient/imaging/resample.hpp"
#include "server/patient/mesh/components.hpp"

namespace eti::segmentation {

namespace {

using imaging::Geometry;

enum class Kind : std::uint8_t { air, soft, bone };

Kind kind_of(Label label) {
    switch (label) {
        case Label::outside:
        case Label::airway:
        case Label::enclosed_air:
            return Kind::air;
        case Label::bone:
        case Label::mandible:
        case Label::spine:
            return Kind::bone;
        default:
            return Kind::soft;
    }
}

/// Whether both grids have the same voxels, with axes in any order and direction.
bool same_voxels(const Geometry& a, const Geometry& b) {
    constexpr double rounded = 1e-3;  // [voxels]
    const Eigen::Matrix3d steps = b.step.inverse() * a.step;
    const Vec3d first = b.to_index(a.origin);
    const Eigen::Matrix3d whole = steps.array().round();
    return (steps - whole).cwiseAbs().maxCoeff() < rounded &&
           (whole.cwiseAbs().rowwise().sum().array() == 1.0).all() &&
           (first.array() - first.array().round()).abs().maxCoeff() < rounded;
}

/// Noise at a border leaves specks beside it, which map_tissues() has removed before.
void drop_small_bones(const SegmentSettings& settings, imaging::Mask& labels) {
    imaging::Bits bone(labels.value.size());
    for (std::size_t i = 0; i < bone.size(); ++i) {
        bone[i] = kind_of(static_cast<Label>(labels.value[i])) == Kind::bone ? 1 : 0;
    }
    const Components pieces = components(labels.geometry.size, bone);
    const double least = static_cast<double>(settings.smallest_bone) / labels.geometry.voxel_volume();
    for (std::size_t i = 0; i < bone.size(); ++i) {
        if (bone[i] != 0 && static_cast<double>(pieces.voxels[pieces.part[i]]) < least) {
            labels.value[i] = value_of(Label::soft);
        }
    }
}

}  // namespace

imaging::Mask labels_on_own_grid(const imaging::Volume& volume, const Geometry& own,
                                 const imaging::Mask& labels, const SegmentSettings& settings) {
    imaging::Mask result = imaging::resample_labels(own, labels);
    if (same_voxels(own, labels.geometry)) {
        return result;
    }
    const Geometry& g = labels.geometry;
    const Eigen::Matrix3d back = g.step.inverse();
    parallel::for_each(own.size[2], 1, [&](int z) {
        for (int y = 0; y < own.size[1]; ++y) {
            for (int x = 0; x < own.size[0]; ++x) {
                const std::size_t i = own.index(x, y, z);
                const float value = volume.value[i];
                const Kind kind = value < settings.air_below    ? Kind::air
                                  : value > settings.bone_above ? Kind::bone
                                                                : Kind::soft;
                if (kind_of(static_cast<Label>(result.value[i])) == kind) {
                    continue;
                }
                const Vec3d at = back * (own.point(x, y, z) - g.origin);
                const Eigen::Vector3i middle = at.array().round().cast<int>();
                double nearest = 1e9;
                for (int k = 0; k < 27; ++k) {
                    const Eigen::Vector3i there =
                        middle + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
                    if (!g.contains(there.x(), there.y(), there.z())) {
                        continue;
                    }
                    const std::uint8_t label = labels.at(there.x(), there.y(), there.z());
                    const double squared = (there.cast<double>() - at).squaredNorm();
                    if (squared < nearest && kind_of(static_cast<Label>(label)) == kind) {
                        nearest = squared;
                        result.value[i] = label;
                    }
                }
            }
        }
    });
    drop_small_bones(settings, result);
    return result;
}

}  // namespace eti::segmentation
