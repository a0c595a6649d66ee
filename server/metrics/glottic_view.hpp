// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/model/thresholds.hpp"
#include "common/model/tools.hpp"
#include "server/metrics/occluders.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::metrics {

/// What an eye sees of the larynx.
struct GlotticView {
    float opening_percent = 0.0f;  ///< POGO: share of the glottic opening's area in sight
    bool epiglottis_seen = false;  ///< looked for only where nothing of the opening is in sight
};

/// `count` points, or one more, that stand for equal shares of a closed polygon's area: a sunflower's spiral
/// (Vogel 1979, Math Biosci 44:179) over the fan of triangles between its centroid and its sides, in pairs
/// across the centroid. None of a polygon without sides.
[[nodiscard]] std::vector<Vec3f> sample_polygon(std::span<const Vec3f> contour, int count);

/// Percentage of glottic opening (Levitan 1998, Acad Emerg Med 5:919), measured as a share of area:
/// straight lines from the eye to points of the opening that neither the patient's skinned surfaces nor
/// laryngoscope nor tube block. Lips are held aside, as in the trainee's picture.
class GlotticViewer {
  public:
    struct Settings {
        int samples = static_cast<int>(threshold::glottis_points.value);
        int epiglottis_samples = static_cast<int>(threshold::epiglottis_points.value);
        float tolerance = threshold::hiding_distance.as_float();  ///< [m]
        float tube_radius = 2.1e-3f;  ///< [m]; 0: there is no tube to hide anything
    };

    /// Copies what it needs of the patient.
    GlotticViewer(const anatomy::Patient& patient, const Laryngoscope& scope, const Settings& settings);
    GlotticViewer(const anatomy::Patient& patient, const Laryngoscope& scope);

    /// `from` [m], patient frame: the eye. The snapshot must come from the same patient.
    [[nodiscard]] GlotticView look(const scene::Snapshot& snapshot, const Vec3f& from);

  private:
    using Hiding = std::vector<Occluder::Recent>;  // surface by surface

    void block(SightLines& lines, const Occluder::Posture& tissue, const scene::Snapshot& snapshot,
               Hiding& hiding);
    void block_by_tube(SightLines& lines, std::span<const Vec3f> nodes) const;

    Settings settings_;
    /// A patient cut from a CT, who has no cloth, lay in it with closed lips. Fingers part them: nothing
    /// before the upper gum counts.
    bool lips_as_scanned_;
    std::vector<Vec3f> rest_centres_;
    std::vector<Occluder> surfaces_;
    std::optional<Occluder> laryngoscope_;
    Laryngoscope scope_;
    std::vector<anatomy::CarriedPoint> epiglottis_;
    Hiding hide_glottis_, hide_epiglottis_;
};

}  // namespace eti::metrics
