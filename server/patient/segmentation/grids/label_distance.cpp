// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/grids/label_distance.hpp"

#include <algorithm>
#include <cmath>

#include "common/mesh/distance.hpp"
#include "server/patient/imaging/resample.hpp"

namespace eti::segmentation {

using imaging::Bits;
using imaging::Geometry;

Bits select(const imaging::Mask& labels, const std::vector<Label>& which) {
    Bits bits(labels.value.size());
    for (std::size_t i = 0; i < bits.size(); ++i) {
        bits[i] = std::any_of(which.begin(), which.end(),
                              [&](Label label) { return labels.value[i] == value_of(label); })
                      ? 1
                      : 0;
    }
    return bits;
}

imaging::Mask upright_labels(const imaging::Mask& labels, double finest, const Box* part) {
    const Geometry& from = labels.geometry;
    Box box;
    for (int corner = 0; corner < 8; ++corner) {
        box.add(from.point((corner & 1) != 0 ? from.size[0] - 1 : 0, (corner & 2) != 0 ? from.size[1] - 1 : 0,
                           (corner & 4) != 0 ? from.size[2] - 1 : 0));
    }
    if (part != nullptr) {
        box.low = box.low.cwiseMax(part->low);
        box.high = box.high.cwiseMin(part->high).cwiseMax(box.low);
    }
    const Vec3d& low = box.low;
    const Vec3d& high = box.high;
    Geometry to;
    const double spacing = std::max(from.spacing().minCoeff(), finest);
    to.origin = low;
    to.step = spacing * Eigen::Matrix3d::Identity();
    for (int k = 0; k < 3; ++k) {
        to.size[static_cast<std::size_t>(k)] =
            std::max(4, static_cast<int>(std::floor((high[k] - low[k]) / spacing + 1e-6)) + 1);
    }
    imaging::require_valid(to, "labels");
    return imaging::resample_labels(to, labels);
}

DistanceGrid distance_of(const Geometry& geometry, const Bits& member) {
    const auto spacing = static_cast<float>(geometry.spacing()[0]);
    DistanceGrid field;
    field.origin = geometry.origin.cast<float>();
    field.spacing = spacing;
    field.size = geometry.size;
    std::vector<float> value(member.begin(), member.end());
    field.value = imaging::smooth_within(geometry.size, value, Bits(member.size(), 1), 0.8f);
    Bits inside(member.size());
    Bits outside(member.size());
    for (std::size_t i = 0; i < member.size(); ++i) {
        field.value[i] = 0.5f - field.value[i];
        inside[i] = field.value[i] < 0.0f ? 1 : 0;
        outside[i] = 1 - inside[i];
    }
    const float band = 2.0f * spacing;
    DistanceGrid near = redistance(field, band);
    const std::vector<float> to_inside = imaging::distance_to(geometry.size, inside);
    const std::vector<float> to_outside = imaging::distance_to(geometry.size, outside);
    for (std::size_t i = 0; i < member.size(); ++i) {
        if (std::fabs(near.value[i]) > 0.95f * band) {
            const float far = inside[i] != 0 ? 0.5f - to_outside[i] : to_inside[i] - 0.5f;
            near.value[i] = std::clamp(far * spacing, -1.0f, 1.0f);
        }
    }
    return near;
}

}  // namespace eti::segmentation
