// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"
#include "server/pbd/particles.hpp"

namespace eti::pbd {

/// The rotation of the polar decomposition of `a`, started from `rotation` (Müller, Bender,
/// Chentanez & Macklin 2016, "A robust method to extract the rotational part of deformations").
/// Always a proper rotation, also for singular or inverted `a`.
[[nodiscard]] Quatf extract_rotation(const Mat3f& a, const Quatf& rotation, int iterations);

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
    };

    void configure(const Description& description, const Particles& particles);

    /// Takes `particles.rest` as the new unloaded shape (after a change of posture).
    void set_rest(const Particles& particles);

    /// One Jacobi pass: fits every cluster to the predicted positions and moves the free particles
    /// towards their averaged goals. Substep `dt` [s].
    void project(Particles& particles, float dt);

    /// Fits every cluster to the current positions without moving anything.
    void fit(const std::vector<Vec3f>& positions);

    [[nodiscard]] std::size_t size() const { return rotation_.size(); }
    [[nodiscard]] std::span<const Quatf> rotation() const { return rotation_; }
    [[nodiscard]] std::span<const Vec3f> centre() const { return centre_; }
    [[nodiscard]] std::span<const Vec3f> rest_centre() const { return rest_centre_; }
    /// Clusters that hold a particle.
    [[nodiscard]] std::span<const std::uint32_t> clusters_of(std::size_t particle) const {
        return {cluster_of_.data() + first_of_[particle], cluster_of_.data() + first_of_[particle + 1]};
    }
    void reset();

  private:
    void fit_cluster(std::size_t cluster, const std::vector<Vec3f>& positions);
    void update_stiffness(float dt);

    std::vector<std::uint32_t> first_, member_;         // members by cluster
    std::vector<std::uint32_t> first_of_, cluster_of_;  // clusters by particle
    std::vector<float> weight_;                         // per membership, sums to one in a cluster
    std::vector<Vec3f> offset_;                         // per membership, rest offset from the rest centre
    std::vector<Vec3f> rest_centre_, centre_;
    std::vector<Quatf> rotation_;
    std::vector<float> spring_, mass_;  // per cluster: spring [N/m] and mean mass share [kg]
    std::vector<float> share_;          // per cluster, part of the way to the goal per pass
    float share_dt_ = 0.0f;
    std::vector<float> inverse_count_;  // per particle, 1 / clusters; 0 when it does not move
};

}  // namespace eti::pbd
