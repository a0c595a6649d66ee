// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "client/review/export.hpp"
#include "client/review/report.hpp"
#include "client/text/catalogue.hpp"
#include "common/scenario/data_file.hpp"
#include "common/session/writer.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/common/session/sample.hpp"

namespace eti::review {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* hostile = "</script><script>alert(1)</script><!--";

class Report : public test::ScratchFolderTest {
  protected:
    template <class Change>
    void record(std::uint64_t steps, const Change& change,
                const std::vector<session::SummaryRecord>& summaries = {}) const {
        session::SessionInfo info = session::sample::info();
        info.scenario = hostile;
        info.scenario_text = "debriefing: was the view held?\n";
        session::SessionWriter writer(path, info, session::sample::scene(), {});
        for (std::uint64_t i = 0; i < steps; ++i) {
            session::StepRecord step = session::sample::step(i);
            step.attempt = 1;
            step.attempt_running = true;
            step.metrics = initial_metrics();
            change(i, step);
            writer.push(step);
        }
        writer.push(session::sample::deformation(0));
        writer.push(session::EventRecord{0, "note", hostile});
        for (const session::SummaryRecord& summary : summaries) {
            writer.push(summary);
        }
        EXPECT_TRUE(writer.close());
    }

    nlohmann::ordered_json json() const {
        return session_json(session::SessionReader(path), summarise(path));
    }

