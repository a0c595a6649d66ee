// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/session/layout.hpp"
#include "common/session/rows.hpp"

namespace eti::session {

namespace {

/// On a recorded session level 4 saves 2-3 % over level 1 and level 9 3-4 %, at 1.3 and up to 7 times the
/// cost.
constexpr unsigned deflate_level = 1;

}  // namespace

void Table::create_column(const hdf5::Group& root, const std::string& path, hid_t type,
                          const hdf5::Shape& row_shape, const hdf5::Label& label) {
    std::vector<hsize_t> start{0}, most{H5S_UNLIMITED}, chunk{chunk_rows_};
    std::size_t bytes = H5Tget_size(type);
    for (const std::size_t extent : row_shape) {
        start.push_back(extent);
        most.push_back(extent);
        chunk.push_back(extent);
        bytes *= extent;
    }
    const hdf5::Handle space(H5Screate_simple(static_cast<int>(start.size()), start.data(), most.data()),
                             H5Sclose);
    const hdf5::Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_shuffle(creation.get());
    H5Pset_deflate(creation.get(), deflate_level);
    H5Pset_fletcher32(creation.get());  // corruption on the disk is reported instead of read
    const hdf5::Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links.get(), 1);
    const hdf5::Handle data_set(
        H5Dcreate2(root.id(), path.c_str(), type, space.get(), links.get(), creation.get(), H5P_DEFAULT),
        H5Dclose);
    if (!data_set || !hdf5::set_label(data_set.get(), label)) {
        throw hdf5::Error(
            fmt::format("{}: the data set cannot be created: {}", root.at(path), hdf5::last_error()));
    }
    columns_.push_back({path, row_shape, {H5Tcopy(type), H5Tclose}, bytes, {}, {}});
}

void Table::open(const hdf5::Group& root) {
    // Without a chunk cache, rows reach the disk when written, not at the next flush. A full disk then shows
    // before the data set's new length is on disk. A flush continues after a failure and would store a length
    // that includes rows never written.
    const hdf5::Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access.get(), 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
    for (Column& column : columns_) {
        column.data_set = {H5Dopen2(root.id(), column.path.c_str(), access.get()), H5Dclose};
        if (!column.data_set) {
            throw hdf5::Error(fmt::format("{}: the data set cannot be opened: {}", root.at(column.path),
                                          hdf5::last_error()));
        }
    }
}

std::byte* Table::next_cell() {
    Column& column = columns_[cursor_];
    const std::size_t offset = column.pending.size();
    column.pending.resize(offset + column.row_bytes);
    if (++cursor_ == columns_.size()) {
        cursor_ = 0;
        if (pending_++ == 0) {
            pending_since_ = std::chrono::steady_clock::now();
        }
    }
    return column.pending.data() + offset;
}

std::vector<std::string> Table::paths() const {
    std::vector<std::string> paths;
    for (const Column& column : columns_) {
        paths.push_back(column.path);
    }
    return paths;
}

std::size_t Table::row_bytes() const {
    std::size_t bytes = 0;
    for (const Column& column : columns_) {
        bytes += column.row_bytes;
    }
    return bytes;
}

void Table::copy_pending(std::size_t first, std::size_t rows, std::vector<std::byte>& to) const {
    for (const Column& column : columns_) {
        const auto from =
            column.pending.begin() + static_cast<std::ptrdiff_t>((first - written_) * column.row_bytes);
        to.insert(to.end(), from, from + static_cast<std::ptrdiff_t>(rows * column.row_bytes));
    }
}

bool Table::has_chunk(bool unfinished) const {
    return unfinished ? pending_ > 0 : rows() / chunk_rows_ > written_ / chunk_rows_;
}

bool Table::overdue(std::chrono::steady_clock::duration limit) const {
    return pending_ > 0 && std::chrono::steady_clock::now() - pending_since_ >= limit;
}

bool Table::write_chunk(bool unfinished) {
    const std::size_t room = chunk_rows_ - written_ % chunk_rows_;
    return !has_chunk(unfinished) || write(std::min(room, pending_));
}

bool Table::write_all() {
    return write(pending_);
}

bool Table::write(std::size_t rows) {
    if (rows == 0) {
        return true;
    }
    for (Column& column : columns_) {
        const hid_t data_set = column.data_set.get();
        if (!set_rows(data_set, column.row_shape, written_ + rows)) {
            error_ = hdf5::last_error();
            return false;
        }
        if (const auto why = write_rows(data_set, column.type.get(), column.row_shape, written_, rows,
                                        column.pending.data())) {
            error_ = *why;
            return false;
        }
        column.pending.erase(column.pending.begin(),
                             column.pending.begin() + static_cast<std::ptrdiff_t>(rows * column.row_bytes));
    }
    written_ += rows;
    pending_ -= rows;
    pending_since_ = std::chrono::steady_clock::now();
    return true;
}

void Table::abandon() {
    for (Column& column : columns_) {
        column.data_set.abandon();
    }
}

void link_time_axis(const hdf5::Group& root) {
    for (const std::string_view group : step_groups) {
        const std::string link = std::string(group) + "/time_ns";
        if (group != step_groups[0] && H5Lcreate_hard(root.id(), "inputs/time_ns", root.id(), link.c_str(),
                                                      H5P_DEFAULT, H5P_DEFAULT) < 0) {
            throw hdf5::Error(fmt::format("{}: cannot be linked: {}", root.at(link), hdf5::last_error()));
        }
    }
}

}  // namespace eti::session
