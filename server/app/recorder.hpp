// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/model/tools.hpp"
#include "common/scenario/scenario.hpp"
#include "common/session/writer.hpp"
#include "server/metrics/metrics.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Keeps the session file: turns what the server computes into records. Call from one thread; nothing
/// waits for the disk. A failing disk is logged once with its remedy, and the session goes on.
class Recorder {
  public:
    /// `info`: start time, version and build are filled in where empty. `start`: before the first step.
    /// `wait_when_full`: for runs that ignore the clock; see SessionWriter::Settings. Throws hdf5::Error if
    /// the file cannot be begun.
    Recorder(const std::filesystem::path& path, session::SessionInfo info, const anatomy::Patient& patient,
             const Laryngoscope& scope, const Scenario& scenario, const scene::Snapshot& start,
             bool wait_when_full);

    /// Once per step. `eye`: as latched, if one has arrived; `eye_used`: of the last look [m].
    void record(const scene::Snapshot& snapshot, const metrics::Live& live, const Parameters& parameters,
                const std::optional<RigidTransform>& eye, const Vec3f& eye_used);
    /// A command, when it takes effect before step `step`. `value`: SI.
    void command(std::uint64_t time_ns, std::uint64_t step, const std::string& kind, double value,
                 const std::string& sender, std::uint32_t id);
    /// The state after a step.
    void state(const session::StateRecord& record) { writer_.push(record); }
    /// `kind`: one word (attempt, command, error, ...).
    void event(std::uint64_t time_ns, const std::string& kind, const std::string& text);
    /// What somebody pointed at or drew.
    void annotation(const session::AnnotationRecord& record) { writer_.push(record); }
    /// An attempt, or the run as a whole (number 0); a later one of the same number replaces an earlier.
    void summary(const metrics::AttemptSummary& summary);

    /// Closes the file; false if something is missing in it. Later calls do nothing.
    bool finish() { return writer_.close(); }

  private:
    void record_deformation(const scene::Snapshot& snapshot);
    void record_fluid(const scene::Snapshot& snapshot);

    session::SessionWriter writer_;
    session::StepRecord step_;
    session::DeformationRecord moved_;
    session::FluidRecord fluid_;
    std::vector<FramePose> recorded_;        // where each frame was when last recorded
    std::optional<std::uint64_t> first_ns_;  // of the first step
    std::uint64_t next_deformation_ns_ = 0;
    bool all_frames_ = true;
};

/// What is recorded of a step. `parameters`: of the attempt so far. `eye`: as latched, if one has arrived;
/// `eye_used`: of the last look [m].
void fill(session::StepRecord& record, const scene::Snapshot& snapshot, const metrics::Live& live,
          const Parameters& parameters, const std::optional<RigidTransform>& eye, const Vec3f& eye_used);

inline constexpr std::uint64_t deformation_period_ns = 1'000'000'000 / 15;

/// Compiler, build type and instruction set: what the bits of a re-run depend on.
[[nodiscard]] std::string build_description();

}  // namespace eti::app
