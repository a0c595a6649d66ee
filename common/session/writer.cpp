// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/writer.hpp"

#include <pthread.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <optional>
#include <semaphore>
#include <thread>

#include "common/hdf5/file.hpp"
#include "common/process/threads/spsc_queue.hpp"
#include "common/session/layout.hpp"
#include "common/session/repair/recording_lock.hpp"
#include "common/session/repair/tail.hpp"
#include "common/session/scene_file.hpp"
#include "common/session/table.hpp"

namespace eti::session {

namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Interval at which the queues are emptied.
constexpr auto poll = 20ms;
/// Longest time that a record is in the tail only, which other programs do not read beside this one.
constexpr auto longest_unwritten = 5s;
constexpr auto warning_period = 10s;

std::size_t deformations_waiting(std::size_t steps) {
    return steps / 12 + 2;  // 15 Hz against 180 Hz
}

}  // namespace

struct SessionWriter::Impl {
    Impl(const std::filesystem::path& file_path, const SessionInfo& info, const SceneRecord& scene,
         Settings wanted)
        : path(file_path),
          settings(std::move(wanted)),
          tube_nodes(std::max<std::size_t>(scene.tube_nodes, 1)),
          steps(settings.waiting_steps),
          commands(256),
          states(64),
          deformations(deformations_waiting(settings.waiting_steps)),
          fluids(deformations_waiting(settings.waiting_steps)),
          events(1024),
          annotations(256),
          summaries(256) {
        create(info, scene);
        thread = std::thread([this] { run(); });
    }

    void create(const SessionInfo& info, const SceneRecord& scene);
    void create_in(hdf5::File made, const SessionInfo& info, const SceneRecord& scene);
    void run();
    void drain();
    [[nodiscard]] std::optional<std::string> write_chunks(bool everything, bool& more);
    void finish();
    void fail(const std::string& reason);
    void end_recording(const std::string& text);
    [[nodiscard]] bool was_overwritten();
    void warn_of_losses();
    void warn_of_deletion();

    template <class T>
    bool push(SpscQueue<T>& ring, const T& record) {
        while (!has_failed.load(std::memory_order_relaxed)) {
            if (ring.push(record)) {
                return true;
            }
            if (!settings.wait_when_full) {
                lost.fetch_add(1, std::memory_order_relaxed);
                return false;
            }
            std::this_thread::sleep_for(1ms);
        }
        return false;
    }

    std::filesystem::path path;
    Settings settings;
    std::size_t tube_nodes;

    SpscQueue<StepRecord> steps;
    SpscQueue<CommandRecord> commands;
    SpscQueue<StateRecord> states;
    SpscQueue<DeformationRecord> deformations;
    SpscQueue<FluidRecord> fluids;
    SpscQueue<EventRecord> events;
    SpscQueue<AnnotationRecord> annotations;
    SpscQueue<SummaryRecord> summaries;

    // Used only by the writer's thread once it runs.
    hdf5::File file;
    hdf5::Group meta;
    Table step_table{step_chunk};
    Table command_table{small_chunk};
    Table state_table{small_chunk};
    Table frame_table{moved_frame_chunk};
    Table deformation_table{small_chunk};
    Table fluid_table{fluid_chunk};
    Table fluid_rows_table{small_chunk};
    Table event_table{small_chunk};
    Table annotation_table{small_chunk};
    Table annotation_place_table{small_chunk};
    Table summary_table{small_chunk};
    // Tables that refer to rows of another come after it; the most valuable tables come first.
    std::vector<Table*> tables{&step_table,       &command_table, &state_table,
                               &event_table,      &summary_table, &annotation_place_table,
                               &annotation_table, &frame_table,   &deformation_table};
    Tail tail{tables};
    std::uint64_t lost_reported = 0;
    Clock::time_point warned_at{};
    bool said_deleted = false;
    std::uint64_t last_time_ns = 0;
    RecordingLock live;

    std::atomic<std::uint64_t> lost{0};
    std::atomic<bool> has_failed{false};
    bool closed = false;

    std::binary_semaphore stop{0};
    std::thread thread;
};

void SessionWriter::Impl::create(const SessionInfo& info, const SceneRecord& scene) {
    hdf5::File made = hdf5::File::create(path);
    try {
        create_in(std::move(made), info, scene);
    } catch (...) {
        // An incomplete file is useless, and would block the next attempt to create it.
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
        throw;
    }
}

