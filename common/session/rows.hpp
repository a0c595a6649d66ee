// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/hdf5/group.hpp"
#include "common/session/cell.hpp"

namespace eti::session {

/// Number of rows readable from the start: all, or those before the first damaged chunk. Throws hdf5::Error
/// if `path` is not a data set.
[[nodiscard]] std::size_t readable_rows(const hdf5::Group& root, const std::string& path);

/// Rows `first` to `first + count - 1` of a data set.
struct RowRange {
    std::size_t first = 0, count = 0;
};

/// How much of a data set can be read.
struct Condition {
    bool there = false;          ///< the data set can be opened
    std::size_t stated = 0;      ///< number of rows as stated
    hdf5::Shape row_shape;       ///< extents behind the row's index
    std::vector<RowRange> lost;  ///< of those, the rows of unreadable chunks, in order
    [[nodiscard]] bool whole() const { return there && lost.empty(); }
    [[nodiscard]] std::size_t prefix() const { return lost.empty() ? stated : lost.front().first; }
    /// One past the last row that can be read.
    [[nodiscard]] std::size_t end() const;
};

/// End of a data set that a killed writer left.
struct RowsEnd {
    std::size_t end = 0;  ///< one past the last readable row, if that is near its stated end
    hdf5::Shape row_shape;
};

/// Examines the last chunks only. Throws hdf5::Error if `path` is not a data set.
[[nodiscard]] RowsEnd rows_end(const hdf5::Group& root, const std::string& path);

/// Resizes a series to `rows`; false if the library fails.
[[nodiscard]] bool set_rows(hid_t data_set, const hdf5::Shape& row_shape, std::size_t rows);

/// Writes rows of a series, each of shape `row_shape`. Nullopt on success, else the reason.
[[nodiscard]] std::optional<std::string> write_rows(hid_t data_set, hid_t type, const hdf5::Shape& row_shape,
                                                    std::size_t first, std::size_t rows, const void* values);

/// Reads a data set chunk by chunk. Never throws: a data set that cannot be opened counts as missing.
[[nodiscard]] Condition examine(const hdf5::Group& root, const std::string& path);

/// The first `rows` rows as memory image of `type`, as far as they can be read; `fill` supplies the others.
/// Throws hdf5::Error if the rows have another shape.
[[nodiscard]] std::vector<std::byte> salvage(const hdf5::Group& root, const std::string& path, hid_t type,
                                             const hdf5::Shape& row_shape, std::size_t rows,
                                             const Condition& condition, std::span<const std::byte> fill);

/// The first `rows` rows as memory image of `type`. Throws hdf5::Error, also if the rows have another shape.
[[nodiscard]] std::vector<std::byte> read_rows_as(const hdf5::Group& root, const std::string& path,
                                                  hid_t type, const hdf5::Shape& row_shape, std::size_t rows);

/// The first `rows` rows of a numeric data set. Throws hdf5::Error.
[[nodiscard]] std::vector<double> read_as_doubles(const hdf5::Group& root, const std::string& path,
                                                  std::size_t rows);

/// A text attribute of a data set; empty where there is none.
[[nodiscard]] std::string text_of(const hdf5::Group& root, const std::string& path,
                                  const char* attribute_name);

template <class T>
void set_missing(T& value) {
    if constexpr (std::is_floating_point_v<T>) {
        value = std::numeric_limits<T>::quiet_NaN();
    } else {
        std::ranges::for_each(value, [](auto& element) { set_missing(element); });
    }
}

/// Reads the records of a list in layout.hpp, up to the common length of its data sets.
template <class Record, class Visit>
[[nodiscard]] std::vector<Record> read_records(const hdf5::Group& root, const Visit& visit) {
    std::size_t rows = std::numeric_limits<std::size_t>::max();
    visit([&](const std::string& path, const hdf5::Label&, auto field, std::size_t) {
        using Field = std::decay_t<decltype(field(std::declval<Record&>()))>;
        // A measured value may be newer than the file; everything else is required.
        if (!is_measure<Field> || root.has(path)) {
            rows = std::min(rows, readable_rows(root, path));
        }
    });
    std::vector<Record> records(rows);
    visit([&](const std::string& path, const hdf5::Label&, auto field, std::size_t width) {
        using Field = std::decay_t<decltype(field(std::declval<Record&>()))>;
        if constexpr (is_measure<Field>) {
            if (!root.has(path)) {
                for (Record& record : records) {
                    set_missing(field(record));
                }
                return;
            }
        }
        const auto bytes =
            read_rows_as(root, path, Cell<Field>::type(width).get(), Cell<Field>::shape(width), rows);
        for (std::size_t i = 0; i < rows; ++i) {
            Cell<Field>::unpack(bytes.data() + i * Cell<Field>::bytes(width), width, field(records[i]));
        }
    });
    return records;
}

}  // namespace eti::session
