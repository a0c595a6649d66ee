// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid/liquid_detail.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "common/math/random.hpp"

namespace eti {
namespace {

constexpr float detail_spacing = 1e-3f;
constexpr std::uint64_t state_ns = 11'111'111;
constexpr float detail_state = 1e-9f * static_cast<float>(state_ns);

std::vector<Vec3f> flat_block(const Vec3f& at, int wide, int high) {
    std::vector<Vec3f> points;
    for (int y = 0; y < high; ++y) {
        for (int k = 0; k < wide * wide; ++k) {
            points.push_back(at + detail_spacing * Eigen::Vector3i(k % wide, y, k / wide).cast<float>());
        }
    }
    return points;
}

LiquidProperties that(float foaming, float stringing) {
    LiquidProperties liquid = properties_of(LiquidKind::saliva);
    liquid.foaming = foaming;
    liquid.stringing = stringing;
    return liquid;
}

/// A flat block whose particles oscillate with random phases and directions, five times a second, with at
/// most `speed`.
view::LiquidDetail churned(float speed, int states, float foaming = 1.0f) {
    constexpr float turns = 2.0f * std::numbers::pi_v<float> * 5.0f;
    view::LiquidDetail detail;
    detail.set_kind(that(foaming, 1.0f));
    for (int s = 0; s < states; ++s) {
        std::vector<Vec3f> points = flat_block(Vec3f::Zero(), 12, 3);
        Random random(5);
        for (Vec3f& p : points) {
            const Vec3f way(random.normal(), random.normal(), random.normal());
            const float phase = 2.0f * std::numbers::pi_v<float> * random.uniform();
            p += speed / turns * std::sin(turns * detail_state * static_cast<float>(s) + phase) *
                 way.normalized();
        }
        detail.advance(static_cast<std::uint64_t>(s + 1) * state_ns, points, detail_spacing, {});
    }
    return detail;
}

// Ihmsen et al. 2012: no air below the threshold of kinetic energy, and more with higher speed.
TEST(LiquidFoam, RequiresSpeedAndAir) {
    EXPECT_TRUE(churned(0.005f, 60).foam().bubbles().empty()) << "it creeps";
    const std::size_t slow = churned(0.02f, 20).foam().bubbles().size();
    const std::size_t fast = churned(0.04f, 20).foam().bubbles().size();
    EXPECT_GT(fast, 2 * slow);
    EXPECT_GT(fast, 10u);
    EXPECT_LE(fast, view::LiquidFoam::max_bubbles);
    EXPECT_TRUE(churned(0.04f, 20, 0.0f).foam().bubbles().empty()) << "what does not foam";
}

TEST(LiquidFoam, HasPublishedSizeNearLiquidAndBursts) {
    view::LiquidDetail detail = churned(0.04f, 20);
    ASSERT_FALSE(detail.foam().bubbles().empty());
    for (const view::Bubble& bubble : detail.foam().bubbles()) {
        EXPECT_GE(bubble.radius, 0.1e-3f);
        EXPECT_LE(bubble.radius, 0.4e-3f);
        EXPECT_LE(bubble.radius_now(), bubble.radius);
        float nearest = 1.0f;
        for (const Vec3f& p : detail.tracks().positions()) {
            nearest = std::min(nearest, (p - bubble.position).norm());
        }
        EXPECT_LT(nearest, 3.0f * detail_spacing);
    }
    // Nothing moves any more, and the longest bubble lifetime is 9 s.
    const std::vector<Vec3f> rest(detail.tracks().positions().begin(), detail.tracks().positions().end());
    const std::size_t before = detail.foam().bubbles().size();
    for (std::uint64_t s = 21; s < 21 + 90 * 10; ++s) {
        detail.advance(s * state_ns, rest, detail_spacing, {});
        if (s == 21 + 90) {
            EXPECT_GT(detail.foam().bubbles().size(), before / 2) << "a second later it is still there";
        }
    }
    EXPECT_TRUE(detail.foam().bubbles().empty());
}

TEST(LiquidFoam, IsDeterministic) {
    const view::LiquidDetail a = churned(0.04f, 20), b = churned(0.04f, 20);
    ASSERT_EQ(a.foam().bubbles().size(), b.foam().bubbles().size());
    EXPECT_EQ(
        std::memcmp(a.foam().bubbles().data(), b.foam().bubbles().data(), a.foam().bubbles().size_bytes()),
        0);
}

/// A drop pulled off a pool at 30 mm/s.
view::LiquidDetail pulled(int states, float stringing = 1.0f) {
    view::LiquidDetail detail;
    detail.set_kind(that(0.0f, stringing));
    for (int s = 0; s < states; ++s) {
        std::vector<Vec3f> points = flat_block(Vec3f::Zero(), 5, 3);
        points.push_back(Vec3f(2e-3f, -1e-3f - 0.03f * detail_state * static_cast<float>(s), 2e-3f));
        detail.advance(static_cast<std::uint64_t>(s + 1) * state_ns, points, detail_spacing, {});
    }
    return detail;
}

TEST(LiquidFilaments, StretchBetweenPartingLiquidAndBreak) {
    EXPECT_TRUE(pulled(2).filaments().filaments().empty()) << "still together";
    const view::LiquidDetail drawn = pulled(12), longer = pulled(24);
    ASSERT_EQ(drawn.filaments().filaments().size(), 1u);
    ASSERT_EQ(longer.filaments().filaments().size(), 1u);
    const view::LiquidFilament& s = drawn.filaments().filaments().front();
    const view::LiquidFilament& l = longer.filaments().filaments().front();
    // Volume of a cylinder; then drainage: the radius decays by e in 1.6 s (Entov & Hinch's form).
    EXPECT_NEAR(std::numbers::pi_v<float> * s.radius() * s.radius() * s.length(), s.volume, 1e-3f * s.volume);
    EXPECT_NEAR(l.volume / s.volume, std::exp(-2.0f * (l.age - s.age) / 1.6f), 1e-3f);
    EXPECT_LT(l.radius(), s.radius());
    EXPECT_NEAR(s.length(), 1e-3f + 0.03f * 11.0f * detail_state, 1e-4f);
    // 14 mm at 30 mm/s.
    EXPECT_TRUE(pulled(46).filaments().filaments().empty());
    EXPECT_TRUE(pulled(12, 0.0f).filaments().filaments().empty()) << "what is not stringy";
}

TEST(LiquidFilaments, AttachToRetractingTool) {
    view::LiquidDetail detail;
    detail.set_kind(that(0.0f, 1.0f));
    const std::vector<Vec3f> pool = flat_block(Vec3f::Zero(), 5, 3);
    float gap = 0.0f;
    for (int s = 0; s < 12; ++s) {
        gap = 0.4e-3f + 0.03f * detail_state * static_cast<float>(s);
        const float y = -gap - 2e-3f;
        const Capsule tool{Vec3f(-20e-3f, y, 2e-3f), Vec3f(20e-3f, y, 2e-3f), 2e-3f};
        detail.advance(static_cast<std::uint64_t>(s + 1) * state_ns, pool, detail_spacing, {&tool, 1});
    }
    ASSERT_FALSE(detail.filaments().filaments().empty());
    EXPECT_LE(detail.filaments().filaments().size(), view::LiquidFilaments::max_filaments);
    for (const view::LiquidFilament& filament : detail.filaments().filaments()) {
        EXPECT_EQ(filament.to.particle, view::LiquidTracks::no_particle);
        EXPECT_NEAR(filament.to.place.y(), -gap, 0.3e-3f);
        EXPECT_GE(filament.length(), gap - 1e-5f);
    }
    // Removing a blade from the scene removes its filaments.
    detail.advance(13 * state_ns, pool, detail_spacing, {});
    EXPECT_TRUE(detail.filaments().filaments().empty());
}

TEST(LiquidDetail, IsEmptyWithoutLiquid) {
    view::LiquidDetail detail = churned(0.04f, 20);
    ASSERT_FALSE(detail.foam().bubbles().empty());
    detail.advance(21 * state_ns, {}, detail_spacing, {});
    EXPECT_TRUE(detail.foam().bubbles().empty());
    EXPECT_TRUE(detail.tracks().positions().empty());
    // A recording that restarts has its initial foam: none.
    view::LiquidDetail again = churned(0.04f, 20);
    const std::vector<Vec3f> rest(again.tracks().positions().begin(), again.tracks().positions().end());
    again.advance(state_ns, rest, detail_spacing, {});
    EXPECT_TRUE(again.foam().bubbles().empty());
}

}  // namespace
}  // namespace eti
