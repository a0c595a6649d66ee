// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "common/hdf5/file.hpp"
#include "common/session/cell.hpp"

namespace eti::session {

/// Data sets that grow together, one row of each per record. Rows collect in memory until a chunk is full:
/// rewriting a compressed chunk wastes its first location in the file.
class Table {
  public:
    explicit Table(std::size_t chunk_rows) : chunk_rows_(chunk_rows) {}

    /// Call while the file is created. Throws hdf5::Error.
    void create_column(const hdf5::Group& root, const std::string& path, hid_t type,
                       const hdf5::Shape& row_shape, const hdf5::Label& label);
    /// Opens the data sets of a reopened file for appending. Throws hdf5::Error.
    void open(const hdf5::Group& root);

    /// Storage for the next row's value in the next column; columns in order of creation.
    [[nodiscard]] std::byte* next_cell();

    [[nodiscard]] std::vector<std::string> paths() const;
    [[nodiscard]] std::size_t rows() const { return written_ + pending_; }
    [[nodiscard]] std::size_t written() const { return written_; }
    /// Whether write_chunk() has something to write.
    [[nodiscard]] bool has_chunk(bool unfinished) const;
    /// Whether a row has waited in memory for longer than `limit`.
    [[nodiscard]] bool overdue(std::chrono::steady_clock::duration limit) const;

    [[nodiscard]] std::size_t row_bytes() const;
    /// Appends waiting rows from row `first` on, column by column, to `to`.
    void copy_pending(std::size_t first, std::size_t rows, std::vector<std::byte>& to) const;

    /// Writes up to the end of the next chunk; an incomplete chunk only if requested. If the program is
    /// killed, the series of one table thus differ by at most one chunk. False on failure; error() states the
    /// reason.
    [[nodiscard]] bool write_chunk(bool unfinished);
    /// Writes everything at once: for a file that may be lost if left unfinished.
    [[nodiscard]] bool write_all();

    [[nodiscard]] const std::string& error() const { return error_; }

    /// Drops data sets that can no longer be written, without any further access to them.
    void abandon();

  private:
    struct Column {
        std::string path;
        hdf5::Shape row_shape;
        hdf5::Handle type;
        std::size_t row_bytes = 0;
        hdf5::Handle data_set;
        std::vector<std::byte> pending;
    };

    [[nodiscard]] bool write(std::size_t rows);

    std::size_t chunk_rows_;
    std::vector<Column> columns_;
    std::size_t cursor_ = 0;
    std::size_t written_ = 0;
    std::size_t pending_ = 0;
    std::chrono::steady_clock::time_point pending_since_{};
    std::string error_;
};

/// Links the steps' time axis into each group of step series. Throws hdf5::Error.
void link_time_axis(const hdf5::Group& root);

/// The visitor that creates a table's columns from a list in layout.hpp.
template <class Record>
[[nodiscard]] auto column_creator(Table& table, const hdf5::Group& root) {
    return [&table, &root](const std::string& path, const hdf5::Label& label, auto field, std::size_t width) {
        using Field = std::decay_t<decltype(field(std::declval<Record&>()))>;
        table.create_column(root, path, Cell<Field>::type(width).get(), Cell<Field>::shape(width), label);
    };
}

/// The visitor that appends a record.
template <class Record>
[[nodiscard]] auto row_appender(Table& table, const Record& record) {
    return [&table, &record](const std::string&, const hdf5::Label&, auto field, std::size_t width) {
        using Field = std::decay_t<decltype(field(record))>;
        Cell<Field>::pack(field(record), width, table.next_cell());
    };
}

}  // namespace eti::session
