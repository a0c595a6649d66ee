// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/patient/newborn/anatomy.hpp"

namespace eti::anatomy {

/// How finely what is drawn is cut at a place: finest at larynx and epiglottis, coarse at trunk and scalp.
class Detail {
  public:
    /// `spacing` [m]: edges in the mouth; all others are finer or coarser in proportion.
    Detail(const Anatomy& anatomy, float spacing);

    /// [m], edges of triangles at a point. Changes by a quarter of the way at most.
    [[nodiscard]] float edge(const Vec3f& point) const;

  private:
    /// Within `reach` of the line between two points edges are this long.
    struct Part {
        Vec3f from, to;  // [m]
        float reach;     // [m]
        float edge;      // [m]
    };
    std::vector<Part> parts_;
    float coarsest_;
};

}  // namespace eti::anatomy
