// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tube.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include "server/scene/posed_shell.hpp"
#include "server/scene/scene.hpp"
#include "tests/support/coarse_newborn.hpp"

namespace eti::scene {
namespace {

constexpr int tube_substeps = 8;
constexpr float tube_dt = step_duration / tube_substeps;
const Vec3f far_away(0.0f, 0.5f, 0.5f);  // [m], for a blade out of the way

/// Solid below z = 0, on a grid of 1 mm.
DistanceGrid floor_grid() {
    DistanceGrid grid;
    grid.origin = Vec3f(-0.05f, -0.05f, -0.02f);
    grid.spacing = 1e-3f;
    grid.size = {101, 101, 201};
    for (int z = 0; z < grid.size[2]; ++z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                grid.value.push_back(grid.node(x, y, z).z());
            }
        }
    }
    return grid;
}

/// Nothing solid nearby.
DistanceGrid empty_grid() {
    DistanceGrid grid;
    grid.size = {2, 2, 2};
    grid.value.assign(8, 1.0f);
    return grid;
}

Tube straight_tube() {
    Tube tube;
    tube.curve_radius = 1e3f;
    return tube;
}

RigidTransform pointing_down(const Vec3f& grip) {
    return {Quatf(Eigen::AngleAxisf(std::numbers::pi_v<float>, Vec3f::UnitX())), grip};
}

class TubeContactTest : public ::testing::Test {
  protected:
    /// One step of the scene's scheme with the tube alone.
    void step(TubeContact& contact, const RigidTransform& to) { step(contact, to, blade_, blade_); }
    void step(TubeContact& contact, const RigidTransform& to, const RigidTransform& blade_from,
              const RigidTransform& blade_to) {
        step(contact, to, blade_from, blade_to, [this](std::size_t i) {
            particles_.predicted[i] = particles_.position[i] + tube_dt * particles_.velocity[i];
        });
    }
    void step(TubeContact& contact, const RigidTransform& to,
              const std::function<void(std::size_t)>& predict) {
        step(contact, to, blade_, blade_, predict);
    }
    /// `predict` returns the predicted position of particle i.
    void step(TubeContact& contact, const RigidTransform& to, const RigidTransform& blade_from,
              const RigidTransform& blade_to, const std::function<void(std::size_t)>& predict) {
        contact.begin_step(particles_, grip_, to, blade_from, blade_to);
        for (int s = 0; s < tube_substeps; ++s) {
            const float begin = static_cast<float>(s) / tube_substeps;
            const float end = static_cast<float>(s + 1) / tube_substeps;
            for (std::size_t i = 0; i < particles_.size(); ++i) {
                predict(i);
            }
            contact.predict(tube_dt, end, patient::gravity(0.0f));
            contact.project(particles_, shell_, begin, end);
            contact.finish();
            for (std::size_t i = 0; i < particles_.size(); ++i) {
                particles_.velocity[i] = (particles_.predicted[i] - particles_.position[i]) / tube_dt;
                particles_.position[i] = particles_.predicted[i];
            }
        }
        grip_ = to;
        contact.nodes(nodes_);
    }

    Tube tube_ = straight_tube();
    Laryngoscope scope_ = make_laryngoscope(Blade::miller_1);
    RigidTransform blade_{Quatf::Identity(), far_away};
    RigidTransform grip_;
    DistanceGrid shell_ = empty_grid();
    pbd::Particles particles_;
    std::vector<Vec3f> nodes_;
};

TEST_F(TubeContactTest, DoesNotTunnelAtMaximumHandSpeed) {
    shell_ = floor_grid();
    grip_ = pointing_down({0, 0, tube_.grip_from_tip + 0.01f});
    TubeContact contact(tube_, scope_, grip_);
    // 1 m/s for 30 mm: it hits the wall after 8 mm, and must bend for the rest.
    const float way = 1.0f * step_duration;
    const int steps = static_cast<int>(30e-3f / way) + 60;
    for (int k = 0; k < steps; ++k) {
        RigidTransform to = grip_;
        to.translation.z() = std::max(to.translation.z() - way, tube_.grip_from_tip - 0.02f);
        step(contact, to);
        for (const Vec3f& node : nodes_) {
            ASSERT_TRUE(node.allFinite());
            ASSERT_GT(node.z(), 0.0f) << "in step " << k << " the centre line is in the wall";
        }
    }
    // A chain with separated segments would be longer than built.
    float length = 0.0f;
    for (std::size_t i = 1; i < nodes_.size(); ++i) {
        length += (nodes_[i] - nodes_[i - 1]).norm();
    }
    EXPECT_NEAR(length, tube_.length, 1e-3f * tube_.length);
}

