// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/text/server_sentences.hpp"

#include <fmt/args.h>

#include <array>
#include <optional>
#include <vector>

#include "client/text/catalogue.hpp"

namespace eti::text {
namespace {

constexpr std::string_view gap = "{}";

// Longer sentences before those that they contain.
constexpr std::array sentence_table{
    translatable("attempt {} ended: {}"),
    translatable("{}; it took {} s, over the limit of {} s"),
    translatable("the tube went into the oesophagus at {} s and did not reach the trachea afterwards"),
    translatable("the tube went into the oesophagus at {} s"),
    translatable("the tube had reached the trachea but slipped out at {} s"),
    translatable("the blade never entered the mouth"),
    translatable("the glottis was never seen ({})"),
    translatable("the tube never entered the mouth ({})"),
    translatable("the tube's tip came no nearer than {} mm to the glottis ({})"),
    translatable("the tube's tip lies {} mm past the carina, in a main bronchus"),
    translatable("the tube's tip lies only {} mm past the glottis, and {} mm are required"),
    translatable("the tube's tip lies {} mm past the glottis, {} mm above the carina"),
    translatable("best view {} %"),
    // Of the automatic score, in reports.
    translatable(
        "Fitted to {} sessions of {} operators with {} patients, graded by {}. No human data was used: it "
        "measures how close a session is to a skilled script, not how good a person is."),
    translatable("Fitted to {} sessions of {} operators with {} patients, graded by {}."),
    translatable("attempt {} takes longer than {} s"),
    translatable("attempt {} does not count: the blade was in the mouth for {} s"),
    translatable("attempt {} began"),
    translatable("the glottis came into view"),
    translatable("the tube passed the glottis"),
    translatable("the tube left the trachea"),
    translatable("the tube went into the oesophagus"),
    translatable("the tube left the oesophagus"),
    translatable("the tube passed the carina"),
    translatable("the tube came back above the carina"),
    translatable("the oxygen saturation fell below 80 %"),
    translatable("the oxygen saturation is above 80 % again"),
    translatable("the heart rate fell below 100 a minute"),
    translatable("the heart rate is above 100 a minute again"),
    translatable("this is the last session; start the server with several: --scenario A --scenario B"),
    translatable("there is no liquid in this scenario; restart it with 'saliva: standby', which starts "
                 "without saliva"),
};

/// The parts of `text` in place of the gaps; nullopt if it is not such a sentence.
std::optional<std::vector<std::string_view>> match(std::string_view text, std::string_view sentence) {
    std::vector<std::string_view> parts;
    std::size_t in_text = 0, in_sentence = 0;
    while (true) {
        const std::size_t next = sentence.find(gap, in_sentence);
        const std::string_view fixed = sentence.substr(in_sentence, next - in_sentence);
        const bool last = next == std::string_view::npos;
        std::size_t found = in_text;
        if (!parts.empty() || in_sentence > 0) {
            // A gap precedes: at the end the fixed part is the text's end, else its first occurrence.
            found = last ? (text.ends_with(fixed) && text.size() >= fixed.size() + in_text
                                ? text.size() - fixed.size()
                                : std::string_view::npos)
                         : text.find(fixed, in_text);
            if (found == std::string_view::npos || found == in_text) {
                return std::nullopt;
            }
            parts.push_back(text.substr(in_text, found - in_text));
        } else if (!text.starts_with(fixed)) {
            return std::nullopt;
        }
        in_text = found + fixed.size();
        if (last) {
            return in_text == text.size() ? std::optional(parts) : std::nullopt;
        }
        in_sentence = next + gap.size();
    }
}

}  // namespace

std::span<const std::string_view> server_sentences() {
    return sentence_table;
}

std::string translate_sentence(std::string_view english) {
    if (language() == languages().front().code) {
        return std::string(english);
    }
    for (const std::string_view sentence : sentence_table) {
        const auto parts = match(english, sentence);
        if (!parts) {
            continue;
        }
        fmt::dynamic_format_arg_store<fmt::format_context> arguments;
        for (const std::string_view part : *parts) {
            arguments.push_back(translate_sentence(part));
        }
        return translate_arguments(sentence, arguments);
    }
    return std::string(translate(english));
}

}  // namespace eti::text
