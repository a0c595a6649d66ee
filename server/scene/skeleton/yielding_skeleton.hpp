// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>

#include "server/patient/model/patient.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/pbd/implicit/relaxation.hpp"
#include "server/pbd/implicit/yielding_bodies.hpp"

namespace eti::scene {

/// Passive mechanics of head, mandible and hyoid of a term newborn of 3.5 kg. Sources and estimates:
/// docs/solver/skeleton.md.
struct JointProperties {
    float head_mass = 0.76f;        ///< [kg]
    float head_inertia = 2.8e-3f;   ///< [kg m^2], about the neck's joint
    float neck_flexion = 0.2f;      ///< [N m/rad]
    float neck_extension = 0.4f;    ///< [N m/rad]
    float neck_range = 0.6f;        ///< [rad] to either side of the posture; beyond it, neck_stop acts
    float neck_stop = 10.0f;        ///< [N m/rad]
    float neck_lift = 190.0f;       ///< [N/m], of the neck's joint against lifting it off the table
    float mattress = 3000.0f;       ///< [N/m], under the occiput
    float occiput = 45e-3f;         ///< [m], of occiput and centre of mass above the neck's joint
    float jaw_mass = 0.02f;         ///< [kg], with the floor of the mouth
    float jaw_inertia = 3e-5f;      ///< [kg m^2], about the jaw's joints
    float jaw_opening = 0.1f;       ///< [N m/rad]
    float jaw_gape = 23e-3f;        ///< [m], between the gums, where jaw_stop begins
    float jaw_stop = 20.0f;         ///< [N m/rad]; also where the gums meet
    float jaw_slide = 1000.0f;      ///< [N/m], forwards
    float jaw_slide_range = 6e-3f;  ///< [m], forwards; beyond it, and backwards, jaw_slide_stop acts
    float jaw_slide_stop = 20e3f;   ///< [N/m]
    float hyoid_mass = 5e-3f;       ///< [kg]
    float hyoid_sideways = 800.0f;  ///< [N/m]
    float hyoid_forward = 500.0f;   ///< [N/m], forwards and upwards
    float hyoid_range = 6e-3f;      ///< [m], along each axis; beyond it, hyoid_stop acts
    float hyoid_stop = 5e3f;        ///< [N/m]
    float damping_time = 0.1f;      ///< [s], damping of every coordinate over its stiffness
    float hand_on_jaw = 1.0f;       ///< [N m/rad], of an assistant who holds the mouth open
    float hand_on_head = 0.5f;      ///< [N m/rad], of a roll or a hand that holds the head back
    /// Passive stiffness of neck, jaw and hyoid in a newborn awake, over that of a relaxed one.
    float awake = 3.0f;
};

/// Head, mandible and hyoid as bodies that yield to the forces of tissue and tools. A commanded posture is
/// the equilibrium without load. Coordinates are offsets from it; the trunk is fixed. Patient frame, SI.
///
/// The skull turns about the neck's joint, which can be lifted. Its weight holds the occiput on the table.
/// The mandible turns about its joints, which slide forwards. The hyoid shifts the tissue around it. Right
/// and left are taken to be symmetrical, but for the hyoid.
class YieldingSkeleton {
  public:
    enum Coordinate : std::uint8_t {
        head_extension,  ///< [rad]
        head_lift,       ///< [m], anterior
        jaw_opening,     ///< [rad]
        jaw_slide,       ///< [m], anterior
        hyoid_left,      ///< [m]
        hyoid_back,      ///< [m]
        hyoid_up,        ///< [m]
    };
    using Bodies = pbd::YieldingBodies;
    using Vector = Bodies::Vector;

    /// What carries a point: bones and, in addition, a share of the hyoid's motion.
    struct Carrier {
        patient::BoneWeights bones{};
        float hyoid = 0.0f;
    };

    explicit YieldingSkeleton(const patient::Patient& patient, const JointProperties& at_term = {});

    /// At rest in a posture.
    void reset(const patient::Posture& posture);
    /// The posture nearest to a wanted one that the joints' stops allow.
    [[nodiscard]] patient::Posture reachable(patient::Posture posture) const;
    /// Moves the equilibrium to a reachable posture, and the bones with it.
    void follow(const patient::Posture& posture);