TEST_F(TubeContactTest, SweptBladeDoesNotPassThroughTube) {
    // Along x, so that it cannot escape sideways around the blade, whose plate faces y.
    grip_ = {Quatf(Eigen::AngleAxisf(0.5f * std::numbers::pi_v<float>, Vec3f::UnitY())),
             {-0.03f, 0.012f, 0.05f}};
    TubeContact contact(tube_, scope_, grip_);
    RigidTransform blade{Quatf::Identity(), Vec3f::Zero()};
    for (int k = 0; k < 6; ++k) {
        RigidTransform to = blade;
        to.translation.y() += 1.0f * step_duration;  // 1 m/s
        step(contact, grip_, blade, to);
        blade = to;
    }
    for (const Vec3f& node : nodes_) {
        const Vec3f local = blade.inverse() * node;
        if (std::fabs(local.x()) < 3e-3f) {
            EXPECT_GT(local.y(), 0.0f) << "on the side it was on";
        }
    }
}

TEST_F(TubeContactTest, PushesTissueAndFeelsReaction) {
    // A free particle beside the tip, overlapping by half a millimetre. The second one lies at the origin, in
    // no channel, and touches nothing.
    particles_.resize(2);
    particles_.radius[0] = 0.5e-3f;
    particles_.inverse_mass[0] = 1.0f / 8e-6f;
    particles_.channels[0] = pbd::channel::tube;
    grip_ = pointing_down({0, 0, tube_.grip_from_tip});
    TubeContact contact(tube_, scope_, grip_);
    const float meet = 0.5f * tube_.outer_diameter + particles_.radius[0];
    particles_.position[0] = Vec3f(meet - 0.5e-3f, 0, 4e-3f);
    step(contact, grip_);
    EXPECT_GT(particles_.position[0].x() - nodes_.back().x(), meet - 0.02e-3f);
    EXPECT_LT(nodes_.back().x(), 0.0f) << "Newton's third law; later the tip swings";
}

// Pulled along a row of particles that press on it from one side and are held by springs, the tube
// experiences friction of its coefficient times the normal force (Coulomb), and the particles are dragged by
// as much.
TEST_F(TubeContactTest, TissueFrictionFollowsCoulomb) {
    constexpr std::size_t count = 12;
    constexpr float spring = 20.0f;  // [N/m] each
    tube_.youngs_modulus *= 300.0f;  // does not sag between them
    const float meet = 0.5f * tube_.outer_diameter + 1e-3f;
    particles_.resize(count);
    std::vector<Vec3f> home(count);
    for (std::size_t i = 0; i < count; ++i) {
        particles_.radius[i] = 1e-3f;
        particles_.inverse_mass[i] = 1.0f / 3e-5f;
        particles_.channels[i] = pbd::channel::tube;
        // On opposite sides, so that the tube stays straight.
        const float side = i % 2 == 0 ? 1.0f : -1.0f;
        home[i] = {side * (meet - 1e-3f), 0, 20e-3f + 2e-3f * static_cast<float>(i / 2)};
        particles_.position[i] = home[i] + Vec3f(side * 1e-3f, 0, 0);
    }
    grip_ = pointing_down({0, 0, tube_.grip_from_tip});
    TubeContact contact(tube_, scope_, grip_);
    const auto draw = [&](float speed, int steps) {
        for (int k = 0; k < steps; ++k) {
            RigidTransform to = grip_;
            to.translation.z() -= speed * step_duration;
            step(contact, to, [&](std::size_t i) {
                // Overdamped, like tissue.
                const float share = spring * particles_.inverse_mass[i] * tube_dt * tube_dt;
                particles_.predicted[i] = particles_.position[i] + share * (home[i] - particles_.position[i]);
            });
        }
        Vec3f carried = Vec3f::Zero();
        float pressed = 0.0f;
        for (std::size_t i = 0; i < count; ++i) {
            carried += spring * (particles_.position[i] - home[i]);
            pressed += spring * std::fabs(particles_.position[i].x() - home[i].x());
        }
        return std::pair(-carried.z(), pressed);
    };
    draw(0.0f, steps_per_second / 2);
    const float weight = contact.grip_wrench().force.z();
    for (const float speed : {0.02f, -0.02f}) {
        const auto [carried, pressed] = draw(speed, steps_per_second / 3);
        EXPECT_GT(pressed, 0.1f);
        EXPECT_NEAR(carried, std::copysign(0.05f * pressed, speed), 0.05f * 0.05f * pressed);
        EXPECT_NEAR(contact.grip_wrench().force.z() - weight, carried, 0.1f * 0.05f * pressed);
    }
}

