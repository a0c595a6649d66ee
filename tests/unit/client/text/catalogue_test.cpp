// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/text/catalogue.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "client/text/server_sentences.hpp"
#include "common/device/held_tool.hpp"
#include "common/model/aims.hpp"
#include "common/model/attempt_metrics.hpp"
#include "common/model/live_measures.hpp"
#include "common/model/runtime_parameters.hpp"
#include "common/model/tissue.hpp"
#include "common/scenario/preset.hpp"

namespace eti {
namespace {

// Texts of tables outside the client, which are translated where they are shown.
std::vector<std::string> texts_of_tables() {
    std::vector<std::string> out;
    const auto add = [&](std::string_view text) {
        // Numbers as norms are the same in every language.
        if (text.find_first_of("abcdefghijklmnopqrstuvwxyz") != std::string_view::npos &&
            text.front() != '`') {
            out.emplace_back(text);
        }
    };
    for (const LiveMeasureField& field : live_measure_fields) {
        add(field.label);
        add(field.short_label);
    }
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        add(field.label);
        add(field.help);
    }
    for (const MetricField& field : metric_fields) {
        add(field.label);
        add(field.definition);
        add(field.norm);
    }
    for (const Aim& aim : aims) {
        add(aim.practise);
    }
    for (const HandKey& key : hand_keys()) {
        add(key.help);
    }
    for (std::size_t i = 0; i < tissue_count; ++i) {
        // What lies inside is never in the line of sight.
        if (const auto tissue = static_cast<Tissue>(i); !is_bone(tissue) && tissue != Tissue::soft) {
            add(name_of(tissue));
        }
    }
    for (const Preset& preset : load_presets().all) {
        add(preset.name);
        add(preset.description);
    }
    return out;
}

class Catalogues : public ::testing::Test {
  protected:
    ~Catalogues() override { text::set_language("en"); }
};

TEST_F(Catalogues, TranslateTextsOfAllTables) {
    const std::vector<std::string> texts = texts_of_tables();
    EXPECT_GT(texts.size(), 150u);
    for (const text::Language& language : text::languages().subspan(1)) {
        text::set_language(language.code);
        std::set<std::string_view> known;
        for (const auto& [english, translated] : text::entries()) {
            known.insert(english);
        }
        for (const std::string& english : texts) {
            EXPECT_TRUE(known.contains(english)) << language.code << ": " << english;
        }
    }
}

TEST_F(Catalogues, TranslateSelectedLanguageElseEnglish) {
    EXPECT_EQ(text::translate("tongue"), "tongue");
    text::set_language("de");
    EXPECT_EQ(text::translate("tongue"), "Zunge");
    EXPECT_EQ(text::translate_format("attempt {}", 2), "Versuch 2");
    EXPECT_EQ(text::translate("no catalogue has this"), "no catalogue has this");
    EXPECT_EQ(text::translate(""), "") << "not the catalogue's header";
    text::set_language("vi");
    EXPECT_EQ(text::translate("epiglottis"), "nắp thanh môn");
    text::set_language("xx");
    EXPECT_EQ(text::language(), "en");
}

TEST_F(Catalogues, TranslateServersSentencesWithNumbers) {
    const std::string english =
        "the tube's tip lies only 2 mm past the glottis, and 5 mm are required; it took 41.0 s, over the "
        "limit of "
        "30 s";
    EXPECT_EQ(text::translate_sentence(english), english);
    text::set_language("de");
    EXPECT_EQ(
        text::translate_sentence(english),
        "die Tubusspitze liegt nur 2 mm hinter der Glottis; nötig sind 5 mm; es dauerte 41.0 s, länger als "
        "die Grenze von 30 s");
    EXPECT_EQ(text::translate_sentence("the glottis was never seen (best view 3 %)"),
              "die Glottis war nie zu sehen (beste Sicht 3 %)");
    EXPECT_EQ(text::translate_sentence("attempt 1 ended: the blade never entered the mouth"),
              "Versuch 1 beendet: der Spatel war nie im Mund");
    EXPECT_EQ(text::translate_sentence("something new"), "something new");
}

TEST_F(Catalogues, LanguageFollowsEnvironmentLikeGettext) {
    struct Row {
        const char *language, *all, *messages, *lang, *expected;
    };
    for (const Row& row :
         {Row{"", "", "", "de_AT.UTF-8", "de"}, Row{"", "", "fr_FR", "de_DE", "fr"},
          Row{"", "vi_VN.UTF-8", "fr_FR", "de_DE", "vi"}, Row{"ja:es", "", "", "de_DE", "es"},
          Row{"es", "C", "", "", "en"}, Row{"", "", "", "", "en"}, Row{"", "", "", "ja_JP", "en"}}) {
        ::setenv("LANGUAGE", row.language, 1);
        ::setenv("LC_ALL", row.all, 1);
        ::setenv("LC_MESSAGES", row.messages, 1);
        ::setenv("LANG", row.lang, 1);
        EXPECT_EQ(text::language_of_environment(), row.expected) << row.lang << ", " << row.language;
    }
}

}  // namespace
}  // namespace eti
