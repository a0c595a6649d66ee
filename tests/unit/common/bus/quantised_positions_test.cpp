// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/quantised_positions.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/bus/codec/wire.hpp"
#include "common/math/random.hpp"

namespace eti::bus {
namespace {

constexpr float farthest_place = 10.0f;  // [m]

std::vector<Vec3f> some(std::size_t count, const Vec3f& size) {
    Random random(7);
    std::vector<Vec3f> positions;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3f share(random.uniform(), random.uniform(), random.uniform());
        positions.push_back(Vec3f(0.1f, -0.2f, 0.05f) + share.cwiseProduct(size));
    }
    return positions;
}

/// Half a 65535th of each edge, and the rounding of floats of up to 0.3 m: one of the box, one of the sum, of
/// 2^-25 relative each.
Vec3f bound(const Box& box) {
    return (box.upper - box.lower) / 131070.0f + Vec3f::Constant(0.3f * 0x1p-23f);
}

TEST(QuantizedPositions, RoundTripErrorIsBelowHalfAQuantum) {
    for (const Vec3f& size : {Vec3f(0.1f, 0.2f, 0.05f), Vec3f(2e-3f, 1e-4f, 0.2f), Vec3f(0.0f, 0.0f, 0.0f)}) {
        const std::vector<Vec3f> positions = some(chunk_positions, size);
        const Box box = box_around(positions);
        std::vector<std::uint16_t> places;
        quantise_positions(box, positions, places);
        std::vector<Vec3f> back;
        ASSERT_TRUE(dequantise_positions(box, places, farthest_place, back)) << size.transpose();
        ASSERT_EQ(back.size(), positions.size());
        for (std::size_t i = 0; i < back.size(); ++i) {
            EXPECT_TRUE(((back[i] - positions[i]).cwiseAbs().array() <= bound(box).array()).all()) << i;
        }
    }
}

TEST(QuantizedPositions, BoxIsTight) {
    const std::vector<Vec3f> positions{{0.1f, 0.2f, 0.3f}, {-0.1f, 0.4f, 0.3f}};
    const Box box = box_around(positions);
    EXPECT_EQ(box.lower, Vec3f(-0.1f, 0.2f, 0.3f));
    EXPECT_EQ(box.upper.head<2>(), Eigen::Vector2f(0.1f, 0.4f));
    EXPECT_GT(box.upper.z(), 0.3f) << "a flat box";
    EXPECT_NEAR(box.upper.z(), 0.3f, 1.1e-6f);
}

template <class Message>
std::size_t wire_bytes(WireType<Message> type, typename WireType<Message>::Message& message) {
    const std::vector<Vec3f> positions = some(chunk_positions, Vec3f::Constant(0.1f));
    encode_positions(box_around(positions), positions, message);
    return type.size_of(&message);
}

TEST(QuantizedPositions, AFullChunkOfEachMessageFitsADatagram) {
    msg::MeshState mesh;
    mesh.object(std::string(48, 'o'));
    EXPECT_LE(wire_bytes<msg::MeshStatePubSubType>({}, mesh), 1300u);
    msg::ParticleState particles;
    EXPECT_LE(wire_bytes<msg::ParticleStatePubSubType>({}, particles), 1300u);
}

TEST(QuantizedPositions, ChunksHoldAllPositions) {
    EXPECT_EQ(chunk_count(0), 0u);
    EXPECT_EQ(chunk_count(1), 1u);
    EXPECT_EQ(chunk_count(chunk_positions), 1u);
    EXPECT_EQ(chunk_count(chunk_positions + 1), 2u);
}

TEST(QuantizedPositions, InvalidChunksAreRefused) {
    const Box box{Vec3f::Zero(), Vec3f::Ones()};
    const std::vector<std::uint16_t> places(3, 1);
    std::vector<Vec3f> back;
    const auto refused = [&](const Box& b, const std::vector<std::uint16_t>& p) {
        return !dequantise_positions(b, p, farthest_place, back) && back.empty();
    };
    constexpr float missing_number = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(refused({Vec3f::Ones(), Vec3f::Zero()}, places)) << "turned inside out";
    EXPECT_TRUE(refused({Vec3f::Zero(), Vec3f(1.0f, 0.0f, 1.0f)}, places)) << "flat";
    EXPECT_TRUE(refused({Vec3f(0.0f, missing_number, 0.0f), Vec3f::Ones()}, places)) << "no number";
    EXPECT_TRUE(refused({Vec3f::Zero(), Vec3f::Constant(11.0f)}, places)) << "far away";
    EXPECT_TRUE(refused(box, std::vector<std::uint16_t>(4, 1))) << "a coordinate is lacking";
    EXPECT_TRUE(refused(box, std::vector<std::uint16_t>(3 * chunk_positions + 3, 1))) << "more than a chunk";
    EXPECT_TRUE(dequantise_positions(box, places, farthest_place, back));
}

}  // namespace
}  // namespace eti::bus
