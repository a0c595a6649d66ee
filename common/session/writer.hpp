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

/// Writes a session file on its own thread.
///
/// The file on disk is consistent at any time (HDF5's single-writer mode): SessionReader reads a file that a
/// killed program leaves, and `repair` makes it readable by every HDF5 tool. Such a file contains everything
/// pushed up to a quarter of a second before. All push() calls must come from one thread; none ever waits
/// unless Settings::wait_when_full is set.
class SessionWriter {
  public:
    struct Settings {
        /// Called once, on the writer's thread, when writing fails (full disk). Recording ends and the
        /// program continues; the text states the file, the reason and the remedy.
        std::function<void(const std::string&)> on_error;
        /// Called on the writer's thread, at most every 10 s, while records are lost because the disk is too
        /// slow.
        std::function<void(const std::string&)> on_warning;
        /// Capacity of the step queue; 1024 steps last 5.7 s at 180 Hz and take about 1 MB.
        std::size_t waiting_steps = 1024;
        /// For runs not tied to real time: push() waits for room instead of losing records.
        bool wait_when_full = false;
    };

    /// Creates the file; never replaces an existing one. Throws hdf5::Error.
    SessionWriter(const std::filesystem::path& path, const SessionInfo& info, const SceneRecord& scene,
                  Settings settings);
    ~SessionWriter();
    SessionWriter(const SessionWriter&) = delete;
    SessionWriter& operator=(const SessionWriter&) = delete;

    /// False if the record was lost: queue full, or recording has failed.
    bool push(const StepRecord& record);
    bool push(const CommandRecord& record);
    bool push(const StateRecord& record);
    bool push(const DeformationRecord& record);
    /// Only for a scene with liquid.
    bool push(const FluidRecord& record);
    bool push(const EventRecord& record);
    bool push(const AnnotationRecord& record);
    bool push(const SummaryRecord& record);

    /// Number of records lost because a queue was full.
    [[nodiscard]] std::uint64_t lost() const;
    [[nodiscard]] bool failed() const;

    /// Writes all queued records, marks the session as finished and closes the file. True if the file
    /// contains everything that was pushed. Does nothing on further calls.
    bool close();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace eti::session
