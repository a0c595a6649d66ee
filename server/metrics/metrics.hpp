// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/model/attempt_metrics.hpp"
#include "common/model/live_measures.hpp"
#include "common/model/run.hpp"
#include "common/model/tools/tools.hpp"
#include "server/metrics/attempt.hpp"
#include "server/metrics/glottic_view.hpp"
#include "server/metrics/outcome_tracker.hpp"
#include "server/patient/model/patient.hpp"
#include "server/physiology/vital_signs.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::metrics {

/// Values that an instructor monitors during a run.
struct LiveMetrics {
    std::uint32_t attempt = 0;  ///< number of the latest attempt; 0 before the first
    bool attempt_running = false;
    LiveMeasures measures;
    TubePlace tube_place = TubePlace::outside;
    Vec3f tube_tip = Vec3f::Zero();  ///< [m]
    std::string message;             ///< text of the latest event
};

struct AttemptSummary {
    std::uint32_t number = 0;  ///< from 1; 0 for the whole run
    double began = 0.0;        ///< [s] since the run began
    double ended = 0.0;
    Outcome outcome;
    AttemptMetrics metrics;
};

/// An event for the session's log.
struct Event {
    std::uint64_t time_ns = 0;  ///< simulation time
    std::string text;
};

/// What the tools are used on. A manikin yields tool poses only: no tissue, view or airway.
enum class PatientKind : std::uint8_t { newborn, manikin };

/// Performance metrics of a run, attempt by attempt, computed from snapshots. Definitions: docs/metrics.md.
/// An attempt begins when the blade's tip passes the mouth opening inwards and ends when it has left the
/// mouth.
class Metrics {
  public:
    /// Starts a run. `time_limit` [s] is per attempt. Without a physiology, vital signs are not simulated.
    void begin(const patient::Patient& patient, const Laryngoscope& scope, double time_limit = 30.0,
               const std::optional<physiology::Physiology>& physiology = std::nullopt,
               PatientKind of = PatientKind::newborn);

    /// Processes the next snapshot; ignores one that is not newer than the last. `view` is the newest result
    /// of GlotticViewer and may be older than the snapshot.
    void observe(const scene::Snapshot& snapshot, const GlotticView& view);

    /// Ends the run and any running attempt.
    void finish();

    [[nodiscard]] const LiveMetrics& live() const { return live_; }
    /// Metrics of the running attempt, else of the run so far. Rocking and smoothness are refreshed once per
    /// second.
    [[nodiscard]] AttemptMetrics current_metrics() const;

    /// Completed attempts.
    [[nodiscard]] std::span<const AttemptSummary> attempts() const { return attempts_; }
    /// The run so far: maxima over attempts, time-weighted means, summed counts and times. The outcome
    /// follows from the tube's current position.
    [[nodiscard]] AttemptSummary run() const;

    [[nodiscard]] std::span<const Event> events() const { return events_; }

  private:
    void start_attempt();
    void add_to_attempt(const AttemptSample& sample);
    void end_attempt();
    void log_transitions(const AirwayWatch::Changes& changes);
    void log_vital_signs(double seconds);
    [[nodiscard]] physiology::Ventilation ventilation() const;
    /// Clears the metrics that this kind of patient does not provide.
    [[nodiscard]] AttemptMetrics measured(AttemptMetrics metrics) const;
    [[nodiscard]] Outcome outcome(const OutcomeTracker& tracker) const;
    void log_event(std::string text);

    PatientKind of_ = PatientKind::newborn;
    Laryngoscope scope_;
    double weight_ = 0.0;       // [kg]
    double time_limit_ = 30.0;  // [s]

    std::optional<std::uint64_t> first_ns_, last_ns_;
    double now_ = 0.0;  // [s] since the run began
    GateTracker blade_;
    AirwayWatch tube_;
    float trachea_length_ = 0.0f;
    std::optional<physiology::VitalSigns> vital_signs_;
    bool desaturated_ = false, bradycardic_ = false;
    double depth_at_lip_ = 0.0;  // [m], latest

    std::optional<Attempt> attempt_;
    double attempt_began_ = 0.0, next_refresh_ = 0.0;
    OutcomeTracker attempt_tracker_, run_tracker_;
    std::vector<AttemptSummary> attempts_;
    std::vector<RunPart::Weights> weights_;  // one per completed attempt
    std::vector<bool> passed_;               // glottis passed, one per completed attempt
    int entries_between_ = 0;                // oesophageal entries while no attempt was running
    int main_stem_between_ = 0;
    bool seen_in_attempt_ = false;
    LiveMetrics live_;
    std::vector<Event> events_;
};

}  // namespace eti::metrics