void SessionWriter::Impl::create_in(hdf5::File made, const SessionInfo& info, const SceneRecord& scene) {
    const hdf5::Group& root = made.root();
    write_header(root, info, scene, 0);
    step_columns(tube_nodes)(column_creator<StepRecord>(step_table, root));
    command_columns(column_creator<CommandRecord>(command_table, root));
    state_columns(column_creator<StateRecord>(state_table, root));
    moved_frame_columns(column_creator<MovedFrame>(frame_table, root));
    moved_frames_columns(column_creator<MovedFrames>(deformation_table, root));
    if (scene.liquid) {
        fluid_columns(column_creator<FluidParticle>(fluid_table, root));
        fluid_rows_columns(column_creator<FluidRows>(fluid_rows_table, root));
        tables.insert(tables.end(), {&fluid_table, &fluid_rows_table});
    }
    event_columns(column_creator<EventRecord>(event_table, root));
    annotation_rows_columns(column_creator<AnnotationRows>(annotation_table, root));
    annotation_place_columns(column_creator<AnnotationPlace>(annotation_place_table, root));
    summary_columns(column_creator<SummaryRecord>(summary_table, root));
    link_time_axis(root);
    tail.create(root);
    made.close();

    // From here on in single-writer mode, in which only rows may be added.
    file = hdf5::File::open(path, hdf5::Access::append_swmr);
    meta = file.root().open("meta");
    for (Table* table : tables) {
        table->open(file.root());
    }
    tail.open(file.root());
    live.set(path);
}

void SessionWriter::Impl::run() {
    // Signals are handled on the program's main thread; exceeding a file-size limit then shows as a failed
    // write.
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    hdf5::prepare_thread();
    for (bool last = false, more = false; !last || more;) {
        last = last || stop.try_acquire_for(more ? 0ms : poll);
        drain();
        more = false;
        if (has_failed) {
            continue;
        }
        warn_of_losses();
        warn_of_deletion();
        if (was_overwritten()) {
            continue;
        }
        if (!tail.write()) {
            fail(tail.error());
        } else if (const auto why = write_chunks(last, more)) {
            fail(*why);
        }
    }
    finish();
}

/// Moves waiting records into the tables; discards them after a failure.
void SessionWriter::Impl::drain() {
    const auto take = [this](auto& ring, const auto& append) {
        // A producer as fast as this thread must not starve the other queues.
        for (std::size_t left = ring.capacity(); left > 0; --left) {
            const auto* record = ring.front();
            if (record == nullptr) {
                return;
            }
            if (!has_failed) {
                append(*record);
            }
            ring.pop();
        }
    };
    take(commands, [this](const CommandRecord& r) { command_columns(row_appender(command_table, r)); });
    take(deformations, [this](const DeformationRecord& r) {
        const MovedFrames moved{r.time_ns, frame_table.rows(), static_cast<std::uint32_t>(r.frame.size())};
        moved_frames_columns(row_appender(deformation_table, moved));
        for (std::size_t i = 0; i < r.frame.size(); ++i) {
            const MovedFrame frame{r.frame[i], r.pose[i]};
            moved_frame_columns(row_appender(frame_table, frame));
        }
    });
    take(fluids, [this](const FluidRecord& r) {
        const FluidRows rows{r.time_ns, fluid_table.rows(), static_cast<std::uint32_t>(r.position.size())};
        fluid_rows_columns(row_appender(fluid_rows_table, rows));
        for (const Vec3f& position : r.position) {
            const FluidParticle particle{position};
            fluid_columns(row_appender(fluid_table, particle));
        }
    });
    take(steps, [this](const StepRecord& r) {
        step_columns(tube_nodes)(row_appender(step_table, r));
        last_time_ns = r.time_ns;
    });
    take(states, [this](const StateRecord& r) { state_columns(row_appender(state_table, r)); });
    take(events, [this](const EventRecord& r) { event_columns(row_appender(event_table, r)); });
    take(annotations, [this](const AnnotationRecord& r) {
        const AnnotationRows rows{r.time_ns,
                                  r.kind,
                                  r.sender,
                                  r.text,
                                  r.object,
                                  annotation_place_table.rows(),
                                  static_cast<std::uint32_t>(r.place.size())};
        annotation_rows_columns(row_appender(annotation_table, rows));
        for (std::size_t i = 0; i < r.place.size(); ++i) {
            const SurfacePlace& at = r.place[i];
            const AnnotationPlace place{at.triangle, {at.u, at.v, at.height}, r.position[i]};
            annotation_place_columns(row_appender(annotation_place_table, place));
        }
    });
    take(summaries, [this](const SummaryRecord& r) { summary_columns(row_appender(summary_table, r)); });
}

/// Writes one chunk of each table if it is full, has waited long enough, or `everything` is set. `more`:
/// whether another chunk remains. Nullopt on success, else the reason.
std::optional<std::string> SessionWriter::Impl::write_chunks(bool everything, bool& more) {
    // A kill between two flushes may leave data in some series and not in others. A flush therefore follows
    // every chunk, however much has accumulated on a busy machine.
    more = false;
    bool any = false;
    for (Table* table : tables) {
        const bool due = everything || table->overdue(longest_unwritten);
        any = any || table->has_chunk(due);
        if (!table->write_chunk(due)) {
            return table->error();
        }
        more = more || table->has_chunk(everything);
    }
    if (any && !file.flush()) {
        return hdf5::last_error();
    }
    return std::nullopt;
}

