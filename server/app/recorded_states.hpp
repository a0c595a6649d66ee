// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <vector>

#include "common/scenario/scenario.hpp"
#include "server/app/recording.hpp"
#include "server/app/scene_messages.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// A recorded session as snapshots of its steps, as far as its file tells: all that is seen and measured.
/// Tissue is there 15 times a second, exact at these times and carried evenly from one to the next; liquid
/// stays where it was. What only a hand feels is not there: velocities, tissue contacts, forces of the tube.
class RecordedStates {
  public:
    /// `recording` has to outlive it. Throws InputError where it lacks the scene, or numbers cannot be right.
    RecordedStates(const Recording& recording, const Scenario& scenario);

    /// What is drawn of the patient, without particles.
    [[nodiscard]] const anatomy::Patient& patient() const { return patient_; }
    [[nodiscard]] std::size_t size() const { return recording_.steps.size(); }

    /// The step of this row. Valid until the next call.
    [[nodiscard]] const scene::Snapshot& at(std::size_t row);
    /// What was measured until then. Valid until the next call.
    [[nodiscard]] const LiveMeasures& measures(std::size_t row);

  private:
    /// Has `from_` the frames of the last record of deformation up to `time_ns`.
    void go_to(std::uint64_t time_ns);
    void fill_frames(std::uint64_t time_ns);
    void find_tube_places();

    const Recording& recording_;
    anatomy::Patient patient_;
    scene::Snapshot snapshot_;
    LiveMeasures measures_;
    std::vector<FramePose> from_;
    std::size_t next_record_ = 0;                  // of deformation, after those that `from_` has
    std::vector<metrics::TubePlace> tube_places_;  // of every sixth row
};

}  // namespace eti::app
