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

/// The newest rows of a session file, before they are in its series: a place of fixed size in the file, which
/// is written over and over. A killed writer's series end with their last full chunks, and the tail goes on
/// from there.
///
/// The place has two halves. Each holds one record after the other: rows of one table, with a checksum and
/// the number of times that the writer has changed halves. It changes when a half is full, and begins the
/// other one with all rows that are in no series yet: whatever a kill tears, the half before it is whole.
class Tail {
  public:
    /// `tables`: what it holds the rows of, the dearest first; rows that point to others behind those. They
    /// have to outlive it.
    explicit Tail(const std::vector<Table*>& tables) : tables_(tables) {}

    /// While the file is made. Throws hdf5::Error.
    void create(const hdf5::Group& root) const;
    /// In a file opened anew. Throws hdf5::Error.
    void open(const hdf5::Group& root);

    /// Writes what waits in the tables and is not here yet; leaves what is too much for it to the series.
    /// False on failure; error() tells why. Not between a table's write and the flush after it.
    [[nodiscard]] bool write();
    [[nodiscard]] const std::string& error() const { return error_; }

    /// Lets go of what can no longer be written.
    void abandon() { bytes_.abandon(); }

  private:
    /// The waiting rows of all tables, or those alone that are not here yet; false if there is no room for
    /// all.
    [[nodiscard]] bool gather(bool again);
    /// The rows of a table from `first` on; false if there is no room for all.
    [[nodiscard]] bool append(std::size_t table, std::size_t first);

    const std::vector<Table*>& tables_;
    hdf5::Handle bytes_;
    std::vector<std::size_t> held_;     // one past the last row of each table that is here
    std::vector<std::size_t> reached_;  // the same, with what is gathered
    std::uint64_t changes_ = 1;         // of halves
    std::size_t place_ = 0;             // in the half
    std::vector<std::byte> buffer_;
    std::string error_;
};

/// Moves the rows of a killed writer's tail into their series and removes it. Returns how many rows that
/// were. Changes nothing in a file that was recorded to its end. Throws hdf5::Error, and leaves the file
/// unusable then: for a copy.
std::size_t take_in_tail(const std::filesystem::path& path);

}  // namespace eti::session
