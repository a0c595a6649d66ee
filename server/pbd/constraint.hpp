// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "server/pbd/particles.hpp"

namespace eti::pbd {

class Sleep;

/// A constraint on the particles of a soft body, besides its clusters. SoftBody calls its
/// constraints at the stages below, so that new kinds need no change to it. Virtual calls are made once per
/// pass, never per particle: kernels are free functions.
class Constraint {
  public:
    using Pair = std::array<std::uint32_t, 2>;

    virtual ~Constraint() = default;

    /// Pairs of particles that must be awake together. A constraint on more than two particles lists every
    /// pair. Called once, by SoftBody::enable_sleeping().
    [[nodiscard]] virtual std::span<const Pair> coupled_pairs() const { return {}; }
    /// Adopts `particles.rest` as the new unloaded shape (after a change of posture).
    virtual void set_rest(const Particles& /*particles*/) {}
    /// Discards all history: all particles are at rest.
    virtual void reset() {}
    /// Called once per step, before sleep is decided: finds what may collide in the step, and wakes particles
    /// where needed.
    virtual void begin_step(Particles& /*particles*/, Sleep& /*sleep*/) {}
    /// Excludes elements whose particles all sleep, until the next call.
    virtual void select(const Particles& /*particles*/) {}
    /// One pass of a substep of `dt` [s]: moves predicted positions of particles with non-zero mobility. Does
    /// not allocate. Not called while all particles sleep.
    virtual void project(Particles& particles, float dt) = 0;
};

/// Holds any constraint by value; copies are deep.
class AnyConstraint {
  public:
    template <std::derived_from<Constraint> Kind>
    AnyConstraint(Kind constraint)
        : own_(std::make_unique<Kind>(std::move(constraint))),
          copy_([](const Constraint& of) -> std::unique_ptr<Constraint> {
              return std::make_unique<Kind>(static_cast<const Kind&>(of));
          }) {}
    AnyConstraint(const AnyConstraint& other) : own_(other.copy_(*other.own_)), copy_(other.copy_) {}
    AnyConstraint(AnyConstraint&&) noexcept = default;
    AnyConstraint& operator=(const AnyConstraint& other) { return *this = AnyConstraint(other); }
    AnyConstraint& operator=(AnyConstraint&&) noexcept = default;
    ~AnyConstraint() = default;

    [[nodiscard]] Constraint& operator*() { return *own_; }

  private:
    std::unique_ptr<Constraint> own_;
    std::unique_ptr<Constraint> (*copy_)(const Constraint& of);
};

}  // namespace eti::pbd
