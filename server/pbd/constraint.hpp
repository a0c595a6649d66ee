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

/// What holds particles of a soft body besides its clusters and tetrahedra. SoftBody walks its constraints
/// at the moments below, so that a further one is added without a change to it. A virtual call is made once
/// a pass, never once a particle: the kernel is a free function.
class Constraint {
  public:
    using Pair = std::array<std::uint32_t, 2>;

    virtual ~Constraint() = default;

    /// Pairs of particles of which one must not sleep through what the other does. Of more than two particles
    /// held together: each with each. Asked for once, by SoftBody::let_sleep().
    [[nodiscard]] virtual std::span<const Pair> ties() const { return {}; }
    /// Takes `particles.rest` as the new unloaded shape (after a change of posture).
    virtual void set_rest(const Particles& /*particles*/) {}
    /// Forgets the past: all particles are at rest.
    virtual void reset() {}
    /// Once per step, before it is settled who sleeps: finds what may meet in the step, and wakes whom it has
    /// to.
    virtual void begin_step(Particles& /*particles*/, Sleep& /*sleep*/) {}
    /// Leaves what holds only sleeping particles alone, until the next call.
    virtual void select(const Particles& /*particles*/) {}
    /// One pass of a substep of `dt` [s]: moves predicted positions of particles whose mobility is not 0.
    /// Does not allocate. Not called while all sleep.
    virtual void project(Particles& particles, float dt) = 0;
};

/// Any constraint as a value: a copy shares nothing with its origin.
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
