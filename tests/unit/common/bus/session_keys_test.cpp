// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/security/session_keys.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/session_description.hpp"

namespace eti::bus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

SessionKeys believed(const msg::SessionDescription& message) {
    std::string why;
    auto keys = SessionKeys::of(message, why);
    EXPECT_TRUE(keys) << why;
    return keys.value_or(SessionKeys());
}

std::string refusal_of_description(const msg::SessionDescription& message) {
    std::string why;
    return SessionKeys::of(message, why) ? "believed" : why;
}

/// Each runtime parameter with a distinct number.
RuntimeParameters numbered() {
    RuntimeParameters values;
    float next = 0.5f;
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        values.*field.value = next++;
    }
    return values;
}

TEST(SessionKeys, NamesOfTheTablesFitTheWire) {
    const msg::SessionDescription message = test::session_description();
    ASSERT_EQ(message.live().size(), runtime_parameter_fields.size());
    for (std::size_t i = 0; i < runtime_parameter_fields.size(); ++i) {
        EXPECT_EQ(message.live()[i].name().to_string(), runtime_parameter_fields[i].name);
        EXPECT_EQ(message.live()[i].label().to_string(), runtime_parameter_fields[i].label);
        EXPECT_EQ(message.live()[i].unit().to_string(), runtime_parameter_fields[i].unit);
        EXPECT_EQ(message.live()[i].help().to_string(), runtime_parameter_fields[i].help);
    }
    ASSERT_EQ(message.parameters().size(), metric_fields.size());
    for (std::size_t i = 0; i < metric_fields.size(); ++i) {
        EXPECT_EQ(message.parameters()[i].name().to_string(), metric_fields[i].key);
        EXPECT_EQ(message.parameters()[i].label().to_string(), metric_fields[i].label);
        EXPECT_EQ(message.parameters()[i].unit().to_string(), metric_fields[i].unit);
    }
    ASSERT_EQ(message.measures().size(), live_measure_fields.size());
    for (std::size_t i = 0; i < live_measure_fields.size(); ++i) {
        EXPECT_EQ(message.measures()[i].name().to_string(), live_measure_fields[i].key);
        EXPECT_EQ(message.measures()[i].label().to_string(), live_measure_fields[i].label);
        EXPECT_EQ(message.measures()[i].unit().to_string(), live_measure_fields[i].si);
    }
}

/// Each live measure with a distinct number.
LiveMeasures numbered_measures() {
    LiveMeasures measures;
    float next = 0.5f;
    for (const LiveMeasureField& field : live_measure_fields) {
        measures.*field.value = next++;
    }
    return measures;
}

TEST(SessionKeys, EveryValueArrivesUnderItsName) {
    const SessionKeys keys = believed(test::session_description());
    msg::LiveMetrics metrics;
    set_runtime_parameters(numbered(), metrics);
    EXPECT_EQ(keys.runtime_parameters(metrics), numbered());
    set_measures(numbered_measures(), metrics);
    EXPECT_EQ(keys.measures(metrics), numbered_measures());
    AttemptMetrics parameters = initial_metrics();
    parameters.time_s = 12.5;
    EXPECT_EQ(keys.metrics(to_msg(parameters)).time_s, 12.5);
    EXPECT_TRUE(keys.key_mismatch().empty()) << keys.key_mismatch();
}

TEST(SessionKeys, ToolsAndWeightMatchTheServer) {
    Tube tube;
    tube.inner_diameter = 2.5e-3f;
    tube.grip_from_tip = 0.09f;
    const Laryngoscope scope = make_laryngoscope(Blade::miller_0);
    const SessionKeys keys = believed(test::session_description(zero_landmarks(), scope, tube));
    EXPECT_EQ(keys.laryngoscope().blade, Blade::miller_0);
    EXPECT_EQ(keys.laryngoscope().blade_length, scope.blade_length);
    EXPECT_EQ(keys.laryngoscope().capsules[2].radius, scope.capsules[2].radius);
    EXPECT_EQ(keys.tube().inner_diameter, 2.5e-3f);
    EXPECT_EQ(keys.tube().grip_from_tip, 0.09f);
    EXPECT_EQ(keys.patient_weight(), 3.5);
}

// A server of another version, with its keys in another order, one more, and one less.
TEST(SessionKeys, LiquidMatchesTheServer) {
    msg::SessionDescription message = test::session_description();
    EXPECT_EQ(believed(message).liquid(), LiquidKind::saliva);
    for (const LiquidKind kind : {LiquidKind::saliva, LiquidKind::blood}) {
        message.liquid(std::string(name_of(kind)));
        EXPECT_EQ(believed(message).liquid(), kind);
    }
}

