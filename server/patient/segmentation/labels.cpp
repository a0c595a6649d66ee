// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/labels.hpp"

#include <algorithm>
#include <cctype>

namespace eti::segmentation {

std::optional<Label> label_named(std::string_view name) {
    struct Word {
        std::string_view word;
        Label label;
    };
    // The more specific words come first: "jaw bone" is the mandible.
    static constexpr std::array<Word, 14> words = {{{"enclosed air", Label::enclosed_air},
                                                    {"enclosed_air", Label::enclosed_air},
                                                    {"airway", Label::airway},
                                                    {"jaw", Label::mandible},
                                                    {"mandible", Label::mandible},
                                                    {"spine", Label::spine},
                                                    {"skull", Label::bone},
                                                    {"bone", Label::bone},
                                                    {"epiglottis", Label::epiglottis},
                                                    {"tongue", Label::tongue},
                                                    {"soft tissue", Label::soft},
                                                    {"head", Label::soft},
                                                    {"body", Label::soft},
                                                    {"skin", Label::soft}}};
    std::string lower(name);
    std::ranges::transform(lower, lower.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const auto found = std::ranges::find_if(
        words, [&](const Word& one) { return lower.find(one.word) != std::string::npos; });
    return found == words.end() ? std::nullopt : std::optional(found->label);
}

}  // namespace eti::segmentation
