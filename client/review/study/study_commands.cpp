// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/study/study_commands.hpp"

#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <string>

#include "client/review/comparison.hpp"
#include "client/review/output.hpp"
#include "client/review/study/ratings.hpp"
#include "client/review/study/study.hpp"
#include "common/process/command_line.hpp"
#include "common/process/progress_bar.hpp"
#include "common/scenario/data_file.hpp"
#include "common/session/anonymise.hpp"

namespace eti::review {

namespace {

constexpr int fewest_resamples = 1000, most_resamples = 1'000'000;

Command add_compare(CommandLine& app) {
    struct Options {
        std::vector<std::vector<std::string>> groups;
        bool paired = false;
        Bootstrap how;
        std::string csv, html, expect;
    };
    const auto options = std::make_shared<Options>();
    CommandLine command = app.add_subcommand(
        "compare", "Compare groups of sessions: means, differences with intervals, effect sizes");
    command
        .add_option("--group", options->groups,
                    "A group's name followed by its session files; give at least two groups")
        .required()
        .type_name("NAME FILE");
    command.add_flag("--paired", options->paired,
                     "Every participant has a session in each group: compare within participants");
    command
        .add_number("--resamples", options->how.resamples, "Number of bootstrap resamples",
                    {fewest_resamples, most_resamples})
        .capture_default_str();
    command.add_number("--seed", options->how.seed, "Seed of the bootstrap", {0}).capture_default_str();
    command.add_option("--csv", options->csv, "Also write a CSV file with one row per session");
    command.add_option("--html", options->html, "Also write the comparison as an HTML page to this file");
    command.add_option("--expect", options->expect,
                       "Compare the results with the expectations of this study, by name or path");
    return {
        command, [options](bool json) {
            const auto expectations =
                options->expect.empty() ? std::vector<Expectation>{}
                                        : load_study(find_data_file(options->expect, "studies")).expectations;
            GroupFiles files;
            std::size_t count = 0, read = 0;
            for (const std::vector<std::string>& group : options->groups) {
                if (group.size() < 2) {
                    throw ComparisonError(
                        fmt::format("--group {}: no files; expected a name and at least one session file: "
                                    "--group NAME FILE...",
                                    group.empty() ? "" : group.front()));
                }
                files.emplace_back(group.front(),
                                   std::vector<std::filesystem::path>(group.begin() + 1, group.end()));
                count += group.size() - 1;
            }
            for (const auto& [path, option] : {std::pair(options->csv, "--csv"), {options->html, "--html"}}) {
                if (!path.empty()) {
                    refuse_existing(path, option);
                }
            }
            ProgressBar bar;
            Comparison comparison = read_groups(files, [&](const std::filesystem::path& file) {
                bar.draw(static_cast<float>(read++) / static_cast<float>(count), file.string());
            });
            comparison.paired = options->paired;
            comparison.how = options->how;
            compare(comparison);
            const std::vector<ExpectationResult> verdicts = check_expectations(comparison, expectations);
            bar.clear();
            if (!options->csv.empty()) {
                write_new_file(options->csv, to_csv(comparison), "--csv");
            }
            if (!options->html.empty()) {
                write_new_file(options->html, to_html(comparison, to_html(verdicts)), "--html");
            }
            if (json) {
                nlohmann::ordered_json out = to_json(comparison);
                out["held_to"] = to_json(verdicts);
                std::cout << out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                          << '\n';
            } else {
                std::cout << to_table(comparison);
                if (!verdicts.empty()) {
                    std::cout << '\n' << to_table(verdicts);
                }
            }
            return 0;
        }};
}

Command add_anonymise(CommandLine& app) {
    struct Options {
        std::string file, out, participant;
    };
    const auto options = std::make_shared<Options>();
    CommandLine command =
        app.add_subcommand("anonymise", "Write a copy of a session without participant, place and time");
    command.add_option("FILE", options->file, "Session file; left unchanged").required();
    command.add_option("--out", options->out, "File to write").required();
    command.add_option("--participant", options->participant, "New pseudonym; without it the copy has none");
    command.footer(
        "Measured series are copied bit by bit. The texts of scenario and operator are kept as well, since "
        "resimulation needs them: check that their comments name no person.");
    return {command, [options](bool json) {
                if (!options->participant.empty()) {
                    require_name("--participant", options->participant);
                }
                refuse_existing(options->out, "--out");
                const auto gone = session::anonymise(options->file, options->out, options->participant);
                if (json) {
                    std::cout << nlohmann::ordered_json{{"written", options->out}, {"removed", gone}}.dump(
                                     2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                              << '\n';
                    return 0;
                }
                for (const std::string& what : gone) {
                    std::cout << "removed: " << what << '\n';
                }
                std::cout << options->out << '\n';
                return 0;
            }};
}

}  // namespace

std::vector<Command> add_study_commands(CommandLine& app) {
    return {add_compare(app), add_anonymise(app)};
}

}  // namespace eti::review
