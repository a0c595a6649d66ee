// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/repair/check.hpp"

#include <fmt/format.h>

#include "common/session/opinions.hpp"
#include "common/session/reader.hpp"
#include "common/session/repair/damage.hpp"
#include "common/session/repair/recording_lock.hpp"
#include "common/session/repair/superblock.hpp"
#include "common/session/repair/survey.hpp"

namespace eti::session {

namespace {

void name_damage(const TableState::Series& series, std::size_t rows, std::vector<std::string>& out) {
    const Condition& found = series.condition;
    if (!found.there) {
        out.push_back(describe({series.path, 0, rows}));
        return;
    }
    for (const RowRange& range : found.lost) {
        out.push_back(describe({series.path, range.first, range.count}));
    }
    if (found.stated < rows) {
        out.push_back(describe({series.path, found.stated, rows - found.stated}));
    }
}

}  // namespace

CheckResult check(const std::filesystem::path& path) {
    const SessionReader reader(path);
    const auto superblock = read_superblock(path);
    CheckResult result;
    result.repairable = superblock.has_value();
    if (reader.is_being_recorded()) {
        result.remarks.push_back("a running program is recording to this file");
    } else if (superblock && superblock->marked_open) {
        result.damage.push_back(
            "the recording program was killed: the file is marked as open for writing, and other HDF5 "
            "programs reject it");
    } else if (reader.rows_in_tail() > 0) {
        result.damage.push_back(
            fmt::format("the recording program was killed: {} rows are only in the file's tail, which other "
                        "programs do not read",
                        reader.rows_in_tail()));
    } else if (!reader.finished()) {
        result.remarks.push_back("the recording was cut off before its end");
    }
    if (superblock && !reader.is_being_recorded() && superblock->stated_size != superblock->actual_size) {
        result.damage.push_back(fmt::format("the file states a size of {} bytes, and has {}",
                                            superblock->stated_size, superblock->actual_size));
    }
    if (reader.lost_records() > 0) {
        result.remarks.push_back(fmt::format("{} records were lost while recording: the disk was too slow",
                                             reader.lost_records()));
    }

    for (const TableState& state : survey(reader.root())) {
        if (reader.is_being_recorded() || state.whole()) {
            result.remarks.push_back(fmt::format("{} {}", state.common, state.what));
            continue;
        }
        result.damage.push_back(fmt::format("{}: {} of {} are intact before the first damage", state.what,
                                            state.common, state.most));
        for (const TableState::Series& series : state.series) {
            name_damage(series, state.most, result.damage);
        }
    }
    const std::vector<Damage> lost_before = read_damage(reader.root());
    for (const Damage& lost : lost_before) {
        result.remarks.push_back("before a repair: " + describe(lost));
    }
    try {
        if (!is_known_lost(lost_before, "scene")) {
            (void)reader.scene();
        }
    } catch (const hdf5::Error& error) {
        result.damage.push_back(error.what());
    }
    try {
        (void)reader.deformations();
        (void)reader.fluids();
        (void)reader.annotations();
        (void)read_ratings(reader.root());
        (void)read_answers(reader.root());
    } catch (const hdf5::Error& error) {
        result.damage.push_back(error.what());
    }
    return result;
}

}  // namespace eti::session
