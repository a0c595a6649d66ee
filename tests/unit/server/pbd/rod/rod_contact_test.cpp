// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/rod/rod_contact.hpp"

#include <gtest/gtest.h>

#include "tests/support/allocations.hpp"
#include "tests/support/elastica.hpp"
#include "tests/support/rod_fixture.hpp"

namespace eti {
namespace {

constexpr float rod_contact_dt = 1.0f / 1440.0f;

/// Contacts of a rod's segment ends with a plane.
struct Plane {
    Vec3f point = Vec3f::Zero();
    Vec3f normal = Vec3f::UnitY();
    float friction = 0.0f;
    float stiffness = 3000.0f;

    /// One contact per segment from `first` on, at its front end.
    [[nodiscard]] std::vector<pbd::RodContact> contacts(const pbd::Rod& rod, std::size_t first) const {
        std::vector<pbd::RodContact> list;
        for (std::size_t s = first; s < rod.size(); ++s) {
            pbd::RodContact contact;
            contact.segment = static_cast<std::uint32_t>(s);
            contact.along = 1.0f;
            contact.normal = normal;
            contact.stiffness = stiffness;
            contact.friction = friction;
            list.push_back(contact);
        }
        return list;
    }

    void find(const pbd::Rod& rod, std::vector<pbd::RodContact>& list) const {
        for (pbd::RodContact& contact : list) {
            const Vec3f now = rod.point(contact.segment, 1.0f);
            contact.gap = normal.dot(now - point);
            contact.slip = now - rod.previous_point(contact.segment, 1.0f);
        }
    }
};

void run_rod(pbd::Rod& rod, const Plane& plane, std::vector<pbd::RodContact>& contacts, double seconds,
             const Vec3f& gravity, const RigidTransform& grip, int passes = 2) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / double{rod_contact_dt})); ++i) {
        rod.predict(rod_contact_dt, gravity, grip);
        for (int pass = 0; pass < passes; ++pass) {
            plane.find(rod, contacts);
            rod.solve(contacts);
        }
        rod.finish();
    }
}

Vec3f run_rod(pbd::Rod& rod, const Plane& plane, std::size_t first, double seconds, const Vec3f& gravity,
              const RigidTransform& grip) {
    std::vector<pbd::RodContact> contacts = plane.contacts(rod, first);
    run_rod(rod, plane, contacts, seconds, gravity, grip);
    Vec3f force = Vec3f::Zero();
    for (const pbd::RodContact& contact : contacts) {
        force += contact.force;
    }
    return force;
}

// A straight cantilever whose clamp is lowered by d while a frictionless plane stops its tip. The reference
// finds the tip force of the elastica that deflects by d minus the spring's overlap F / k. Tolerance: h^2 / 4
// L^2 = 0.1 % of discretisation each for deflection and overlap, 1 % taken.
TEST(RodContact, TipForceOnPlaneMatchesElastica) {
    const Tube tube = test::cantilever();
    for (const float lowered : {0.005f, 0.03f}) {
        pbd::Rod rod(tube, test::damped(32), {});
        const Plane plane{.point = Vec3f(0.0f, lowered, 0.0f)};
        const Vec3f force = run_rod(rod, plane, 31, test::settled, Vec3f::Zero(), {});
        double low = 0.0;
        double high = 0.02;  // where F L^2 / EI = 3: the deflection still grows with the force
        for (int i = 0; i < 50; ++i) {
            const double middle = 0.5 * (low + high);
            const double reached = test::solve({.length = double{tube.length},
                                                .stiffness = double{tube.bending_stiffness()},
                                                .tip_force = {0.0, middle}})
                                       .tip.y();
            (reached < double{lowered} - middle / double{plane.stiffness} ? low : high) = middle;
        }
        EXPECT_NEAR(double{force.y()}, low, 0.01 * low);
        EXPECT_NEAR(double{rod.tip().y()}, double{lowered} - low / 3000.0, 1e-5);
        // The force on the plane equals the force on the hand.
        EXPECT_NEAR(double{rod.grip_wrench().force.y()}, low, 0.01 * low);
    }
}

