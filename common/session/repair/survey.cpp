// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/repair/survey.hpp"

#include <algorithm>
#include <limits>

#include "common/session/layout.hpp"
#include "common/session/rows.hpp"

namespace eti::session {

namespace {

using hdf5::Group;

/// Data sets of equal length.
struct EqualLength {
    const char* what;
    std::vector<std::string> paths;
};

/// Drops those of `times` whose rows are not all among the first `rows` of the referenced data set.
void drop_incomplete(const Group& root, const std::string& group, std::size_t rows, std::size_t& times) {
    if (times == 0) {
        return;  // the group may be missing
    }
    const auto first = read_as_doubles(root, group + "/first_row", times);
    const auto count = read_as_doubles(root, group + "/row_count", times);
    while (times > 0 && first[times - 1] + count[times - 1] > static_cast<double>(rows)) {
        --times;
    }
}

std::vector<EqualLength> tables(const Group& root) {
    std::vector<EqualLength> all;
    const auto add = [&]<class Record>(const char* what, const Record&, const auto& visit) {
        EqualLength table{what, {}};
        visit([&](const std::string& path, const hdf5::Label&, auto field, std::size_t) {
            using Field = std::decay_t<decltype(field(std::declval<Record&>()))>;
            // A measured value may be newer than the file.
            if (!is_measure<Field> || root.has(path)) {
                table.paths.push_back(path);
            }
        });
        all.push_back(std::move(table));
    };
    add("steps", StepRecord{}, step_columns(1));
    add("commands", CommandRecord{}, command_columns);
    add("moved frames", MovedFrame{}, moved_frame_columns);
    add("deformations", MovedFrames{}, moved_frames_columns);
    add("events", EventRecord{}, event_columns);
    add("summaries", SummaryRecord{}, summary_columns);
    if (root.has("fluid")) {
        add("liquid particles", FluidParticle{}, fluid_columns);
        add("states of the liquid", FluidRows{}, fluid_rows_columns);
    }
    if (root.has("annotations")) {
        add("places of annotations", AnnotationPlace{}, annotation_place_columns);
        add("annotations", AnnotationRows{}, annotation_rows_columns);
    }
    if (root.has("state")) {
        add("hashes of the state", StateRecord{}, state_columns);
    }
    return all;
}

}  // namespace

bool TableState::whole() const {
    return std::ranges::all_of(
        series, [&](const Series& s) { return s.condition.whole() && s.condition.stated == common; });
}

std::vector<TableState> survey(const Group& root) {
    std::vector<TableState> states;
    for (const EqualLength& table : tables(root)) {
        TableState state{table.what, {}, std::numeric_limits<std::size_t>::max()};
        for (const std::string& path : table.paths) {
            const Condition& found = state.series.emplace_back(path, examine(root, path)).condition;
            state.common = std::min(state.common, found.prefix());
            state.most = std::max(state.most, found.stated);
        }
        states.push_back(std::move(state));
    }
    const auto rows_of = [&](std::string_view what) {
        const auto found = std::ranges::find(states, what, &TableState::what);
        return found == states.end() ? nullptr : &found->common;
    };
    // A time of the deformation counts if all its frames are present, one of the liquid if all its particles
    // are.
    const auto drop = [&](const char* group, const char* rows, const char* times) {
        if (rows_of(rows) != nullptr) {
            drop_incomplete(root, group, *rows_of(rows), *rows_of(times));
        }
    };
    drop("deformation", "moved frames", "deformations");
    drop("fluid", "liquid particles", "states of the liquid");
    drop("annotations", "places of annotations", "annotations");
    return states;
}

}  // namespace eti::session
