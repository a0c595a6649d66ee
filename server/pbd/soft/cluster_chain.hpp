// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/pbd/constraint.hpp"

namespace eti::pbd {

/// Neighbouring clusters joined to a beam. Shape matching keeps the shape of each; XPBD constraints (Macklin
/// et al. 2016) couple the frames of neighbours like rigid bodies:
///     rotation    log(R_next R^T),  compliance l / (E I);
///     gap         at the joint,     compliance l / (E A) along the beam, l / (k G A) across.
/// All joints are solved at once. A static load therefore meets the compliances, not inertia: the stiffness
/// does not depend on the substep, unlike that of overlapping clusters (cantilevers,
/// tests/unit/server/pbd/soft/cluster_chain_test.cpp). Moments and forces of a joint are equal and opposite.
class ClusterChain final : public Constraint {
  public:
    static constexpr std::size_t max_clusters = 6;

    struct Description {
        /// [clusters]: members, disjoint, ordered from one end to the other; two or more clusters.
        std::vector<std::vector<std::uint32_t>> clusters;
        std::vector<float> fitting_mass;  ///< [particles][kg]; finite even where the mass is infinite
        std::vector<float> volume;        ///< [particles][m^3]
        float youngs_modulus = 320e3f;    ///< [Pa]
        float poissons_ratio = 0.45f;
        Vec3f across = Vec3f::UnitX();  ///< unit vector; not changed by postures
    };

    void configure(const Description& description, const Particles& particles);
    [[nodiscard]] std::span<const Pair> coupled_pairs() const override { return coupled_pairs_; }
    void set_rest(const Particles& particles) override;
    void reset() override;
    void select(const Particles& particles) override;
    void project(Particles& particles, float dt) override;

  private:
    static constexpr int max_rows = 6 * (static_cast<int>(max_clusters) - 1);
    using Matrix6 = Eigen::Matrix<float, 6, 6>;
    using Rows = Eigen::Matrix<float, Eigen::Dynamic, 1, 0, max_rows, 1>;
    using Square = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, 0, max_rows, max_rows>;

    struct Member {
        std::uint32_t particle = 0;
        float weight = 0.0f;        ///< sums to one over a cluster
        Vec3f arm = Vec3f::Zero();  ///< [m], from the cluster's centre, at rest
        bool free = true;
    };
    struct Cluster {
        std::vector<Member> members;
        float mass = 0.0f;                                          ///< [kg]
        Vec3f rest_centre = Vec3f::Zero();                          ///< [m]
        Eigen::Matrix3f inverse_inertia = Eigen::Matrix3f::Zero();  ///< [1/(kg m^2)], inverse inertia at rest
        /// Response of its frame (centre, rotation) to a force and a moment at rest; reduced where members
        /// are held.
        Matrix6 response = Matrix6::Zero();
        Vec3f centre = Vec3f::Zero();  ///< [m], of the last fit
        Quatf rotation = Quatf::Identity();
        Vec3f shift = Vec3f::Zero(), turn = Vec3f::Zero();  ///< [m] and [rad], of the last pass
    };
    struct Joint {
        Vec3f rest = Vec3f::Zero();  ///< [m]
        /// [m/N] and [rad/(N m)]: at rest, and in the joint's own axes.
        Eigen::Matrix3f stretch_compliance = Eigen::Matrix3f::Zero(),
                        bend_compliance = Eigen::Matrix3f::Zero();
        Vec3f local_stretch_compliance = Vec3f::Zero(), local_bend_compliance = Vec3f::Zero();
        Vec3f bend_rotation = Vec3f::Zero();  ///< [rad], in the middle cluster's frame
    };

    void fit(Cluster& cluster, const std::vector<Vec3f>& positions) const;
    void measure();
    void invert(float dt);
    void compute_response();
    [[nodiscard]] const Quatf& middle() const { return clusters_[clusters_.size() / 2].rotation; }

    std::vector<Cluster> clusters_;            // [clusters]
    std::vector<Joint> joints_;                // [clusters - 1]
    std::vector<Pair> coupled_pairs_;          // members of neighbouring clusters
    std::vector<Vec3f> inverted_at_rotation_;  // [joints][rad], at the last inversion
    Vec3f across_ = Vec3f::UnitX();
    Rows residual_,
        multiplier_;  // joint gaps, and multipliers over the squared substep
    Square inverse_;  // for inverse_dt_; in the middle cluster's frame
    float inverse_dt_ = 0.0f;
    bool asleep_ = false;
};

}  // namespace eti::pbd
