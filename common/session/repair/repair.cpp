// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "common/hdf5/copy.hpp"
#include "common/hdf5/file.hpp"
#include "common/process/files/atomic_file_writer.hpp"
#include "common/session/layout.hpp"
#include "common/session/opinions.hpp"
#include "common/session/reader.hpp"
#include "common/session/repair/check.hpp"
#include "common/session/repair/damage.hpp"
#include "common/session/repair/recording_lock.hpp"
#include "common/session/repair/superblock.hpp"
#include "common/session/repair/survey.hpp"
#include "common/session/repair/tail.hpp"
#include "common/session/rows.hpp"
#include "common/session/scene_file.hpp"
#include "common/session/table.hpp"

namespace eti::session {

namespace {

using hdf5::Group;
using hdf5::Handle;

/// A series to be written: rows that could be read, and filled ones elsewhere.
struct Column {
    std::string path;
    std::string units, description;
    Handle type;
    hdf5::Shape row_shape;
    std::size_t row_bytes = 0;
    Condition condition;
    std::vector<std::byte> image;

    [[nodiscard]] bool lost(std::size_t row) const {
        return row >= condition.stated || std::ranges::any_of(condition.lost, [&](const RowRange& range) {
                   return row >= range.first && row < range.first + range.count;
               });
    }
    template <class T>
    [[nodiscard]] T value(std::size_t row) const {
        T value;
        std::memcpy(&value, image.data() + row * row_bytes, sizeof(T));
        return value;
    }
    template <class T>
    void set(std::size_t row, T value) {
        std::memcpy(image.data() + row * row_bytes, &value, sizeof(T));
    }
};

struct Salvaged {
    std::vector<Column> columns;
    std::size_t rows = 0;
    std::size_t unfinished = 0;  ///< rows after these that a killed writer had begun; dropped
    [[nodiscard]] Column& at(std::string_view path) {
        return *std::ranges::find(columns, path, &Column::path);
    }
    [[nodiscard]] bool lost(std::size_t row) const {
        return std::ranges::any_of(columns, [&](const Column& column) { return column.lost(row); });
    }
};

/// A row without information: NaN, 0 or an empty text.
template <class Field>
std::vector<std::byte> nothing(std::size_t bytes) {
    std::vector<std::byte> row(bytes);
    constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
    if constexpr (std::is_same_v<Field, double>) {
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        std::memcpy(row.data(), &none, sizeof(none));
    } else if constexpr (!std::is_integral_v<Field> && !std::is_same_v<Field, std::string>) {
        for (std::size_t at = 0; at + sizeof(float) <= bytes; at += sizeof(float)) {
            std::memcpy(row.data() + at, &not_a_number, sizeof(float));
        }
    }
    return row;
}

/// Interpolates lost times and step numbers linearly between their neighbours.
template <class T>
void bridge(Column& column, std::size_t rows) {
    std::optional<std::size_t> before;
    for (std::size_t row = 0; row < rows;) {
        if (!column.lost(row)) {
            before = row++;
            continue;
        }
        std::size_t after = row;
        while (after < rows && column.lost(after)) {
            ++after;
        }
        double slope = 0.0;
        if (before && after < rows) {
            slope = (static_cast<double>(column.value<T>(after)) -
                     static_cast<double>(column.value<T>(*before))) /
                    static_cast<double>(after - *before);
        } else if (before && *before > 0) {
            slope = static_cast<double>(column.value<T>(*before)) -
                    static_cast<double>(column.value<T>(*before - 1));
        } else if (after + 1 < rows && !column.lost(after + 1)) {
            slope =
                static_cast<double>(column.value<T>(after + 1)) - static_cast<double>(column.value<T>(after));
        }
        const bool forwards = before.has_value();
        const std::size_t from = before.value_or(std::min(after, rows - 1));
        const double start = forwards || after < rows ? static_cast<double>(column.value<T>(from)) : 0.0;
        for (; row < after; ++row) {
            const double along = static_cast<double>(row) - static_cast<double>(from);
            column.set<T>(row, static_cast<T>(std::max(0.0, start + slope * along)));
        }
    }
}

/// An interrupted write leaves some series a chunk longer than others; their stated rows may not exist and
/// are dropped. Missing rows before them are damage.
void leave_out_unfinished(Salvaged& table, std::size_t chunk) {
    std::size_t finished = table.rows;
    for (const Column& column : table.columns) {
        if (column.condition.there && table.rows - column.condition.end() <= chunk) {
            finished = std::min(finished, column.condition.end());
        }
    }
    table.unfinished = table.rows - finished;
    table.rows = finished;
}

Condition condition_in(const std::vector<TableState>& states, const std::string& path) {
    for (const TableState& state : states) {
        const auto found = std::ranges::find(state.series, path, &TableState::Series::path);
        if (found != state.series.end()) {
            return found->condition;
        }
    }
    return {};
}

/// The file to repair.
struct Source {
    const Group& root;
    const std::vector<TableState>& states;
    bool killed = false;  ///< its writer did not finish
};

/// `chunk`: rows per chunk of the table.
template <class Record, class Visit>
Salvaged salvage_table(const Source& source, std::size_t chunk, const Visit& visit) {
    const Group& root = source.root;
    Salvaged table;
    std::vector<std::vector<std::byte>> fills;
    visit([&](const std::string& path, const hdf5::Label& label, auto field, std::size_t width) {
        using Field = std::decay_t<decltype(field(std::declval<Record&>()))>;
        if (is_measure<Field> && !root.has(path)) {
            return;  // a value that is newer than the file
        }
        Column& column = table.columns.emplace_back();
        column.path = path;
        column.units = label.units;
        column.description = label.description;
        column.type = Cell<Field>::type(width);
        column.row_shape = Cell<Field>::shape(width);
        column.row_bytes = Cell<Field>::bytes(width);
        column.condition = condition_in(source.states, path);
        table.rows = std::max(table.rows, column.condition.end());
        fills.push_back(nothing<Field>(column.row_bytes));
    });
    if (source.killed) {
        leave_out_unfinished(table, chunk);
    }
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        Column& column = table.columns[i];
        try {
            column.image = salvage(root, column.path, column.type.get(), column.row_shape, table.rows,
                                   column.condition, fills[i]);
        } catch (const hdf5::Error&) {  // another type or shape than expected
            column.condition = {};
            column.image = salvage(root, column.path, column.type.get(), column.row_shape, table.rows,
                                   column.condition, fills[i]);
        }
        if (column.path.ends_with("/time_ns") || column.path.ends_with("/step")) {
            bridge<std::uint64_t>(column, table.rows);
        }
    }
    return table;
}

/// Keeps the times whose rows are all present, and their rows. In a killed writer's file, the last times may
/// refer to dropped rows and are dropped as well.
void keep_whole_times(const std::string& group, Salvaged& times, Salvaged& rows,
                      std::vector<Damage>& damage) {
    Column& first = times.at(group + "/first_row");
    Column& count = times.at(group + "/row_count");
    std::vector<std::size_t> kept_times, kept_rows;
    std::vector<bool> row_lost(rows.rows);
    for (std::size_t row = 0; row < rows.rows; ++row) {
        row_lost[row] = rows.lost(row);
    }
    const auto past = [&](std::size_t i) {
        return first.value<std::uint64_t>(i) + count.value<std::uint32_t>(i);
    };
    while (rows.unfinished > 0 && times.rows > 0 && !times.lost(times.rows - 1) &&
           past(times.rows - 1) > rows.rows && past(times.rows - 1) <= rows.rows + rows.unfinished) {
        --times.rows;
        ++times.unfinished;
    }
    for (std::size_t i = 0; i < times.rows; ++i) {
        const std::uint64_t from = first.value<std::uint64_t>(i), n = count.value<std::uint32_t>(i);
        const bool whole = !times.lost(i) && from <= rows.rows && n <= rows.rows - from &&
                           std::none_of(row_lost.begin() + static_cast<std::ptrdiff_t>(from),
                                        row_lost.begin() + static_cast<std::ptrdiff_t>(from + n),
                                        [](bool lost) { return lost; });
        if (!whole) {
            if (!damage.empty() && damage.back().path == group &&
                damage.back().first + damage.back().count == i) {
                ++damage.back().count;
            } else {
                damage.push_back({group, i, 1});
            }
            continue;
        }
        first.set<std::uint64_t>(i, kept_rows.size());
        kept_times.push_back(i);
        for (std::uint64_t row = from; row < from + n; ++row) {
            kept_rows.push_back(row);
        }
    }
    const auto keep = [](Salvaged& table, const std::vector<std::size_t>& kept) {
        for (Column& column : table.columns) {
            std::vector<std::byte> image(kept.size() * column.row_bytes);
            for (std::size_t i = 0; i < kept.size(); ++i) {
                std::memcpy(image.data() + i * column.row_bytes,
                            column.image.data() + kept[i] * column.row_bytes, column.row_bytes);
            }
            column.image = std::move(image);
        }
        table.rows = kept.size();
    };
    keep(times, kept_times);
    keep(rows, kept_rows);
}

void list_damage(const Salvaged& table, std::vector<Damage>& damage) {
    for (const Column& column : table.columns) {
        for (const RowRange& range : column.condition.lost) {
            if (range.first < table.rows) {
                damage.push_back({column.path, range.first, std::min(range.count, table.rows - range.first)});
            }
        }
        if (column.condition.stated < table.rows) {
            damage.push_back({column.path, column.condition.stated, table.rows - column.condition.stated});
        }
    }
}

void write_table(const Group& root, const Salvaged& salvaged, std::size_t chunk) {
    Table table(chunk);
    for (const Column& column : salvaged.columns) {
        table.create_column(root, column.path, column.type.get(), column.row_shape,
                            {column.units, column.description});
    }
    table.open(root);
    for (std::size_t row = 0; row < salvaged.rows; ++row) {
        for (const Column& column : salvaged.columns) {
            std::memcpy(table.next_cell(), column.image.data() + row * column.row_bytes, column.row_bytes);
        }
    }
    if (!table.write_all()) {
        throw hdf5::Error(fmt::format("{}: cannot be written: {}", root.place(), table.error()));
    }
}

std::size_t tube_nodes_of(const Group& root) {
    try {
        return std::max<std::size_t>(root.open("scene").open("tube").integer("nodes"), 1);
    } catch (const hdf5::Error&) {
        const hdf5::Shape shape = examine(root, "tools/tube_nodes").row_shape;
        return shape.size() == 2 ? shape[0] : 1;
    }
}

/// Whether ratings or answers can be read.
bool is_whole(const Group& root, std::string_view opinions) {
    try {
        opinions == ratings_group ? (void)read_ratings(root) : (void)read_answers(root);
        return true;
    } catch (const hdf5::Error&) {
        return false;
    }
}

struct Rewritten {
    std::vector<Damage> damage;
    std::vector<std::string> left_out;  ///< what a killed writer had begun, as texts
};

/// Writes everything readable of `from` into a new file `to`.
Rewritten rewrite(const SessionReader& from, const std::vector<TableState>& states,
                  const std::filesystem::path& to) {
    const Group& root = from.root();
    const Source source{root, states, !from.finished()};
    Rewritten result;
    std::vector<Damage>& damage = result.damage;
    SceneRecord scene;
    try {
        scene = from.scene();
    } catch (const hdf5::Error&) {
        scene.tube_nodes = tube_nodes_of(root);
        damage.push_back({"scene", 0, 1});
    }
    hdf5::File file = hdf5::File::create(to);
    write_header(file.root(), from.info(), scene, from.lost_records());
    const auto write = [&](const Salvaged& table, std::size_t chunk) {
        if (table.unfinished > 0) {
            result.left_out.push_back(fmt::format("omitted {} rows of {} that were not completely written",
                                                  table.unfinished, table.columns.front().path));
        }
        write_table(file.root(), table, chunk);
    };
    const auto plain = [&](const Salvaged& table, std::size_t chunk) {
        list_damage(table, damage);
        write(table, chunk);
    };
    const std::size_t nodes = tube_nodes_of(root);
    plain(salvage_table<StepRecord>(source, step_chunk, step_columns(nodes)), step_chunk);
    plain(salvage_table<CommandRecord>(source, small_chunk, command_columns), small_chunk);
    if (root.has("state")) {
        plain(salvage_table<StateRecord>(source, small_chunk, state_columns), small_chunk);
    }
    plain(salvage_table<EventRecord>(source, small_chunk, event_columns), small_chunk);
    plain(salvage_table<SummaryRecord>(source, small_chunk, summary_columns), small_chunk);
    const auto listed = [&](const char* group, Salvaged times, Salvaged rows, std::size_t rows_chunk) {
        keep_whole_times(group, times, rows, damage);
        write(rows, rows_chunk);
        write(times, small_chunk);
    };
    listed("deformation", salvage_table<MovedFrames>(source, small_chunk, moved_frames_columns),
           salvage_table<MovedFrame>(source, moved_frame_chunk, moved_frame_columns), moved_frame_chunk);
    if (root.has("fluid")) {
        listed("fluid", salvage_table<FluidRows>(source, small_chunk, fluid_rows_columns),
               salvage_table<FluidParticle>(source, fluid_chunk, fluid_columns), fluid_chunk);
    }
    if (root.has("annotations")) {
        listed("annotations", salvage_table<AnnotationRows>(source, small_chunk, annotation_rows_columns),
               salvage_table<AnnotationPlace>(source, small_chunk, annotation_place_columns), small_chunk);
    }
    link_time_axis(file.root());
    for (const char* group : {ratings_group, answers_group}) {
        if (!root.has(group)) {
            continue;
        }
        if (!is_whole(root, group)) {
            damage.push_back({group, 0, 1});
            continue;
        }
        hdf5::copy_members(root.open(group), file.root().create(group),
                           {[](std::string_view) { return true; }, [](auto...) { return std::nullopt; }});
    }
    if (!damage.empty()) {
        write_damage(file.root(), damage);
    }
    if (from.finished() && !file.root().open("meta").change_integer("finished", 1)) {
        throw hdf5::Error(fmt::format("{}: cannot be written", to.string()));
    }
    file.close();
    return result;
}

bool scene_is_whole(const SessionReader& reader) {
    try {
        (void)reader.scene();
        return true;
    } catch (const hdf5::Error&) {
        return is_known_lost(read_damage(reader.root()), "scene");
    }
}

std::filesystem::path kept_as(const std::filesystem::path& path) {
    std::filesystem::path kept = path.string() + ".before-repair";
    std::error_code error;
    for (int number = 2; std::filesystem::exists(kept, error); ++number) {
        kept = fmt::format("{}.before-repair.{}", path.string(), number);
    }
    return kept;
}

}  // namespace

