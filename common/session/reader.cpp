// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/reader.hpp"

#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>

#include "common/process/files/descriptor.hpp"
#include "common/session/layout.hpp"
#include "common/session/repair/recording_lock.hpp"
#include "common/session/repair/superblock.hpp"
#include "common/session/repair/tail.hpp"
#include "common/session/rows.hpp"
#include "common/session/scene_file.hpp"

namespace eti::session {

namespace {

using hdf5::Group;

constexpr const char* time_axis = "/time_ns";

hdf5::File open_session(const std::filesystem::path& path, bool live) {
    // Repair cannot help a path that is not a regular file.
    hdf5::require_regular_file(path);
    try {
        return hdf5::File::open(path, live ? hdf5::Access::read_swmr : hdf5::Access::read_orphaned);
    } catch (const hdf5::Error& error) {
        throw hdf5::Error(
            fmt::format("{}. If it is a session file, it is damaged or its recording ended before the first "
                        "step; try: eti-review check --repair {}",
                        error.what(), path.string()));
    }
}

/// A temporary copy for the duration of the reading.
class PassingCopy {
  public:
    explicit PassingCopy(const std::filesystem::path& of)
        : path_((std::filesystem::temp_directory_path() / "eti-session-XXXXXX").string()) {
        const Descriptor file(::mkstemp(path_.data()));
        if (!file) {
            throw hdf5::Error(fmt::format("{}: cannot be copied: {}", of.string(), std::strerror(errno)));
        }
        std::filesystem::copy_file(of, path_, std::filesystem::copy_options::overwrite_existing);
    }
    ~PassingCopy() { ::unlink(path_.c_str()); }
    PassingCopy(const PassingCopy&) = delete;
    PassingCopy& operator=(const PassingCopy&) = delete;
    [[nodiscard]] const std::string& path() const { return path_; }

