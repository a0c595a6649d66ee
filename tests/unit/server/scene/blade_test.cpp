// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/blade.hpp"

#include <gtest/gtest.h>

#include "common/math/random.hpp"
#include "server/scene/scene.hpp"

namespace eti::scene {
namespace {

constexpr int blade_substeps = 8;
constexpr float blade_dt = step_duration / blade_substeps;

/// Free particles with no force except the blade's.
pbd::Particles cloud(std::size_t count) {
    pbd::Particles p;
    p.resize(count);
    Random random(1);
    for (std::size_t i = 0; i < count; ++i) {
        p.position[i] = Vec3f(0.03f * (random.uniform() - 0.5f), 0.03f * (random.uniform() - 0.5f),
                              0.12f * random.uniform());
        p.velocity[i] = 0.1f * Vec3f(random.normal(), random.normal(), random.normal());
        p.inverse_mass[i] = 1.0f / ((1.0f + random.uniform()) * 1e-5f);
        p.radius[i] = 1e-3f;
        p.channels[i] = pbd::channel::blade;
    }
    return p;
}

struct Wrench {
    Vec3d force = Vec3d::Zero();
    Vec3d torque = Vec3d::Zero();
};

/// Force on the blade from the particles' change of momentum in a step: minus momentum gained over time, and
/// its moment about the tool's origin. `reported` is the blade's own value.
Wrench felt(pbd::Particles& p, BladeContact& contact, const RigidTransform& from, const RigidTransform& to,
            Snapshot& reported) {
    Wrench sum;
    contact.begin_step(p, from, to);
    for (int s = 0; s < blade_substeps; ++s) {
        const float begin = static_cast<float>(s) / blade_substeps;
        const float end = static_cast<float>(s + 1) / blade_substeps;
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.predicted[i] = p.position[i] + blade_dt * p.velocity[i];
        }
        contact.project(p, begin, end, blade_dt);
        const Vec3d origin = (from.translation + end * (to.translation - from.translation)).cast<double>();
        for (std::size_t i = 0; i < p.size(); ++i) {
            const Vec3f velocity = (p.predicted[i] - p.position[i]) / blade_dt;
            const Vec3d gained =
                (velocity - p.velocity[i]).cast<double>() / static_cast<double>(p.inverse_mass[i]);
            sum.force -= gained / static_cast<double>(step_duration);
            sum.torque -=
                (p.predicted[i].cast<double>() - origin).cross(gained) / static_cast<double>(step_duration);
            p.velocity[i] = velocity;
            p.position[i] = p.predicted[i];
        }
    }
    contact.end_step(p, step_duration, reported);
    return sum;
}

// Newton's third law, from the particles' momenta. A velocity is a difference of positions of 0.1 m, rounded
// by 4e-9 m, over dt: 5e-6 m/s at random of 2000 particles of 15 mg each in 8 substeps, 1e-8 kg m/s or 2e-6
// N.
TEST(BladeContact, WrenchBalancesParticleMomentum) {
    std::vector<BladeContact::Edge> edges;
    for (std::uint32_t i = 0; i < 400; i += 2) {
        edges.push_back({i, i + 1});
    }
    BladeContact contact(make_laryngoscope(Blade::miller_1), edges);
    pbd::Particles p = cloud(2000);
    RigidTransform pose{Quatf::Identity(), Vec3f(0.002f, -0.02f, 0.0f)};
    Random random(2);
    int loaded = 0;
    for (int k = 0; k < 30; ++k) {
        RigidTransform next = pose;
        next.translation += Vec3f(0.0f, 0.5f * step_duration, 0.1f * step_duration);
        next.rotation = (quaternion_from(0.02f * Vec3f(random.normal(), random.normal(), random.normal())) *
                         pose.rotation)
                            .normalized();
        Snapshot reported;
        const Wrench expected = felt(p, contact, pose, next, reported);
        EXPECT_LT((reported.tissue_force.cast<double>() - expected.force).norm(),
                  1e-5 + 1e-4 * expected.force.norm());
        EXPECT_LT((reported.tissue_torque.cast<double>() - expected.torque).norm(),
                  1e-6 + 1e-4 * expected.torque.norm());
        // The parts add up to the whole.
        Vec3f sum = Vec3f::Zero();
        for (const TissueContact& touched : reported.tissue_contacts) {
            sum += touched.force;
        }
        EXPECT_LT((sum - reported.tissue_force).norm(), 1e-5f + 1e-4f * sum.norm());
        loaded += expected.force.norm() > 0.01 && expected.torque.norm() > 1e-4 ? 1 : 0;
        pose = next;
    }
    EXPECT_GT(loaded, 10);
}

// A column of particles shot at a blade at rest: all their normal momentum is transferred, m v over the step,
// at the lever arm of the contact point.
TEST(BladeContact, StoppedVolleyDeliversItsMomentum) {
    BladeContact contact(make_laryngoscope(Blade::miller_1));
    contact.friction = 0.0f;
    pbd::Particles p;
    constexpr std::size_t count = 50;
    p.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        // Above the middle of the blade's proximal part, 5 mm thick; they arrive within the step.
        p.position[i] = Vec3f(0.0f, 7e-3f, 0.030f + 1e-4f * static_cast<float>(i));
        p.velocity[i] = Vec3f(0, -1.0f, 0);
        p.inverse_mass[i] = 1e5f;
        p.radius[i] = 1e-3f;
        p.channels[i] = pbd::channel::blade;
    }
    Snapshot reported;
    felt(p, contact, {}, {}, reported);
    const double force = count * 1e-5 * 1.0 / static_cast<double>(step_duration);
    EXPECT_NEAR(static_cast<double>(reported.tissue_force.y()), -force, 1e-3 * force);
    // The moment x F of a force along -y at z is +z F about x.
    const double lever = 0.030 + 0.5e-4 * (count - 1);
    EXPECT_NEAR(static_cast<double>(reported.tissue_torque.x()), lever * force, 1e-3 * lever * force);
}

