// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/soft_body.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/support/cluster_block.hpp"

namespace eti::pbd {
namespace {

constexpr float soft_body_dt = 1.0f / 1440.0f;
constexpr Sleep::Settings soft_body_sleep;

/// Records its calls, and pulls its second particle to its first at their rest distance.
class Noted final : public Constraint {
  public:
    Noted(std::string& notes, char name, Pair pair) : notes_(notes), name_(name), pair_(pair) {}

    [[nodiscard]] std::span<const Pair> coupled_pairs() const override { return {&pair_, 1}; }
    void set_rest(const Particles& /*particles*/) override { note("rest"); }
    void reset() override { note("reset"); }
    void begin_step(Particles& /*particles*/, Sleep& /*sleep*/) override { note("begin"); }
    void select(const Particles& /*particles*/) override { note("select"); }
    void project(Particles& particles, float /*dt*/) override {
        note("project");
        const auto [first, second] = pair_;
        const Vec3f goal = particles.predicted[first] + particles.rest[second] - particles.rest[first];
        if (particles.mobility(second) > 0.0f) {
            particles.predicted[second] = goal;
        }
    }

  private:
    void note(const char* what) {
        notes_ += name_;
        notes_ += what;
        notes_ += ' ';
    }

    std::string& notes_;
    char name_;
    Pair pair_;
};

/// Counts its passes.
class Counted final : public Constraint {
  public:
    explicit Counted(int& last) : last_(last) {}
    void project(Particles& /*particles*/, float /*dt*/) override { last_ = ++passes_; }

  private:
    int& last_;  // of the constraint projected last
    int passes_ = 0;
};

/// A cube of 24 mm in blocks of clusters, fixed by its uppermost layers, with two further constraints.
class SoftBodyTest : public ::testing::Test {
  protected:
    static constexpr int n = 13;
    static constexpr std::uint32_t corner = 0, far = n - 1;  // of the lowest layer

    SoftBodyTest() : body_(test::cluster_block(n, 8e3f, Vec3f::Zero(), 2)) {
        body_.settings.damping = 60.0f;
        body_.constraints.push_back(Noted(notes_, 'a', Constraint::Pair{corner, far}));
        body_.constraints.push_back(Noted(notes_, 'b', Constraint::Pair{corner, far}));
    }

    void step() {
        body_.begin_step();
        test::substep(body_, soft_body_dt);
        body_.end_step();
    }
    [[nodiscard]] std::string notes() { return std::exchange(notes_, {}); }

    std::string notes_;
    SoftBody body_;
};

TEST_F(SoftBodyTest, CallsConstraintsInOrder) {
    body_.enable_sleeping({}, soft_body_sleep);
    step();
    EXPECT_EQ(notes(), "abegin bbegin aselect bselect aproject bproject ");
    step();
    EXPECT_EQ(notes(), "abegin bbegin aproject bproject ") << "the same are awake";
    body_.set_rest();
    EXPECT_EQ(notes(), "arest brest ");
    body_.reset();
    EXPECT_EQ(notes(), "areset breset ");
}

// For the sanitizers, which reject access to the first element of an empty array.
TEST(SoftBody, EmptyBodyTakesSubsteps) {
    SoftBody body;
    body.particles.resize(0);
    body.begin_step();
    test::substep(body, soft_body_dt);
    body.end_step();
    body.set_rest();
    body.reset();
    EXPECT_TRUE(body.sleep.all_awake());
}

TEST_F(SoftBodyTest, ProjectsConstraintsAfterClusters) {
    body_.particles.position[corner].y() -= 1e-3f;
    test::substep(body_, soft_body_dt);
    const Particles& p = body_.particles;
    EXPECT_LT((p.position[far] - p.position[corner] - (p.rest[far] - p.rest[corner])).norm(), 1e-8f);
    EXPECT_LT(p.position[far].y(), -1e-5f);
}

TEST_F(SoftBodyTest, ProjectsNoConstraintWhileAllSleep) {
    body_.enable_sleeping({}, soft_body_sleep);
    for (int k = 0; k <= soft_body_sleep.steps; ++k) {
        step();
    }
    ASSERT_FALSE(body_.sleep.any_awake());
    step();
    notes_.clear();
    step();
    EXPECT_EQ(notes(), "abegin bbegin ");
}

TEST_F(SoftBodyTest, CopyHasIndependentConstraints) {
    int last = 0;
    body_.constraints.assign(1, Counted(last));
    test::substep(body_, soft_body_dt);
    SoftBody copy = body_;
    test::substep(copy, soft_body_dt);
    EXPECT_EQ(last, 2) << "the copy goes on from where its origin was";
    test::substep(copy, soft_body_dt);
    test::substep(body_, soft_body_dt);
    EXPECT_EQ(last, 2) << "the origin did not go on with the copy";
}

TEST_F(SoftBodyTest, ConstraintWakesItsParticles) {
    body_.enable_sleeping({}, soft_body_sleep);
    for (int k = 0; k <= soft_body_sleep.steps; ++k) {
        step();
    }
    ASSERT_FALSE(body_.sleep.any_awake());
    for (int k = 0; k < 3; ++k) {
        body_.sleep.wake(body_.particles, corner);
        body_.particles.position[corner].y() -= 1e-3f;
        step();
    }
    EXPECT_GT(body_.particles.mobility(far), 0.0f);
}

}  // namespace
}  // namespace eti::pbd
