// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/panel/model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/math/units.hpp"
#include "panel_scene.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;
using test::PanelScene;

TEST(PanelModel, ListsRuntimeParametersFromPaperFirst) {
    PanelScene one;
    one.say();
    std::vector<std::string> names;
    for (const panel::ParameterRow& row : one.model.rows()) {
        names.push_back(row.name);
        const RuntimeParameterField& field = *find_runtime_parameter(row.name);
        EXPECT_EQ(row.label, field.label);
        EXPECT_EQ(row.unit, field.unit);
        EXPECT_EQ(row.low, field.low);
        EXPECT_EQ(row.high, field.high);
        EXPECT_FLOAT_EQ(row.start, field.default_value()) << row.name;
        EXPECT_FLOAT_EQ(row.now.value_or(NAN), field.default_value()) << row.name;
        EXPECT_EQ(row.help, field.help);
    }
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), runtime_parameter_fields.size());
    // Xiao et al. 2020: size and stiffness of the tongue, head, jaw, table, secretions, stiffness of the
    // tube.
    EXPECT_EQ(std::vector(names.begin(), names.begin() + 7),
              (std::vector<std::string>{"tongue_scale", "tissue_stiffness", "head_elevation", "jaw_opening",
                                        "table_angle", "secretion", "tube_youngs_modulus"}));
    EXPECT_EQ(one.at("view_axes").group, panel::Group::aids);
    EXPECT_EQ(one.at("tube_curve_radius").group, panel::Group::other);
}

TEST(PanelModel, ListsUnknownServerParameter) {
    PanelScene one;
    msg::LiveKey key;
    key.name("gravity");
    key.label("gravity");
    key.unit("m/s2");
    key.per_unit(1.0f);
    key.high(20.0f);
    key.start(9.8f);
    one.source.description.live().push_back(key);
    one.source.description.header().send_time_ns(7);
    one.scene.apply(one.source.description);
    one.say();
    EXPECT_EQ(one.at("gravity").label, "gravity");
    EXPECT_EQ(one.at("gravity").now, std::nullopt) << "its value was not told";
    one.model.request(one.row("gravity"), 3.0f);
    one.model.update(one.now);
    EXPECT_EQ(one.sent, (PanelScene::Sent{{"gravity", 3.0f}}));
}

TEST(PanelModel, ShowsServerValueAndPendingRequest) {
    PanelScene one;
    one.say();
    const std::size_t table = one.row("table_angle");
    one.model.request(table, -10.0f);
    EXPECT_EQ(one.at("table_angle").now, 0.0f);
    EXPECT_EQ(one.at("table_angle").wanted, -10.0f);
    one.model.update(one.now);
    ASSERT_EQ(one.sent.size(), 1u);
    EXPECT_EQ(one.sent[0].first, "table_angle");
    EXPECT_FLOAT_EQ(one.sent[0].second, -10.0f * degree);
    one.live.table_angle = -4.0f * degree;
    one.say();
    EXPECT_FLOAT_EQ(*one.at("table_angle").now, -4.0f);
    EXPECT_EQ(one.at("table_angle").wanted, -10.0f);
    one.live.table_angle = -10.0f * degree;
    one.say();
    EXPECT_EQ(one.at("table_angle").wanted, std::nullopt);
}

TEST(PanelModel, UnfulfilledRequestTimesOut) {
    PanelScene one;
    one.say();
    one.model.request(one.row("table_angle"), -10.0f);
    one.model.update(one.now);
    // At 0.17 rad/s ten degrees take 1.03 s; the model waits for two seconds more.
    one.say(2.9);
    EXPECT_NE(one.at("table_angle").wanted, std::nullopt);
    one.say(0.2);
    EXPECT_EQ(one.at("table_angle").wanted, std::nullopt);
}

TEST(PanelModel, LimitsParameterRateAndSendsFinalValue) {
    PanelScene one;
    one.say();
    const std::size_t tongue = one.row("tongue_scale");
    // A slider dragged for a second at 100 pictures a second.
    for (int i = 0; i <= 100; ++i) {
        one.model.request(tongue, 1.0f + 0.003f * static_cast<float>(i));
        one.model.update(one.now);
        one.now += 10ms;
    }
    EXPECT_EQ(one.sent.size(), 11u);
    one.now += 100ms;
    one.model.update(one.now);
    EXPECT_FLOAT_EQ(one.sent.back().second, 1.3f);
}

