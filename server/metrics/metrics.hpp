// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/model/parameters.hpp"
#include "common/model/run.hpp"
#include "common/model/tools.hpp"
#include "server/metrics/attempt.hpp"
#include "server/metrics/glottic_view.hpp"
#include "server/metrics/story.hpp"
#include "server/metrics/vital_signs.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::metrics {

/// What an instructor watches while a run goes on.
struct Live {
    std::uint32_t attempt = 0;  ///< number of the last attempt; 0 before the first
    bool attempt_running = false;
    float glottic_opening_percent = 0.0f;
    float gum_force = 0.0f;                 ///< [N]
    float tube_depth_past_glottis = -1.0f;  ///< [m]; minus the distance from the glottis before it
    TubePlace tube_place = TubePlace::outside;
    Vec3f tube_tip = Vec3f::Zero();  ///< [m]
    std::string message;             ///< the last event
    /// Looked for only where nothing of the opening is in sight.
    bool epiglottis_in_sight = false;
    double oxygen_saturation = std::numeric_limits<double>::quiet_NaN();  ///< [%], where it is simulated
    double heart_rate = std::numeric_limits<double>::quiet_NaN();         ///< [1/min], likewise
};

struct AttemptSummary {
    std::uint32_t number = 0;  ///< from 1; 0 for the whole run
    double began = 0.0;        ///< [s] since the run began
    double ended = 0.0;
    Outcome outcome;
    Parameters parameters;
};

/// Something worth a line in the session's record.
struct Event {
    std::uint64_t time_ns = 0;  ///< simulation time
    std::string text;
};

/// What is measured on. A manikin says where the tools are, and nothing of tissue, view and airway.
enum class Patient : std::uint8_t { newborn, manikin };

/// The performance parameters of a run, attempt by attempt, from snapshots. Definitions: docs/metrics.md.
/// An attempt begins when the blade's tip passes the mouth opening inwards and ends when it is out again.
class Metrics {
  public:
    /// Starts a run. `time_limit` [s] per attempt. Without a physiology, vital signs are not simulated.
    void begin(const anatomy::Patient& patient, const Laryngoscope& scope, double time_limit = 30.0,
               const std::optional<Physiology>& physiology = std::nullopt, Patient of = Patient::newborn);

    /// Takes in the next snapshot; one that is not newer than the last is ignored. `view` is the newest
    /// result of GlotticViewer, which may be older than the snapshot.
    void observe(const scene::Snapshot& snapshot, const GlotticView& view);

    /// Ends the run, and with it an attempt that still goes on.
    void finish();

    [[nodiscard]] const Live& live() const { return live_; }
    /// Of the attempt that is going on, else of the run so far. Rocking and smoothness are brought up to
    /// date once a second.
    [[nodiscard]] Parameters live_parameters() const;

    /// Attempts that have ended.
    [[nodiscard]] std::span<const AttemptSummary> attempts() const { return attempts_; }
    /// The run so far: maxima over attempts, means weighted by time, summed counts and time. The outcome
    /// is judged by where the tube lies now.
    [[nodiscard]] AttemptSummary run() const;

    [[nodiscard]] std::span<const Event> events() const { return events_; }

  private:
    void start_attempt();
    void add_to_attempt(const Moment& moment);
    void end_attempt();
    void note_changes(const AirwayWatch::Changes& changes);
    void note_vital_signs(double seconds);
    [[nodiscard]] Ventilation ventilation() const;
    /// What of these is measured here.
    [[nodiscard]] Parameters measured(Parameters parameters) const;
    [[nodiscard]] Outcome outcome(const Story& story) const;
    void note(std::string text);

    Patient of_ = Patient::newborn;
    Laryngoscope scope_;
    double weight_ = 0.0;       // [kg]
    double time_limit_ = 30.0;  // [s]

    std::optional<std::uint64_t> first_ns_, last_ns_;
    double now_ = 0.0;  // [s] since the run began
    Passage blade_;
    AirwayWatch tube_;
    float trachea_length_ = 0.0f;
    std::optional<VitalSigns> vital_signs_;
    bool desaturated_ = false, bradycardic_ = false;
    double depth_at_lip_ = 0.0;  // [m], newest

    std::optional<Attempt> attempt_;
    double attempt_began_ = 0.0, next_refresh_ = 0.0;
    Story attempt_story_, run_story_;
    std::vector<AttemptSummary> attempts_;
    std::vector<RunPart::Weights> weights_;  // one per attempt that has ended
    std::vector<bool> passed_;               // glottis passed, one per attempt that has ended
    int entries_between_ = 0;                // into the oesophagus, while no attempt was going on
    int main_stem_between_ = 0;
    bool seen_in_attempt_ = false;
    Live live_;
    std::vector<Event> events_;
};

}  // namespace eti::metrics
