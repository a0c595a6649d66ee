// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include "allocation_counter.hpp"
#include "devices/haptics/haptic_loop.hpp"
#include "devices/sensor/hand_sensor.hpp"

namespace eti::devices {
namespace {

constexpr std::int64_t ms = 1'000'000;

SensorSetup setup_with_script() {
    SensorSetup setup;
    setup.script.emplace();
    Stage stage;
    stage.name = "a name too long for a string's own buffer";
    stage.tip_at = Landmark::mouth_opening;
    stage.axis_from = Landmark::upper_gum;
    stage.axis_to = Landmark::vallecula;
    stage.speed = 0.2f;
    setup.script->laryngoscope.stages = {stage, stage, stage};
    setup.script->laryngoscope.stages[1].tip_at = Landmark::vallecula;
    setup.script->tremor = 0.3e-3f;
    for (std::size_t i = 0; i < landmark_count; ++i) {
        setup.start.landmarks[i] =
            Vec3f(0.0f, 0.004f * static_cast<float>(i), -0.003f * static_cast<float>(i * i));
    }
    return setup;
}

TEST(HapticCycle, AllocatesNothing) {
    const SensorSetup setup = setup_with_script();
    HandSensor sensor(setup);
    auto scene = std::make_unique<TripleBuffer<SceneState>>();
    HapticCycle cycle(sensor, *scene, {});
    SceneState state;
    state.seen = setup.start;
    state.blade = make_laryngoscope(Blade::miller_1).capsules;
    state.tissue.count = TissueReport::most_points;
    const std::uint64_t before = allocations();
    for (int i = 1; i <= 6000; ++i) {
        if (i % 6 == 0) {
            // Half-way another session begins and the script starts anew.
            state.session = i < 3000 ? 0 : 1;
            state.seen.time = 1e-3 * (i < 3000 ? i : i - 3000);
            state.proxy_arrived = state.tissue_arrived = 1'000 * ms + i * ms;
            scene->write(state);
        }
        (void)cycle.run(1'000 * ms + i * ms);
    }
    EXPECT_EQ(allocations(), before);
    const auto proof = std::make_unique<int>(1);
    EXPECT_EQ(allocations(), before + 1) << "allocations are not counted";
}

/// A device that may be away.
class Coming final : public Sensor {
  public:
    Reading exchange(const Wrench& wrench, float) override {
        given = wrench;
        Reading reading;
        reading.present = present;
        return reading;
    }
    bool present = true;
    Wrench given;
};

TEST(HapticCycle, ADeviceThatGoesOrAPersonWhoWantsItGetsNoForceAtOnce) {
    Coming sensor;
    auto scene = std::make_unique<TripleBuffer<SceneState>>();
    HapticCycle cycle(sensor, *scene, {});
    SceneState state;
    std::int64_t now = 1'000 * ms;
    const auto pass = [&](int cycles, float force, bool stop = false) {
        bool published = false;
        for (int i = 0; i < cycles; ++i) {
            now += ms;
            state.proxy_arrived = state.tissue_arrived = now;
            state.tissue.wrench.force.x() = force;
            scene->write(state);
            published = cycle.run(now, stop).has_value();
        }
        return published;
    };
    EXPECT_TRUE(pass(600, 0.0f));
    EXPECT_TRUE(pass(100, 2.0f));
    EXPECT_NEAR(sensor.given.force.x(), 2.0f, 1e-5f);
    sensor.present = false;
    EXPECT_FALSE(pass(1, 2.0f)) << "a pose that is not there is not published";
    EXPECT_FALSE(pass(1, 2.0f));
    EXPECT_EQ(sensor.given.force.norm(), 0.0f);
    sensor.present = true;
    EXPECT_TRUE(pass(300, 2.0f));
    EXPECT_EQ(sensor.given.force.norm(), 0.0f) << "not quiet yet";
    pass(600, 0.0f);
    pass(100, 2.0f);
    EXPECT_NEAR(sensor.given.force.x(), 2.0f, 1e-5f);
    EXPECT_TRUE(pass(1, 2.0f, true));
    EXPECT_EQ(sensor.given.force.norm(), 0.0f);
    EXPECT_EQ(cycle.record().stopped_cycles, 1u);
    EXPECT_EQ(cycle.record().absent_cycles, 2u);
}

TEST(SimulationTime, IsCarriedOnAtTheSimulationsPaceWithinTwoSteps) {
    SimulationTime time;
    SceneState scene;
    scene.seen.time = 3.0;
    scene.proxy_arrived = 1'000 * ms;
    scene.pace = 0.5f;
    EXPECT_NEAR(time.at(scene, 1'004 * ms), 3.002, 1e-9);
    EXPECT_NEAR(time.at(scene, 5'000 * ms), 3.0 + 2.0 / 180.0, 1e-9);
    // The next message is about an earlier time than was guessed: time stands still, it does not go back.
    scene.seen.time = 3.0 + 1.0 / 180.0;
    scene.proxy_arrived = 5'000 * ms;
    EXPECT_NEAR(time.at(scene, 5'001 * ms), 3.0 + 2.0 / 180.0, 1e-9);
    // Another session starts at its own time.
    scene.session = 1;
    scene.seen.time = 0.0;
    EXPECT_NEAR(time.at(scene, 5'002 * ms), 0.001, 1e-9);
}

}  // namespace
}  // namespace eti::devices