    const std::filesystem::path path = folder / "run.eti.h5";
};

TEST_F(Report, TimelineKeepsSingleStepPeaks) {
    record(600, [](std::uint64_t i, session::StepRecord& step) {
        step.measures.gum_force_n = i == 301 ? 7.5f : 1.0f;
        step.measures.glottic_opening_percent = i == 123 ? 80.0f : 0.0f;
        step.measures.tube_depth_past_glottis = -0.01f;
    });
    const auto samples = json()["samples"];
    EXPECT_EQ(samples["time_s"].size(), 100u);  // 180 Hz to 30 Hz
    const auto greatest = [&](std::size_t line) {
        double most = 0;
        for (const auto& value : samples["lines"][line]["values"]) {
            most = std::max(most, value.get<double>());
        }
        return most;
    };
    EXPECT_EQ(greatest(0), 7.5);
    EXPECT_EQ(greatest(1), 80.0);
}

TEST_F(Report, ListsWorstMissFirstWithItsTime) {
    session::SummaryRecord run;
    run.metrics = initial_metrics();
    run.metrics.oesophageal_entries = 3;  // exceeds its target of none by more than a single entry does
    run.metrics.time_s = 31;              // nearly 30
    run.metrics.cormack_lehane_grade = 1;
    run.metrics.attempts = 1;
    record(600,
           [](std::uint64_t i, session::StepRecord& step) {
               step.metrics.oesophageal_entries = i >= 360 ? 3 : 0;
               step.metrics.time_s = i >= 540 ? 31 : 1;
           },
           {run});
    const auto practise = json()["practise"];
    ASSERT_EQ(practise.size(), 2u);
    EXPECT_EQ(practise[0]["key"], "oesophageal_entries");
    EXPECT_EQ(practise[0]["light"], "missed");
    EXPECT_NEAR(practise[0]["time_s"].get<double>(), 2.0, 1e-6);
    EXPECT_EQ(practise[1]["key"], "time_s");
    EXPECT_EQ(practise[1]["light"], "near");
    EXPECT_NEAR(practise[1]["time_s"].get<double>(), 3.0, 1e-6);
}

TEST_F(Report, HasDebriefingRatingsAndAnswers) {
    record(10, [](std::uint64_t, session::StepRecord&) {});
    session::add_ratings(path, {{"ada", "blade", 4, ""}});
    session::add_answers(path, {{"tlx", "effort", "How hard was it?", "2", ""}});
    EXPECT_EQ(json()["debriefing"], "was the view held?");
    EXPECT_EQ(json()["ratings"][0]["score"], 4);
    EXPECT_EQ(json()["answers"][0]["text"], "How hard was it?");
}

TEST_F(Report, OutcomeIsUnknownWithoutSummary) {
    record(50, [](std::uint64_t, session::StepRecord&) {});
    EXPECT_TRUE(json()["run"]["success"].is_null());
}

TEST_F(Report, HandlesAllNanAndEmptySessions) {
    record(50, [](std::uint64_t, session::StepRecord& step) {
        for (const MetricField& field : metric_fields) {
            step.metrics.*field.value = nan;
        }
        step.measures.gum_force_n = step.measures.glottic_opening_percent =
            step.measures.tube_depth_past_glottis = session::missing_number;
        step.proxy = session::missing_pose();
        step.tube_nodes.assign(session::sample::tube_nodes, Vec3f::Constant(session::missing_number));
    });
    const auto text = nlohmann::ordered_json::parse(escape_for_script(json()));
    for (const auto& value : text["run"]["values"]) {
        EXPECT_TRUE(value.is_null());
    }
    for (const auto& light : text["run"]["lights"]) {
        EXPECT_EQ(light, "");
    }
    EXPECT_TRUE(text["practise"].empty());
    EXPECT_TRUE(text["moments"].empty());
    EXPECT_TRUE(anatomy_json(session::SessionReader(path))["tools"]["time_s"].empty());

    std::filesystem::remove(path);
    record(0, [](std::uint64_t, session::StepRecord&) {});
    EXPECT_TRUE(json()["samples"]["time_s"].empty());
}

TEST_F(Report, EscapesHostileText) {
    record(10, [](std::uint64_t, session::StepRecord&) {});
    const std::string text = escape_for_script(json());
    EXPECT_EQ(text.find('<'), std::string::npos);
    EXPECT_EQ(nlohmann::ordered_json::parse(text)["scenario"], hostile);
    EXPECT_EQ(escape_for_script("\xff<"), "\"\xef\xbf\xbd\\u003c\"");
}

TEST_F(Report, PageEmbedsSessionsAndIsNotOverwritten) {
    if (report_page().empty()) {
        GTEST_SKIP() << "built without the page, as npm was missing";
    }
    record(100, [](std::uint64_t, session::StepRecord&) {});
    const auto never = [] { return false; };
    const ScoreModel score = load_score(find_data_file("scripted", "scores"));
    const auto page = write_report({path, path}, folder / "out", score, never);
    std::stringstream text;
    text << std::ifstream(page).rdbuf();
    const std::string_view begins = "<script type=\"application/json\" id=\"sessions\">";
    const std::size_t from = text.str().find(begins) + begins.size();
    const auto data =
        nlohmann::ordered_json::parse(text.str().substr(from, text.str().find("</script>", from) - from));
    EXPECT_EQ(data["sessions"].size(), 2u);
    EXPECT_TRUE(data["sessions"][0]["score"].is_null()) << "of an outcome that is unknown";
    EXPECT_EQ(data["fields"].size(), metric_fields.size());
    EXPECT_THROW(write_report({path}, folder / "out", score, never), ExportError);
    EXPECT_TRUE(write_report({path}, folder / "stopped", score, [] { return true; }).empty());
}

TEST_F(Report, PageSpeaksSelectedLanguage) {
    if (report_page().empty()) {
        GTEST_SKIP() << "built without the page, as npm was missing";
    }
    record(100, [](std::uint64_t, session::StepRecord&) {});
    text::set_language("de");
    const auto page = write_report({path}, folder / "de", std::nullopt, [] { return false; });
    text::set_language("en");
    std::stringstream text;
    text << std::ifstream(page).rdbuf();
    const auto script = [&](const std::string& id) {
        const std::string begins = "<script type=\"application/json\" id=\"" + id + "\">";
        const std::size_t from = text.str().find(begins) + begins.size();
        return nlohmann::ordered_json::parse(
            text.str().substr(from, text.str().find("</script>", from) - from));
    };
    EXPECT_NE(text.str().find("<html lang=\"de\">"), std::string::npos);
    EXPECT_NE(text.str().find("<title>NeoETI-Bericht</title>"), std::string::npos);
    EXPECT_EQ(script("texts")["To practise"], "Zu üben");
    const auto data = script("sessions");
    EXPECT_EQ(data["fields"][0]["label"], "Kraft am Oberkieferkamm, Maximum");
    EXPECT_EQ(data["fields"][0]["key"], "gum_force_n.max") << "keys are for programs";
    EXPECT_EQ(data["sessions"][0]["events"][0]["text"], hostile) << "what people wrote stays";
}

}  // namespace
}  // namespace eti::review