void SessionWriter::Impl::warn_of_losses() {
    const Clock::time_point now = Clock::now();
    const std::uint64_t total = lost.load(std::memory_order_relaxed);
    if (total == lost_reported || (lost_reported > 0 && now - warned_at < warning_period)) {
        return;
    }
    const std::string text = fmt::format(
        "{}: {} records were lost because the disk was too slow. Remedy: record to a faster disk, or raise "
        "the number of queued steps (waiting_steps, now {}).",
        path.string(), total - lost_reported, settings.waiting_steps);
    lost_reported = total;
    warned_at = now;
    event_columns(row_appender(event_table, EventRecord{last_time_ns, "recording", text}));
    if (settings.on_warning) {
        settings.on_warning(text);
    }
}

void SessionWriter::Impl::warn_of_deletion() {
    const std::optional<int> descriptor = said_deleted ? std::nullopt : live.deleted();
    if (!descriptor) {
        return;
    }
    said_deleted = true;
    if (settings.on_error) {
        settings.on_error(fmt::format(
            "{}: was deleted during the recording and will be lost when this program exits. Remedy: before "
            "that, run: cp /proc/{}/fd/{} NEW_NAME, then: eti-review check --repair NEW_NAME",
            path.string(), ::getpid(), *descriptor));
    }
}

/// A program that opens the file in order to create it anew (h5py's mode "w") is not refused: readers of a
/// running recording need it unlocked.
bool SessionWriter::Impl::was_overwritten() {
    if (!live.overwritten()) {
        return false;
    }
    end_recording(fmt::format(
        "{}: recording stopped: another program has overwritten the file, and what was recorded is lost. "
        "Remedy: record again, to another file, and open a running recording for reading only (h5py: "
        "File(name, \"r\", swmr=True))",
        path.string()));
    return true;
}

void SessionWriter::Impl::fail(const std::string& reason) {
    if (was_overwritten()) {  // the reason is its consequence
        return;
    }
    end_recording(
        fmt::format("{}: recording stopped: {}. The recording up to then is kept. Remedy: free some "
                    "space on the disk or record elsewhere, then run: eti-review check --repair {}",
                    path.string(), reason, path.string()));
}

void SessionWriter::Impl::end_recording(const std::string& text) {
    // Do not touch the library's handles: another write could only damage the file.
    for (Table* table : tables) {
        table->abandon();
    }
    tail.abandon();
    meta = {};
    file.abandon();
    live.clear();
    has_failed = true;
    if (settings.on_error) {
        settings.on_error(text);
    }
}

void SessionWriter::Impl::finish() {
    if (has_failed || was_overwritten()) {
        return;
    }
    if (!meta.change_integer("lost_records", lost.load()) || !meta.change_integer("finished", 1)) {
        fail(hdf5::last_error());
        return;
    }
    try {
        meta = {};
        file.close();
        live.clear();
    } catch (const hdf5::Error&) {
        fail(hdf5::last_error());
    }
}

SessionWriter::SessionWriter(const std::filesystem::path& path, const SessionInfo& info,
                             const SceneRecord& scene, Settings settings)
    : impl_(std::make_unique<Impl>(path, info, scene, std::move(settings))) {}

SessionWriter::~SessionWriter() {
    close();
}

bool SessionWriter::push(const StepRecord& record) {
    return impl_->push(impl_->steps, record);
}
bool SessionWriter::push(const CommandRecord& record) {
    return impl_->push(impl_->commands, record);
}
bool SessionWriter::push(const StateRecord& record) {
    return impl_->push(impl_->states, record);
}
bool SessionWriter::push(const DeformationRecord& record) {
    return impl_->push(impl_->deformations, record);
}
bool SessionWriter::push(const FluidRecord& record) {
    return impl_->push(impl_->fluids, record);
}
bool SessionWriter::push(const EventRecord& record) {
    return impl_->push(impl_->events, record);
}
bool SessionWriter::push(const AnnotationRecord& record) {
    return impl_->push(impl_->annotations, record);
}
bool SessionWriter::push(const SummaryRecord& record) {
    return impl_->push(impl_->summaries, record);
}

std::uint64_t SessionWriter::lost() const {
    return impl_->lost.load(std::memory_order_relaxed);
}

bool SessionWriter::failed() const {
    return impl_->has_failed;
}

bool SessionWriter::close() {
    if (!impl_->closed) {
        impl_->closed = true;
        impl_->stop.release();
        impl_->thread.join();
    }
    return !failed() && lost() == 0;
}

}  // namespace eti::session
