// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/check.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "common/session/liveness.hpp"
#include "common/session/reader.hpp"
#include "common/session/superblock.hpp"
#include "common/session/survey.hpp"

namespace eti::session {

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

    for (const TableState& state : survey(reader.root())) {
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
        (void)reader.fluids();
        (void)reader.annotations();
    } catch (const hdf5::Error& error) {
        result.damage.push_back(error.what());
        result.repairable = false;
    }
    return result;
}

}  // namespace eti::session
