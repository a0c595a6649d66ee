// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <optional>

#include "client/review/study/form.hpp"
#include "client/review/study/prompt.hpp"
#include "client/review/study/ratings.hpp"
#include "client/review/study/study.hpp"
#include "client/review/study/study_commands.hpp"
#include "client/review/summary.hpp"
#include "common/scenario/data_file.hpp"

namespace eti::review {

namespace {

using nlohmann::ordered_json;

void print(const ordered_json& json) {
    std::cout << json.dump(2, ' ', false, ordered_json::error_handler_t::replace) << '\n';
}

/// Asks until the answer is valid or empty. nullopt at the end of input.
std::optional<std::string> ask(const Form::Question& question) {
    for (;;) {
        std::cout << question.ask << "\n  " << expected_answer(question)
                  << ", Enter skips it: " << std::flush;
        std::optional<std::string> line = read_line();
        if (!line || line->empty() || is_valid_answer(question, *line)) {
            return line;
        }
        std::cout << fmt::format("  '{}' is not a valid answer to this question.\n", line->substr(0, 60));
    }
}

void print_form(const Form& form) {
    std::cout << fmt::format("{} ({})\n{}\n\n", form.title, form.name, form.source);
    for (const Form::Question& question : form.questions) {
        std::cout << fmt::format("{}: {}\n    {}\n", question.name, question.ask, expected_answer(question));
    }
}

Command add_rate(CommandLine& app) {
    struct Options {
        std::string file, rater;
        std::vector<std::string> scores;
    };
    const auto options = std::make_shared<Options>();
    CommandLine command =
        app.add_subcommand("rate", "Add an instructor's ratings to a session file, or print those in it");
    command.add_option("FILE", options->file, "Session file").required();
    const Option rater =
        command.add_option("--rater", options->rater, "Rater's pseudonym, the same for each session");
    command
        .add_option("--score", options->scores,
                    "ITEM=SCORE, 1 (worst) to 5 (best), may be repeated; replaces this rater's earlier score "
                    "of the item")
        .needs(rater)
        .type_name("ITEM=1..5");
    return {command, [options](bool json) {
                if (!options->rater.empty() || !options->scores.empty()) {
                    require_name("--rater", options->rater);
                    std::vector<session::Rating> ratings;
                    for (const std::string& text : options->scores) {
                        ratings.push_back(parse_rating(text, options->rater));
                    }
                    if (ratings.empty()) {
                        throw RatingError("--rater: no scores; expected at least one --score ITEM=1..5");
                    }
                    session::add_ratings(options->file, ratings);
                }
                const auto ratings = session::read_ratings(session::SessionReader(options->file).root());
                if (json) {
                    print({{"file", options->file}, {"ratings", ratings_json(ratings)}});
                    return 0;
                }
                for (const session::Rating& rating : ratings) {
                    std::cout << fmt::format("{:<24}{:<24}{}\n", rating.rater, rating.item, rating.score);
                }
                return 0;
            }};
}

Command add_agreement(CommandLine& app) {
    const auto files = std::make_shared<std::vector<std::filesystem::path>>();
    CommandLine command = app.add_subcommand(
        "agreement", "Agreement of instructors who rated the same sessions: intraclass correlations");
    command.add_option("FILE", *files, "Session files with ratings").required();
    return {command, [files](bool json) {
                constexpr double level = 0.95;
                const auto items = rater_agreement(*files, level);
                if (json) {
                    print({{"level", level}, {"items", to_json(items)}});
                } else {
                    std::cout << to_table(items);
                }
                return 0;
            }};
}

Command add_questionnaire(CommandLine& app) {
    struct Options {
        std::string file, form = "realism", answers;
        bool show = false;
    };
    const auto options = std::make_shared<Options>();
    CommandLine command = app.add_subcommand(
        "questionnaire",
        "Ask the participant, on the terminal or from a file, and store the answers in the session file");
    command.add_option("FILE", options->file, "Session file");
    command.add_option("--form", options->form, "Form by name or path").capture_default_str();
    command.add_option("--answers", options->answers,
                       "YAML file with one answer per line, NAME: ANSWER, instead of asking");
    command.add_flag("--show", options->show, "Print the form and exit");
    return {command, [options](bool json) {
                const Form form = load_form(find_data_file(options->form, "forms"));
                if (options->show) {
                    print_form(form);
                    return 0;
                }
                if (options->file.empty()) {
                    throw RatingError("questionnaire: no session file; expected one, or --show");
                }
                (void)session::SessionReader(options->file);  // check the file before asking questions
                std::vector<session::Answer> answers;
                if (!options->answers.empty()) {
                    answers = load_answers(form, options->answers);
                } else {
                    std::cout << form.title << "\n\n";
                    for (const Form::Question& question : form.questions) {
                        const auto answer = ask(question);
                        if (!answer) {
                            std::cerr << "\neti-review: not all questions were answered; nothing was saved\n";
                            return interrupted;
                        }
                        if (!answer->empty()) {
                            answers.push_back(
                                {form.name, question.name, question.ask, *answer, session::utc_now()});
                        }
                    }
                }
                if (!answers.empty()) {
                    session::add_answers(options->file, answers);
                }
                if (json) {
                    print({{"file", options->file}, {"form", form.name}, {"answers", answers_json(answers)}});
                } else {
                    std::cout << fmt::format("{}: {} of {} questions answered\n", options->file,
                                             answers.size(), form.questions.size());
                }
                return 0;
            }};
}

}  // namespace

std::vector<Command> add_rating_commands(CommandLine& app) {
    return {add_rate(app), add_agreement(app), add_questionnaire(app)};
}

}  // namespace eti::review
