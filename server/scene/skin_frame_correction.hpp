// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/patient/model/patient.hpp"

namespace eti::scene {

/// Shifts skinning frames so that the drawn surface coincides with its tetrahedra. A frame follows its
/// cluster rigidly and does not stretch: beside a blade the drawn surface would deviate by millimetres from
/// the mesh that is in contact (docs/decisions/skinning.md). Not thread safe.
class SkinFrameCorrection {
  public:
    /// `tetrahedra`: indices, in the patient, of the tongue's tetrahedra.
    void configure(const patient::Patient& patient, std::span<const std::uint32_t> tetrahedra);

    /// Shifts the frames of the tongue's clusters by the weighted mean residual of the vertices that they
    /// carry, in several iterations. `position` [particles][m]; `frames` [bones | clusters | skull], fitted
    /// to the clusters.
    void shift(std::span<const Vec3f> position, std::span<FramePose> frames);

    /// Number of anchor vertices.
    [[nodiscard]] std::size_t size() const { return anchors_.size(); }

  private:
    /// A surface vertex: a fixed barycentric point of a tetrahedron, skinned by frames.
    struct Anchor {
        Vec3f rest = Vec3f::Zero();                // [m]
        std::array<std::uint32_t, 4> corner = {};  // particle indices
        std::array<float, 4> share = {};           // barycentric coordinates; sum to one
        std::uint32_t first = 0, end = 0;          // range in carriers_
    };
    struct Carrier {
        std::uint16_t frame;
        float weight;
    };
    /// A frame's map of rest points: columns, padded to four numbers for SIMD.
    using Columns = std::array<Eigen::Vector4f, 4>;

    void add(const Anchor& anchor, const SkinWeights& skin);

    std::vector<Anchor> anchors_;
    std::vector<Carrier> carriers_;
    std::vector<Vec3f> rest_centre_;          // [frames][m]
    std::vector<std::uint16_t> used_;         // frames that carry an anchor
    std::vector<std::uint16_t> shifted_;      // the tongue's frames among used_
    std::vector<float> carried_;              // [frames], sum of weights
    std::vector<Columns> maps_;               // scratch [frames]
    std::vector<Eigen::Vector4f> sum_, way_;  // [frames][m]; sums are zero between iterations
    std::vector<Eigen::Vector4f> residual_;   // scratch [anchors][m]
};

}  // namespace eti::scene