namespace {

std::vector<std::string> repair_beside(const std::filesystem::path& path) {
    if (is_being_written(path)) {
        throw hdf5::Error(
            fmt::format("{}: a running program is recording to this file; end it first", path.string()));
    }
    const auto superblock = read_superblock(path);
    if (!superblock) {
        throw hdf5::Error(
            fmt::format("{}: not a session file, or its first bytes are destroyed", path.string()));
    }
    AtomicFileWriter copy(path);
    AtomicFileWriter rewritten(path.string() + ".rewritten");
    std::filesystem::copy_file(path, copy.path());
    std::vector<std::string> done;
    const bool marked = superblock->marked_open || superblock->stated_size != superblock->actual_size;
    const auto clear_mark = [&](const std::filesystem::path& of) {
        if (!repair_superblock(of)) {
            throw hdf5::Error(fmt::format("{}: cannot be changed: {}", of.string(), std::strerror(errno)));
        }
    };
    if (marked) {
        clear_mark(copy.path());
        done.push_back("cleared the killed writer's flag and set the file's size");
    }
    std::size_t from_tail = 0;
    try {
        from_tail = merge_tail(copy.path());
    } catch (const hdf5::Error& error) {  // damaged: what can be read without it
        if (!full_disk_reason(error.what()).empty()) {
            throw;
        }
        std::filesystem::copy_file(path, copy.path(), std::filesystem::copy_options::overwrite_existing);
        if (marked) {
            clear_mark(copy.path());
        }
    }
    if (from_tail > 0) {
        done.push_back(fmt::format("moved the newest {} rows from the tail into their series", from_tail));
    }
    {
        const SessionReader reader(copy.path());  // throws if it is not a session
        const auto states = survey(reader.root());
        if (std::ranges::all_of(states, &TableState::whole) && scene_is_whole(reader) &&
            is_whole(reader.root(), ratings_group) && is_whole(reader.root(), answers_group)) {
            if (from_tail > 0) {
                copy.finish();
            } else if (marked) {
                clear_mark(path);
            }
            return done;
        }
        const Rewritten result = rewrite(reader, states, rewritten.path());
        done.insert(done.end(), result.left_out.begin(), result.left_out.end());
        for (const Damage& lost : result.damage) {
            done.push_back(describe(lost));
        }
    }
    const std::filesystem::path kept = kept_as(path);
    std::filesystem::rename(path, kept);
    std::filesystem::rename(rewritten.path(), path);
    done.push_back(fmt::format("wrote all readable data to a new file; the old one is {}", kept.string()));
    return done;
}

}  // namespace

