// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/model/tools/tools.hpp"
#include "common/scenario/scenario.hpp"
#include "common/session/writer.hpp"
#include "server/metrics/metrics.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Writes the session file from the server's results. Call from one thread; never waits for the disk. A disk
/// failure is logged once with its remedy, and the session continues.
class Recorder {
  public:
    /// `info`: start time, version and build are filled in where empty. `start`: snapshot before the first
    /// step. `wait_when_full`: for runs that are not in real time; see SessionWriter::Settings. Throws
    /// hdf5::Error if the file cannot be created.
    Recorder(const std::filesystem::path& path, session::SessionInfo info, const patient::Patient& patient,
             const Laryngoscope& scope, const Scenario& scenario, const scene::Snapshot& start,
             bool wait_when_full);

    /// Call once per step. `eye`: as latched, if any has arrived; `eye_used`: of the last view evaluation
    /// [m].
    void record(const scene::Snapshot& snapshot, const metrics::LiveMetrics& live,
                const AttemptMetrics& metrics, const std::optional<RigidTransform>& eye,
                const Vec3f& eye_used);
    /// Records a command that takes effect before step `step`. `value`: SI.
    void command(std::uint64_t time_ns, std::uint64_t step, const std::string& kind, double value,
                 const std::string& sender, std::uint32_t id);
    /// Records the state after a step.
    void state(const session::StateRecord& record) { writer_.push(record); }
    /// Records an event. `kind`: one word (attempt, command, error, ...).
    void event(std::uint64_t time_ns, const std::string& kind, const std::string& text);
    /// Records an annotation.
    void annotation(const session::AnnotationRecord& record) { writer_.push(record); }
    /// Records an attempt, or the whole run (number 0); replaces an earlier record of the same number.
    void summary(const metrics::AttemptSummary& summary);

    /// Closes the file. Returns false if it is incomplete. Later calls do nothing.
    bool finish() { return writer_.close(); }

  private:
    void record_deformation(const scene::Snapshot& snapshot);
    void record_fluid(const scene::Snapshot& snapshot);

    session::SessionWriter writer_;
    session::StepRecord step_;
    session::DeformationRecord moved_;
    session::FluidRecord fluid_;
    std::vector<FramePose> recorded_;        // frames as last recorded
    std::optional<std::uint64_t> first_ns_;  // of the first step
    std::uint64_t next_deformation_ns_ = 0;
    bool all_frames_ = true;
};

/// Fills the record of a step. `metrics`: of the attempt so far. `eye`: as latched, if any has arrived;
/// `eye_used`: of the last view evaluation [m].
void fill(session::StepRecord& record, const scene::Snapshot& snapshot, const metrics::LiveMetrics& live,
          const AttemptMetrics& metrics, const std::optional<RigidTransform>& eye, const Vec3f& eye_used);

inline constexpr std::uint64_t deformation_period_ns = 1'000'000'000 / 15;

/// Compiler, build type and instruction set, on which the bits of a re-simulation depend.
[[nodiscard]] std::string build_description();

}  // namespace eti::app
