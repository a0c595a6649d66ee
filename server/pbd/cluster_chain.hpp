// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/pbd/constraint.hpp"

namespace eti::pbd {

/// Clusters side by side that are joined to a beam. Shape matching keeps each one's shape; here neighbours'
/// frames are held to each other, as rigid bodies, by XPBD constraints (Macklin et al. 2016):
///     turn apart    log(R_next R^T),  compliance l / (E I);
///     joint apart,                    compliance l / (E A) along the beam, l / (k G A) across.
/// All joints are solved at once. Where a beam at rest bears a load, that meets the compliances, not inertia:
/// how stiff it is does not hang on the substep, as it does where clusters overlap (cantilevers,
/// tests/unit/server/pbd/cluster_chain_test.cpp). A joint's moments and forces are equal and opposite.
class ClusterChain final : public Constraint {
  public:
    static constexpr std::size_t most_clusters = 6;

    struct Description {
        /// Members, each in one cluster, from one end to the other; two or more clusters.
        std::vector<std::vector<std::uint32_t>> clusters;
        std::vector<float> fitting_mass;  ///< [kg], per particle; finite also where the mass is infinite
        std::vector<float> volume;        ///< [m^3], per particle
        float youngs_modulus = 320e3f;    ///< [Pa]
        float poissons_ratio = 0.45f;
        Vec3f across = Vec3f::UnitX();  ///< unit vector; postures leave it as it is
    };

    void configure(const Description& description, const Particles& particles);
    [[nodiscard]] std::span<const Pair> ties() const override { return ties_; }
    void set_rest(const Particles& particles) override;
    void reset() override;
    void select(const Particles& particles) override;
    void project(Particles& particles, float dt) override;

  private:
    static constexpr int most_rows = 6 * (static_cast<int>(most_clusters) - 1);
    using Matrix6 = Eigen::Matrix<float, 6, 6>;
    using Vector6 = Eigen::Matrix<float, 6, 1>;
    using Rows = Eigen::Matrix<float, Eigen::Dynamic, 1, 0, most_rows, 1>;
    using Square = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, 0, most_rows, most_rows>;

    struct Member {
        std::uint32_t particle = 0;
        float weight = 0.0f;        ///< they sum to one in a cluster
        Vec3f arm = Vec3f::Zero();  ///< [m], from the cluster's centre at rest
        bool free = true;
    };
    struct Cluster {
        std::vector<Member> members;
        float mass = 0.0f;                                    ///< [kg]
        Vec3f rest_centre = Vec3f::Zero();                    ///< [m]
        Eigen::Matrix3f lightness = Eigen::Matrix3f::Zero();  ///< [1/(kg m^2)], inverse inertia at rest
        /// How its frame, centre and turn, answers a force and a moment at rest: less where members are held.
        Matrix6 answer = Matrix6::Zero();
        Vec3f centre = Vec3f::Zero();  ///< [m], as last fitted
        Quatf rotation = Quatf::Identity();
        Vec3f shift = Vec3f::Zero(), turn = Vec3f::Zero();  ///< [m] and [rad], of the last pass
    };
    struct Joint {
        Vec3f rest = Vec3f::Zero();  ///< [m]
        /// [m/N] and [rad/(N m)] at rest, and those about and along the joint's own axes.
        Eigen::Matrix3f give = Eigen::Matrix3f::Zero(), bend = Eigen::Matrix3f::Zero();
        Vec3f own_give = Vec3f::Zero(), own_bend = Vec3f::Zero();
        Vec3f bent = Vec3f::Zero();  ///< [rad], in the middle cluster's frame
    };

    void fit(Cluster& cluster, const std::vector<Vec3f>& positions) const;
    void measure();
    void invert(float dt);
    void answer();
    [[nodiscard]] const Quatf& middle() const { return clusters_[clusters_.size() / 2].rotation; }

    std::vector<Cluster> clusters_;
    std::vector<Joint> joints_;
    std::vector<Pair> ties_;        // members of neighbours
    std::vector<Vec3f> bent_then_;  // as the joints were when last inverted
    Vec3f across_ = Vec3f::UnitX();
    Rows apart_, held_;  // what joints are apart, and with what they are held, over the squared substep
    Square inverse_;     // for inverse_dt_; in the middle cluster's frame
    float inverse_dt_ = 0.0f;
    bool asleep_ = false;
};

}  // namespace eti::pbd
