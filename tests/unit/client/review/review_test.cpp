// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include "client/review/export.hpp"
#include "client/review/summary.hpp"
#include "common/session/writer.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/common/session/sample.hpp"

namespace eti::review {
namespace {

class Review : public test::ScratchFolderTest {
  protected:
    void record(std::uint64_t steps, const std::vector<session::SummaryRecord>& summaries,
                const std::string& event = "began") const {
        session::SessionWriter writer(path, session::sample::info(), session::sample::scene(), {});
        for (std::uint64_t i = 0; i < steps; ++i) {
            writer.push(session::sample::step(i));
        }
        writer.push(session::EventRecord{0, "attempt", event});
        for (const session::SummaryRecord& summary : summaries) {
            writer.push(summary);
        }
        EXPECT_TRUE(writer.close());
    }

    const std::filesystem::path path = folder / "run.eti.h5";
};

session::SummaryRecord attempt(std::uint32_t number, double gum_force) {
    session::SummaryRecord record;
    record.attempt = number;
    record.outcome.reason = "attempt " + std::to_string(number) + " ended";
    record.metrics.gum_force_max_n = gum_force;
    record.metrics.tube_speed_max_cm_per_s = std::numeric_limits<double>::quiet_NaN();
    return record;
}

TEST_F(Review, SummarisesAndExportsNotesAndAnnotations) {
    {
        session::SessionWriter writer(path, session::sample::info(), session::sample::scene(), {});
        writer.push(session::sample::step(0));
        writer.push(session::EventRecord{0, "attempt", "began"});
        writer.push(session::EventRecord{1'500'000'000, "note", "desk:7: lift"});
        writer.push(session::EventRecord{2'500'000'000, "annotation", "desk:7 points at tongue"});
        writer.push(session::AnnotationRecord{2'500'000'000,
                                              "point",
                                              "desk:7",
                                              "say \"ah\"",
                                              "tongue",
                                              {{9, 0.25f, 0.5f, 0.001f}},
                                              {Vec3f(1, 2, 3)}});
        ASSERT_TRUE(writer.close());
    }
    const Summary summary = summarise(path);
    const auto json = to_json(summary);
    ASSERT_EQ(json.at("remarks").size(), 2u);
    EXPECT_EQ(json.at("remarks")[0].at("text"), "desk:7: lift");
    EXPECT_EQ(json.at("remarks")[0].at("time_s").get<double>(), 1.5);
    EXPECT_NE(to_table(summary).find("Remarks\n       1.5 s  desk:7: lift\n       2.5 s  desk:7 points"),
              std::string::npos)
        << to_table(summary);
    (void)export_csv(
        path, folder / "csv", [](const auto&) {}, [] { return false; });
    std::ifstream file(folder / "csv" / "annotations.csv");
    std::string head, row;
    std::getline(file, head);
    std::getline(file, row);
    EXPECT_EQ(head, "time [s],kind,sender,text,object,triangle,u,v,height [m],x [m],y [m],z [m]\r");
    EXPECT_EQ(
        row,
        "2.500000000,\"point\",\"desk:7\",\"say \"\"ah\"\"\",\"tongue\",9,0.25,0.5,0.00100000005,1,2,3\r");
}

TEST_F(Review, LiquidAndTissueAreExported) {
    session::SceneRecord scene = session::sample::scene();
    scene.liquid = true;
    {
        session::SessionWriter writer(path, session::sample::info(), scene, {});
        session::StepRecord step = session::sample::step(0);
        step.runtime_parameters.tissue_stiffness = 12e3f;
        writer.push(step);
        writer.push(session::FluidRecord{500'000'000, {Vec3f(1, 2, 3), Vec3f(4, 5, 0.25f)}});
        ASSERT_TRUE(writer.close());
    }
    (void)export_csv(
        path, folder / "csv", [](const auto&) {}, [] { return false; });
    const auto text = [&](const char* name) {
        std::ifstream file(folder / "csv" / name);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    EXPECT_EQ(text("fluid.csv"),
              "time [s],x [m],y [m],z [m]\r\n0.500000000,1,2,3\r\n0.500000000,4,5,0.25\r\n");
    EXPECT_NE(text("tissue.csv").find("12000"), std::string::npos) << text("tissue.csv");
}

TEST_F(Review, JsonUsesDesignNamesAndNullIfMissing) {
    record(10, {attempt(1, 2.5), attempt(2, 3.5), attempt(0, 3.5)});
    const auto json = to_json(summarise(path));
    EXPECT_FALSE(json.at("success").get<bool>());
    EXPECT_EQ(json.at("reason"), "attempt 0 ended");
    EXPECT_EQ(json.at("parameters").at("gum_force_n").at("max").get<double>(), 3.5);
    EXPECT_TRUE(json.at("parameters").at("tube_speed_cm_per_s").at("max").is_null());
    ASSERT_EQ(json.at("attempts").size(), 2u);
    EXPECT_EQ(json.at("attempts")[0].at("attempt"), 1);
    EXPECT_EQ(json.at("attempts")[0].at("parameters").at("gum_force_n").at("max").get<double>(), 2.5);
    EXPECT_EQ(json.at("file"), path.string());
    EXPECT_EQ(json.at("scenario"), "term");
    EXPECT_NEAR(json.at("duration_s").get<double>(), 9.0 / 180.0, 1e-7);
    for (const MetricField& field : metric_fields) {
        const std::string key(field.key.substr(0, field.key.find('.')));
        EXPECT_TRUE(json.at("parameters").contains(key)) << key;
    }
}

// Two attempts; the recording ends in the second, after the tube has passed the glottis.
TEST_F(Review, ComputesMissingSummaryFromSteps) {
    {
        session::SessionWriter writer(path, session::sample::info(), session::sample::scene(), {});
        for (std::uint64_t i = 0; i < 360; ++i) {
            session::StepRecord step = session::sample::step(i);
            step.attempt = i < 100 ? 1 : 2;
            step.attempt_running = i < 90 || i >= 100;
            step.measures.tube_depth_past_glottis = i < 180 ? -0.01f : 0.012f;
            step.metrics = {};
            step.metrics.gum_force_max_n = i < 100 ? 3.0 : 2.0;
            step.metrics.gum_force_mean_n = i < 100 ? 0.5 : 1.0;
            step.metrics.time_s = i < 90 ? static_cast<double>(i) / 180.0 : i < 100 ? 0.5 : 1.5;
            step.metrics.tube_speed_mean_cm_per_s = 7.0;
            step.metrics.attempts = 1;
            writer.push(step);
        }
        EXPECT_TRUE(writer.close());
    }
    const Summary summary = summarise(path);
    EXPECT_FALSE(summary.has_run);
    EXPECT_EQ(summary.unfinished_attempt, 2u);
    const auto json = to_json(summary);
    EXPECT_TRUE(json.at("success").is_null());
    EXPECT_TRUE(json.at("attempts")[0].at("success").is_null());
    EXPECT_EQ(json.at("reason"),
              "the recording ends at 2.0 s, before the results were computed; the tube passed the glottis at "
              "1.0 s and lay 12 mm beyond it");
    const auto& run = json.at("parameters");
    EXPECT_EQ(run.at("gum_force_n").at("max").get<double>(), 3.0);
    EXPECT_NEAR(run.at("gum_force_n").at("mean").get<double>(), (0.5 * 0.5 + 1.5 * 1.0) / 2.0, 1e-12);
    EXPECT_EQ(run.at("time_s").get<double>(), 2.0);
    EXPECT_EQ(run.at("attempts").get<double>(), 2.0);
    EXPECT_TRUE(run.at("tube_speed_cm_per_s").at("mean").is_null()) << "its weights are not recorded";
    EXPECT_EQ(json.at("attempts")[0].at("parameters").at("gum_force_n").at("max").get<double>(), 2.0);
    EXPECT_NE(to_table(summary).find("unknown: the recording ends"), std::string::npos);
}

TEST_F(Review, TableListsPaperParametersFirst) {
    record(10, {attempt(1, 2.5), attempt(0, 3.5)});
    const std::string table = to_table(summarise(path));
    std::size_t position = 0;
    for (const bool in_paper : {true, false}) {
        for (const MetricField& field : metric_fields) {
            if (field.in_paper == in_paper) {
                const std::size_t found = table.find("  " + std::string(field.label) + " ", position);
                ASSERT_NE(found, std::string::npos) << field.label;
                position = found;
            }
        }
    }
    const std::size_t line = table.find("force on the upper gum, maximum");
    const std::string row = table.substr(line, table.find('\n', line) - line);
    EXPECT_LT(row.find("3.50"), row.find("2.50")) << "the run stands before its attempts: " << row;
}

TEST_F(Review, TableWidthIsBoundedForManyAttempts) {
    std::vector<session::SummaryRecord> all;
    for (std::uint32_t i = 0; i <= 11; ++i) {
        all.push_back(attempt(i, i));
    }
    record(10, all);
    std::istringstream table(to_table(summarise(path)));
    std::string line;
    std::size_t widest = 0;
    std::string text;
    while (std::getline(table, line)) {
        widest = std::max(widest, line.size());
        text += line;
    }
    EXPECT_LE(widest, 110u);
    for (const session::SummaryRecord& record : all) {
        if (record.attempt > 0) {
            EXPECT_NE(text.find(" attempt " + std::to_string(record.attempt)), std::string::npos);
        }
    }
}

TEST_F(Review, ExportQuotesText) {
    record(10, {}, "the \"blade\", or so\nit says");
    export_csv(
        path, folder / "csv", [](const auto&) {}, [] { return false; });
    std::ifstream file(folder / "csv" / "events.csv", std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    EXPECT_EQ(text,
              "time [s],kind,text\r\n0.000000000,\"attempt\",\"the \"\"blade\"\", or so\nit says\"\r\n");
}

TEST_F(Review, StoppedExportLeavesOnlyCompleteFiles) {
    record(200, {});
    int asked = 0;
    const auto written = export_csv(
        path, folder / "csv", [](const auto&) {}, [&] { return ++asked > 250; });
    EXPECT_EQ(written.size(), 2u) << "the inputs' 200 rows, no command, and then half the tools";
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "csv"), {}), 2);
}

TEST_F(Review, ExportErrorNamesUnwritableFolder) {
    record(10, {});
    std::ofstream(folder / "csv") << "a file where the folder should be";
    EXPECT_EQ(
        eti::test::error_of<std::runtime_error>([&] {
            export_csv(
                path, folder / "csv", [](const auto&) {}, [] { return false; });
        }),
        (folder / "csv").string() + ": cannot create the folder: Not a directory; choose another with --out");
}

}  // namespace
}  // namespace eti::review
