// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"
#include "server/pbd/particles.hpp"

namespace eti::pbd {

/// Overlapping clusters held to their rest shape (Müller et al. 2005, "Meshless deformations based
/// on shape matching"). A particle in k clusters counts in each with mass m/k (Rivers & James 2007),
/// so that averaging the goals conserves momentum. Stiffness is a compliance (XPBD, Macklin et al.
/// 2016): each membership is a zero-length spring between particle and goal, with the stiffness for
/// which a uniform strain stores the energy of Young's modulus E:
///     k = 5 E V / (n r^2)
/// (V volume per particle, n clusters per particle, r cluster radius; <q_x^2> = r^2/5 in a sphere).
class ShapeMatching {
  public:
    struct Description {
        std::vector<std::uint32_t> first;    ///< count + 1
        std::vector<std::uint32_t> member;   ///< particle indices
        std::vector<float> youngs_modulus;   ///< [Pa], per cluster
        std::vector<float> particle_volume;  ///< [m^3], per particle
        std::vector<float> fitting_mass;     ///< [kg], per particle; finite also where the mass is infinite
        /// Above 0: what Müller 2005 calls stiffness, the share of the way to the goal that every pass
        /// takes, in place of the moduli. How stiff that is depends on passes and substeps.
        float goal_share = 0.0f;
        /// Per particle, whether project_early() moves it; empty: none.
        std::vector<bool> early;
    };

    void configure(const Description& description, const Particles& particles);

    /// Takes `particles.rest` as the new unloaded shape (after a change of posture).
    void set_rest(const Particles& particles);

    /// Takes other moduli [Pa], one per cluster; shape and state stay.
    void set_youngs_modulus(std::span<const float> moduli);

    /// One Jacobi pass: fits every cluster to the predicted positions and moves the free particles
    /// towards their averaged goals. Substep `dt` [s].
    void project(Particles& particles, float dt);

    /// The same in two parts, so that what only needs the early particles can run beside the second: first
    /// the clusters that hold an early one, and those particles; then the rest, still from the positions
    /// before. The bits are those of project().
    void project_early(Particles& particles, float dt);
    void project_late(Particles& particles);
    /// Whether the second part leaves all of these alone.
    [[nodiscard]] bool are_early(std::span<const std::uint32_t> particles) const;

    /// Fits every cluster to the current positions without moving anything.
    void fit(const std::vector<Vec3f>& positions);

    /// Leaves the blocks that sleep as the last pass fitted them, and particles that sleep where they are,
    /// until the next call.
    void select(std::span<const std::uint8_t> block_asleep, const Particles& particles);
    static constexpr std::size_t block_size = 8;  ///< clusters, one after the other, that are fitted together
    [[nodiscard]] std::size_t blocks() const { return blocks_.size(); }

    [[nodiscard]] std::size_t size() const { return rest_centre_.size(); }
    [[nodiscard]] std::span<const std::uint32_t> members_of(std::size_t cluster) const {
        return {member_.data() + first_[cluster], member_.data() + first_[cluster + 1]};
    }
    [[nodiscard]] std::span<const Quatf> rotation() const { return {rotation_.data(), size()}; }
    [[nodiscard]] std::span<const Vec3f> centre() const { return centre_; }
    [[nodiscard]] std::span<const Vec3f> rest_centre() const { return rest_centre_; }
    /// Clusters that hold a particle.
    [[nodiscard]] std::span<const std::uint32_t> clusters_of(std::size_t particle) const {
        return {cluster_of_.data() + first_of_[particle], cluster_of_.data() + first_of_[particle + 1]};
    }
    /// Where its clusters want a particle that they do not move, as the last pass fitted them, and the
    /// stiffness [N/m] with which they pull it there. Of a particle in some cluster.
    struct Pull {
        Vec3f goal = Vec3f::Zero();
        float stiffness = 0.0f;
    };
    [[nodiscard]] Pull pull_on(std::size_t particle) const;
    void reset();

    /// Whether to use AVX2: set by configure() to what the processor has. The bits are the same without.
    void use_avx2(bool wanted) { avx2_ = wanted; }

  private:
    /// What a cluster tells its particles: the columns of its rotation and the place of the body's origin
    /// under its motion, all times the part of the way to the goal that a pass takes; last, that part.
    struct alignas(64) Frame {
        float packed[16] = {};
    };

    using Indices = std::span<const std::uint32_t>;
    // Blocks of eight clusters, and particles: bodies of the kernels, and the same for AVX2.
    void fit_blocks(Indices blocks);
    void fit_blocks_avx2(Indices blocks);
    void move_particles(Particles& particles, Indices which) const;
    void move_particles_avx2(Particles& particles, Indices which) const;
    void read(const std::vector<Vec3f>& positions, std::size_t begin, std::size_t end);
    void fit(Indices blocks);
    void move(Particles& particles, Indices which) const;
    void update_shares(float dt);

    std::vector<std::uint32_t> first_, member_;         // members by cluster
    std::vector<std::uint32_t> first_of_, cluster_of_;  // clusters by particle
    // Per membership: weight, which sums to one in a cluster, and before it the rest offset from the rest
    // centre times that weight.
    std::vector<Eigen::Vector4f> moment_;
    // Positions to fit to, and rest positions from the origin with a one, so that loads are whole.
    std::vector<Eigen::Vector4f> wide_, wide_rest_;
    Vec3f origin_ = Vec3f::Zero();  // one of the particles at rest: rest positions from there keep digits
    std::vector<Vec3f> rest_centre_, centre_;
    // Per cluster: spring [N/m], the same for a modulus of 1 Pa, and mean mass share [kg].
    std::vector<float> spring_, unit_spring_, mass_;
    // Per cluster, filled up to whole blocks.
    std::vector<Quatf> rotation_;
    std::vector<Eigen::Vector4f> lever_;  // rest centre from the origin, and the part of the way per pass
    std::vector<Frame> frame_;            // of the last fit
    // Blocks of clusters, and free particles: the early ones, and behind them the rest.
    std::vector<std::uint32_t> blocks_, movers_;
    std::size_t early_blocks_ = 0, early_movers_ = 0;
    std::vector<std::uint32_t> awake_blocks_, awake_movers_;  // of these
    std::size_t awake_early_blocks_ = 0, awake_early_movers_ = 0;
    float share_dt_ = 0.0f;
    float goal_share_ = 0.0f;
    bool avx2_ = false;
    std::vector<float> inverse_count_;  // per particle, 1 / clusters; 0 when it does not move
};

}  // namespace eti::pbd
