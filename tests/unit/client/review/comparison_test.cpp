// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/comparison.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "client/review/output.hpp"
#include "client/review/study/form.hpp"
#include "client/review/study/ratings.hpp"
#include "common/scenario/data_file.hpp"
#include "common/session/writer.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/common/session/sample.hpp"

namespace eti::review {
namespace {

class Study : public test::ScratchFolderTest {
  protected:
    /// A session of three steps whose run took `time` with that force on the gum; without `ends` it is cut
    /// off.
    std::filesystem::path session(const std::string& name, const std::string& participant, double time,
                                  double gum = 1.0, bool ends = true,
                                  const std::string& quality = "full") const {
        session::SessionInfo info = session::sample::info();
        info.more[session::quality_text] = quality;
        if (!participant.empty()) {
            info.more["participant"] = participant;
        }
        const std::filesystem::path path = folder / (name + ".eti.h5");
        session::SessionWriter writer(path, info, session::sample::scene(), {});
        for (std::uint64_t i = 0; i < 3; ++i) {
            writer.push(session::sample::step(i));
        }
        if (ends) {
            session::SummaryRecord run;
            run.outcome = {time < 20.0, "it ended"};
            run.metrics = initial_metrics();
            run.metrics.time_s = time;
            run.metrics.gum_force_max_n = gum;
            writer.push(run);
        }
        EXPECT_TRUE(writer.close());
        return path;
    }

    static Comparison compared(const GroupFiles& files, bool paired) {
        Comparison comparison = read_groups(files, [](const auto&) {});
        comparison.paired = paired;
        comparison.how.resamples = 2000;
        compare(comparison);
        return comparison;
    }

    static const MeasureRow& row(const Comparison& comparison, std::string_view key) {
        return *std::ranges::find_if(comparison.rows,
                                     [key](const MeasureRow& r) { return r.measure->key == key; });
    }