TEST_F(TubeContactTest, SagMatchesBeamTheory) {
    tube_.length = 0.1f;
    tube_.grip_from_tip = 0.1f;
    // Gravity is +y: the patient is supine.
    grip_ = {Quatf::Identity(), Vec3f::Zero()};
    TubeContact contact(tube_, scope_, grip_);
    for (int k = 0; k < 3 * steps_per_second; ++k) {
        step(contact, grip_);
    }
    // Euler-Bernoulli cantilever: w L^4 / (8 E I); PVC of 1300 kg/m^3.
    const float area =
        0.25f * std::numbers::pi_v<float> *
        (tube_.outer_diameter * tube_.outer_diameter - tube_.inner_diameter * tube_.inner_diameter);
    const float weight = 1300.0f * area * 9.81f;
    const float sag = weight * std::pow(tube_.length, 4.0f) / (8.0f * tube_.bending_stiffness());
    EXPECT_NEAR(nodes_.back().y(), sag, 0.05f * sag);
    // The hand carries the full weight, including the connector's.
    const float carried = weight * tube_.length + 9.81f * pbd::RodSettings{}.connector_mass;
    EXPECT_NEAR(contact.grip_wrench().force.y(), carried, 0.05f * carried);
}

// Pushed straight onto the floor the tube pushes back axially, and no longer once it is drawn back.
TEST_F(TubeContactTest, GripFeelsContactForce) {
    // The tip is round and as thick as the tube.
    grip_ = pointing_down({0, 0, tube_.grip_from_tip + 4e-3f});
    shell_ = floor_grid();
    TubeContact contact(tube_, scope_, grip_);
    const auto push = [&](float height) {
        RigidTransform to = grip_;
        to.translation.z() = tube_.grip_from_tip + height;
        for (int k = 0; k < steps_per_second / 2; ++k) {
            step(contact, to);
        }
        return contact.grip_wrench().force.z();
    };
    const float free = push(4e-3f);
    EXPECT_GT(push(-2e-3f), free + 0.01f);
    EXPECT_NEAR(push(4e-3f), free, 1e-3f);
}

/// A pose in the newborn in which the tube lies on an arc from in front of the lips to its tip at a landmark,
/// or beyond.
struct Lying {
    const char* name;
    Landmark tip;
    float turned;  ///< [rad], angle of the tip from backwards towards the feet
    float radius;  ///< [m], of the arc
    const char* of;
    float youngs_modulus;  ///< [Pa]
    float beyond = 0.0f;   ///< [m], of the arc
};

