// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/session/table.hpp"

namespace eti::session {

/// The newest rows of a session file, before they are in its series: a region of fixed size in the file,
/// overwritten repeatedly. A killed writer's series end with their last full chunks, and the tail continues
/// from there.
///
/// The region has two halves. Each holds a sequence of records: rows of one table, with a checksum and the
/// number of switches between the halves so far. When a half is full, the writer switches and starts the
/// other one with all rows that are in no series yet. Whatever write a kill interrupts, the previous half is
/// complete.
class Tail {
  public:
    /// `tables`: the tables to hold, most valuable first; rows that refer to others come after those. The
    /// tables must outlive the tail.
    explicit Tail(const std::vector<Table*>& tables) : tables_(tables) {}

    /// Call while the file is created. Throws hdf5::Error.
    void create(const hdf5::Group& root) const;
    /// Call on a reopened file. Throws hdf5::Error.
    void open(const hdf5::Group& root);

    /// Writes rows that wait in the tables and are not in the tail yet; the excess waits for the series.
    /// False on failure; error() states the reason. Do not call between a table's write and the flush after
    /// it.
    [[nodiscard]] bool write();
    [[nodiscard]] const std::string& error() const { return error_; }

    /// Drops what can no longer be written.
    void abandon() { bytes_.abandon(); }

  private:
    /// Gathers the waiting rows of all tables, or only those not in the tail yet; false if there is no room
    /// for all.
    [[nodiscard]] bool gather(bool again);
    /// Appends the rows of a table from `first` on; false if there is no room for all.
    [[nodiscard]] bool append(std::size_t table, std::size_t first);

    const std::vector<Table*>& tables_;
    hdf5::Handle bytes_;
    std::vector<std::size_t> held_;     // one past the last row of each table that is here
    std::vector<std::size_t> reached_;  // the same, including gathered rows
    std::uint64_t changes_ = 1;         // of halves
    std::size_t place_ = 0;             // in the half
    std::vector<std::byte> buffer_;
    std::string error_;
};

/// Moves the rows of a killed writer's tail into their series and removes the tail. Returns the number of
/// rows. Changes nothing in a completely recorded file. Throws hdf5::Error and then leaves the file unusable:
/// use it on a copy.
std::size_t merge_tail(const std::filesystem::path& path);

}  // namespace eti::session
