// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "common/session/record.hpp"

namespace eti::session {

/// Writes a session file on a thread of its own.
///
/// What is on disk is a consistent file at any time (HDF5's single-writer mode): a killed program leaves a
/// file that SessionReader reads and that `repair` opens to every HDF5 tool. What was pushed a quarter of a
/// second before is in it. All push() calls must come from one thread; none ever waits,
/// unless Settings::wait_when_full says so.
class SessionWriter {
  public:
    struct Settings {
        /// Called on the writer's thread, once, when writing failed (full disk). Recording ends there, the
        /// program goes on; the text names the file, the reason and the remedy.
        std::function<void(const std::string&)> on_error;
        /// Called on the writer's thread, at most every 10 s, while records are lost because the disk
        /// cannot follow.
        std::function<void(const std::string&)> on_warning;
        /// Steps that may wait for the disk; 1024 last 5.7 s at 180 Hz and take about 1 MB.
        std::size_t waiting_steps = 1024;
        /// For runs that ignore the clock: push() waits for room instead of losing records.
        bool wait_when_full = false;
    };

    /// Creates the file; refuses to replace one. Throws hdf5::Error.
    SessionWriter(const std::filesystem::path& path, const SessionInfo& info, const SceneRecord& scene,
                  Settings settings);
    ~SessionWriter();
    SessionWriter(const SessionWriter&) = delete;
    SessionWriter& operator=(const SessionWriter&) = delete;

    /// False if the record was lost: no room, or recording has failed.
    bool push(const StepRecord& record);
    bool push(const CommandRecord& record);
    bool push(const StateRecord& record);
    bool push(const DeformationRecord& record);
    /// Only for a scene with liquid.
    bool push(const FluidRecord& record);
    bool push(const EventRecord& record);
    bool push(const AnnotationRecord& record);
    bool push(const SummaryRecord& record);

    /// Records lost for want of room.
    [[nodiscard]] std::uint64_t lost() const;
    [[nodiscard]] bool failed() const;

    /// Writes what still waits, marks the session as finished and closes the file. True if all that was
    /// pushed is in it. Does nothing when called again.
    bool close();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace eti::session
