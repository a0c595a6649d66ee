// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/agreement.hpp"

#include <algorithm>

#include "server/patient/imaging/filter.hpp"
#include "server/patient/segmentation/grids/label_distance.hpp"

namespace eti::segmentation {

namespace {

/// Voxels of a structure that have a face outside it.
imaging::Bits surface_of(const imaging::Geometry& geometry, const imaging::Bits& bits) {
    imaging::Bits surface(bits.size(), 0);
    for (std::size_t i = 0; i < bits.size(); ++i) {
        if (bits[i] == 0) {
            continue;
        }
        const auto [x, y, z] = geometry.coordinates(i);
        const auto in = [&](int a, int b, int c) {
            return geometry.contains(a, b, c) && bits[geometry.index(a, b, c)] != 0;
        };
        const bool inner = in(x - 1, y, z) && in(x + 1, y, z) && in(x, y - 1, z) && in(x, y + 1, z) &&
                           in(x, y, z - 1) && in(x, y, z + 1);
        surface[i] = inner ? 0 : 1;
    }
    return surface;
}

}  // namespace

Agreement agreement(const imaging::Mask& found, const imaging::Mask& truth,
                    const std::vector<Label>& labels) {
    if (found.geometry.size != truth.geometry.size ||
        (found.geometry.step - truth.geometry.step).norm() > 1e-3 * truth.geometry.step.norm() ||
        (found.geometry.origin - truth.geometry.origin).norm() > 0.1 * truth.geometry.spacing().minCoeff()) {
        throw imaging::VolumeError(
            "the two label volumes have different sizes or positions; expected the same grid. Remedy: "
            "compare labels of the same CT.");
    }
    const imaging::Bits a = select(found, labels);
    const imaging::Bits b = select(truth, labels);
    Agreement result;
    std::size_t both = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        result.voxels_found += a[i];
        result.voxels_true += b[i];
        both += static_cast<std::size_t>(a[i] & b[i]);
    }
    if (result.voxels_found + result.voxels_true == 0) {
        result.dice = 1.0;
        result.mean_surface_distance = 0.0;
        return result;
    }
    if (result.voxels_found == 0 || result.voxels_true == 0) {
        return result;
    }
    result.dice =
        2.0 * static_cast<double>(both) / static_cast<double>(result.voxels_found + result.voxels_true);
    const imaging::Bits border_a = surface_of(found.geometry, a);
    const imaging::Bits border_b = surface_of(found.geometry, b);
    const auto to_a = imaging::distance_to(found.geometry.size, border_a);
    const auto to_b = imaging::distance_to(found.geometry.size, border_b);
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (border_a[i] != 0) {
            sum += static_cast<double>(to_b[i]);
            count += 1.0;
        }
        if (border_b[i] != 0) {
            sum += static_cast<double>(to_a[i]);
            count += 1.0;
        }
    }
    result.mean_surface_distance = sum / count;
    return result;
}

}  // namespace eti::segmentation
