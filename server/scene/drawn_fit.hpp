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

/// Shifts frames so that what they draw lies where its tetrahedra have it. A frame turns and goes along with
/// its cluster, but does not stretch: beside a blade the surface would be drawn up to millimetres from the
/// mesh that the blade has met (docs/decisions/skinning.md).
class DrawnFit {
  public:
    /// `tetrahedra`: the patient's numbers of those in the tongue.
    void configure(const anatomy::Patient& patient, std::span<const std::uint32_t> tetrahedra);

    /// Shifts the frames of the tongue's clusters by the mean of what vertices that they carry lack, weighted
    /// as they carry them, several times over. `position` [m], one per particle; `frames`: all of the
    /// patient's, fitted to the clusters.
    void shift(std::span<const Vec3f> position, std::span<FramePose> frames);

    /// How many vertices are asked.
    [[nodiscard]] std::size_t size() const { return anchors_.size(); }

  private:
    /// A vertex of the surface: a point of a tetrahedron that frames carry.
    struct Anchor {
        Vec3f rest = Vec3f::Zero();                // [m]
        std::array<std::uint32_t, 4> corner = {};  // particles
        std::array<float, 4> share = {};           // sum to one
        std::uint32_t first = 0, end = 0;          // in carriers_
    };
    struct Carrier {
        std::uint16_t frame;
        float weight;
    };
    /// What a frame does to rest points: columns, four numbers each for the processor's sake.
    using Columns = std::array<Eigen::Vector4f, 4>;

    void add(const Anchor& anchor, const SkinWeights& skin);

    std::vector<Anchor> anchors_;
    std::vector<Carrier> carriers_;
    std::vector<Vec3f> rest_centre_;          // [m], by frame
    std::vector<std::uint16_t> used_;         // frames that carry an anchor
    std::vector<std::uint16_t> shifted_;      // of these the tongue's
    std::vector<float> carried_;              // by frame, sum of weights
    std::vector<Columns> maps_;               // scratch, by frame
    std::vector<Eigen::Vector4f> sum_, way_;  // by frame [m]; between rounds sums are zero
    std::vector<Eigen::Vector4f> lack_;       // scratch, by anchor [m]
};

}  // namespace eti::scene
