// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <vector>

#include "common/scenario/scenario.hpp"
#include "server/app/output/recording.hpp"
#include "server/app/output/scene_messages.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// A recorded session as snapshots of its steps, as far as recorded: everything that is drawn and measured.
/// Deformation is recorded at 15 Hz; it is exact at these times and interpolated linearly between them.
/// Liquid keeps its last recorded positions. Data for haptics is missing: velocities, tissue contacts, forces
/// of the tube.
class RecordedStates {
  public:
    /// `recording` must outlive it. Throws InputError if the scene is missing or values are implausible.
    RecordedStates(const Recording& recording, const Scenario& scenario);

    /// The drawn parts of the patient, without particles.
    [[nodiscard]] const patient::Patient& patient() const { return patient_; }
    [[nodiscard]] std::size_t size() const { return recording_.steps.size(); }

    /// Snapshot of the step in this row. Valid until the next call.
    [[nodiscard]] const scene::Snapshot& at(std::size_t row);
    /// Metrics up to this row. Valid until the next call.
    [[nodiscard]] const AttemptStatus& status(std::size_t row);

  private:
    /// Loads `from_` with the frames of the last deformation record up to `time_ns`.
    void seek(std::uint64_t time_ns);
    void fill_frames(std::uint64_t time_ns);
    void find_tube_places();

    const Recording& recording_;
    patient::Patient patient_;
    scene::Snapshot snapshot_;
    AttemptStatus status_;
    std::vector<FramePose> from_;
    std::size_t next_record_ = 0;                  // deformation record that follows those in `from_`
    std::vector<metrics::TubePlace> tube_places_;  // of every sixth row
};

}  // namespace eti::app
