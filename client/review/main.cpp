// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/review/export.hpp"
#include "client/review/report.hpp"
#include "client/review/score.hpp"
#include "client/review/server_program.hpp"
#include "client/review/study/study.hpp"
#include "client/review/study/study_commands.hpp"
#include "client/review/summary.hpp"
#include "client/text/catalogue.hpp"
#include "common/process/command_line.hpp"
#include "common/process/escaped.hpp"
#include "common/process/guard.hpp"
#include "common/process/stop_signal.hpp"
#include "common/scenario/data_file.hpp"
#include "common/session/repair/check.hpp"

namespace {

using namespace eti;

constexpr int refused = 1;

int summary(const std::filesystem::path& file, bool json) {
    const review::Summary summary = review::summarise(file);
    if (json) {
        std::cout << to_json(summary).dump(2) << '\n';
    } else {
        std::cout << escaped_lines(to_table(summary));
    }
    return 0;
}

int check(const std::filesystem::path& file, bool repair, bool json) {
    std::vector<std::string> done;
    if (repair) {
        done = session::repair(file);
    }
    const session::CheckResult result = session::check(file);
    if (json) {
        nlohmann::ordered_json out;
        out["file"] = file.string();
        out["sound"] = result.is_valid();
        out["repaired"] = done;
        out["damage"] = result.damage;
        out["remarks"] = result.remarks;
        std::cout << out.dump(2) << '\n';
        return result.is_valid() ? 0 : refused;
    }
    for (const std::string& text : done) {
        std::cout << "repaired: " << escaped_lines(text) << '\n';
    }
    for (const std::string& text : result.remarks) {
        std::cout << escaped_lines(text) << '\n';
    }
    for (const std::string& text : result.damage) {
        std::cerr << escaped_lines(file.string() + ": " + text) << '\n';
    }
    if (!result.is_valid() && result.repairable && !repair) {
        std::cerr << "Remedy: eti-review check --repair " << escaped(file.string()) << '\n';
    }
    std::cout << escaped(file.string()) << (result.is_valid() ? ": valid\n" : ": damaged\n");
    return result.is_valid() ? 0 : refused;
}

int export_csv(const std::filesystem::path& file, const std::filesystem::path& folder, bool json) {
    const bool on_terminal = ::isatty(STDERR_FILENO) != 0;
    int count = 0;
    const auto progress = [&](const std::filesystem::path& path) {
        if (on_terminal) {
            std::cerr << fmt::format("\r\033[K[{}] {}", ++count, escaped(path.string())) << std::flush;
        }
    };
    const auto written = review::export_csv(file, folder, progress, stop_requested);
    if (on_terminal) {
        std::cerr << "\r\033[K";
    }
    nlohmann::ordered_json names = nlohmann::ordered_json::array();
    for (const std::filesystem::path& path : written) {
        names.push_back(path.string());
        if (!json) {
            std::cout << path.string() << '\n';
        }
    }
    if (json) {
        std::cout << nlohmann::ordered_json{{"file", file.string()}, {"written", names}}.dump(2) << '\n';
    }
    return stop_requested() ? review::interrupted : 0;
}

/// Options of a replay, passed to eti-server.
struct Replay {
    std::optional<double> speed, from, to;
    bool loop = false, pause = false;
};

/// The server publishes the replay, as only it may publish a session. Returns only if it was not found.
int replay(const std::filesystem::path& file, const Replay& how, const std::vector<std::string>& further) {
    std::vector<std::string> words{"--replay", file.string()};
    for (const auto& [name, value] :
         {std::pair("--speed", how.speed), {"--from", how.from}, {"--to", how.to}}) {
        if (value) {
            words.insert(words.end(), {name, fmt::format("{}", *value)});
        }
    }
    if (how.loop) {
        words.emplace_back("--loop");
    }
    if (how.pause) {
        words.emplace_back("--pause");
    }
    words.insert(words.end(), further.begin(), further.end());
    review::exec_server(words);
    return refused;
}

constexpr const char* no_score = "none";

/// Without a score the page is still written, and the user is told how to get one.
std::optional<review::ScoreModel> score_for_report(const std::string& name) {
    if (name == no_score) {
        return std::nullopt;
    }
    try {
        return review::load_score(find_data_file(name, "scores"));
    } catch (const InputError& error) {
        throw InputError(
            fmt::format("--score: {}\nRemedy: use --score {} to write the report without a score",
                        error.what(), no_score));
    }
}

int report(const std::vector<std::filesystem::path>& files, const std::filesystem::path& folder,
           const std::string& score, bool json) {
    const std::optional<review::ScoreModel> model = score_for_report(score);
    const std::filesystem::path written = review::write_report(files, folder, model, stop_requested);
    if (written.empty()) {
        return review::interrupted;
    }
    if (json) {
        std::cout << nlohmann::ordered_json{{"written", written.string()}}.dump(2) << '\n';
    } else {
        std::cout << written.string() << '\n';
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    CommandLine app("Reviews recorded sessions (*.eti.h5).", "eti-review");
    app.require_subcommand(1);
    app.fallthrough();
    bool json = false;
    app.add_flag("--json", json, "Print the result as one JSON object");

    std::filesystem::path file;
    CommandLine summary_command =
        app.add_subcommand("summary", "Print the metrics of the run and of each attempt");
    summary_command.add_option("FILE", file, "Session file").required();

    CommandLine check_command =
        app.add_subcommand("check", "Read everything and report whether the file is valid");
    check_command.add_option("FILE", file, "Session file").required();
    bool repair = false;
    check_command.add_flag(
        "--repair", repair,
        "Repair a file so that any HDF5 program can open it: clear the flag that a killed recording leaves, "
        "keep all readable rows, list those that are lost. A changed file is kept as FILE.before-repair");

    CommandLine export_command = app.add_subcommand("export", "Write every series as CSV");
    export_command.add_option("FILE", file, "Session file").required();
    std::filesystem::path folder;
    export_command.add_option("--out", folder, "Output folder; created if missing").required();

    CommandLine replay_command =
        app.add_subcommand("replay", "Publish a session on the bus as if it were live, for clients to show");
    replay_command.add_option("FILE", file, "Session file; must be the first argument").required();
    Replay how;
    replay_command.add_number("--speed", how.speed, "Playback speed", {1.0 / 16, 16.0, "times real time"});
    replay_command.add_number("--from", how.from, "Start time", {0.0, 1e7, "s"});
    replay_command.add_number("--to", how.to, "End time", {0.0, 1e7, "s"});
    replay_command.add_flag("--loop", how.loop, "Restart at the end");
    replay_command.add_flag("--pause", how.pause, "Start paused");
    replay_command.footer(
        "On a terminal: space pauses, arrow keys seek by 1 s, < and > by one state, [ and ] change the "
        "speed, 0 seeks to the start, q quits. Other options (--session, --domain, --peer, ...) are passed "
        "to eti-server.");
    replay_command.allow_extras();
    replay_command.fallthrough(false);

    CommandLine report_command = app.add_subcommand(
        "report", "Write one page that opens offline: outcome, metrics, timeline, tools over the anatomy");
    std::vector<std::filesystem::path> files;
    report_command
        .add_option("FILE", files, "Session files, at most four; the first is compared with the others")
        .required()
        .expected(1, 4);
    report_command.add_option("--out", folder, "Folder for report.html; created if missing").required();

    std::string score = "scripted";
    report_command
        .add_option("--score", score, fmt::format("Score model, by name or path; {}: no score", no_score))
        .capture_default_str();

    std::string language = "auto", of_languages;
    std::vector<std::string> language_codes{"auto"};
    for (const text::Language& one : text::languages()) {
        language_codes.emplace_back(one.code);
        of_languages += fmt::format("; {}: {}", one.code, one.name);
    }
    report_command
        .add_option("--language", language,
                    fmt::format("Language of the page; auto: as the environment says (LANGUAGE, LC_ALL, "
                                "LC_MESSAGES, LANG){}",
                                of_languages))
        .capture_default_str()
        .one_of(language_codes);

    CommandLine study_command = app.add_subcommand(
        "study", "Run the sessions of a study one after another; resumes where it was interrupted");
    std::string study_file;
    study_command.add_option("STUDY", study_file, "Study by name or path").required();
    review::StudyRun study_run;
    study_command.add_option("--out", study_run.folder, "Folder of the study; created if missing").required();
    study_command.add_option("--participant", study_run.participant, "Run only this participant's sessions");
    study_command.add_flag("--status", study_run.status_only,
                           "Print the progress of the study without running anything");
    study_command.footer(
        "Other options are passed to eti-server. Ctrl-C interrupts the study until it is started again; an "
        "interrupted session is run again.");
    study_command.allow_extras();
    study_command.fallthrough(false);
    study_command.add_flag("--json", json, "Print the result as one JSON object");

    std::vector<review::Command> study_commands = review::add_study_commands(app);
    std::ranges::move(review::add_rating_commands(app), std::back_inserter(study_commands));
    std::ranges::move(review::add_score_commands(app), std::back_inserter(study_commands));

    if (const auto status = app.parse(argc, argv)) {
        return *status;
    }
    if (replay_command.parsed()) {
        return replay(file, how, replay_command.remaining());
    }
    // The guarded task decides when to end; it inherits the handler.
    catch_stop_signals();

    if (study_command.parsed()) {  // starts programs that need more resources than the guarded task may use
        try {
            study_run.server_options = study_command.remaining();
            return run_study(review::load_study(find_data_file(study_file, "studies")), study_run, json);
        } catch (const std::exception& error) {
            std::cerr << "eti-review: " << escaped_lines(error.what()) << '\n';
            return refused;
        }
    }

    // Session files may come from third parties, and the HDF5 library can crash on a damaged one.
    const GuardedResult ended = run_guarded([&] {
        if (summary_command.parsed() || (check_command.parsed() && !repair)) {
            end_at_once_on_stop();
        }
        try {
            if (summary_command.parsed()) {
                return summary(file, json);
            }
            if (check_command.parsed()) {
                return check(file, repair, json);
            }
            if (report_command.parsed()) {
                text::set_language(language == "auto" ? text::language_of_environment() : language);
                return report(files, folder, score, json);
            }
            for (const review::Command& command : study_commands) {
                if (command.parser.parsed()) {
                    return command.run(json);
                }
            }
            return export_csv(file, folder, json);
        } catch (const std::exception& error) {
            std::cerr << "eti-review: " << escaped_lines(error.what()) << '\n';
            return refused;
        }
    });
    if (ended.broken) {
        const std::string read = (files.empty() ? file : files.front()).string();
        std::cerr << "eti-review: " << (read.empty() ? "a file" : escaped(read))
                  << ": damaged: reading failed with " << *ended.broken << '\n';
        return refused;
    }
    return ended.status;
}
