// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/rigid/rigid_layer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "common/math/units.hpp"
#include "shell_shapes.hpp"

namespace eti::rigid {
namespace {

using test::blade_radius;
using test::box_mesh;
using test::floor_mesh;
using test::rod_scope;
using test::tissue_of;

constexpr float dt = 1.0f / 180.0f;

RigidTransform at_height(float y, float x = 0.0f) {
    return {Quatf::Identity(), {x, y, -0.05f}};
}

Vec3f sum_of_normal_forces(const ProxyResult& result) {
    Vec3f sum = Vec3f::Zero();
    for (const Contact& contact : result.contacts) {
        sum += contact.force * contact.normal;
    }
    return sum;
}

// Residual of the momentum balance of a reported steady force: the remaining speed belongs to the effective
// mass m + h c + h^2 k of the implicit coupling over one substep h.
float steady_tolerance(const Settings& settings, const ProxyResult& result) {
    const float h = dt / static_cast<float>(result.substeps);
    const float mass = settings.mass + h * settings.damping + h * h * settings.stiffness;
    const float float_error = settings.stiffness * 100.0f * std::numeric_limits<float>::epsilon();
    return mass * result.velocity.norm() / h + float_error;
}

TEST(RigidLayer, PressedProxyCarriesTheSpringForce) {
    const TriangleMesh shell = floor_mesh(0.4f, 30);
    const Settings settings;
    RigidLayer layer(rod_scope(), shell, tissue_of(shell, Tissue::upper_gum), settings);
    layer.reset(at_height(0.02f));
    const RigidTransform device = at_height(blade_radius - 5 * millimetre);
    for (int i = 0; i < 180; ++i) {
        layer.step(device, dt);
    }
    const ProxyResult& result = layer.result();
    const float extension = result.pose.translation.y() - device.translation.y();
    // The rod lies flat: the contact balances the spring's pull at one end; the far end stays off or at rest.
    EXPECT_NEAR(extension, 5 * millimetre, 0.01f * millimetre);
    EXPECT_NEAR(result.force.y(), settings.stiffness * extension, steady_tolerance(settings, result));
    EXPECT_LT(steady_tolerance(settings, result), 0.05f) << "the tolerance must mean something at 10 N";
    EXPECT_NEAR(sum_of_normal_forces(result).y(), result.force.y(), 1e-3f);
    EXPECT_LT(std::hypot(result.force.x(), result.force.z()), 0.02f);
    EXPECT_LT(result.penetration, settings.penetration_tolerance);
    ASSERT_FALSE(result.contacts.empty());
    for (const Contact& contact : result.contacts) {
        EXPECT_EQ(contact.tissue, Tissue::upper_gum);
        EXPECT_NEAR(contact.position.y(), 0.0f, 1e-6f);
        EXPECT_GT(contact.normal.y(), 0.9999f);
    }
}

TEST(RigidLayer, CachedTrianglesMatchFreshQuery) {
    // Cached triangles are reused while the tool moves on; a fresh layer at each pose finds its own.
    const TriangleMesh shell = box_mesh(Vec3f::Constant(-0.03f), Vec3f::Constant(0.03f), 6);
    const std::vector<Tissue> tissue = tissue_of(shell);
    RigidLayer goes(rod_scope(), shell, tissue, Settings{});
    int touched = 0;
    for (int i = 0; i < 200; ++i) {
        const float along = 0.4e-3f * static_cast<float>(i);
        const Quatf turn(Eigen::AngleAxisf(0.01f * static_cast<float>(i), Vec3f(1, 2, 3).normalized()));
        const RigidTransform place{turn, Vec3f(along, along - 0.06f, 0.5f * along - 0.06f)};
        goes.reset(place);
        RigidLayer stands(rod_scope(), shell, tissue, Settings{});
        stands.reset(place);
        EXPECT_EQ(goes.result().penetration, stands.result().penetration) << i;
        touched += stands.result().penetration > 0.0f ? 1 : 0;
    }
    EXPECT_GT(touched, 10);
    EXPECT_LT(touched, 190);
}

TEST(RigidLayer, TippedBladeBalancesForceAndTorque) {
    const TriangleMesh shell = floor_mesh(0.6f, 40);
    Settings settings;
    settings.friction = 0.0f;
    RigidLayer layer(rod_scope(), shell, tissue_of(shell), settings);
    // Tip down by 40 deg: one contact at the tip, 96 mm from the origin.
    const Quatf tipped(Eigen::AngleAxisf(40 * degree, Vec3f::UnitX()));
    RigidTransform device{tipped, {0, 0.1f, 0}};
    layer.reset(device);
    for (int i = 0; i < 60; ++i) {
        layer.step(device, dt);
    }
    device.translation.y() = (0.1f - blade_radius) * std::sin(40 * degree) + blade_radius - 4 * millimetre;
    for (int i = 0; i < 400; ++i) {
        layer.step(device, dt);
    }
    const ProxyResult& result = layer.result();
    const Vec3f spring = settings.stiffness * (device.translation - result.pose.translation);
    const Vec3f spring_torque =
        settings.rotational_stiffness * rotation_vector(device.rotation * result.pose.rotation.conjugate());
    EXPECT_GT(result.force.y(), 1.0f);
    EXPECT_LT((result.force + spring).norm(), steady_tolerance(settings, result) + 1e-3f);
    // The lever arm of 0.1 m turns the force's tolerance into the torque's; the rotation is read back from a
    // float quaternion, 20 N m/rad times a few epsilon.
    EXPECT_LT((result.torque + spring_torque).norm(), 0.1f * steady_tolerance(settings, result) + 2e-4f);
    Vec3f torque = Vec3f::Zero();
    for (const Contact& contact : result.contacts) {
        torque += (contact.position - result.pose.translation).cross(contact.force * contact.normal);
    }
    EXPECT_LT((torque - result.torque).norm(), 1e-3f * result.torque.norm());
}

// The blade lies between two gums, as in a mouth, and the hand turns it: each gum carries the hand's torque
// over the distance between them, however small the sum of all contacts is. So 130 N on a gum may occur with
// 34 N in total.
TEST(RigidLayer, BladeBetweenGumsActsAsLever) {
    constexpr float near = 0.056f, far = 0.084f;  // [m], along the blade, to the ridge of each gum
    constexpr float half_width = 0.1e-3f;         // [m], of the ridges
    TriangleMesh shell = box_mesh({-0.02f, -blade_radius - 0.01f, near - half_width},
                                  {0.02f, -blade_radius, near + half_width}, 2);
    std::vector<Tissue> tissue = tissue_of(shell, Tissue::upper_gum);
    const TriangleMesh lower = box_mesh({-0.02f, blade_radius, far - half_width},
                                        {0.02f, blade_radius + 0.01f, far + half_width}, 2);
    const std::uint32_t first = static_cast<std::uint32_t>(shell.vertices.size());
    for (const Triangle& t : lower.triangles) {
        shell.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    shell.vertices.insert(shell.vertices.end(), lower.vertices.begin(), lower.vertices.end());
    tissue.resize(shell.triangles.size(), Tissue::lower_gum);
    Settings settings;
    settings.friction = 0.0f;
    RigidLayer layer(rod_scope(), shell, tissue, settings);
    layer.reset({});
    // The hand turns the tip up, towards the lower gum, and pushes down by a millimetre.
    const RigidTransform device{Quatf(Eigen::AngleAxisf(-6 * degree, Vec3f::UnitX())), {0, -1e-3f, 0}};
    for (int i = 0; i < 400; ++i) {
        layer.step(device, dt);
    }
    const ProxyResult& result = layer.result();
    const Vec3f force = settings.stiffness * (device.translation - result.pose.translation);
    const Vec3f torque =
        settings.rotational_stiffness * rotation_vector(device.rotation * result.pose.rotation.conjugate());
    ASSERT_LT(force.norm(), settings.force_limit);
    ASSERT_LT(torque.norm(), settings.torque_limit);
    // Balance of forces along y, and of torques about x, where a force along y at z has the torque -z times
    // it.
    const float lower_bears = -(torque.x() + force.y() * near) / (far - near);
    const float upper_bears = lower_bears - force.y();
    EXPECT_GT(upper_bears, 5.0f * force.norm()) << "a lever, or the test says nothing";
    float on_upper = 0.0f;
    float on_lower = 0.0f;
    for (const Contact& contact : result.contacts) {
        (contact.tissue == Tissue::upper_gum ? on_upper : on_lower) += contact.force;
    }
    // The remaining speed, which the longest arm turns into force on a gum; and both ridges' width.
    const float tolerance = steady_tolerance(settings, result) * rod_scope().blade_length / (far - near) +
                            2.0f * half_width / (far - near) * upper_bears;
    EXPECT_LT(tolerance, 0.02f * upper_bears);
    EXPECT_NEAR(on_upper, upper_bears, tolerance);
    EXPECT_NEAR(on_lower, lower_bears, tolerance);
    EXPECT_LT((result.force + force).norm(), steady_tolerance(settings, result) + 1e-3f);
    EXPECT_NEAR(on_upper - on_lower, result.force.y(), 0.01f) << "each contact is counted once";
}

TEST(RigidLayer, SlidesWithoutCatchingOnInternalEdges) {
    const TriangleMesh shell = floor_mesh(0.4f, 60);
    const Settings settings;
    RigidLayer layer(rod_scope(), shell, tissue_of(shell), settings);
    const float pressed = blade_radius - 2 * millimetre;
    layer.reset(at_height(blade_radius, -0.08f));
    for (int i = 0; i < 90; ++i) {
        layer.step(at_height(pressed, -0.08f), dt);
    }
    float lowest = 1.0f;
    float highest = 0.0f;
    for (int i = 0; i < 288; ++i) {
        const float x = -0.08f + 0.1f * dt * static_cast<float>(i + 1);
        const ProxyResult& result = layer.step(at_height(pressed, x), dt);
        lowest = std::min(lowest, result.pose.translation.y());
        highest = std::max(highest, result.pose.translation.y());
        if (i > 100) {
            // Sliding friction opposes the motion with the Coulomb coefficient. The two friction directions
            // follow the velocity of each contact point, so the pyramid is exact here except for the slow
            // rotation about the handle.
            EXPECT_NEAR(-result.force.x() / result.force.y(), settings.friction, 0.05f * settings.friction);
            // The spring balances the friction: lag = mu N / k, rotated a little by the torque.
            EXPECT_NEAR(x - result.pose.translation.x(),
                        settings.friction * result.force.y() / settings.stiffness, 0.05f * millimetre);
        }
    }
    EXPECT_LT(highest - lowest, 0.01f * millimetre);
}

TEST(RigidLayer, CornerStopsBothDirections) {
    TriangleMesh shell = floor_mesh(0.3f, 20);
    test::append_rectangle(shell, {0.03f, 0, -0.15f}, {0, 0, 0.3f}, {0, 0.2f, 0}, 20, 20);
    shell = test::welded(shell);
    Settings settings;
    settings.friction = 0.0f;
    RigidLayer layer(rod_scope(), shell, tissue_of(shell), settings);
    // The handle's radius exceeds the blade's: rolled by 45 deg into the corner's bisector it stays free.
    const Quatf rolled(Eigen::AngleAxisf(45 * degree, Vec3f::UnitZ()));
    layer.reset({rolled, {0, 0.04f, -0.05f}});
    const RigidTransform device{
        rolled, {0.03f - blade_radius + 3 * millimetre, blade_radius - 5 * millimetre, -0.05f}};
    for (int i = 0; i < 240; ++i) {
        layer.step(device, dt);
    }
    const ProxyResult& result = layer.result();
    EXPECT_NEAR(result.force.y(), settings.stiffness * (result.pose.translation - device.translation).y(),
                steady_tolerance(settings, result));
    EXPECT_NEAR(result.force.x(), settings.stiffness * (result.pose.translation - device.translation).x(),
                steady_tolerance(settings, result));
    EXPECT_NEAR(result.pose.translation.x(), 0.03f - blade_radius, 0.02f * millimetre);
    EXPECT_NEAR(result.pose.translation.y(), blade_radius, 0.02f * millimetre);
}

TEST(RigidLayer, FreeProxyFollowsWithoutLag) {
    RigidLayer layer(rod_scope(), {}, {});
    layer.reset(at_height(0));
    float lag = 0.0f;
    for (int i = 1; i <= 360; ++i) {
        const RigidTransform device = at_height(0, 0.2f * dt * static_cast<float>(i));
        layer.step(device, dt);
        lag = (device.translation - layer.result().pose.translation).norm();
    }
    RecordProperty("lag_um_at_0.2_m_per_s", std::to_string(lag * 1e6f));
    // The damper acts on the velocity relative to the device's, so that a steady motion has no lag; what
    // remains is position round-off, 0.4 m times epsilon, over a time constant of some substeps.
    EXPECT_LT(lag, 2e-6f);
    EXPECT_NEAR(layer.result().velocity.x(), 0.2f, 1e-3f);
}

class Tunnelling : public testing::TestWithParam<float> {};

TEST_P(Tunnelling, ThinWallStopsEveryApproach) {
    const float speed = GetParam();
    const TriangleMesh shell =
        test::box_mesh({-0.15f, -0.5f * millimetre, -0.15f}, {0.15f, 0.5f * millimetre, 0.15f}, 25);
    const Laryngoscope scope = rod_scope();
    const Quatf flat = Quatf::Identity();
    const Quatf tip_first(Eigen::AngleAxisf(90 * degree, Vec3f::UnitX()));
    const Quatf oblique(Eigen::AngleAxisf(25 * degree, Vec3f(1, 0.3f, 0.2f).normalized()));
    for (const Quatf& turn : {flat, tip_first, oblique}) {
        RigidLayer layer(scope, shell, tissue_of(shell));
        const Vec3f start(0.003f, 0.14f, -0.03f);
        layer.reset({turn, start});
        const int steps = static_cast<int>(0.26f / (speed * dt));
        for (int i = 1; i <= steps; ++i) {
            const ProxyResult& result =
                layer.step({turn, start - Vec3f(0, speed * dt * static_cast<float>(i), 0)}, dt);
            for (const Capsule& capsule : scope.capsules) {
                ASSERT_GT((result.pose * capsule.a).y(), 0.5f * capsule.radius) << "step " << i;
                ASSERT_GT((result.pose * capsule.b).y(), 0.5f * capsule.radius) << "step " << i;
            }
            ASSERT_LT(result.penetration, 0.2f * blade_radius);
            ASSERT_EQ(result.rolled_back, 0) << "contacts must act before the last resort does";
        }
        // Back above the wall the proxy coincides with the device again.
        for (int i = 0; i < 360; ++i) {
            layer.step({turn, start}, dt);
        }
        EXPECT_LT((layer.result().pose.translation - start).norm(), 0.01f * millimetre);
    }
}

INSTANTIATE_TEST_SUITE_P(Speeds, Tunnelling, testing::Values(0.1f, 0.3f, 0.6f, 1.0f));

TEST(RigidLayer, ThinFinStopsTheBladeSideways) {
    const TriangleMesh shell =
        test::box_mesh({-0.5f * millimetre, -0.05f, 0.02f}, {0.5f * millimetre, 0.0f, 0.021f}, 6);
    const Laryngoscope scope = rod_scope();
    RigidLayer layer(scope, shell, tissue_of(shell));
    const Quatf turn = Quatf::Identity();
    layer.reset({turn, {0.05f, -0.02f, -0.02f}});
    for (int i = 1; i <= 20; ++i) {  // 1 m/s
        layer.step({turn, {0.05f - static_cast<float>(i) * dt, -0.02f, -0.02f}}, dt);
        const RigidTransform& pose = layer.result().pose;
        const Vec3f a = pose * scope.capsules[1].a;
        const Vec3f b = pose * scope.capsules[2].b;
        const Vec3f crossing = a + (0.0205f - a.z()) / (b.z() - a.z()) * (b - a);
        ASSERT_GT(crossing.x(), 0.5f * millimetre);
    }
    EXPECT_GT(layer.result().force.x(), 10.0f);
}

TEST(RigidLayer, JumpsAndHalfTurnsStayBoundedAndRecover) {
    const TriangleMesh shell = floor_mesh(0.4f, 20);
    const Settings settings;
    RigidLayer layer(rod_scope(), shell, tissue_of(shell), settings);
    layer.reset(at_height(0.05f));
    const std::array<RigidTransform, 4> poses = {
        at_height(0.05f, 1.0f), RigidTransform{Quatf(0, 0, 1, 0), {0, 0.2f, 0}},
        RigidTransform{Quatf(0, 1, 0, 0), {0, -0.9f, 0}}, at_height(0.05f)};
    for (const RigidTransform& device : poses) {
        for (int i = 0; i < 540; ++i) {
            const ProxyResult& result = layer.step(device, dt);
            ASSERT_TRUE(result.pose.translation.allFinite());
            ASSERT_LT(result.velocity.norm(), settings.force_limit / settings.damping * 1.2f);
            // The shell carries at most the spring and the impulse that stops the proxy within a step.
            ASSERT_LT(result.force.norm(), 3.0f * settings.force_limit);
        }
    }
    EXPECT_LT((layer.result().pose.translation - poses.back().translation).norm(), 0.01f * millimetre);
    EXPECT_LT(rotation_vector(layer.result().pose.rotation * poses.back().rotation.conjugate()).norm(),
              1e-3f);
}

TEST(RigidLayer, LastFreePoseIsClearOfTheShell) {
    const TriangleMesh shell = floor_mesh(0.4f, 20);
    const Settings settings;
    RigidLayer layer(rod_scope(), shell, tissue_of(shell), settings);
    layer.reset(at_height(0.03f));
    for (int i = 1; i < 60; ++i) {
        const ProxyResult& result = layer.step(at_height(0.03f - 0.5f * dt * static_cast<float>(i)), dt);
        for (const Capsule& capsule : rod_scope().capsules) {
            for (const Vec3f& end : {capsule.a, capsule.b}) {
                EXPECT_GT((result.last_free * end).y(),
                          capsule.radius - settings.penetration_tolerance - 1e-6f);
            }
        }
        EXPECT_LT((result.last_free.translation - result.pose.translation).norm(), 1 * millimetre);
    }
}

TEST(RigidLayer, ContactsBeyondTheBoundAreCounted) {
    const TriangleMesh shell = floor_mesh(0.4f, 30);
    Settings settings;
    std::uint32_t dropped[2];
    for (const int bound : {128, 1}) {
        settings.max_contacts = bound;
        RigidLayer layer(rod_scope(), shell, tissue_of(shell, Tissue::upper_gum), settings);
        layer.reset(at_height(0.02f));
        for (int i = 0; i < 60; ++i) {
            layer.step(at_height(blade_radius - 5 * millimetre), dt);
        }
        dropped[bound == 1 ? 1 : 0] = layer.result().dropped_contacts;
        EXPECT_GE(layer.result().contacts.size(), 1u);
        EXPECT_TRUE(layer.result().pose.translation.allFinite());
    }
    EXPECT_EQ(dropped[0], 0u);
    EXPECT_GE(dropped[1], 1u) << "a rod that lies flat touches with both ends";
}

TEST(RigidLayer, SameInputsGiveTheSameBits) {
    const TriangleMesh shell = box_mesh({-0.05f, -0.05f, 0.0f}, {0.05f, 0.0f, 0.1f}, 12);
    const auto run = [&](RigidLayer& layer) {
        std::vector<float> trace;
        layer.reset(at_height(0.03f));
        for (int i = 0; i < 300; ++i) {
            const float t = static_cast<float>(i) * dt;
            const Quatf turn(Eigen::AngleAxisf(0.3f * std::sin(7 * t), Vec3f(1, 0.4f, 0.1f).normalized()));
            const ProxyResult& r =
                layer.step({turn, {0.02f * std::sin(5 * t), 0.01f * std::cos(9 * t), -0.02f}}, dt);
            for (const Vec3f& v : {r.pose.translation, r.velocity, r.angular_velocity, r.force, r.torque}) {
                trace.insert(trace.end(), {v.x(), v.y(), v.z()});
            }
            for (const Contact& c : r.contacts) {
                trace.insert(trace.end(), {c.force, c.position.x(), c.normal.z()});
            }
        }
        return trace;
    };
    RigidLayer first(rod_scope(), shell, tissue_of(shell));
    const std::vector<float> once = run(first);
    const std::vector<float> again = run(first);  // after other work on the same layer
    RigidLayer second(rod_scope(), shell, tissue_of(shell));
    const std::vector<float> fresh = run(second);
    ASSERT_EQ(once.size(), again.size());
    ASSERT_EQ(once.size(), fresh.size());
    EXPECT_GT(once.size(), 300u * 15u) << "the run must touch the shell";
    EXPECT_EQ(std::memcmp(once.data(), again.data(), once.size() * sizeof(float)), 0);
    EXPECT_EQ(std::memcmp(once.data(), fresh.data(), once.size() * sizeof(float)), 0);
}

TEST(RigidLayer, MovingShellCarriesTheProxy) {
    TriangleMesh shell = floor_mesh(0.4f, 20);
    const Settings settings;
    RigidLayer layer(rod_scope(), shell, tissue_of(shell), settings);
    layer.reset(at_height(blade_radius));
    for (int i = 0; i < 180; ++i) {  // 20 mm/s for a second
        for (Vec3f& vertex : shell.vertices) {
            vertex.y() += 0.02f * dt;
        }
        layer.move_shell(shell.vertices);
        layer.step(at_height(blade_radius), dt);
    }
    for (int i = 0; i < 90; ++i) {
        layer.step(at_height(blade_radius), dt);
    }
    EXPECT_NEAR(layer.result().pose.translation.y(), 0.02f + blade_radius, settings.penetration_tolerance);
    EXPECT_NEAR(layer.result().force.y(), settings.stiffness * 0.02f, 0.01f * settings.stiffness * 0.02f);
}

// Candidates and their hierarchy follow a creeping shell late.
TEST(RigidLayer, CreepingShellIsMetAsOneBuiltThere) {
    TriangleMesh shell = floor_mesh(0.4f, 20);
    RigidLayer crept(rod_scope(), shell, tissue_of(shell));
    const RigidTransform above = at_height(0.02f);
    crept.reset(above);
    for (int i = 0; i < 500; ++i) {
        for (Vec3f& vertex : shell.vertices) {
            vertex += Vec3f(0.02f, 0.03f + 0.1f * vertex.x(), 0.01f) * millimetre;
        }
        crept.move_shell(shell.vertices);
        crept.step(above, dt);
        ASSERT_TRUE(crept.result().contacts.empty());
    }
    RigidLayer fresh(rod_scope(), shell, tissue_of(shell));
    std::size_t met = 0;
    for (RigidLayer* layer : {&crept, &fresh}) {
        layer->reset(above);
    }
    for (int i = 0; i < 180; ++i) {
        for (RigidLayer* layer : {&crept, &fresh}) {
            layer->step(at_height(0.015f - 0.1e-3f * static_cast<float>(i)), dt);
        }
        ASSERT_EQ(crept.result().contacts.size(), fresh.result().contacts.size()) << i;
        ASSERT_EQ(crept.result().force, fresh.result().force) << i;
        met += fresh.result().contacts.size();
    }
    EXPECT_GT(met, 100u);
}

TEST(RigidLayer, ProxyInsideTheShellComesFree) {
    const TriangleMesh shell = box_mesh({-0.1f, -0.05f, -0.1f}, {0.1f, 0.0f, 0.1f}, 20);
    RigidLayer layer(rod_scope(), shell, tissue_of(shell));
    layer.reset(at_height(-0.02f));  // the blade lies in the solid, the handle sticks out
    const RigidTransform above = at_height(0.03f);
    for (int i = 0; i < 180; ++i) {
        const ProxyResult& result = layer.step(above, dt);
        ASSERT_TRUE(result.pose.translation.allFinite());
    }
    EXPECT_FALSE(layer.result().embedded);
    EXPECT_LT((layer.result().pose.translation - above.translation).norm(), 0.01f * millimetre);
    for (int i = 0; i < 180; ++i) {
        layer.step(at_height(-0.002f), dt);
    }
    EXPECT_NEAR(layer.result().pose.translation.y(), blade_radius, 0.05f * millimetre)
        << "and is held from outside";
}

TEST(RigidLayer, RefusesMalformedInput) {
    const TriangleMesh shell = floor_mesh(0.1f, 2);
    std::vector<Tissue> few(shell.triangles.size() - 1, Tissue::soft);
    EXPECT_THROW(RigidLayer(rod_scope(), shell, few), std::invalid_argument);
    TriangleMesh broken = shell;
    broken.triangles[0][1] = 4711;
    EXPECT_THROW(RigidLayer(rod_scope(), broken, tissue_of(broken)), std::invalid_argument);
    EXPECT_THROW(RigidLayer(Laryngoscope{}, shell, tissue_of(shell)), std::invalid_argument);

    RigidLayer layer(rod_scope(), shell, tissue_of(shell));
    layer.reset(at_height(0.05f));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    layer.step({Quatf(nan, 0, 0, 0), {0, nan, 0}}, dt);
    EXPECT_LT((layer.result().pose.translation - at_height(0.05f).translation).norm(), 1e-6f);
}

}  // namespace
}  // namespace eti::rigid
