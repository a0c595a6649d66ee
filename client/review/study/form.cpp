// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/study/form.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <string_view>

#include "common/scenario/yaml_map.hpp"

namespace eti::review {

namespace {

constexpr std::array<std::string_view, 3> kinds{"scale", "yes_no", "words"};
constexpr std::size_t longest_answer = 500;

}  // namespace

Form load_form(const std::filesystem::path& file) {
    Form form;
    YamlMap root = YamlMap::parse(read_text_file(file), file.string());
    form.name = root.name("name", file.stem().string());
    form.title = root.text("title", form.name);
    form.source = root.text("source", "");
    for (YamlMap& entry : root.list("questions")) {
        Form::Question question;
        question.name = entry.name("name", "");
        question.ask = entry.text("ask", "");
        question.kind = static_cast<Form::Kind>(entry.choice("kind", 0, kinds));
        question.low = entry.text("low", "");
        question.high = entry.text("high", "");
        if (question.name.empty() || question.ask.empty()) {
            entry.refuse(question.name.empty() ? "name" : "ask", "nothing",
                         "a question with a name and a text");
        }
        if (std::ranges::find(form.questions, question.name, &Form::Question::name) != form.questions.end()) {
            entry.refuse("name", question.name, "a different name for each question");
        }
        entry.finish();
        form.questions.push_back(std::move(question));
    }
    if (form.questions.empty()) {
        root.refuse("questions", "none", "a list with at least one question");
    }
    root.finish();
    return form;
}

std::string expected_answer(const Form::Question& question) {
    switch (question.kind) {
        case Form::Kind::scale:
            return question.low.empty() && question.high.empty()
                       ? fmt::format("{} to {}", session::lowest_score, session::highest_score)
                       : fmt::format("{} ({}) to {} ({})", session::lowest_score, question.low,
                                     session::highest_score, question.high);
        case Form::Kind::yes_no:
            return "yes or no";
        case Form::Kind::words:
            break;
    }
    return fmt::format("text, at most {} bytes", longest_answer);
}

bool is_valid_answer(const Form::Question& question, const std::string& answer) {
    switch (question.kind) {
        case Form::Kind::scale:
            return answer.size() == 1 && answer[0] >= '0' + session::lowest_score &&
                   answer[0] <= '0' + session::highest_score;
        case Form::Kind::yes_no:
            return answer == "yes" || answer == "no";
        case Form::Kind::words:
            break;
    }
    return !answer.empty() && answer.size() <= longest_answer &&
           std::ranges::none_of(answer, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

std::vector<session::Answer> load_answers(const Form& form, const std::filesystem::path& file) {
    YamlMap root = YamlMap::parse(read_text_file(file), file.string());
    std::vector<session::Answer> answers;
    for (const Form::Question& question : form.questions) {
        if (!root.has(question.name)) {
            continue;
        }
        const std::string answer = root.text(question.name, "");
        if (!is_valid_answer(question, answer)) {
            root.refuse(question.name, answer, expected_answer(question));
        }
        answers.push_back({form.name, question.name, question.ask, answer, session::utc_now()});
    }
    root.finish();
    if (answers.empty()) {
        throw InputError(fmt::format("{}: no answers; expected at least one, such as '{}: ...'",
                                     file.string(), form.questions.front().name));
    }
    return answers;
}

}  // namespace eti::review
