// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/hdf5/file.hpp"
#include "common/session/record.hpp"

namespace eti::session {

/// A data set of numbers with one row per step, command, event, ...; integers as doubles.
struct Series {
    std::string path;  ///< "tools/tube_nodes"
    std::string units;
    hdf5::Shape row_shape;  ///< extents behind the row's index
    std::vector<double> values;
    std::vector<std::string> texts;  ///< instead of values, for a data set of texts
    [[nodiscard]] std::size_t row_size() const;
    [[nodiscard]] std::size_t rows() const;
};

/// Reads a session file: finished, still being recorded (what is on disk so far), or left by a killed
/// program. Never changes the file: to read a killed program's tail, it makes a copy while it opens the file.
/// Data sets of unequal length, as a killed writer leaves them, are read up to the last row that all have.
/// All functions throw hdf5::Error.
///
/// The HDF5 library may crash on a hostile file: read files of unknown origin in run_guarded().
class SessionReader {
  public:
    explicit SessionReader(const std::filesystem::path& path);
    [[nodiscard]] const hdf5::Group& root() const { return file_.root(); }

    [[nodiscard]] const SessionInfo& info() const { return info_; }
    [[nodiscard]] bool finished() const { return finished_; }  ///< closed in order
    [[nodiscard]] bool is_being_recorded() const {
        return being_recorded_;
    }  ///< being recorded by a running program
    /// Number of rows that only the tail of a killed program's file contains.
    [[nodiscard]] std::size_t rows_in_tail() const { return rows_in_tail_; }
    [[nodiscard]] std::uint64_t lost_records() const { return lost_; }
    /// Time of the last step [s].
    [[nodiscard]] double duration() const;

    [[nodiscard]] SceneRecord scene() const;
    [[nodiscard]] std::vector<StepRecord> steps() const;
    [[nodiscard]] std::vector<CommandRecord> commands() const;
    /// Empty for a file older than these records.
    [[nodiscard]] std::vector<StateRecord> states() const;
    [[nodiscard]] std::vector<DeformationRecord> deformations() const;
    /// Empty for a session without secretions.
    [[nodiscard]] std::vector<FluidRecord> fluids() const;
    [[nodiscard]] std::vector<EventRecord> events() const;
    /// Empty for a file of a program without annotations.
    [[nodiscard]] std::vector<AnnotationRecord> annotations() const;
    /// The last record of each attempt, ordered by attempt; attempt 0, the whole run, comes first if present.
    [[nodiscard]] std::vector<SummaryRecord> summaries() const;

    /// Every data set of a group and its subgroups with one row per entry of the group's time axis (per
    /// attempt, in the summary), truncated to their common length; the time axis first.
    [[nodiscard]] std::vector<Series> series(const std::string& group) const;

  private:
    void merge_tail(const std::filesystem::path& path);

    bool being_recorded_ = false;
    hdf5::File file_;
    std::size_t rows_in_tail_ = 0;
    SessionInfo info_;
    bool finished_ = false;
    std::uint64_t lost_ = 0;
};

}  // namespace eti::session
