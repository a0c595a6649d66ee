// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/repair/tail.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <span>

#include "common/session/repair/superblock.hpp"
#include "common/session/rows.hpp"

namespace eti::session {

namespace {

using hdf5::Group;
using hdf5::Handle;

constexpr const char* tail_group = "tail";
constexpr const char* bytes_path = "tail/bytes";

/// Also holds several seconds of rows that a busy machine delays. Unwritten parts take no disk space.
constexpr std::size_t half_bytes = 1024 * 1024;
/// Above this size the halves are switched: it exceeds all rows waiting for a full chunk and some tenths of a
/// second of new ones.
constexpr std::size_t usual_bytes = 512 * 1024;

/// Header of a record's rows, which are stored column by column.
struct Head {
    std::uint32_t checksum = 0;  ///< of everything after it
    std::uint32_t table = 0;
    std::uint64_t changes = 0;
    std::uint64_t first = 0;  ///< row number
    std::uint64_t rows = 0;
    std::uint64_t bytes = 0;  ///< of the rows
};
static_assert(sizeof(Head) == 40);

std::uint32_t checksum_of(std::span<const std::byte> record) {
    constexpr std::size_t from = sizeof(Head::checksum);
    return metadata_checksum(reinterpret_cast<const unsigned char*>(record.data()) + from,
                             record.size() - from);
}

/// A table with rows in the tail, as a reader finds it.
struct FoundTable {
    std::vector<std::string> paths;
    std::map<std::uint64_t, std::vector<std::byte>> rows;  ///< each with all its columns
};

struct FoundColumn {
    Handle data_set, type;
    hdf5::Shape row_shape;
    std::size_t row_bytes = 0;
    std::size_t end = 0;  ///< one past the last row that can be read
};

std::vector<FoundTable> tables_of(const Group& tail) {
    const auto paths = tail.read_texts("column");
    const auto numbers = tail.read<std::uint32_t>("table", {paths.size()}).values;
    std::vector<FoundTable> tables;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        if (numbers[i] > paths.size()) {
            throw hdf5::Error(fmt::format("{}: damaged", tail.at("table")));
        }
        tables.resize(std::max<std::size_t>(tables.size(), numbers[i] + 1));
        tables[numbers[i]].paths.push_back(paths[i]);
    }
    return tables;
}

std::vector<FoundColumn> columns_of(const Group& root, const FoundTable& table) {
    std::vector<FoundColumn> columns;
    for (const std::string& path : table.paths) {
        FoundColumn& column = columns.emplace_back();
        column.data_set = {H5Dopen2(root.id(), path.c_str(), H5P_DEFAULT), H5Dclose};
        column.type = {column.data_set ? H5Dget_type(column.data_set.get()) : -1, H5Tclose};
        if (!column.type) {
            throw hdf5::Error(fmt::format("{}: cannot be opened: {}", root.at(path), hdf5::last_error()));
        }
        const RowsEnd found = rows_end(root, path);
        column.row_shape = found.row_shape;
        column.end = found.end;
        column.row_bytes = H5Tget_size(column.type.get());
        for (const std::size_t extent : column.row_shape) {
            column.row_bytes *= extent;
        }
    }
    return columns;
}

/// Reads the records of one half into their tables, up to the first invalid one.
void read_half(std::span<const std::byte> half, const std::vector<std::vector<FoundColumn>>& columns,
               std::vector<FoundTable>& tables) {
    std::uint64_t changes = 0;
    while (half.size() >= sizeof(Head)) {
        Head head;
        std::memcpy(&head, half.data(), sizeof(head));
        if (head.bytes > half.size() - sizeof(head) || head.table >= tables.size() || head.changes == 0 ||
            (changes != 0 && head.changes != changes) ||
            checksum_of(half.first(sizeof(head) + head.bytes)) != head.checksum) {
            return;
        }
        changes = head.changes;
        std::size_t row_bytes = 0;
        for (const FoundColumn& column : columns[head.table]) {
            row_bytes += column.row_bytes;
        }
        if (head.rows > head.bytes || head.rows * row_bytes != head.bytes) {
            return;
        }
        for (std::uint64_t row = 0; row < head.rows; ++row) {
            std::vector<std::byte>& whole = tables[head.table].rows[head.first + row];
            whole.clear();
            const std::byte* column_rows = half.data() + sizeof(head);
            for (const FoundColumn& column : columns[head.table]) {
                const std::byte* const at = column_rows + row * column.row_bytes;
                whole.insert(whole.end(), at, at + column.row_bytes);
                column_rows += head.rows * column.row_bytes;
            }
        }
        half = half.subspan(sizeof(head) + head.bytes);
    }
}

void extend(FoundColumn& column, std::size_t rows) {
    if (!set_rows(column.data_set.get(), column.row_shape, rows)) {
        throw hdf5::Error(fmt::format("cannot change the length of a series: {}", hdf5::last_error()));
    }
}

/// Appends the newest rows without a gap. Returns how many of them the table's series lacked.
std::size_t append_rows(FoundTable& table, std::vector<FoundColumn>& columns) {
    if (table.rows.empty()) {
        return 0;
    }
    const std::size_t past = table.rows.rbegin()->first + 1;
    std::size_t first = past;
    for (auto row = table.rows.rbegin(); row != table.rows.rend() && row->first + 1 == first; ++row) {
        first = row->first;
    }
    // A column that ends before the tail's first row is damaged, and remains so.
    std::size_t from = past;
    for (const FoundColumn& column : columns) {
        if (column.end >= first) {
            from = std::min(from, column.end);
        }
    }
    if (from == past) {
        return 0;
    }
    std::size_t offset = 0;
    for (FoundColumn& column : columns) {
        extend(column, column.end);  // drops a partially written chunk
        extend(column, std::max(column.end, past));
        std::vector<std::byte> values;
        for (std::size_t row = from; row < past; ++row) {
            const std::byte* const at = table.rows.at(row).data() + offset;
            values.insert(values.end(), at, at + column.row_bytes);
        }
        if (const auto why = write_rows(column.data_set.get(), column.type.get(), column.row_shape, from,
                                        past - from, values.data())) {
            throw hdf5::Error(fmt::format("cannot continue a series: {}", *why));
        }
        offset += column.row_bytes;
    }
    return past - from;
}

}  // namespace

