// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/placement/volume_orientation.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <numbers>

#include "server/patient/segmentation/placement/head_frame.hpp"

namespace eti::segmentation {

namespace {

/// The rotation by right angles (without mirroring) nearest to a rotation.
Eigen::Matrix3d nearest_right_turn(const Eigen::Matrix3d& axes) {
    Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
    double alike = -4.0;
    for (int first = 0; first < 6; ++first) {
        for (int second = 0; second < 6; ++second) {
            if (first % 3 != second % 3) {
                Eigen::Matrix3d turn;
                turn.col(0) = (first < 3 ? 1.0 : -1.0) * Vec3d::Unit(first % 3);
                turn.col(1) = (second < 3 ? 1.0 : -1.0) * Vec3d::Unit(second % 3);
                turn.col(2) = turn.col(0).cross(turn.col(1));
                if (const double trace = (turn.transpose() * axes).trace(); trace > alike) {
                    alike = trace;
                    best = turn;
                }
            }
        }
    }
    return best;
}

/// Axes of an orthogonal grid, right-handed; those of LPS if it is sheared.
Eigen::Matrix3d axes_of(const imaging::Geometry& geometry) {
    Eigen::Matrix3d axes = geometry.step.colwise().normalized();
    constexpr double right_angled = 1e-4;
    if ((axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > right_angled) {
        return Eigen::Matrix3d::Identity();
    }
    if (axes.determinant() < 0.0) {
        axes.col(0) *= -1.0;
    }
    return axes;
}

}  // namespace

Points turned(Points points, const Eigen::Matrix3d& turn) {
    for (auto& [name, places] : points) {
        for (Vec3d& p : places) {
            p = turn * p;
        }
    }
    return points;
}

VolumeOrientation orient_volume(const imaging::Volume& volume, const Points& given,
                                const SegmentSettings& settings, std::vector<std::string>& contradictions) {
    constexpr double degree = std::numbers::pi / 180.0;
    constexpr double hardly_turned = 5.0 * degree;  // seeds tolerate 10
    constexpr double max_turned = 50.0 * degree;    // 45, plus the accuracy of the rotation
    VolumeOrientation stand;
    HeadFrame head;
    try {
        head = find_head(volume, settings);
    } catch (const imaging::VolumeError& error) {
        for (const char* name : {"mouth", "mandible", "skull", "spine", "tongue"}) {
            if (!given.contains(name)) {
                throw;
            }
        }
        contradictions.push_back(
            fmt::format("{} The file's directions and the given points are used.", error.what()));
        for (const Vec3d& p : given.at("skull")) {
            stand.place.in_plane += p / static_cast<double>(given.at("skull").size());
        }
        stand.place.size = 0.0;
        return stand;
    }
    const Eigen::Matrix3d grid = axes_of(volume.geometry);
    stand.axes = grid * nearest_right_turn(grid.transpose() * head.axes);
    const Eigen::Matrix3d residual_rotation = stand.axes.transpose() * head.axes;
    stand.residual_rotation = Eigen::AngleAxisd(residual_rotation).angle() < hardly_turned
                                  ? Eigen::Matrix3d::Identity()
                                  : residual_rotation;
    stand.turn = head.turn();
    const Eigen::Matrix3d into = (stand.axes * stand.residual_rotation).transpose();
    stand.place.plane_normal = into * head.axes.col(0);
    stand.place.in_plane = into * head.centre;
    stand.place.size = head.size;
    if (stand.turn > max_turned) {
        contradictions.push_back(
            fmt::format("the head is rotated by {:.0f} degrees from the file's directions of left, back and "
                        "top; labels follow the image, in which left and right cannot be distinguished. "
                        "Remedy: correct the directions in the program that wrote the file.",
                        stand.turn / degree));
    }
    return stand;
}

}  // namespace eti::segmentation