std::vector<std::string> repair(const std::filesystem::path& path) {
    hdf5::require_regular_file(path);
    const auto refuse_full_disk = [&](const std::string& why) {
        const double megabytes = 2e-6 * static_cast<double>(std::filesystem::file_size(path));
        throw hdf5::Error(
            fmt::format("{}: cannot be repaired: {}; the file is unchanged. A repair writes copies beside "
                        "it: free {:.0f} MB "
                        "there, or copy the file to another disk and repair it there",
                        path.string(), why, std::max(1.0, std::ceil(megabytes))));
    };
    try {
        return repair_beside(path);
    } catch (const hdf5::Error& error) {
        if (const std::string why = full_disk_reason(error.what()); !why.empty()) {
            refuse_full_disk(why);
        }
        throw;
    } catch (const std::filesystem::filesystem_error& error) {
        // Copying a file to a full disk may end in "Input/output error".
        std::error_code ignored;
        const bool full =
            std::filesystem::space(path.parent_path().empty() ? "." : path.parent_path(), ignored).available <
            std::filesystem::file_size(path, ignored);
        if (full || error.code() == std::errc::no_space_on_device || error.code() == std::errc::io_error ||
            error.code() == std::errc::file_too_large) {
            refuse_full_disk(full ? std::strerror(ENOSPC) : error.code().message());
        }
        throw;
    }
}

}  // namespace eti::session
