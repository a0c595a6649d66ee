// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "common/operator/operator.hpp"
#include "common/scenario/scenario.hpp"
#include "server/metrics/metrics.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/scene.hpp"

namespace eti::app {

/// Tools parked well clear of the face, the patient as the scenario wants it: until someone says otherwise.
[[nodiscard]] scene::Inputs parked(const Scenario& scenario, const anatomy::Patient& patient);

/// The scenario's patient, from the cache or built anew (some seconds).
[[nodiscard]] anatomy::Patient patient_of(const Scenario& scenario);

/// What may be asked of a session's patient while it runs.
struct PatientLimits {
    float head_scale = 1.0f;    ///< that the model was built with
    float tongue_scale = 1.0f;  ///< the same
    /// [Pa], that the solver bears in the built tongue.
    float stiffest = std::numeric_limits<float>::infinity();
    std::string bearer;  ///< what does not bear more
    bool saliva = false;

    /// [Pa], of a tongue of this size. Its tetrahedra are as much larger and weigh the same: they bear less.
    [[nodiscard]] float stiffest_at(float scale) const { return stiffest * tongue_scale / scale; }
};

[[nodiscard]] PatientLimits limits_of(const Scenario& scenario, const anatomy::Patient& patient);

/// Looks at snapshots and measures: of one session, in the order of its steps.
class Assessor {
  public:
    Assessor(const anatomy::Patient& patient, const Laryngoscope& scope, const Scenario& scenario);

    /// Takes in the next step. The view is judged at 30 Hz from `eye` [m], by default from where it is best.
    void observe(const scene::Snapshot& snapshot, const std::optional<Vec3f>& eye);

    /// Whether the view of the last step was judged, or would have been but for a manikin: then all is told.
    [[nodiscard]] bool due() const { return due_; }
    /// Where that was judged from [m].
    [[nodiscard]] const Vec3f& eye() const { return eye_; }
    [[nodiscard]] metrics::Metrics& metrics() { return metrics_; }
    [[nodiscard]] const metrics::Metrics& metrics() const { return metrics_; }

  private:
    bool manikin_;  // nothing there gives way, so there is no view to judge
    metrics::GlotticViewer viewer_;
    metrics::GlotticView view_;
    metrics::Metrics metrics_;
    Vec3f eye_ = Vec3f::Zero();
    bool due_ = false;
};

/// One scenario as it is simulated and judged: the scene, and the metrics that watch it. Without a clock,
/// bus or record.
class Simulation {
  public:
    /// `patient` has to outlive it. Throws InputError where the solver's settings cannot bear its tissue.
    Simulation(const Scenario& scenario, const anatomy::Patient& patient, const scene::Inputs& start);

    /// One step, and its judgement from `eye`; see Assessor.
    void step(const scene::Inputs& inputs, const std::optional<Vec3f>& eye);

    /// The judge of scene()'s steps where they are taken without step().
    [[nodiscard]] Assessor& assessor() { return assessor_; }
    [[nodiscard]] double time() const;  ///< [s]
    /// What a person at the scene sees.
    [[nodiscard]] Observation observation() const;

    [[nodiscard]] const Laryngoscope& scope() const { return scope_; }
    [[nodiscard]] scene::Scene& scene() { return scene_; }
    [[nodiscard]] const scene::Scene& scene() const { return scene_; }
    [[nodiscard]] const scene::Snapshot& snapshot() const { return scene_.snapshot(); }
    [[nodiscard]] metrics::Metrics& metrics() { return assessor_.metrics(); }
    [[nodiscard]] const metrics::Metrics& metrics() const { return assessor_.metrics(); }

  private:
    Laryngoscope scope_;
    scene::Scene scene_;
    Assessor assessor_;
    float tube_depth_rule_ = 0.0f;  // [m]
};

}  // namespace eti::app
