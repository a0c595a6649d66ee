// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"
#include "server/pbd/particles.hpp"

namespace eti::pbd {

/// Overlapping clusters with shape matching (Müller et al. 2005, "Meshless deformations based on shape
/// matching"). A particle in k clusters has mass m/k in each (Rivers & James 2007), so that averaging the
/// goals conserves momentum.
///
/// Stiffness is a compliance (XPBD, Macklin et al. 2016): each membership is a zero-length spring between
/// particle and goal, such that a uniform strain stores the energy of Young's modulus E: k = 5 E V / (n r^2),
/// with V volume per particle, n clusters per particle, r cluster radius; <q_x^2> = r^2/5 in a sphere.
class ShapeMatching {
  public:
    struct Description {
        std::vector<std::uint32_t> first;    ///< [clusters + 1]: ranges of `member`
        std::vector<std::uint32_t> member;   ///< [memberships]: particle indices
        std::vector<float> youngs_modulus;   ///< [clusters][Pa]
        std::vector<float> particle_volume;  ///< [particles][m^3]
        std::vector<float> fitting_mass;     ///< [particles][kg]; finite even where the mass is infinite
        /// If above 0, replaces the moduli: the fraction of the distance to the goal that every pass moves
        /// ("stiffness" in Müller 2005). The resulting stiffness depends on passes and substeps.
        float goal_share = 0.0f;
    };

    void configure(const Description& description, const Particles& particles);

    /// Adopts `particles.rest` as the new unloaded shape (after a change of posture).
    void set_rest(const Particles& particles);

    /// Sets the `moduli` [clusters][Pa]; shape and state are unchanged.
    void set_youngs_modulus(std::span<const float> moduli);

    /// One Jacobi pass: fits every cluster to the predicted positions and moves the free particles
    /// towards their averaged goals. Substep `dt` [s].
    void project(Particles& particles, float dt);

    /// Fits every cluster to the current positions without moving anything.
    void fit(const std::vector<Vec3f>& positions);

    /// Skips sleeping blocks (`block_asleep` [blocks]), whose last fit is kept, and sleeping particles, until
    /// the next call.
    void select(std::span<const std::uint8_t> block_asleep, const Particles& particles);
    static constexpr std::size_t block_size = 8;  ///< consecutive clusters that are fitted together
    [[nodiscard]] std::size_t blocks() const { return blocks_.size(); }

    [[nodiscard]] std::size_t size() const { return rest_centre_.size(); }
    [[nodiscard]] std::span<const std::uint32_t> members_of(std::size_t cluster) const {
        return {member_.data() + first_[cluster], member_.data() + first_[cluster + 1]};
    }
    [[nodiscard]] std::span<const Quatf> rotation() const { return {rotation_.data(), size()}; }
    [[nodiscard]] std::span<const Vec3f> centre() const { return centre_; }
    [[nodiscard]] std::span<const Vec3f> rest_centre() const { return rest_centre_; }
    /// Clusters that contain a particle.
    [[nodiscard]] std::span<const std::uint32_t> clusters_of(std::size_t particle) const {
        return {cluster_of_.data() + first_of_[particle], cluster_of_.data() + first_of_[particle + 1]};
    }
    /// Goal position of a particle that its clusters do not move, from the last pass, and the stiffness [N/m]
    /// of the spring to it. The particle must be in a cluster.
    struct GoalSpring {
        Vec3f goal = Vec3f::Zero();
        float stiffness = 0.0f;
    };
    [[nodiscard]] GoalSpring goal_spring(std::size_t particle) const;
    void reset();

    /// Enables AVX2; configure() sets it to what the processor supports. Results are bit-identical either
    /// way.
    void use_avx2(bool wanted) { avx2_ = wanted; }

  private:
    /// A cluster's frame as its particles read it: the columns of its rotation and the image of the body's
    /// origin, all times the fraction of the distance to the goal per pass; last, that fraction.
    struct alignas(64) Frame {
        float packed[16] = {};
    };

    using Indices = std::span<const std::uint32_t>;
    // Kernels over blocks of eight clusters and over particles; scalar and AVX2 versions.
    void fit_blocks(Indices blocks);
    void fit_blocks_avx2(Indices blocks);
    void move_particles(Particles& particles, Indices which) const;
    void move_particles_avx2(Particles& particles, Indices which) const;
    void read(const std::vector<Vec3f>& positions, std::size_t begin, std::size_t end);
    void fit(Indices blocks);
    void move(Particles& particles, Indices which) const;
    void update_shares(float dt);

    std::vector<std::uint32_t> first_, member_;  // [clusters + 1], [memberships]: members by cluster
    std::vector<std::uint32_t> first_of_,
        cluster_of_;  // [particles + 1], [memberships]: clusters by particle
    // [memberships]: the rest offset from the rest centre times the weight, then the weight, which sums to
    // one over a cluster.
    std::vector<Eigen::Vector4f> moment_;
    // [particles][m]: positions to fit, and rest positions relative to the origin with a fourth number 1;
    // padded to whole loads.
    std::vector<Eigen::Vector4f> wide_, wide_rest_;
    Vec3f origin_ = Vec3f::Zero();  // one of the rest positions; rest positions are relative to it for
                                    // precision
    std::vector<Vec3f> rest_centre_, centre_;  // [clusters][m]
    // [clusters]: spring [N/m], the same for a modulus of 1 Pa, and mean mass per member [kg].
    std::vector<float> spring_, unit_spring_, mass_;
    // [clusters], padded to whole blocks.
    std::vector<Quatf> rotation_;
    std::vector<Eigen::Vector4f> lever_;          // rest centre from the origin, and the fraction per pass
    std::vector<Frame> frame_;                    // of the last fit
    std::vector<std::uint32_t> blocks_, movers_;  // indices of all blocks, and of free particles in clusters
    std::vector<std::uint32_t> awake_blocks_, awake_movers_;  // the awake ones among these
    float share_dt_ = 0.0f;
    float goal_share_ = 0.0f;
    bool avx2_ = false;
    std::vector<float> inverse_count_;  // [particles], 1 / clusters; 0 for fixed ones
};

}  // namespace eti::pbd
