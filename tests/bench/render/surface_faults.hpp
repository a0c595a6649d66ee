// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "client/render/views/camera.hpp"
#include "common/math/random.hpp"
#include "tests/bench/render/measures.hpp"

namespace eti::bench {

/// Faults of the surfaces without bones: edges with other than two triangles, and pairs of triangles of one
/// surface that pass through each other.
class SurfaceFaults {
  public:
    explicit SurfaceFaults(const MeshSet& shapes);

    /// Those that a picture shows; nothing lies more than 0.1 mm before them.
    struct Count {
        int open_edges = 0, crossings = 0;
    };
    [[nodiscard]] Count in_view(const Raster& raster, const render::Camera& camera) const;

  private:
    struct Fault {
        Vec3f place;  ///< middle of the edge, or where an edge of one triangle passes through the other
        std::int16_t organ;
    };
    [[nodiscard]] static int seen(const std::vector<Fault>& faults, const Raster& raster,
                                  const render::Camera& camera);
    std::vector<Fault> open_, crossed_;
};

/// A gaze of the blade's lens: up to 10 degrees about its own, from up to 0.5 mm beside its place.
[[nodiscard]] render::Camera gaze_beside(const render::Camera& lens, Random& random);

/// A gaze at the glottis without a blade: from air within 6 mm of the epiglottis's tip, up to 10 degrees
/// beside it, with the field of `lens`.
[[nodiscard]] render::Camera gaze_in_throat(const MeshSet& shapes, const Landmarks& landmarks,
                                            const render::Camera& lens, Random& random);

}  // namespace eti::bench