TEST(PanelModel, TotalSendRateMatchesServerLimit) {
    PanelScene one;
    one.say();
    // Twenty at once, and twenty a second: see server/app/run/commands/command_queue.hpp.
    for (int i = 0; i < 400; ++i) {
        for (std::size_t row = 0; row < one.model.rows().size(); ++row) {
            one.model.request(row, one.model.rows()[row].low + (i % 2 == 0 ? 0.0f : 1.0f));
        }
        one.model.update(one.now);
        one.now += 10ms;
    }
    EXPECT_NEAR(static_cast<double>(one.sent.size()), 20.0 + 20.0 * 4.0, 1.0);
}

TEST(PanelModel, RefusalIsShownUntilNextRequest) {
    PanelScene one;
    one.say();
    const std::size_t tongue = one.row("tongue_scale");
    one.model.request(tongue, 1.4f);
    one.model.update(one.now);
    const bus::Refusal refusals[] = {{"tongue_scale", "tongue scale 1.4, expected 0.8 to 1.2"}};
    one.model.note_refusals(refusals);
    EXPECT_EQ(one.at("tongue_scale").refusal, refusals[0].reason);
    EXPECT_EQ(one.at("tongue_scale").wanted, std::nullopt);
    EXPECT_EQ(one.at("head_scale").refusal, "");
    one.model.request(tongue, 1.2f);
    EXPECT_EQ(one.at("tongue_scale").refusal, "");
    const bus::Refusal other[] = {{"reset", "nothing has moved yet"}};
    one.model.note_refusals(other);
    EXPECT_EQ(one.model.refusal(), "nothing has moved yet");
}

TEST(PanelModel, ClampsToRangeAndIgnoresNan) {
    PanelScene one;
    one.say();
    one.model.request(one.row("jaw_opening"), 90.0f);
    EXPECT_EQ(one.at("jaw_opening").wanted, 35.0f);
    one.model.request(one.row("jaw_opening"), std::nanf(""));
    EXPECT_EQ(one.at("jaw_opening").wanted, 35.0f);
    one.model.request(one.row("view_axes"), 0.7f);
    EXPECT_EQ(one.at("view_axes").wanted, 1.0f);
}

TEST(PanelModel, PresetRequestsOnlyItsOwnValues) {
    Presets presets;
    presets.all.push_back(
        parse_preset("description: x\nset:\n  tongue_scale: 1.2\n  table_angle_deg: -5\n", "hard.yaml"));
    PanelScene one(true, presets);
    one.say();
    one.model.request(one.model.presets().all[0]);
    one.model.update(one.now);
    ASSERT_EQ(one.sent.size(), 2u);
    EXPECT_EQ(one.sent[0], (std::pair<std::string, float>{"tongue_scale", 1.2f}));
    EXPECT_EQ(one.sent[1].first, "table_angle");
    EXPECT_FLOAT_EQ(one.sent[1].second, -5.0f * degree);
    EXPECT_EQ(one.model.chosen()->name, "hard");
    one.live.tongue_scale = 1.2f;
    one.live.table_angle = -5.0f * degree;
    one.say();
    one.model.request_initial_values(panel::Group::published);
    one.now += 1s;
    one.sent.clear();
    one.model.update(one.now);
    EXPECT_EQ(one.sent.size(), 7u);
    EXPECT_EQ(one.sent[0], (std::pair<std::string, float>{"tongue_scale", 1.0f}));
}

TEST(PanelModel, ObserverSendsNothing) {
    PanelScene one(false);
    one.say();
    EXPECT_FALSE(one.model.commands());
    one.model.request(one.row("tongue_scale"), 1.2f);
    one.model.request("stop");
    one.model.request_initial_values(panel::Group::published);
    one.model.request(parse_preset("description: x\nset:\n  tongue_scale: 1.2\n", "hard.yaml"));
    one.model.update(one.now);
    EXPECT_EQ(one.at("tongue_scale").wanted, std::nullopt);
    EXPECT_EQ(one.at("tongue_scale").now, 1.0f) << "it sees all";
}