// Two joined particles, 8 mm apart, with the blade's tip of 3.5 mm radius passing between them: individually
// they are not in its path; the edge carries them along, and stays a particle's radius off the tip.
TEST(BladeContact, TipDoesNotSlipBetweenJoinedParticles) {
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    for (const bool joined : {false, true}) {
        BladeContact contact(
            scope, joined ? std::vector<BladeContact::Edge>{{0, 1}} : std::vector<BladeContact::Edge>{});
        contact.friction = 0.0f;
        pbd::Particles p;
        p.resize(2);
        const Capsule& tip = scope.capsules[2];
        const float apart = tip.radius + 1.5e-3f;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3f middle = 0.5f * (tip.a + tip.b);
            p.position[i] = middle + Vec3f(i == 0 ? apart : -apart, tip.radius + 2e-3f, 0.0f);
            p.inverse_mass[i] = 1e5f;
            p.radius[i] = 1e-3f;
            p.channels[i] = pbd::channel::blade;
        }
        const float before = p.position[0].y();
        RigidTransform pose;
        Snapshot reported;
        for (int k = 0; k < 90; ++k) {
            RigidTransform next = pose;
            next.translation.y() += 0.02f * step_duration;
            for (Vec3f& velocity : p.velocity) {
                velocity.setZero();
            }
            felt(p, contact, pose, next, reported);
            pose = next;
        }
        // The blade has moved 10 mm; the edge started 1 mm above first contact.
        const float lifted = p.position[0].y() - before;
        EXPECT_NEAR(lifted, joined ? 9e-3f : 0.0f, 1e-5f);
        EXPECT_NEAR(p.position[1].y(), p.position[0].y(), 1e-5f);
    }
}

// At the tip, no particle passes through the blade at any speed of a hand: the axis sweeps 30 mm in one
// substep at most.
TEST(BladeContact, TipDoesNotPassAParticleAtAnyHandSpeed) {
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    for (const float speed : {0.1f, 0.5f, 1.0f, 3.0f, 10.0f, 30.0f}) {
        BladeContact contact(scope);
        pbd::Particles p;
        p.resize(1);
        p.position[0] = Vec3f(0.3e-3f, 20e-3f, scope.blade_length - 8e-3f);
        p.inverse_mass[0] = 1e5f;
        p.radius[0] = 0.5e-3f;
        p.channels[0] = pbd::channel::blade;
        RigidTransform pose;
        for (int k = 0; pose.translation.y() < 60e-3f; ++k) {
            RigidTransform next = pose;
            next.translation.y() += speed * step_duration;
            Snapshot reported;
            felt(p, contact, pose, next, reported);
            pose = next;
            ASSERT_GT(p.position[0].y(), pose.translation.y()) << speed << " m/s, step " << k;
        }
    }
}

}  // namespace
}  // namespace eti::scene
