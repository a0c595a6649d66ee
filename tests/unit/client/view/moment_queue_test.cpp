// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/moment_queue.hpp"

#include <gtest/gtest.h>

#include "synthetic_scene.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t step_ns = 33'333'333;

// The tongue's lift tells which shape is shown, the percentage which measures: both are the moment's number.
class MomentQueueTest : public ::testing::Test {
  protected:
    MomentQueueTest() {
        scene_.apply(source_.description);
        for (const auto& object : source_.objects) {
            scene_.apply(object);
        }
    }

    static std::uint64_t time_of(int moment) { return static_cast<std::uint64_t>(moment) * step_ns; }
    void add_shape(int moment) {
        queue_.add(
            synthetic::deformation(source_, time_of(moment), 1e-4f * static_cast<float>(moment), 0.01f),
            now_);
    }
    void add_proxy(int moment) { queue_.add(synthetic::proxy(source_, time_of(moment)), now_); }
    void add_measures(int moment) {
        queue_.add(synthetic::metrics(source_, time_of(moment), static_cast<float>(moment)), now_);
    }
    void release() { queue_.release_into(scene_, now_); }

    void expect_moment(int moment) {
        constexpr std::size_t tongue = 2;
        ASSERT_TRUE(scene_.has_all_frames());
        EXPECT_NEAR((scene_.frames()[tongue].centre - source_.rest_centres[tongue]).norm(),
                    1e-4f * static_cast<float>(moment), 1e-7f);
        EXPECT_FLOAT_EQ(scene_.measures().glottic_opening_percent, static_cast<float>(moment));
        EXPECT_EQ(scene_.simulation_time_ns(), time_of(moment));
    }

    synthetic::Scene source_ = synthetic::make_scene();
    view::SceneView scene_;
    view::MomentQueue queue_;
    view::MomentQueue::Clock::time_point now_{};
};

TEST_F(MomentQueueTest, ShapeWaitsForItsMeasures) {
    add_shape(1), add_proxy(1), add_measures(1);
    release();
    expect_moment(1);
    add_shape(2), add_proxy(2), add_shape(3), add_proxy(3);
    release();
    expect_moment(1);
    add_measures(2);
    release();
    expect_moment(2);
}

TEST_F(MomentQueueTest, MeasuresWaitForTheirShape) {
    add_shape(1), add_proxy(1), add_measures(1);
    release();
    add_measures(2);
    release();
    expect_moment(1);
    add_shape(2), add_proxy(2);
    release();
    expect_moment(2);
}

TEST_F(MomentQueueTest, SeekShowsOneMoment) {
    add_shape(10), add_proxy(10), add_measures(10);
    release();
    expect_moment(10);
    // Forwards: the shape comes first.
    add_shape(100), add_proxy(100);
    release();
    expect_moment(10);
    add_measures(100);
    release();
    expect_moment(100);
    // Back by less than a second: a state at time 0 tells of the restart, with the shape of the goal. The
    // last measures from before are late.
    add_measures(100), add_shape(0), add_proxy(90);
    release();
    expect_moment(100);
    add_shape(90), add_measures(90);
    release();
    expect_moment(90);
}

TEST_F(MomentQueueTest, ShapeWithoutMeasuresIsShownLater) {
    add_shape(1), add_proxy(1), add_measures(1);
    release();
    add_shape(2), add_proxy(2);
    now_ += view::MomentQueue::longest_hold;
    release();
    EXPECT_EQ(scene_.simulation_time_ns(), time_of(2));
}

TEST_F(MomentQueueTest, LostShapeDoesNotHoldMeasures) {
    add_shape(1), add_proxy(1), add_measures(1);
    release();
    add_proxy(2), add_measures(2);
    now_ += view::MomentQueue::longest_wait_for_shape;
    release();
    EXPECT_FLOAT_EQ(scene_.measures().glottic_opening_percent, 2.0f);
}

}  // namespace
}  // namespace eti
