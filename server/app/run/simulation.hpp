// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>

#include "common/model/pace.hpp"
#include "common/model/thresholds.hpp"
#include "common/operator/operator.hpp"
#include "common/scenario/scenario.hpp"
#include "server/metrics/metrics.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/scene.hpp"

namespace eti::app {

/// Steps between two evaluations of the view, whose results are published.
inline constexpr std::uint64_t steps_per_view_check =
    steps_per_second / static_cast<std::uint64_t>(threshold::look_rate.value);

/// Initial inputs: tools parked clear of the face, runtime parameters as in the scenario.
[[nodiscard]] scene::Inputs parked_inputs(const Scenario& scenario, const patient::Patient& patient);

/// The scenario's patient, from the cache or built (some seconds).
[[nodiscard]] patient::Patient patient_of(const Scenario& scenario);

/// Limits of runtime parameters for a session's patient.
struct PatientLimits {
    float head_scale = 1.0f;    ///< with which the model was built
    float tongue_scale = 1.0f;  ///< with which the model was built
    bool saliva = false;
    bool bones_yield = false;
};

[[nodiscard]] PatientLimits limits_of(const Scenario& scenario);

/// Evaluates the view and computes metrics from a session's snapshots, in order.
class Assessor {
  public:
    Assessor(const patient::Patient& patient, const Laryngoscope& scope, const Scenario& scenario);

    /// Processes the next step. The view is evaluated at 30 Hz from `eye` [m], by default from the best
    /// position.
    void observe(const scene::Snapshot& snapshot, const std::optional<Vec3f>& eye);

    /// Whether the last step was due for a view evaluation (also with a manikin, which has none); results are
    /// then published.
    [[nodiscard]] bool due() const { return due_; }
    /// Eye position of the last evaluation [m].
    [[nodiscard]] const Vec3f& eye() const { return eye_; }
    [[nodiscard]] metrics::Metrics& metrics() { return metrics_; }
    [[nodiscard]] const metrics::Metrics& metrics() const { return metrics_; }

  private:
    bool manikin_;  // nothing deforms, so there is no view to evaluate
    metrics::GlotticViewer viewer_;
    metrics::GlotticView view_;
    metrics::Metrics metrics_;
    Vec3f eye_ = Vec3f::Zero();
    bool due_ = false;
};

/// Simulation and assessment of one scenario: the scene and its metrics. Without clock, bus or record.
class Simulation {
  public:
    /// `patient` must outlive it.
    Simulation(const Scenario& scenario, const patient::Patient& patient, const scene::Inputs& start);

    /// Advances by one step and assesses it from `eye`; see Assessor.
    void step(const scene::Inputs& inputs, const std::optional<Vec3f>& eye);

    /// Assessor for scene()'s steps that are taken without step().
    [[nodiscard]] Assessor& assessor() { return assessor_; }
    [[nodiscard]] double time() const;  ///< [s]
    /// What a person at the scene would see.
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