    [[nodiscard]] const patient::BonePoses& bones() const { return poses_; }
    /// Share of the hyoid's motion at a rest position [m]: 1 at the hyoid, 0 from 2 cm on.
    [[nodiscard]] float hyoid_share(const Vec3f& rest) const;
    [[nodiscard]] Vec3f pose_point(const Vec3f& rest, const Carrier& carrier) const;
    /// Jacobian of pose_point() in the coordinates.
    [[nodiscard]] Bodies::Columns columns(const Vec3f& rest, const Carrier& carrier) const;
    /// The same for a point [m] in the current posture; its carriers are taken to be there without load.
    [[nodiscard]] Bodies::Columns columns_at(const Vec3f& posed, const Carrier& carrier) const;

    /// Sets the muscles' tone: 0 relaxed, as the properties are, to 1 awake. Stops are ligaments and bone and
    /// do not change.
    void set_muscle_tone(float tone) { passive_ = 1.0f + tone * (properties_.awake - 1.0f); }

    /// From now on the passive stiffness relaxes, by one Prony term as in pbd::Relaxation; properties are
    /// those of a sudden load. Stops, hands and the mattress do not.
    void relax(const pbd::Relaxation& relaxation) { relaxation_ = relaxation; }
    /// Where true, muscles forget past offsets within a tenth of a second.
    void set_recovering(bool recovers) { recovers_ = recovers; }
    /// By how much the muscles' rest lags behind the offsets that hold them, times the relaxing share.
    [[nodiscard]] Vector unrelaxed() const { return relaxation_.share * (offset_ - muscle_rest_); }

    /// Discards all loads.
    void unload();
    /// Adds a force [N] that acts at a point until unload().
    void add_load(const Bodies::Columns& at, const Vec3f& force);
    /// The same where something with a `stiffness` [N/m] along the unit `normal` presses: the force changes
    /// by so much as the point moves, which keeps the step stable.
    void add_contact(const Bodies::Columns& at, const Vec3f& force, const Vec3f& normal, float stiffness);

    /// Adds a force [N] of fingers on the thyroid cartilage.
    void press_larynx(const Vec3f& force) { add_load(columns(thyroid_, thyroid_carrier_), force); }

    /// Writes the bodies' own matrix and force for a step of `dt` [s].
    void write(Bodies& bodies, float dt) const;
    /// Applies a solved step.
    void advance(const Vector& step, float dt);

    [[nodiscard]] const Vector& offset() const { return offset_; }
    [[nodiscard]] const Vector& velocity() const { return velocity_; }
    [[nodiscard]] const Vector& load() const { return load_; }
    /// Angles with the offset [rad].
    [[nodiscard]] float head_elevation() const { return posture_.head_elevation + offset_[head_extension]; }
    [[nodiscard]] float opening() const { return posture_.jaw_opening + offset_[jaw_opening]; }

  private:
    void place();
    /// Jacobian of a point. `neck_arm` [m]: its arm about the neck's joint, by the weights of skull and
    /// mandible; `on_jaw` [m]: where the mandible carries it.
    [[nodiscard]] Bodies::Columns columns_about(const Vec3f& neck_arm, const Vec3f& on_jaw,
                                                const Carrier& carrier) const;
    /// Restoring force at an offset, its derivative, and the share of that which muscles have.
    struct Restoring {
        float force = 0.0f, stiffness = 0.0f, passive = 0.0f;
    };
    [[nodiscard]] std::array<Restoring, Bodies::coordinates> restoring() const;
    /// Of the table on the occiput, by how far the occiput has risen.
    [[nodiscard]] Restoring table() const;

    const patient::Skeleton joints_;
    JointProperties properties_;     // scaled to the patient
    Vec3f hyoid_ = Vec3f::Zero();    // [m], at rest
    float reach_ = 0.0f;             // [m], of the hyoid's motion
    Vec3f thyroid_ = Vec3f::Zero();  // [m], front of the thyroid cartilage at rest
    Carrier thyroid_carrier_;
    float passive_ = 1.0f;                         // stiffness of muscles over that of relaxed ones
    float widest_opening_ = 0.0f, closed_ = 0.0f;  // [rad], where the jaw's stops begin
    patient::Posture posture_;
    Vector offset_ = Vector::Zero(), velocity_ = Vector::Zero(), load_ = Vector::Zero();
    pbd::Relaxation relaxation_;
    Vector muscle_rest_ = Vector::Zero();  // of the relaxing branch
    bool recovers_ = false;
    Bodies::Matrix contact_stiffness_ = Bodies::Matrix::Zero();
    patient::BonePoses poses_;
};

}  // namespace eti::scene
