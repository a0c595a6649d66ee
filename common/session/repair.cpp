// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/hdf5/file.hpp"
#include "common/session/check.hpp"
#include "common/session/layout.hpp"
#include "common/session/liveness.hpp"
#include "common/session/reader.hpp"
#include "common/session/rows.hpp"
#include "common/session/scene_file.hpp"
#include "common/session/superblock.hpp"
#include "common/session/survey.hpp"
#include "common/session/table.hpp"

namespace eti::session {

namespace {

using hdf5::Group;
using hdf5::Handle;

bool cut(const Group& root, const std::string& path, std::size_t rows) {
    const Handle data_set(H5Dopen2(root.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle space(data_set ? H5Dget_space(data_set.get()) : -1, H5Sclose);
    const int rank = space ? H5Sget_simple_extent_ndims(space.get()) : -1;
    if (rank < 1) {
        return false;
    }
    std::vector<hsize_t> extent(static_cast<std::size_t>(rank));
    H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
    extent[0] = rows;
    return H5Dset_extent(data_set.get(), extent.data()) >= 0;
}

/// Cuts longer data sets in place; false if the file's structure does not let it.
bool cut_to_common(const std::filesystem::path& path, const std::vector<TableState>& states,
                   std::vector<std::string>& done) {
    hdf5::File file = hdf5::File::open(path, hdf5::Access::modify);
    for (const TableState& state : states) {
        for (const Length& length : state.lengths) {
            if (length.stated == state.common) {
                continue;
            }
            if (!cut(file.root(), length.path, state.common)) {
                return false;
            }
            done.push_back(
                fmt::format("cut {} from {} to {} rows", length.path, length.stated, state.common));
        }
    }
    file.close();
    return true;
}

/// The first `rows` rows of one data set, whatever its type.
void copy_rows(const Group& from, const Group& to, const std::string& path, std::size_t rows,
               std::size_t chunk) {
    const Handle source(H5Dopen2(from.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle type(source ? H5Dget_type(source.get()) : -1, H5Tclose);
    const Handle space(source ? H5Dget_space(source.get()) : -1, H5Sclose);
    const int rank = space ? H5Sget_simple_extent_ndims(space.get()) : -1;
    if (!type || rank < 1) {
        throw hdf5::Error(fmt::format("{}: not a readable data set", from.at(path)));
    }
    std::vector<hsize_t> extent(static_cast<std::size_t>(rank));
    H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
    const hdf5::Shape row_shape(extent.begin() + 1, extent.end());
    const std::string units = text_of(from, path, "units"), description = text_of(from, path, "description");
    Table table(chunk);
    table.create_column(to, path, type.get(), row_shape, {units, description});
    table.open(to);
    const auto bytes = read_rows_as(from, path, type.get(), row_shape, rows);
    const std::size_t row_bytes = rows == 0 ? 0 : bytes.size() / rows;
    for (std::size_t i = 0; i < rows; ++i) {
        std::memcpy(table.next_cell(), bytes.data() + i * row_bytes, row_bytes);
    }
    if (!table.write_all()) {
        throw hdf5::Error(fmt::format("{}: cannot be written: {}", to.at(path), table.error()));
    }
}

/// Writes what is whole into a new file, which then takes the damaged one's place.
void rewrite(const std::filesystem::path& path, const std::vector<TableState>& states) {
    const std::filesystem::path unfinished = path.string() + ".unfinished." + std::to_string(::getpid());
    try {
        const SessionReader from(path);
        hdf5::File to = hdf5::File::create(unfinished);
        write_head(to.root(), from.info(), from.scene(), from.lost_records());
        for (const TableState& state : states) {
            for (const Length& length : state.lengths) {
                copy_rows(from.root(), to.root(), length.path, state.common, step_chunk);
            }
        }
        link_time_axis(to.root());
        to.close();
        std::filesystem::rename(unfinished, path);
    } catch (...) {
        std::error_code ignored;
        std::filesystem::remove(unfinished, ignored);
        throw;
    }
}

}  // namespace

std::vector<std::string> repair(const std::filesystem::path& path) {
    if (being_written(path)) {
        throw hdf5::Error(
            fmt::format("{}: a running program is recording into this file; end it first", path.string()));
    }
    hdf5::require_plain_file(path);
    std::vector<std::string> done;
    const auto superblock = read_superblock(path);
    if (!superblock) {
        throw hdf5::Error(
            fmt::format("{}: not a session file, or its first bytes are destroyed", path.string()));
    }
    if (superblock->marked_open || superblock->stated_size != superblock->actual_size) {
        if (!mend_superblock(path)) {
            throw hdf5::Error(fmt::format("{}: cannot be changed: {}", path.string(), std::strerror(errno)));
        }
        done.push_back("cleared the mark of the killed writer and stated the file's size");
    }

    std::vector<TableState> states;
    {
        const SessionReader reader(path);  // refuses what is no session
        states = survey(reader.root());
    }
    if (std::all_of(states.begin(), states.end(), [](const TableState& s) { return s.equal(); })) {
        return done;
    }
    const bool readable =
        std::all_of(states.begin(), states.end(), [](const TableState& s) { return s.readable(); });
    if (!readable || !cut_to_common(path, states, done)) {
        rewrite(path, states);
        for (const TableState& state : states) {
            done.push_back(fmt::format("kept the first {} {}", state.common, state.what));
        }
        done.push_back("wrote what is whole into a new file in place of the damaged one");
    }
    return done;
}

}  // namespace eti::session