  private:
    std::string path_;
};

void require_session(const Group& root, const std::filesystem::path& path) {
    const auto names = root.attributes();
    if (std::find(names.begin(), names.end(), "kind") == names.end() || root.text("kind") != file_kind) {
        throw hdf5::Error(fmt::format("{}: an HDF5 file, but not a session of this program", path.string()));
    }
    if (const std::uint64_t found = root.integer("schema"); found != schema) {
        throw hdf5::Error(
            fmt::format("{}: recorded with layout {}, this program reads layout {}; use the version that "
                        "recorded it",
                        path.string(), found, schema));
    }
}

struct Found {
    std::string path;
    H5T_class_t kind;
    std::size_t bytes;
    hdf5::Shape row_shape;
};

void find_data_sets(const Group& root, const std::string& prefix, bool with_subgroups,
                    std::vector<Found>& found) {
    for (const std::string& name : root.open(prefix).members()) {
        const std::string path = prefix + "/" + name;
        if (root.is_group(path)) {
            // A group with its own time axis is another table.
            if (with_subgroups && !root.has(path + time_axis)) {
                find_data_sets(root, path, true, found);
            }
            continue;
        }
        const hdf5::Handle data_set(H5Dopen2(root.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
        const hdf5::Handle type(data_set ? H5Dget_type(data_set.get()) : -1, H5Tclose);
        const hdf5::Handle space(data_set ? H5Dget_space(data_set.get()) : -1, H5Sclose);
        const int rank = space ? H5Sget_simple_extent_ndims(space.get()) : -1;
        if (!type || rank < 1) {
            throw hdf5::Error(
                fmt::format("{}: not a readable data set: {}", root.at(path), hdf5::last_error()));
        }
        std::vector<hsize_t> extent(static_cast<std::size_t>(rank));
        H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
        found.push_back({path, H5Tget_class(type.get()), H5Tget_size(type.get()),
                         hdf5::Shape(extent.begin() + 1, extent.end())});
    }
}

}  // namespace

std::size_t Series::row_size() const {
    std::size_t size = 1;
    for (const std::size_t extent : row_shape) {
        size *= extent;
    }
    return size;
}

std::size_t Series::rows() const {
    return texts.empty() ? (row_size() == 0 ? 0 : values.size() / row_size()) : texts.size();
}

SessionReader::SessionReader(const std::filesystem::path& path)
    : being_recorded_(is_being_written(path)), file_(open_session(path, being_recorded_)) {
    require_session(file_.root(), path);
    const Group meta = file_.root().open("meta");
    info_ = read_info(meta);
    finished_ = meta.integer("finished") != 0;
    lost_ = meta.integer("lost_records");
    if (!being_recorded_ && !finished_ && file_.root().has("tail")) {
        merge_tail(path);
    }
}

void SessionReader::merge_tail(const std::filesystem::path& path) {
    try {
        const PassingCopy copy(path);
        if (!repair_superblock(copy.path())) {
            return;
        }
        const std::size_t rows = session::merge_tail(copy.path());
        file_ = hdf5::File::open(copy.path(), hdf5::Access::read, path);
        rows_in_tail_ = rows;
    } catch (const hdf5::Error&) {
        // A damaged file is read without its tail.
    } catch (const std::filesystem::filesystem_error& error) {
        throw hdf5::Error(fmt::format(
            "{}: its newest rows are read from a copy, which cannot be created: {}. Remedy: free some space "
            "there, or set TMPDIR to another folder, or run: eti-review check --repair {}",
            path.string(), error.code().message(), path.string()));
    }
}

double SessionReader::duration() const {
    const std::size_t rows = readable_rows(file_.root(), "inputs/time_ns");
    if (rows == 0) {
        return 0.0;
    }
    const auto bytes =
        read_rows_as(file_.root(), "inputs/time_ns", hdf5::number_type<std::uint64_t>(), {}, rows);
    std::uint64_t last = 0;
    std::memcpy(&last, bytes.data() + (rows - 1) * sizeof(last), sizeof(last));
    return static_cast<double>(last) * 1e-9;
}

SceneRecord SessionReader::scene() const {
    return read_scene(file_.root().open("scene"));
}

std::vector<StepRecord> SessionReader::steps() const {
    const std::size_t nodes = file_.root().open("scene").open("tube").integer("nodes");
    return read_records<StepRecord>(file_.root(), step_columns(std::max<std::size_t>(nodes, 1)));
}

std::vector<CommandRecord> SessionReader::commands() const {
    return read_records<CommandRecord>(file_.root(), command_columns);
}

std::vector<StateRecord> SessionReader::states() const {
    if (!file_.root().has("state")) {
        return {};
    }
    return read_records<StateRecord>(file_.root(), state_columns);
}

std::vector<DeformationRecord> SessionReader::deformations() const {
    const auto frames = read_records<MovedFrame>(file_.root(), moved_frame_columns);
    const auto times = read_records<MovedFrames>(file_.root(), moved_frames_columns);
    std::vector<DeformationRecord> records;
    std::uint64_t expected = 0;
    for (const MovedFrames& moved : times) {
        if (moved.first_row != expected) {
            throw hdf5::Error(fmt::format("{}: row {} begins at {}, the one before ends at {}",
                                          file_.root().at("deformation/first_row"), records.size(),
                                          moved.first_row, expected));
        }
        expected += moved.row_count;
        if (expected > frames.size()) {
            break;
        }
        DeformationRecord record;
        record.time_ns = moved.time_ns;
        for (std::uint64_t row = moved.first_row; row < expected; ++row) {
            record.frame.push_back(frames[row].frame);
            record.pose.push_back(frames[row].pose);
        }
        records.push_back(std::move(record));
    }
    return records;
}

std::vector<FluidRecord> SessionReader::fluids() const {
    if (!file_.root().has("fluid")) {
        return {};
    }
    const auto particles = read_records<FluidParticle>(file_.root(), fluid_columns);
    const auto times = read_records<FluidRows>(file_.root(), fluid_rows_columns);
    std::vector<FluidRecord> records;
    std::uint64_t expected = 0;
    for (const FluidRows& rows : times) {
        if (rows.first_row != expected) {
            throw hdf5::Error(fmt::format("{}: row {} begins at {}, the one before ends at {}",
                                          file_.root().at("fluid/first_row"), records.size(), rows.first_row,
                                          expected));
        }
        expected += rows.row_count;
        if (expected > particles.size()) {
            break;
        }
        FluidRecord record{rows.time_ns, {}};
        for (std::uint64_t row = rows.first_row; row < expected; ++row) {
            record.position.push_back(particles[row].position);
        }
        records.push_back(std::move(record));
    }
    return records;
}

std::vector<EventRecord> SessionReader::events() const {
    return read_records<EventRecord>(file_.root(), event_columns);
}

std::vector<AnnotationRecord> SessionReader::annotations() const {
    if (!file_.root().has("annotations")) {
        return {};
    }
    const auto places = read_records<AnnotationPlace>(file_.root(), annotation_place_columns);
    std::vector<AnnotationRecord> records;
    for (AnnotationRows& rows : read_records<AnnotationRows>(file_.root(), annotation_rows_columns)) {
        if (rows.first_row > places.size() || rows.row_count > places.size() - rows.first_row) {
            break;
        }
        AnnotationRecord record{rows.time_ns,
                                std::move(rows.kind),
                                std::move(rows.sender),
                                std::move(rows.text),
                                std::move(rows.object),
                                {},
                                {}};
        for (std::uint64_t row = rows.first_row; row < rows.first_row + rows.row_count; ++row) {
            const AnnotationPlace& at = places[row];
            record.place.push_back({at.triangle, at.place.x(), at.place.y(), at.place.z()});
            record.position.push_back(at.position);
        }
        records.push_back(std::move(record));
    }
    return records;
}

std::vector<SummaryRecord> SessionReader::summaries() const {
    std::map<std::uint32_t, SummaryRecord> last;
    for (SummaryRecord& record : read_records<SummaryRecord>(file_.root(), summary_columns)) {
        last[record.attempt] = std::move(record);
    }
    std::vector<SummaryRecord> records;
    const bool known = !info().more.contains(manikin_text);
    for (auto& [attempt, record] : last) {
        record.outcome.known = known;
        records.push_back(std::move(record));
    }
    return records;
}

std::vector<Series> SessionReader::series(const std::string& group) const {
    const Group& root = file_.root();
    std::vector<Found> found;
    find_data_sets(root, group, true, found);
    std::stable_partition(found.begin(), found.end(),
                          [](const Found& f) { return f.path.ends_with(time_axis); });
    std::size_t rows = found.empty() ? 0 : std::numeric_limits<std::size_t>::max();
    for (const Found& f : found) {
        rows = std::min(rows, readable_rows(root, f.path));
    }
    std::vector<Series> all;
    for (const Found& f : found) {
        Series series{f.path, text_of(root, f.path, "units"), f.row_shape, {}, {}};
        if (f.kind == H5T_STRING) {
            const hdf5::Handle type = hdf5::fixed_text_type(f.bytes);
            const auto bytes = read_rows_as(root, f.path, type.get(), f.row_shape, rows);
            series.texts.resize(rows);
            for (std::size_t i = 0; i < rows; ++i) {
                Cell<std::string>::unpack(bytes.data() + i * f.bytes, f.bytes, series.texts[i]);
            }
        } else {
            series.values = read_as_doubles(root, f.path, rows);
        }
        all.push_back(std::move(series));
    }
    return all;
}

}  // namespace eti::session