/// A hand that holds a tracked tube without feedback and keeps pushing against resistance.
class PushedTube : public TubeContactTest, public ::testing::WithParamInterface<Lying> {
  protected:
    PushedTube() {
        patient::Posture open;
        open.jaw_opening = 29.0f * std::numbers::pi_v<float> / 180.0f;  // as in the scenarios
        const patient::Patient& newborn = test::coarse_newborn();
        shell_ = scene::PosedShell(newborn, patient::pose_bones(newborn.skeleton, open)).distance();
        const float turned = GetParam().turned;
        Eigen::Matrix3f axes;
        axes.col(0) = Vec3f::UnitX();
        axes.col(2) = Vec3f(0, std::cos(turned), -std::sin(turned));
        axes.col(1) = axes.col(2).cross(axes.col(0));
        const RigidTransform landmark{Quatf(axes),
                                      newborn.landmarks[static_cast<std::size_t>(GetParam().tip)].rest};
        const RigidTransform tip = landmark * along_arc(1.0f / GetParam().radius, GetParam().beyond);
        // The fingers hold it 15 mm in front of the lips.
        const float lips = newborn.landmarks[static_cast<std::size_t>(Landmark::mouth_opening)].rest.y();
        float length = 0.0f;
        do {
            length += 1e-3f;
            held_ = tip * along_arc(1.0f / GetParam().radius, length).inverse();
            narrowest_ = std::min(narrowest_, shell_.distance(held_.translation));
        } while (held_.translation.y() > lips - 15e-3f && length < 0.15f);
        tube_ = Tube{};
        tube_.youngs_modulus = GetParam().youngs_modulus;
        tube_.grip_from_tip = length;
        tube_.length = length + 20e-3f;
    }
    /// A step after which no node may be inside the shell.
    void step_and_look(TubeContact& contact, const RigidTransform& to) {
        step(contact, to);
        for (const Vec3f& node : nodes_) {
            deepest_ = std::min(deepest_, shell_.distance(node));
        }
    }
    /// Maximum speed [m/s] of the tip in the third second after the grip has moved to `to` at 0.2 m/s.
    float rests_at(TubeContact& contact, const RigidTransform& to) {
        const RigidTransform from = grip_;
        const int count = std::max(
            1, static_cast<int>((to.translation - from.translation).norm() / (0.2f * step_duration)));
        for (int k = 1; k <= count; ++k) {
            step_and_look(contact, interpolate(from, to, static_cast<float>(k) / static_cast<float>(count)));
        }
        float fastest = 0.0f;
        for (int k = 0; k < 5 * steps_per_second / 2; ++k) {
            const Vec3f before = nodes_.back();
            step_and_look(contact, grip_);
            if (k >= 2 * steps_per_second) {
                fastest = std::max(fastest, (nodes_.back() - before).norm() / step_duration);
            }
        }
        return fastest;
    }

    RigidTransform held_;
    float narrowest_ = 1.0f;  ///< [m], along the initial path
    float deepest_ = 1.0f;    ///< [m], to the shell; negative: inside it
};

TEST_P(PushedTube, ComesToRestWithoutCrossingWall) {
    ASSERT_GT(narrowest_, 0.0f);
    Tube bent = tube_;
    bent.curve_radius = GetParam().radius;
    for (const Vec3f& direction :
         {Vec3f(0, 0, 1), Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, -1, 0), Vec3f(0, -1, 1)}) {
        grip_ = held_;
        TubeContact contact(bent, scope_, grip_);
        contact.set_material(tube_);
        for (const float push : {10e-3f, 20e-3f, 40e-3f}) {
            deepest_ = 1.0f;
            RigidTransform pushed = held_;
            pushed.translation += held_.rotation * (push * direction.normalized());
            const float fastest = rests_at(contact, pushed);
            EXPECT_LT(fastest, 1e-3f) << "pushed by " << push << " m along " << direction.transpose();
            EXPECT_GT(deepest_, 0.0f) << "pushed by " << push << " m along " << direction.transpose();
            EXPECT_LE(contact.grip_wrench().force.norm(), 1.001f * pbd::RodHold{}.force);
        }
    }
}

/// Bare, and with a stylet as in the scenarios.
std::vector<Lying> everywhere() {
    std::vector<Lying> all;
    for (const auto& [of, modulus] : {std::pair("Bare", 15e6f), std::pair("WithAStylet", 40e6f)}) {
        all.push_back({"mouth", Landmark::tongue_dorsum, -0.25f, 60e-3f, of, modulus});
        all.push_back({"pharynx", Landmark::epiglottis_tip, 0.84f, 42e-3f, of, modulus});
        all.push_back({"glottis", Landmark::glottis, 1.24f, 40e-3f, of, modulus});
        all.push_back({"trachea", Landmark::trachea_mid, 1.59f, 52e-3f, of, modulus});
        all.push_back({"carina", Landmark::carina, 1.64f, 74e-3f, of, modulus});
        all.push_back({"gullet", Landmark::oesophagus_mid, 1.51f, 58e-3f, of, modulus});
        all.push_back({"lowestGullet", Landmark::oesophagus_mid, 1.51f, 58e-3f, of, modulus, 10e-3f});
    }
    return all;
}

INSTANTIATE_TEST_SUITE_P(Places, PushedTube, ::testing::ValuesIn(everywhere()),
                         [](const auto& lying) { return std::string(lying.param.name) + lying.param.of; });

}  // namespace
}  // namespace eti::scene