// Pushed axially, the tube carries far more than a segment weighs (0.4 mN): the target overlap is 1 mm, and
// the spring gives k F. The axis is stiff (EA / L = 640 N/m, in series with the contact's k); a short stout
// rod does not buckle.
TEST(RodContact, HeadOnPushMatchesSpringsInSeries) {
    Tube tube = test::cantilever();
    tube.length = 0.02f;
    tube.grip_from_tip = 0.02f;
    pbd::RodSettings settings = test::damped(8);
    pbd::Rod rod(tube, settings, {});
    const Plane wall{.point = Vec3f(0.0f, 0.0f, 0.019f), .normal = -Vec3f::UnitZ(), .stiffness = 2000.0f};
    const Vec3f force = run_rod(rod, wall, 7, 0.5, Vec3f::Zero(), {});
    const double area = test::line_density(tube, settings) / double{settings.density};
    // Stretch is lumped in the joints between the segments' middles: 7.5 of 8 lengths (h / 2 at the clamp is
    // the held segment's own).
    const double axial = double{tube.youngs_modulus} * area / (double{tube.length} * 7.0 / 7.5);
    const double expected = 0.001 / (1.0 / axial + 1.0 / 2000.0);
    EXPECT_LT(double{tube.bending_stiffness()} * 2.4674 / (0.02 * 0.02), 1e3);
    EXPECT_NEAR(-double{force.z()}, expected, 0.005 * expected);
    EXPECT_GT(expected, 1.0);
}

// Fingers that advance while a wall stops the rod apply at most their force limit; drawn back, they hold it
// where they did before.
TEST(RodContact, HoldSlipsAtItsForceLimit) {
    Tube tube = test::cantilever();
    tube.length = 0.02f;
    tube.grip_from_tip = 0.02f;
    pbd::RodSettings settings = test::damped(8);
    settings.hold = pbd::RodHold{.force = 1.5f};
    pbd::Rod rod(tube, settings, {});
    const Plane wall{.point = Vec3f(0.0f, 0.0f, 0.02f), .normal = -Vec3f::UnitZ(), .stiffness = 2000.0f};
    RigidTransform grip;
    grip.translation.z() = 0.01f;
    const Vec3f force = run_rod(rod, wall, 7, 0.5, Vec3f::Zero(), grip);
    EXPECT_NEAR(-force.z(), 1.5f, 0.005f * 1.5f);
    EXPECT_NEAR(rod.grip_wrench().force.z(), -1.5f, 1e-4f);
    EXPECT_LT(rod.pose(rod.held()).translation.z(), 0.5f * grip.translation.z());
    run_rod(rod, wall, 7, 0.5, Vec3f::Zero(), {});
    EXPECT_LT(rod.pose(rod.held()).translation.norm(), 1e-6f);
}

// Thrown at 5 m/s, no point of it moves farther in a substep than its clearance.
TEST(RodContact, MovesNoFurtherThanClearance) {
    Tube tube = test::cantilever();
    pbd::RodSettings settings;
    settings.held = false;
    settings.connector_mass = 0.0f;
    pbd::Rod rod(tube, settings, {});
    const std::vector<float> room(rod.size(), 1e-3f);
    rod.predict(rod_contact_dt, Vec3f(0.0f, 5.0f / rod_contact_dt, 0.0f), {});
    rod.solve();
    rod.finish();
    for (int substep = 0; substep < 5; ++substep) {
        const Vec3f before = rod.tip();
        rod.predict(rod_contact_dt, Vec3f::Zero(), {});
        rod.limit_motion(room);
        EXPECT_LE((rod.tip() - before).norm(), 1.001e-3f);
        const Vec3f guess = rod.tip();
        rod.solve({}, room);
        EXPECT_LE((rod.tip() - guess).norm(), 1.001e-3f);
        rod.finish();
    }
}

