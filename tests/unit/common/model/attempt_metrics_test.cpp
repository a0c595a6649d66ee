// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/math/hash.hpp"
#include "common/model/attempt_metrics_json.hpp"
#include "common/model/thresholds.hpp"

namespace eti {
namespace {

// Every field has a distinct value.
AttemptMetrics numbered() {
    AttemptMetrics parameters;
    double next = 0.5;
    for (const MetricField& field : metric_fields) {
        parameters.*field.value = next++;
    }
    return parameters;
}

TEST(AttemptMetrics, TableNamesEveryMemberOnce) {
    EXPECT_EQ(sizeof(AttemptMetrics), metric_fields.size() * sizeof(double))
        << "a member stands not in the table";
    const AttemptMetrics parameters = numbered();
    std::set<double> values;
    std::set<std::string_view> keys;
    for (const MetricField& field : metric_fields) {
        values.insert(parameters.*field.value);
        keys.insert(field.key);
    }
    EXPECT_EQ(values.size(), metric_fields.size()) << "a member stands twice in the table";
    EXPECT_EQ(keys.size(), metric_fields.size()) << "a key stands twice in the table";
}

TEST(AttemptMetrics, PaperMetricsHaveTheirKeys) {
    const nlohmann::ordered_json json = metrics_to_json(numbered());
    for (const char* name :
         {"gum_force_n", "blade_depth_cm", "glottic_opening_percent", "tube_speed_cm_per_s"}) {
        EXPECT_TRUE(json.at(name).at("max").is_number()) << name;
        EXPECT_TRUE(json.at(name).at("mean").is_number()) << name;
    }
    for (const char* name : {"pitch_peaks", "yaw_peaks", "pitch_rocking_deg", "yaw_rocking_deg", "attempts",
                             "time_s", "head_elevation_deg", "oesophageal_entries", "tube_depth_at_lip_cm"}) {
        EXPECT_TRUE(json.at(name).is_number()) << name;
    }
    EXPECT_EQ(std::count_if(metric_fields.begin(), metric_fields.end(),
                            [](const MetricField& field) { return field.in_paper; }),
              16);
    EXPECT_EQ(json.at("gum_force_n").at("max"), numbered().gum_force_max_n);
}

TEST(AttemptMetrics, NonFiniteValuesAreNull) {
    AttemptMetrics parameters = numbered();
    parameters.tube_speed_mean_cm_per_s = std::numeric_limits<double>::quiet_NaN();
    parameters.time_s = std::numeric_limits<double>::infinity();
    const auto json = nlohmann::json::parse(metrics_to_json(parameters).dump());
    EXPECT_TRUE(json.at("tube_speed_cm_per_s").at("mean").is_null());
    EXPECT_TRUE(json.at("time_s").is_null());
    EXPECT_EQ(json.at("tube_speed_cm_per_s").at("max"), parameters.tube_speed_max_cm_per_s);
}

TEST(AttemptMetrics, JsonKeepsTheOrderOfDisplay) {
    const nlohmann::ordered_json json = metrics_to_json(numbered());
    EXPECT_EQ(json.begin().key(), "gum_force_n");
    EXPECT_EQ(std::prev(json.end()).key(), "heart_rate_per_min");
}

// FNV-1a over everything that defines a metric. If this fails because a definition or a number has changed,
// raise definitions_version too, and record the current hash beside it. Better wording alone keeps the
// version.
TEST(AttemptMetrics, DefinitionsMatchTheirVersion) {
    Hash hash;
    for (const MetricField& field : metric_fields) {
        for (const std::string_view text :
             {field.key, field.unit, describe(field.combine), field.definition}) {
            hash.add(text);
        }
    }
    for (const Threshold& threshold : thresholds) {
        hash.add(threshold.name);
        hash.add(fmt::format("{}", threshold.value));
        hash.add(threshold.unit);
        hash.add(threshold.meaning);
    }
    EXPECT_EQ(definitions_version, 1u);
    EXPECT_EQ(fmt::format("{:016x}", hash.value()), "a07cd526ac661809");
}

}  // namespace
}  // namespace eti
