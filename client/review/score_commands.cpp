// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <set>

#include "client/review/output.hpp"
#include "client/review/score.hpp"
#include "client/review/study/ratings.hpp"
#include "client/review/study/study_commands.hpp"
#include "client/review/summary.hpp"
#include "common/process/command_line.hpp"
#include "common/process/progress_bar.hpp"
#include "common/scenario/data_file.hpp"

namespace eti::review {

namespace {

constexpr std::string_view skill_source =
    "the skill given to scripted operators, or 1 if the trachea was not intubated";

nlohmann::ordered_json to_json(const GradeError& error) {
    return {{"sessions", error.sessions},
            {"mean_error", error.mean_error},
            {"blind_error", error.baseline_error},
            {"rank", error.rank}};
}

Command add_train(CommandLine& app) {
    struct Options {
        std::vector<std::filesystem::path> files;
        std::string label = "skill", out, html, name = "lab";
        double penalty = 1.0;
    };
    const auto options = std::make_shared<Options>();
    CommandLine command = app.add_subcommand(
        "train", "Fit a score to graded sessions, and cross-validate it on unseen patients and operators");
    command.add_option("FILE", options->files, "Session files").required();
    command
        .add_option("--label", options->label,
                    "Source of the grades: skill (of scripted operators, and whether they intubated), or an "
                    "item rated by instructors")
        .capture_default_str();
    command.add_option("--out", options->out, "Score file to write").required();
    command.add_option("--name", options->name, "Name of the score").capture_default_str();
    command.add_option("--html", options->html, "Also write the validation as an HTML page to this file");
    command
        .add_number("--penalty", options->penalty, "L2 penalty on the weights; larger values shrink them",
                    {1e-3, 1e3})
        .capture_default_str();
    return {command, [options](bool json) {
                require_name("--name", options->name);
                (void)parse_rating(options->label + "=1", "");  // an item's name
                refuse_existing(options->out, "--out");
                if (!options->html.empty()) {
                    refuse_existing(options->html, "--html");
                }
                ProgressBar bar;
                std::vector<Example> examples;
                std::vector<std::string> left_out;
                std::size_t read = 0;
                for (const std::filesystem::path& file : options->files) {
                    bar.draw(static_cast<float>(read++) / static_cast<float>(options->files.size()),
                             file.string());
                    if (auto example = read_example(file, options->label)) {
                        examples.push_back(std::move(*example));
                    } else {
                        left_out.push_back(file.string());
                    }
                }
                bar.clear();
                for (const std::string& file : left_out) {
                    std::cerr << fmt::format(
                        "{} is excluded: it has no grade by '{}', or its outcome is unknown\n", file,
                        options->label);
                }
                const ValidationResult judged = cross_validate(examples, options->penalty);
                ScoreModel model = fit(examples, options->penalty);
                model.validation = judged;
                model.name = options->name;
                model.human_rated = options->label != "skill";
                model.source = model.human_rated ? fmt::format("instructors' ratings of '{}'", options->label)
                                                 : std::string(skill_source);
                std::set<std::string> patients, persons;
                for (const Example& example : examples) {
                    patients.insert(example.patient);
                    persons.insert(example.person);
                }
                model.patients = patients.size();
                model.persons = persons.size();
                write_new_file(options->out, to_yaml(model), "--out");
                if (!options->html.empty()) {
                    write_new_file(options->html, to_html(model), "--html");
                }
                if (json) {
                    std::cout << nlohmann::ordered_json{{"written", options->out},
                                                        {"sessions", model.sessions},
                                                        {"left_out", left_out},
                                                        {"all", to_json(judged.all)},
                                                        {"intubated", to_json(judged.intubated)},
                                                        {"right", judged.accuracy},
                                                        {"blind_right", judged.baseline_accuracy},
                                                        {"brier", judged.brier}}
                                     .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                              << '\n';
                } else {
                    std::cout << to_table(model) << options->out << '\n';
                }
                return 0;
            }};
}

Command add_apply(CommandLine& app) {
    struct Options {
        std::vector<std::filesystem::path> files;
        std::string model = "scripted";
    };
    const auto options = std::make_shared<Options>();
    CommandLine command = app.add_subcommand("apply", "Score sessions, with the contribution of each metric");
    command.add_option("FILE", options->files, "Session files").required();
    command.add_option("--model", options->model, "Score by name or path").capture_default_str();
    return {command, [options](bool json) {
                const ScoreModel model = load_score(find_data_file(options->model, "scores"));
                auto out = nlohmann::ordered_json::array();
                for (const std::filesystem::path& file : options->files) {
                    const Summary summary = summarise(file);
                    if (!summary.outcome_known(summary.run)) {
                        throw ScoreError(
                            fmt::format("{}: no score, as its outcome is unknown: {}; expected a complete "
                                        "session of a simulated newborn",
                                        file.string(), summary.run.outcome.reason));
                    }
                    const Score score = score_of(model, summary.run.metrics, summary.run.outcome.success);
                    if (json) {
                        nlohmann::ordered_json one{{"file", file.string()},
                                                   {"success", summary.run.outcome.success}};
                        one.update(to_json(score, model));
                        out.push_back(std::move(one));
                    } else {
                        std::cout << fmt::format("{}: outcome {}\n{}", file.string(),
                                                 outcome_word(summary, summary.run), to_table(score, model));
                    }
                }
                if (json) {
                    std::cout << out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                              << '\n';
                }
                return 0;
            }};
}

}  // namespace

std::vector<Command> add_score_commands(CommandLine& app) {
    CommandLine group = app.add_subcommand("score", "Score sessions automatically, or fit a score");
    group.require_subcommand(1);
    return {add_train(group), add_apply(group)};
}

}  // namespace eti::review