// A rod lying free on a tilted plane slides if tan(angle) > friction, with g (sin - mu cos), and stays
// otherwise.
TEST(RodContact, FrictionHoldsBelowItsAngleAndSlidesAbove) {
    Tube tube;
    tube.curve_radius = 0.0f;
    pbd::RodSettings settings;
    settings.held = false;
    settings.velocity_damping = 0.0f;
    settings.connector_mass = 0.0f;
    const float friction = 0.3f;
    const Vec3f across = Vec3f::UnitX();
    for (const float angle : {0.2f, 0.28f, 0.36f, 0.5f}) {  // tan: 0.203, 0.288, 0.376, 0.546
        pbd::Rod rod(tube, settings, {});
        const Plane plane{.friction = friction};
        const Vec3f gravity = 9.81f * (std::sin(angle) * across - std::cos(angle) * Vec3f::UnitY());
        std::vector<pbd::RodContact> contacts = plane.contacts(rod, 0);
        run_rod(rod, plane, contacts, 0.05, gravity, {});
        const Vec3f from = rod.tip();
        const Vec3f start = rod.segments().back().velocity.cast<float>();
        const double time = 0.1;
        run_rod(rod, plane, contacts, time, gravity, {});
        const double way = double{(rod.tip() - from).dot(across)} - double{start.dot(across)} * time;
        const double pull = 9.81 * (std::sin(double{angle}) - double{friction} * std::cos(double{angle}));
        if (pull > 0.0) {
            // Implicit Euler lags by half a step: dt / time. Overlap settles within a few substeps.
            EXPECT_NEAR(way, 0.5 * pull * time * time, 0.03 * 0.5 * pull * time * time);
        } else {
            // Friction's multipliers have settled: 0.1 um/s is far below visibility.
            EXPECT_LT(std::abs((rod.tip() - from).dot(across)), 1e-8f);
        }
    }
}

// A tube sliding along a plane loses energy in every substep and comes to rest.
TEST(RodContact, FrictionOnlyDissipatesEnergy) {
    Tube tube;
    tube.curve_radius = 0.0f;
    pbd::RodSettings settings;
    settings.held = false;
    settings.velocity_damping = 0.0f;
    pbd::Rod rod(tube, settings, {});
    const Plane plane{.friction = 0.4f};
    const Vec3f gravity(0.0f, -9.81f, 0.0f);
    std::vector<pbd::RodContact> contacts = plane.contacts(rod, 0);
    run_rod(rod, plane, contacts, 0.1, gravity, {});
    rod.predict(rod_contact_dt, gravity, {});
    for (std::uint32_t s = 0; s < rod.size(); ++s) {
        const float mass = 1.0f / static_cast<float>(rod.segments()[s].inverse_mass);
        rod.load(s, 0.5f, Vec3f(0.3f * mass / rod_contact_dt, 0.0f, 0.0f));  // 0.3 m/s sideways
    }
    rod.solve();
    rod.finish();
    double before = rod.energy();
    const double start = before;
    for (int i = 0; i < 300; ++i) {
        run_rod(rod, plane, contacts, double{rod_contact_dt}, gravity, {});
        const double now = rod.energy();
        // The contact springs store m g overlap / 2 = 1e-8 J, which may return.
        ASSERT_LT(now, before + 2e-8);
        before = now;
    }
    // v / (mu g) = 76 ms of the 208 ms simulated.
    EXPECT_LT(rod.segments().back().velocity.norm(), 1e-3);
    EXPECT_LT(before, start);
}

TEST(RodContact, SolvesWithoutAllocating) {
    const Tube tube = test::cantilever();
    pbd::Rod rod(tube, {}, {});
    const Plane plane{.point = Vec3f(0.0f, 0.001f, 0.0f), .friction = 0.1f};
    std::vector<pbd::RodContact> contacts = plane.contacts(rod, rod.size() - 1);
    const long before = test::allocations();
    float most = 0.0f;
    for (int i = 0; i < 20; ++i) {
        run_rod(rod, plane, contacts, double{rod_contact_dt}, Vec3f::Zero(), {});
        most = std::max(most, contacts.back().force.y());
    }
    EXPECT_GT(most, 0.0f);
    EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace eti