    std::string refusal(const GroupFiles& files, bool paired = false) const {
        return eti::test::error_of<ComparisonError>([&] { (void)compared(files, paired); });
    }
};

TEST_F(Study, GroupsHaveMeansDeviationsAndDifferences) {
    const Comparison found =
        compared({{"easy", {session("a", "", 10), session("b", "", 14)}},
                  {"hard", {session("c", "", 20), session("d", "", 26), session("e", "", 29)}}},
                 false);
    const MeasureRow& time = row(found, "time_s");
    EXPECT_EQ(time.groups[0].count, 2u);
    EXPECT_EQ(time.groups[1].count, 3u);
    EXPECT_DOUBLE_EQ(time.groups[0].mean, 12.0);
    EXPECT_DOUBLE_EQ(time.groups[1].mean, 25.0);
    EXPECT_NEAR(time.groups[0].deviation, std::sqrt(8.0), 1e-12);
    EXPECT_NEAR(time.groups[1].deviation, std::sqrt(21.0), 1e-12);
    ASSERT_EQ(time.contrasts.size(), 1u);
    EXPECT_DOUBLE_EQ(time.contrasts[0].difference.value, 13.0);
    // Two and three values bound no interval.
    EXPECT_TRUE(std::isnan(time.contrasts[0].difference.interval.low));
    ASSERT_EQ(found.remarks.size(), 2u);
    EXPECT_EQ(found.remarks[0].rfind("2 sessions in group easy: fewer than 10", 0), 0u) << found.remarks[0];
    EXPECT_DOUBLE_EQ(row(found, "success_percent").groups[0].mean, 100.0);
    EXPECT_DOUBLE_EQ(row(found, "success_percent").groups[1].mean, 0.0);
    // Only one test of the paper's measures is informative: Holm counts it alone.
    EXPECT_DOUBLE_EQ(time.contrasts[0].p_adjusted, time.contrasts[0].difference.p);
    // A tube that never entered a mouth has no speed in any session.
    EXPECT_EQ(std::ranges::count_if(
                  found.rows, [](const auto& r) { return r.measure->key == "tube_speed_cm_per_s.max"; }),
              0);
}

TEST_F(Study, PairsSessionsByParticipant) {
    const Comparison found =
        compared({{"before", {session("a1", "P1", 30), session("a2", "P2", 20), session("a3", "P3", 15)}},
                  {"after", {session("b2", "P2", 15), session("b4", "P4", 99), session("b1", "P1", 22)}}},
                 true);
    const Contrast& time = row(found, "time_s").contrasts[0];
    EXPECT_EQ(time.pairs, 2u);
    EXPECT_DOUBLE_EQ(time.difference.value, -6.5);  // (22 - 30 + 15 - 20) / 2
    ASSERT_EQ(found.remarks.size(), 3u);
    EXPECT_EQ(found.remarks[2].rfind("2 pairs: fewer than 10", 0), 0u) << found.remarks[2];
    EXPECT_NE(found.remarks[0].find("P3"), std::string::npos);
    EXPECT_NE(found.remarks[1].find("P4"), std::string::npos);
}

TEST_F(Study, RemarksOnSessionsOfReducedQuality) {
    const GroupFiles mixed = {{"a", {session("1", "", 10, 1.0, true, "reduced"), session("2", "", 20)}},
                              {"b", {session("3", "", 11), session("4", "", 23)}}};
    const Comparison found = compared(mixed, false);
    ASSERT_FALSE(found.remarks.empty());
    EXPECT_EQ(found.remarks[0].rfind("1 of 4 sessions were simulated at reduced quality", 0), 0u)
        << found.remarks[0];
    const GroupFiles alike = {{"a", {session("5", "", 10, 1.0, true, "reduced")}},
                              {"b", {session("6", "", 11, 1.0, true, "reduced")}}};
    for (const std::string& remark : compared(alike, false).remarks) {
        EXPECT_EQ(remark.find("quality"), std::string::npos) << remark;
    }
}

TEST_F(Study, PairsSessionsByOrderWithoutParticipants) {
    const Comparison found = compared({{"a", {session("1", "", 10), session("2", "", 20)}},
                                       {"b", {session("3", "", 11), session("4", "", 23)}}},
                                      true);
    EXPECT_DOUBLE_EQ(row(found, "time_s").contrasts[0].difference.value, 2.0);
    EXPECT_EQ(found.remarks.size(), 2u);
}

TEST_F(Study, RejectsInvalidComparisonsWithReason) {
    const auto one = session("1", "P1", 10), two = session("2", "P2", 12), third = session("3", "P1", 12),
               plain = session("4", "", 9), cut = session("5", "P2", 0, 0, false);
    EXPECT_NE(refusal({{"a", {one}}}).find("one group"), std::string::npos);
    EXPECT_NE(refusal({{"a", {one}}, {"a", {two}}}).find("given twice"), std::string::npos);
    EXPECT_NE(refusal({{"a", {one}}, {"b", {one}}}).find("counts once"), std::string::npos);
    EXPECT_NE(refusal({{"a", {one}}, {"b", {cut}}}).find("known outcome"), std::string::npos);
    EXPECT_NE(refusal({{"a", {one, third}}, {"b", {two}}}, true).find("both of participant P1"),
              std::string::npos);
    EXPECT_NE(refusal({{"a", {one}}, {"b", {plain}}}, true).find("1 of 2 files name no participant"),
              std::string::npos);
    EXPECT_NE(refusal({{"a", {one}}, {"b", {two}}}, true).find("0 participants"), std::string::npos);
    // A truncated session is left out and reported.
    const Comparison found = compared({{"a", {one}}, {"b", {two, cut}}}, false);
    EXPECT_EQ(found.groups[1].sessions.size(), 1u);
    ASSERT_EQ(found.remarks.size(), 3u);  // and two on the groups' sizes
    EXPECT_NE(found.remarks[0].find("5.eti.h5 is excluded"), std::string::npos);
}

TEST(Csv, FormulasAreNotRun) {
    EXPECT_EQ(csv_text("P1"), "\"P1\"");
    EXPECT_EQ(csv_text("=HYPERLINK(\"x\")"), "\"'=HYPERLINK(\"\"x\"\")\"");
    for (const char* text : {"+1", "-1", "@SUM(A1)", "\t=1", "\r=1"}) {
        EXPECT_EQ(csv_text(text), "\"'" + std::string(text) + "\"");
    }
}

TEST_F(Study, CsvHasOneRowPerSession) {
    const Comparison found = compared(
        {{"a", {session("1", "P1", 10, 2.5)}}, {"b \"x\"", {session("2", "P\"2", 12), session("3", "", 40)}}},
        false);
    const std::string csv = to_csv(found);
    EXPECT_EQ(std::ranges::count(csv, '\n'), 4);
    EXPECT_TRUE(csv.starts_with("file,group,participant,scenario,operator,seed,success,gum_force_n.max,"))
        << csv;
    EXPECT_NE(csv.find("1.eti.h5\",\"a\",\"P1\",\"term\",\"expert\",18364758544493064720,1,2.5,"),
              std::string::npos)
        << csv;
    EXPECT_NE(csv.find("\"b \"\"x\"\"\",\"P\"\"2\""), std::string::npos);
    const std::string head = csv.substr(0, csv.find('\r'));
    std::string row = csv.substr(csv.rfind("\r\n", csv.size() - 3) + 2);
    EXPECT_EQ(std::ranges::count(head, ','), std::ranges::count(row, ','));
}

TEST_F(Study, HtmlPageEscapesText) {
    const Comparison found = compared({{"<script>alert(1)</script>", {session("1", "\"><img src=x>", 10)}},
                                       {"b", {session("2", "", 12), session("3", "", 14)}}},
                                      false);
    const std::string page = to_html(found);
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("<img"), std::string::npos);
    EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos);
    EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST_F(Study, ComputesRaterAgreementPerItem) {
    std::vector<std::filesystem::path> files;
    const int scores[4][2] = {{1, 2}, {3, 3}, {4, 5}, {5, 5}};
    for (int i = 0; i < 4; ++i) {
        files.push_back(session(std::to_string(i), "", 10));
        const std::string a = "overall=" + std::to_string(scores[i][0]),
                          b = "overall=" + std::to_string(scores[i][1]);
        session::add_ratings(files.back(), {parse_rating(a, "ann"), parse_rating("lift=2", "ann")});
        session::add_ratings(files.back(), {parse_rating(b, "bob")});
    }
    files.push_back(session("half", "", 10));
    session::add_ratings(files.back(), {parse_rating("overall=4", "bob")});
    const auto items = rater_agreement(files, 0.95);
    ASSERT_EQ(items.size(), 2u);
    EXPECT_EQ(items[1].item, "overall");
    EXPECT_EQ(items[1].sessions, 4u);
    EXPECT_EQ(items[1].left_out, 1u);
    const Agreement expected = agreement({{1, 2}, {3, 3}, {4, 5}, {5, 5}}, 0.95);
    EXPECT_EQ(items[1].value.single, expected.single);
    EXPECT_TRUE(std::isnan(items[0].value.single));  // one rater
    EXPECT_THROW((void)rater_agreement({session("none", "", 1)}, 0.95), RatingError);
}

TEST_F(Study, RatingsUseFivePointScale) {
    EXPECT_EQ(parse_rating("a=1", "x").score, 1);
    EXPECT_EQ(parse_rating("depth-of_tube2=5", "x").item, "depth-of_tube2");
    for (const char* text : {"a=0", "a=6", "a=", "=3", "a", "a b=3", "a=3.5", "a=10", "a=-1", "a= 3"}) {
        EXPECT_THROW((void)parse_rating(text, "x"), RatingError) << text;
    }
}

TEST_F(Study, FormAcceptsValidAnswersOnly) {
    const auto write = [&](const char* name, const std::string& text) {
        std::ofstream(folder / name) << text;
        return folder / name;
    };
    const Form form =
        load_form(write("form.yaml",
                        "name: f\nquestions:\n  - {name: look, ask: \"Looks real?\", low: no, high: yes}\n"
                        "  - {name: hard, ask: \"Hard?\", kind: yes_no}\n"
                        "  - {name: missing, ask: \"What is missing?\", kind: words}\n"));
    ASSERT_EQ(form.questions.size(), 3u);
    EXPECT_TRUE(is_valid_answer(form.questions[0], "5"));
    for (const char* no : {"0", "6", "", "4.5", "yes"}) {
        EXPECT_FALSE(is_valid_answer(form.questions[0], no)) << no;
    }
    EXPECT_FALSE(is_valid_answer(form.questions[1], "maybe"));
    EXPECT_FALSE(is_valid_answer(form.questions[2], "a\x1b[2J"));
    const auto answers = load_answers(form, write("answers.yaml", "look: 4\nmissing: foam, above all\n"));
    ASSERT_EQ(answers.size(), 2u);
    EXPECT_EQ(answers[0].answer, "4");
    EXPECT_EQ(answers[1].text, "What is missing?");
    EXPECT_THROW((void)load_answers(form, write("a.yaml", "look: 9\n")), InputError);
    EXPECT_THROW((void)load_answers(form, write("b.yaml", "other: 3\n")), InputError);
    EXPECT_THROW((void)load_form(write("c.yaml", "name: f\n")), InputError);
    EXPECT_THROW((void)load_form(write("d.yaml", "questions: [{name: a, ask: b}, {name: a, ask: c}]\n")),
                 InputError);
}

TEST_F(Study, ShippedFormsAreValid) {
    for (const std::string& name : data_names("forms")) {
        EXPECT_FALSE(load_form(find_data_file(name, "forms")).questions.empty()) << name;
    }
    EXPECT_GE(data_names("forms").size(), 1u);
}

}  // namespace
}  // namespace eti::review