void Tail::create(const Group& root) const {
    const Group group = root.create(tail_group);
    std::vector<std::string> columns;
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < tables_.size(); ++i) {
        for (const std::string& path : tables_[i]->paths()) {
            columns.push_back(path);
            numbers.push_back(static_cast<std::uint32_t>(i));
        }
    }
    group.write_texts("column", columns, {"1", "series whose rows may be in the tail"});
    group.write<std::uint32_t>("table", numbers, {numbers.size()},
                               {"1", "series of equal number grow together"});
    const std::array<hsize_t, 1> size{2 * half_bytes};
    const Handle space(H5Screate_simple(1, size.data(), nullptr), H5Sclose);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_EARLY);  // later the file's structure may not change
    H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER);
    const Handle data_set(H5Dcreate2(root.id(), bytes_path, H5T_NATIVE_UINT8, space.get(), H5P_DEFAULT,
                                     creation.get(), H5P_DEFAULT),
                          H5Dclose);
    if (!data_set ||
        !hdf5::set_label(data_set.get(), {"1",
                                          "newest rows of a killed recording, which eti-review check "
                                          "--repair moves into their series; unused in a finished file"})) {
        throw hdf5::Error(
            fmt::format("{}: the data set cannot be created: {}", root.at(bytes_path), hdf5::last_error()));
    }
}

void Tail::open(const Group& root) {
    bytes_ = {H5Dopen2(root.id(), bytes_path, H5P_DEFAULT), H5Dclose};
    if (!bytes_) {
        throw hdf5::Error(
            fmt::format("{}: the data set cannot be opened: {}", root.at(bytes_path), hdf5::last_error()));
    }
    held_.assign(tables_.size(), 0);
}

bool Tail::append(std::size_t table, std::size_t first) {
    const Table& from = *tables_[table];
    const std::size_t at = buffer_.size(), begins = at + sizeof(Head);
    const std::size_t room = begins < half_bytes ? (half_bytes - begins) / from.row_bytes() : 0;
    const std::size_t rows = std::min(from.rows() - first, room);
    if (rows > 0) {
        buffer_.resize(begins);
        from.copy_pending(first, rows, buffer_);
        const Head head{0, static_cast<std::uint32_t>(table), changes_, first, rows, buffer_.size() - begins};
        std::memcpy(buffer_.data() + at, &head, sizeof(head));
        const std::uint32_t checksum = checksum_of(std::span(buffer_).subspan(at));
        std::memcpy(buffer_.data() + at, &checksum, sizeof(checksum));
        reached_[table] = first + rows;
    }
    return first + rows == from.rows();
}

bool Tail::gather(bool again) {
    buffer_.clear();
    reached_ = held_;
    // Rows that refer to others are useless without them.
    for (std::size_t i = 0; i < tables_.size(); ++i) {
        const std::size_t written = tables_[i]->written();
        if (!append(i, again ? written : std::max(held_[i], written))) {
            return false;
        }
    }
    return true;
}

bool Tail::write() {
    const bool all = gather(false);
    if (buffer_.empty()) {
        return true;
    }
    if (!all || place_ + buffer_.size() > usual_bytes) {
        ++changes_;
        (void)gather(true);  // the excess waits for its series
        place_ = 0;
    }
    if (const auto why = write_rows(bytes_.get(), H5T_NATIVE_UINT8, {}, changes_ % 2 * half_bytes + place_,
                                    buffer_.size(), buffer_.data())) {
        error_ = *why;
        return false;
    }
    place_ += buffer_.size();
    held_ = reached_;
    return true;
}

std::size_t merge_tail(const std::filesystem::path& path) {
    hdf5::File file = hdf5::File::open(path, hdf5::Access::modify);
    const Group& root = file.root();
    if (!root.has(tail_group) || root.open("meta").integer("finished") != 0) {
        return 0;
    }
    const Group tail = root.open(tail_group);
    std::vector<FoundTable> tables = tables_of(tail);
    std::vector<std::vector<FoundColumn>> columns;
    for (const FoundTable& table : tables) {
        columns.push_back(columns_of(root, table));
    }
    const auto bytes = tail.read<std::uint8_t>("bytes", {2 * half_bytes}).values;
    const std::span<const std::byte> all = std::as_bytes(std::span(bytes));
    // Which half is newer does not matter: rows that both hold are identical.
    read_half(all.first(half_bytes), columns, tables);
    read_half(all.last(half_bytes), columns, tables);
    std::size_t rows = 0;
    for (std::size_t i = 0; i < tables.size(); ++i) {
        rows += append_rows(tables[i], columns[i]);
    }
    columns.clear();
    if (H5Ldelete(root.id(), tail_group, H5P_DEFAULT) < 0) {
        throw hdf5::Error(fmt::format("{}: cannot be removed: {}", root.at(tail_group), hdf5::last_error()));
    }
    file.close();
    return rows;
}

}  // namespace eti::session
