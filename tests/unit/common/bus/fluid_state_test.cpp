// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/fluid_state.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "common/bus/codec/wire.hpp"
#include "common/math/random.hpp"

namespace eti::bus {
namespace {

constexpr float farthest_particle = 10.0f;  // [m]

struct Sample {
    explicit Sample(std::size_t count) {
        Random random(11);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3f share(random.uniform(), random.uniform(), random.uniform());
            positions.push_back(lower + share.cwiseProduct(upper - lower));
        }
    }
    [[nodiscard]] Liquid liquid() const { return {lower, upper, 0.7e-3f, positions}; }

    Vec3f lower{-0.05f, -0.02f, -0.07f}, upper{0.05f, 0.09f, 0.06f};
    std::vector<Vec3f> positions;
};

TEST(FluidState, RoundTripErrorIsBelowQuantum) {
    const Sample sample(1000);
    std::vector<Vec3f> back;
    msg::FluidState message;
    ASSERT_EQ(fluid_chunk_count(1000), 6u);
    for (std::size_t chunk = 0; chunk < 6; ++chunk) {
        encode_fluid_chunk(sample.liquid(), chunk, message);
        EXPECT_EQ(message.chunks(), 6);
        ASSERT_TRUE(decode_fluid_chunk(message, farthest_particle, back));
    }
    ASSERT_EQ(back.size(), 1000u);
    // Half of a 65535th of each edge, and the rounding of floats of 0.1 m.
    const Vec3f quantum = (sample.upper - sample.lower) / 131070.0f + Vec3f::Constant(0.1f * 0x1p-22f);
    for (std::size_t i = 0; i < back.size(); ++i) {
        EXPECT_TRUE(((back[i] - sample.positions[i]).cwiseAbs().array() <= quantum.array()).all()) << i;
    }
}

TEST(FluidState, EachChunkFitsADatagramAndStandsAlone) {
    const Sample sample(500);
    for (const std::size_t chunk : {std::size_t{2}, std::size_t{0}}) {
        msg::FluidState message;
        encode_fluid_chunk(sample.liquid(), chunk, message);
        EXPECT_LE(WireType<msg::FluidStatePubSubType>().size_of(&message), 1300u);
        std::vector<Vec3f> alone;
        ASSERT_TRUE(decode_fluid_chunk(message, farthest_particle, alone));
        ASSERT_EQ(alone.size(), chunk == 2 ? 500 - 2 * fluid_chunk_particles : fluid_chunk_particles);
        EXPECT_LT((alone.front() - sample.positions[chunk * fluid_chunk_particles]).norm(), 2e-6f);
    }
}

TEST(FluidState, NoLiquidIsOneEmptyChunk) {
    msg::FluidState message;
    encode_fluid_chunk(Sample(0).liquid(), 0, message);
    EXPECT_EQ(fluid_chunk_count(0), 1u);
    std::vector<Vec3f> back;
    EXPECT_TRUE(decode_fluid_chunk(message, farthest_particle, back));
    EXPECT_TRUE(back.empty());
}

TEST(FluidState, PositionsAreClampedToTheBox) {
    Sample sample(0);
    sample.positions = {Vec3f(1.0f, 0.0f, 0.0f)};
    msg::FluidState message;
    encode_fluid_chunk(sample.liquid(), 0, message);
    std::vector<Vec3f> back;
    ASSERT_TRUE(decode_fluid_chunk(message, farthest_particle, back));
    EXPECT_NEAR(back[0].x(), sample.upper.x(), 1e-7f);
}

TEST(FluidState, HostileChunksAreRefused) {
    const Sample sample(300);
    msg::FluidState good;
    encode_fluid_chunk(sample.liquid(), 0, good);
    std::vector<Vec3f> untouched;
    const auto refused = [&](const char* what, const std::function<void(msg::FluidState&)>& spoil) {
        msg::FluidState message = good;
        spoil(message);
        EXPECT_FALSE(decode_fluid_chunk(message, farthest_particle, untouched)) << what;
        EXPECT_TRUE(untouched.empty()) << what;
    };
    constexpr float missing_number = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinite = std::numeric_limits<float>::infinity();
    refused("a coordinate is lacking", [](auto& m) { m.places().pop_back(); });
    refused("more than a chunk holds", [](auto& m) { m.places().resize(579, 1); });
    refused("no chunks", [](auto& m) { m.chunks(0); });
    refused("a chunk beyond the last", [](auto& m) { m.chunk(m.chunks()); });
    refused("chunks without end", [](auto& m) { m.chunks(65535); });
    refused("box turned inside out", [](auto& m) { std::swap(m.lower(), m.upper()); });
    refused("flat box", [](auto& m) { m.upper().y(m.lower().y()); });
    refused("box that is no number", [](auto& m) { m.lower().z(missing_number); });
    refused("box without end", [](auto& m) { m.upper().x(infinite); });
    refused("box far away", [](auto& m) { m.lower().x(-11.0f); });
    refused("no spacing", [](auto& m) { m.spacing(0.0f); });
    refused("spacing that is no number", [](auto& m) { m.spacing(missing_number); });
    refused("drops as large as a head", [](auto& m) { m.spacing(0.1f); });
}

}  // namespace
}  // namespace eti::bus
