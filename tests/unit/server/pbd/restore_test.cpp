// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A state that is saved, restored and advanced continues bit-identically: there is no hidden state.
#include <gtest/gtest.h>

#include <cstring>

#include "common/math/random.hpp"
#include "tests/support/cluster_block.hpp"
#include "tests/support/rod_fixture.hpp"
#include "tests/support/threads.hpp"
#include "tests/unit/server/pbd/fluid/fluid_fixture.hpp"

namespace eti::pbd {
namespace {

constexpr float restore_dt = 1.0f / 1440.0f;

template <class T>
void append(std::vector<std::byte>& bytes, std::span<const T> values) {
    const auto raw = std::as_bytes(values);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

std::vector<std::byte> bits(const Particles& p) {
    std::vector<std::byte> bytes;
    append(bytes, std::span<const Vec3f>(p.position));
    append(bytes, std::span<const Vec3f>(p.velocity));
    return bytes;
}

/// Runs `body`, saves it, runs it further, and repeats that from the copy, on the given number of threads.
/// Returns the final state.
template <class Body, class Advance, class State>
std::vector<std::byte> run_from(Body body, const Advance& advance, const State& state, std::size_t threads) {
    return eti::test::with_threads(threads, [&] {
        advance(body, 30);
        Body saved = body;
        const std::vector<std::byte> then = state(body);
        advance(body, 30);
        EXPECT_NE(state(body), then) << "something has to happen";
        EXPECT_EQ(state(saved), then) << "a copy shares nothing with its origin";
        advance(saved, 30);
        EXPECT_EQ(state(saved), state(body)) << threads;
        return state(body);
    });
}

template <class Body, class Advance, class State>
void expect_same_for_all_threads(const Body& body, const Advance& advance, const State& state) {
    const std::vector<std::byte> one = run_from(body, advance, state, 1);
    EXPECT_EQ(run_from(body, advance, state, 2), one);
    EXPECT_EQ(run_from(body, advance, state, 8), one);
}

void throw_about(Particles& p) {
    Random random(3);
    for (Vec3f& v : p.velocity) {
        v = 0.3f * Vec3f(random.normal(), random.normal(), random.normal());
    }
}

void expect_same_for_all_threads(const SoftBody& body) {
    expect_same_for_all_threads(
        body,
        [](SoftBody& b, int count) {
            for (int n = 0; n < count; ++n) {
                eti::test::substep(b, restore_dt);
            }
        },
        [](const SoftBody& b) { return bits(b.particles); });
}

TEST(Restore, ClustersAndLinks) {
    SoftBody body = eti::test::cluster_block(11, 8e3f);  // more than one range for each thread
    std::vector<std::array<std::uint32_t, 2>> ends;
    for (std::uint32_t i = 0; i + 7 < body.particles.size(); i += 50) {
        ends.push_back({i, i + 7});
    }
    body.links.configure(ends, std::vector<float>(ends.size(), 30.0f), body.particles);
    throw_about(body.particles);
    expect_same_for_all_threads(body);
}

TEST(Restore, Rod) {
    expect_same_for_all_threads(
        Rod(Tube{}, {}, {}),
        [](Rod& rod, int count) {
            eti::test::run(rod, double{restore_dt} * count, restore_dt, Vec3f(0, -9.81f, 0), {},
                           {0.02f, 0.0f, 0.01f}, 2);
        },
        [](const Rod& rod) {
            std::vector<std::byte> bytes;
            for (const RodSegment& s : rod.segments()) {
                append(bytes, std::span<const double>(s.position.data(), 3));
                append(bytes, std::span<const double>(s.rotation.coeffs().data(), 4));
                append(bytes, std::span<const double>(s.velocity.data(), 3));
                append(bytes, std::span<const double>(s.angular_velocity.data(), 3));
            }
            return bytes;
        });
}

TEST(Restore, FluidWithEmitters) {
    Fluid fluid(FluidSettings{}, 9);
    fluid_fixture::fill(fluid, 10, 10, 8);
    FluidEmitter gland;
    gland.position = Vec3f(5e-3f, 5e-3f, 12e-3f);
    gland.direction = Vec3f(0, 0, -1);
    gland.flow = 1e-6f;
    fluid.set_emitters({&gland, 1});
    const DistanceGrid solid = fluid_fixture::vessel(Vec3f::Zero(), 1e-3f * fluid_fixture::at(12, 12, 20));
    expect_same_for_all_threads(
        fluid,
        [&](Fluid& f, int count) {
            FluidSurroundings surroundings;
            surroundings.solid = &solid;
            for (int n = 0; n < count; ++n) {
                f.step(restore_dt, Vec3f(1.0f, 0, -9.81f), surroundings);
            }
        },
        [](const Fluid& f) {
            std::vector<std::byte> bytes;
            append(bytes, f.positions());
            append(bytes, f.velocities());
            append(bytes, f.ids());
            return bytes;
        });
}

}  // namespace
}  // namespace eti::pbd
