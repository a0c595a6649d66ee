// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/check.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

#include "common/session/layout.hpp"
#include "common/session/liveness.hpp"
#include "common/session/reader.hpp"
#include "common/session/rows.hpp"
#include "common/session/superblock.hpp"

namespace eti::session {

namespace {

using hdf5::Group;

/// Data sets of equal length.
struct EqualLength {
    const char* what;
    std::vector<std::string> paths;
};

std::vector<EqualLength> tables() {
    std::vector<EqualLength> all;
    const auto add = [&](const char* what, const auto& visit) {
        EqualLength table{what, {}};
        visit([&](const std::string& path, const hdf5::Label&, auto, std::size_t) {
            table.paths.push_back(path);
        });
        all.push_back(std::move(table));
    };
    add("steps", [](const auto& column) { step_columns(1, column); });
    add("commands", [](const auto& column) { command_columns(column); });
    add("moved frames", [](const auto& column) { moved_frame_columns(column); });
    add("deformations", [](const auto& column) { moved_frames_columns(column); });
    add("events", [](const auto& column) { event_columns(column); });
    add("summaries", [](const auto& column) { summary_columns(column); });
    return all;
}

struct Length {
    std::string path;
    std::size_t stated;
    std::size_t readable;
};

struct TableState {
    const char* what;
    std::vector<Length> lengths;
    std::size_t common = std::numeric_limits<std::size_t>::max();
    [[nodiscard]] bool equal() const {
        return std::all_of(lengths.begin(), lengths.end(),
                           [&](const Length& l) { return l.stated == common; });
    }
};

std::vector<TableState> survey(const Group& root) {
    std::vector<TableState> states;
    for (const EqualLength& table : tables()) {
        TableState state{table.what, {}, std::numeric_limits<std::size_t>::max()};
        for (const std::string& path : table.paths) {
            const bool parameter = path.starts_with("metrics/") || path.starts_with("summary/");
            if (parameter && !root.has(path)) {
                continue;  // newer than the file
            }
            state.lengths.push_back({path, stated_rows(root, path), readable_rows(root, path)});
            state.common = std::min(state.common, state.lengths.back().readable);
        }
        states.push_back(std::move(state));
    }
    // A time of the deformation counts if all its frames are there.
    const std::size_t frames = states[2].common;
    std::size_t& times = states[3].common;
    const auto first = read_as_doubles(root, "deformation/first_row", times);
    const auto count = read_as_doubles(root, "deformation/row_count", times);
    while (times > 0 && first[times - 1] + count[times - 1] > static_cast<double>(frames)) {
        --times;
    }
    return states;
}

bool cut(const Group& root, const std::string& path, std::size_t rows) {
    const hdf5::Handle data_set(H5Dopen2(root.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    const hdf5::Handle space(data_set ? H5Dget_space(data_set.get()) : -1, H5Sclose);
    const int rank = space ? H5Sget_simple_extent_ndims(space.get()) : -1;
    if (rank < 1) {
        return false;
    }
    std::vector<hsize_t> extent(static_cast<std::size_t>(rank));
    H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
    extent[0] = rows;
    return H5Dset_extent(data_set.get(), extent.data()) >= 0;
}

}  // namespace

CheckResult check(const std::filesystem::path& path) {
    const SessionReader reader(path);
    const auto superblock = read_superblock(path);
    CheckResult result;
    result.repairable = superblock.has_value();
    if (reader.live()) {
        result.remarks.push_back("a running program is recording into this file");
    } else if (superblock && superblock->marked_open) {
        result.damage.push_back(
            "the program that recorded was killed: the file is marked as open for writing, and other HDF5 "
            "programs "
            "refuse it");
    } else if (!reader.finished()) {
        result.remarks.push_back("the recording was cut off before its end");
    }
    if (superblock && !reader.live() && superblock->stated_size != superblock->actual_size) {
        result.damage.push_back(fmt::format("the file says that it has {} bytes, and has {}",
                                            superblock->stated_size, superblock->actual_size));
    }
    if (reader.lost_records() > 0) {
        result.remarks.push_back(fmt::format(
            "{} records were lost while recording: the disk could not follow", reader.lost_records()));
    }

    const hdf5::File file = hdf5::File::open(path, hdf5::Access::read_beside_writer);
    for (const TableState& state : survey(file.root())) {
        const std::size_t most =
            std::max_element(state.lengths.begin(), state.lengths.end(),
                             [](const Length& a, const Length& b) { return a.stated < b.stated; })
                ->stated;
        if (!reader.live() && !state.equal()) {
            result.damage.push_back(
                fmt::format("{}: {} of {} rows are whole", state.what, state.common, most));
        } else {
            result.remarks.push_back(fmt::format("{} {}", state.common, state.what));
        }
    }
    try {
        (void)reader.scene();
        (void)reader.deformations();
    } catch (const hdf5::Error& error) {
        result.damage.push_back(error.what());
        result.repairable = false;
    }
    return result;
}

std::vector<std::string> repair(const std::filesystem::path& path) {
    if (being_written(path)) {
        throw hdf5::Error(
            fmt::format("{}: a running program is recording into this file; end it first", path.string()));
    }
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
        const hdf5::File file = hdf5::File::open(path, hdf5::Access::read);
        states = survey(file.root());
    }
    if (std::all_of(states.begin(), states.end(), [](const TableState& s) { return s.equal(); })) {
        return done;
    }
    hdf5::File file = hdf5::File::open(path, hdf5::Access::modify);
    for (const TableState& state : states) {
        for (const Length& length : state.lengths) {
            if (length.stated != state.common) {
                if (!cut(file.root(), length.path, state.common)) {
                    throw hdf5::Error(fmt::format("{}: cannot be cut to its {} whole rows: {}",
                                                  file.root().at(length.path), state.common,
                                                  hdf5::last_error()));
                }
                done.push_back(
                    fmt::format("cut {} from {} to {} rows", length.path, length.stated, state.common));
            }
        }
    }
    file.close();
    return done;
}

}  // namespace eti::session