TEST(PanelModel, ReportsMissingServerAndDropsCommands) {
    PanelScene one;
    one.say();
    one.served = false;
    one.model.request(one.row("tongue_scale"), 1.2f);
    one.model.request("reset");
    one.model.update(one.now);
    EXPECT_EQ(one.model.refusal(), "no server accepts commands");
    EXPECT_EQ(one.at("tongue_scale").wanted, std::nullopt);
    one.served = true;
    one.now += 1s;
    one.model.update(one.now);
    EXPECT_TRUE(one.sent.empty());
    one.model.request("reset");
    one.model.update(one.now);
    EXPECT_EQ(one.sent.size(), 1u);
    EXPECT_EQ(one.model.refusal(), "");
}

TEST(PanelModel, IsStaleOneSecondAfterLastStatus) {
    PanelScene one;
    EXPECT_TRUE(one.model.stale(one.now));
    one.say();
    EXPECT_FALSE(one.model.stale(one.now));
    one.now += 1001ms;
    // Receiving the same status again is not an update.
    one.model.follow(one.scene, one.connection, one.now);
    EXPECT_TRUE(one.model.stale(one.now));
    EXPECT_NEAR(one.model.silent_s(one.now), 1.001, 1e-6);
    one.say();
    EXPECT_FALSE(one.model.stale(one.now));
}

TEST(PanelModel, SearchMatchesLabelNameAndHelp) {
    PanelScene one;
    one.say();
    EXPECT_TRUE(panel::matches(one.at("tongue_scale"), "Tongue"));
    EXPECT_TRUE(panel::matches(one.at("tissue_stiffness"), "stiff tongue"));
    EXPECT_FALSE(panel::matches(one.at("tissue_stiffness"), "stiff tube"));
    EXPECT_TRUE(panel::matches(one.at("tube_youngs_modulus"), "  pvc "));
    EXPECT_TRUE(panel::matches(one.at("secretion"), ""));
}

TEST(PanelHistory, KeepsLastMinuteAndRestartsWithTime) {
    PanelScene one;
    for (int i = 0; i < 90; ++i) {
        one.gum_force = 0.1f * static_cast<float>(i);
        one.say(1.0);
    }
    const panel::Series& gum = one.model.history().series()[0];
    ASSERT_EQ(gum.field->short_label, "gum force");
    EXPECT_EQ(gum.samples.size(), 61u);
    EXPECT_NEAR(gum.samples.front().time_s, one.time_s - 60.0, 1e-6);
    EXPECT_FLOAT_EQ(gum.samples.back().value, 8.9f);
    EXPECT_FLOAT_EQ(gum.high(), 8.9f);
    const panel::Series& load = one.model.history().series().back();
    EXPECT_FLOAT_EQ(load.samples.back().value, 50.0f);
    EXPECT_EQ(load.high(), 100.0f);
    one.time_s = 0.0;
    one.say(1.0);
    EXPECT_EQ(one.model.history().series()[0].samples.size(), 1u);
}

TEST(PanelHistory, HasNoAirwaySeriesOnManikin) {
    PanelScene one;
    one.manikin = true;
    one.say();
    for (const panel::Series& series : one.model.history().series()) {
        EXPECT_EQ(series.samples.empty(), series.field->short_label != "server's load")
            << series.field->short_label;
    }
}

TEST(PanelHealth, ReportsSilentDevicesAndLosses) {
    PanelScene one;
    one.connection.states = 990;
    one.connection.states_missed = 10;
    one.connection.contested = true;
    one.connection.programs = {"eti-haptics lab:7"};
    one.load = 1.2f;
    one.say();
    const auto line = [&](std::string_view label) {
        for (const panel::HealthLine& each : one.model.health()) {
            if (each.label == label) {
                return each;
            }
        }
        return panel::HealthLine{};
    };
    EXPECT_EQ(line("load").value, "120 % of a step");
    EXPECT_EQ(line("load").level, hud::Level::bad);
    EXPECT_EQ(line("laryngoscope's device").value, "sending");
    EXPECT_EQ(line("laryngoscope's device").level, hud::Level::good);
    EXPECT_EQ(line("tube's device").value, "none");
    EXPECT_EQ(line("shapes lost").value, "10 (1.00 %)");
    EXPECT_EQ(line("shapes lost").level, hud::Level::bad);
    EXPECT_EQ(line("session").value, "two servers: stop one");
    EXPECT_EQ(line("on the bus").value, "eti-haptics lab:7");
    view::SceneView nothing;
    EXPECT_EQ(panel::health_of(nothing, {}, 0.0).front().value, "no data yet");
}

}  // namespace
}  // namespace eti
