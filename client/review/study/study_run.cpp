// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iostream>

#include "client/review/output.hpp"
#include "client/review/server_program.hpp"
#include "client/review/study/prompt.hpp"
#include "client/review/study/study.hpp"
#include "common/process/files/descriptor.hpp"
#include "common/process/files/folder.hpp"
#include "common/process/guard.hpp"
#include "common/process/stop_signal.hpp"
#include "common/scenario/scenario.hpp"
#include "common/session/repair/recording_lock.hpp"

namespace eti::review {

namespace {

constexpr int no_server = 127;

enum class State : std::uint8_t { open, done, cut_off, recorded_now };
constexpr std::string_view state_words[] = {"open", "done", "cut off", "being recorded"};

/// State of a session's file, which is read in a separate process.
State state_of(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
        return State::open;
    }
    if (session::is_being_written(file)) {
        return State::recorded_now;
    }
    const GuardedResult read = run_guarded([&file] {
        try {
            const Summary summary = summarise(file);
            return summary.finished && summary.has_run ? 0 : 1;
        } catch (const std::exception&) {
            return 1;
        }
    });
    return !read.broken && read.status == 0 ? State::done : State::cut_off;
}

/// Lock on a session, for several processes that run a study in the same folder: locks the byte of that
/// index in an empty file. The kernel releases it when the process ends, even by a crash.
class Claim {
  public:
    Claim(const std::filesystem::path& folder, std::size_t session) {
        const std::filesystem::path lock_file = folder / "study.lock";
        file_ = Descriptor(::open(lock_file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
        struct flock lock {};
        lock.l_type = F_WRLCK;
        lock.l_whence = SEEK_SET;
        lock.l_start = static_cast<off_t>(session);
        lock.l_len = 1;
        held_ = file_ && ::fcntl(file_.get(), F_OFD_SETLK, &lock) == 0;
        if (!held_ && (!file_ || (errno != EAGAIN && errno != EACCES))) {
            throw InputError(fmt::format(
                "{}: cannot be locked ({}), so another process might run the same session; expected a "
                "writable file on a file system that supports locks: choose another folder with --out",
                lock_file.string(), std::strerror(errno)));
        }
    }

    [[nodiscard]] bool held() const { return held_; }

  private:
    Descriptor file_;
    bool held_ = false;
};

/// Progress of a study in a folder.
class Progress {
  public:
    Progress(const Study& study, const std::filesystem::path& folder)
        : folder_(folder), sessions_(plan_of(study)) {
        look_again();
    }

    [[nodiscard]] const std::vector<PlannedSession>& sessions() const { return sessions_; }
    [[nodiscard]] State state(std::size_t i) const { return states_[i]; }
    /// Re-reads the states, as other processes may run sessions in the same folder. Completed sessions stay
    /// so.
    void look_again() {
        for (std::size_t i = 0; i < sessions_.size(); ++i) {
            look_again(i);
        }
    }
    State look_again(std::size_t i) {
        if (states_[i] != State::done) {
            states_[i] = state_of(folder_ / sessions_[i].file);
        }
        return states_[i];
    }
    [[nodiscard]] std::size_t done() const {
        return static_cast<std::size_t>(std::ranges::count(states_, State::done));
    }

    /// Replaces the progress file.
    void write() const {
        std::string out = "number,participant,place,condition,scenario,operator,skill,seed,state,file\r\n";
        for (std::size_t i = 0; i < sessions_.size(); ++i) {
            const PlannedSession& one = sessions_[i];
            out += fmt::format("{},{},{},{},{},{},{},{},{},{}\r\n", i + 1, one.participant->name, one.place,
                               csv_text(one.condition->name), csv_text(one.condition->scenario),
                               csv_text(one.participant->operator_),
                               one.participant->skill ? fmt::format("{:.4g}", *one.participant->skill) : "",
                               one.participant->seed, state_words[static_cast<std::size_t>(states_[i])],
                               csv_text(one.file.string()));
        }
        write_file(folder_ / "plan.csv", out, "--out");
    }

  private:
    std::filesystem::path folder_;
    std::vector<PlannedSession> sessions_;
    std::vector<State> states_ = std::vector<State>(sessions_.size(), State::open);
};

/// A folder belongs to one study: it contains a copy of the study's file.
void keep_study(const Study& study, const std::filesystem::path& folder) {
    const std::filesystem::path kept = folder / "study.yaml";
    std::error_code ignored;
    if (!std::filesystem::exists(kept, ignored)) {
        write_file(kept, study.text, "--out");
    } else if (read_text_file(kept) != study.text) {
        throw InputError(fmt::format(
            "{}: the study in this folder differs from the given one; expected an identical file, as its "
            "sessions belong together: give {} itself, or choose another folder with --out",
            kept.string(), kept.string()));
    }
}

/// Renames an interrupted recording, to free its name for the next.
void set_aside(const std::filesystem::path& file) {
    for (int number = 1;; ++number) {
        const std::filesystem::path aside = fmt::format("{}.cut-{}", file.string(), number);
        if (!std::filesystem::exists(aside)) {
            std::filesystem::rename(file, aside);
            return;
        }
    }
}

std::vector<std::string> server_arguments(const PlannedSession& session, const StudyRun& how) {
    const Study::Participant& who = *session.participant;
    std::vector<std::string> words{
        "--scenario", session.condition->scenario,          "--participant", who.name,
        "--record",   (how.folder / session.file).string(), "--seed",        std::to_string(who.seed)};
    if (who.operator_.empty()) {
        words.emplace_back("--finish-after-attempt");
    } else {
        words.insert(words.end(), {"--operator", who.operator_, "--fast", "--no-dds"});
        if (who.skill) {
            words.insert(words.end(), {"--operator-skill", fmt::format("{:.4g}", *who.skill)});
        }
        if (who.attempts) {
            words.insert(words.end(), {"--operator-attempts", std::to_string(*who.attempts)});
        }
    }
    words.insert(words.end(), how.server_options.begin(), how.server_options.end());
    return words;
}

/// Whether the participant is ready.
bool ready(const PlannedSession& session) {
    std::cout << fmt::format("{}: condition {} ({}). Enter starts it, q and Enter quits: ",
                             session.participant->name, session.condition->name, session.condition->scenario)
              << std::flush;
    const auto line = read_line();
    return line && *line != "q";
}

std::string outcome_of(const std::filesystem::path& file) {
    const Summary summary = summarise(file);
    return fmt::format("outcome {}, {:.1f} s", outcome_word(summary, summary.run), summary.duration);
}

}  // namespace

int run_study(const Study& study, const StudyRun& how, bool json) {
    if (!how.participant.empty() &&
        std::ranges::find(study.participants, how.participant, &Study::Participant::name) ==
            study.participants.end()) {
        throw InputError(fmt::format("--participant {}: not in the study; expected one of {} to {}",
                                     how.participant, study.participants.front().name,
                                     study.participants.back().name));
    }
    for (const Study::Condition& condition : study.conditions) {
        (void)load_scenario(find_data_file(condition.scenario, "scenarios"));
    }
    for (const Study::Participant& participant : study.participants) {
        if (!participant.operator_.empty()) {
            (void)find_data_file(participant.operator_, "operators");
        }
    }
    if (!how.status_only) {
        keep_study(study, how.folder);
    }
    Progress progress(study, how.folder);
    const std::size_t count = progress.sessions().size();
    const auto end = [&](int status) {
        if (json) {
            std::cout << nlohmann::ordered_json{{"study", study.name},
                                                {"sessions", count},
                                                {"done", progress.done()},
                                                {"plan", (how.folder / "plan.csv").string()}}
                             .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                      << '\n';
        } else {
            std::cout << fmt::format("{}: {} of {} sessions done; {}\n", study.name, progress.done(), count,
                                     (how.folder / "plan.csv").string());
        }
        return status;
    };
    if (how.status_only) {
        for (std::size_t i = 0; i < count && !json; ++i) {
            const PlannedSession& session = progress.sessions()[i];
            std::cout << fmt::format("[{}/{}] {} {} {}\n", i + 1, count, session.participant->name,
                                     session.condition->name,
                                     state_words[static_cast<std::size_t>(progress.state(i))]);
        }
        return end(0);
    }
    progress.write();
    for (std::size_t i = 0; i < count; ++i) {
        const PlannedSession& session = progress.sessions()[i];
        if ((!how.participant.empty() && session.participant->name != how.participant) ||
            progress.state(i) == State::done) {
            continue;
        }
        const Claim claim(how.folder, i);
        // Another process may have completed it, or have been killed while its server continues.
        if (claim.held() && progress.look_again(i) == State::done) {
            continue;
        }
        if (!claim.held() || progress.state(i) == State::recorded_now) {
            std::cerr << fmt::format(
                "eti-review: session {} of {} ({}, {}) is being recorded by another process and is left to "
                "it\n",
                i + 1, count, session.participant->name, session.condition->name);
            continue;
        }
        if (stop_requested() || (session.participant->operator_.empty() && !ready(session))) {
            return end(interrupted);
        }
        const std::filesystem::path file = how.folder / session.file;
        if (progress.state(i) == State::cut_off) {
            set_aside(file);
        }
        make_folder(file.parent_path());
        const int status = run_server(server_arguments(session, how));
        std::error_code ignored;
        if (stop_requested() && std::filesystem::exists(file, ignored)) {
            set_aside(file);  // stopped early, though cleanly
        }
        progress.look_again();
        progress.write();
        if (stop_requested()) {
            return end(interrupted);
        }
        // The exit status says whether the trachea was intubated, which the file also contains.
        if (progress.state(i) != State::done) {
            std::cerr << fmt::format(
                "eti-review: session {} of {} ({}, {}) ended with status {} and an incomplete recording; see "
                "eti-server's messages above, and start the study again\n",
                i + 1, count, session.participant->name, session.condition->name, status);
            return end(status == no_server ? no_server : 1);
        }
        if (!json) {
            std::cout << fmt::format("[{}/{}] {} {}: {}\n", i + 1, count, session.participant->name,
                                     session.condition->name, outcome_of(file))
                      << std::flush;
        }
    }
    return end(0);
}

}  // namespace eti::review