TEST(SessionKeys, OtherVersionWorksOnCommonKeys) {
    msg::SessionDescription theirs = test::session_description();
    theirs.version("9.8.7");
    std::ranges::reverse(theirs.live());
    theirs.live().pop_back();  // the first one in this version
    msg::LiveKey stranger = theirs.live().front();
    stranger.name("humidity");
    theirs.live().insert(theirs.live().begin(), stranger);
    std::ranges::reverse(theirs.landmarks());
    std::ranges::reverse(theirs.measures());
    theirs.measures().pop_back();
    const SessionKeys keys = believed(theirs);
    EXPECT_THAT(keys.key_mismatch(),
                AllOf(HasSubstr("9.8.7"), HasSubstr(ETI_VERSION), HasSubstr("only the server knows humidity"),
                      HasSubstr("only this program knows " + std::string(runtime_parameter_fields[0].name))));
    msg::LiveMetrics metrics;
    metrics.live().push_back(77.0f);
    const RuntimeParameters values = numbered();
    for (std::size_t i = runtime_parameter_fields.size(); i-- > 1;) {
        metrics.live().push_back(values.*runtime_parameter_fields[i].value);
    }
    for (std::size_t i = live_measure_fields.size(); i-- > 1;) {
        metrics.measures().push_back(numbered_measures().*live_measure_fields[i].value);
    }
    for (std::size_t i = landmark_count; i-- > 0;) {
        metrics.landmarks().push_back(to_msg(Vec3f(0.125f * static_cast<float>(i), 0.0f, 0.0f)));
    }
    const RuntimeParameters heard = keys.runtime_parameters(metrics);
    EXPECT_TRUE(std::isnan(heard.*runtime_parameter_fields[0].value)) << "the server does not have it";
    for (std::size_t i = 1; i < runtime_parameter_fields.size(); ++i) {
        EXPECT_EQ(heard.*runtime_parameter_fields[i].value, values.*runtime_parameter_fields[i].value)
            << runtime_parameter_fields[i].name;
    }
    LiveMeasures measures = keys.measures(metrics);
    EXPECT_TRUE(std::isnan(measures.*live_measure_fields[0].value));
    measures.*live_measure_fields[0].value = numbered_measures().*live_measure_fields[0].value;
    EXPECT_EQ(measures, numbered_measures());
    EXPECT_EQ(keys.landmarks(metrics).value()[3].x(), 0.375f);
    metrics.landmarks().pop_back();
    EXPECT_FALSE(keys.landmarks(metrics));
    metrics.landmarks().push_back(to_msg(Vec3f(nan, 0.0f, 0.0f)));
    EXPECT_FALSE(keys.landmarks(metrics));
}

TEST(SessionKeys, IncompatiblePeerIsRefusedWithBothVersions) {
    msg::SessionDescription theirs = test::session_description();
    theirs.version("9.8.7");
    theirs.landmarks().pop_back();
    EXPECT_THAT(refusal_of_description(theirs), AllOf(HasSubstr("9.8.7"), HasSubstr(ETI_VERSION),
                                                      HasSubstr(std::string(landmark_names.back()))));
}

TEST(SessionKeys, InvalidDescriptionIsRefused) {
    const auto with = [](const auto& change) {
        msg::SessionDescription message = test::session_description();
        change(message);
        return refusal_of_description(message);
    };
    EXPECT_EQ(with([](auto&) {}), "believed");
    EXPECT_NE(with([](auto& m) { m.blade_length(nan); }), "believed");
    EXPECT_NE(with([](auto& m) { m.blade_length(0.0f); }), "believed");
    EXPECT_NE(with([](auto& m) { m.laryngoscope().pop_back(); }), "believed");
    EXPECT_NE(with([](auto& m) { m.laryngoscope()[1].a().x(nan); }), "believed");
    EXPECT_NE(with([](auto& m) { m.laryngoscope()[1].radius(-1.0f); }), "believed");
    EXPECT_NE(with([](auto& m) { m.tube_inner_diameter(m.tube_outer_diameter()); }), "believed");
    EXPECT_NE(with([](auto& m) { m.tube_length(5.0f); }), "believed");
    EXPECT_NE(with([](auto& m) { m.tube_grip_from_tip(nan); }), "believed");
    EXPECT_NE(with([](auto& m) { m.tube_curve_radius(0.0f); }), "believed");
    EXPECT_NE(with([](auto& m) { m.patient_weight_kg(nan); }), "believed");
    EXPECT_NE(with([](auto& m) { m.landmarks()[2].rest().y(nan); }), "believed");
    EXPECT_NE(with([](auto& m) { m.live()[0].per_unit(0.0f); }), "believed");
    EXPECT_NE(with([](auto& m) { m.live()[0].low(m.live()[0].high() + 1.0f); }), "believed");
    EXPECT_NE(with([](auto& m) { m.live()[0].start(nan); }), "believed");
}

}  // namespace
}  // namespace eti::bus
