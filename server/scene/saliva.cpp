// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/saliva.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

#include "server/scene/scene.hpp"

namespace eti::scene {

namespace {

// Lengths are for a newborn of 3.5 kg and scale with the patient; volumes scale with their cube.
constexpr float spacing = 1e-3f;               // [m]
constexpr float min_spacing = 0.85e-3f;        // [m], for any patient: saliva is visual only
constexpr float pool = 1.2e-6f;                // [m^3], initially in the throat
constexpr float film = 0.4e-6f;                // [m^3], initially on the tongue
constexpr float gland_flow = 2e-9f;            // [m^3/s], per gland; half a millilitre per minute in total
constexpr float gland_search = 8e-3f;          // [m], search radius for free space around the anatomical
                                               // position
constexpr float sphincter_radius = 1.8e-3f;    // [m]; half the gullet's thickness plus the shell's offset
constexpr float sphincter_half_width = 3e-3f;  // [m]
constexpr float glottis_kept_free = 4e-3f;     // [m], kept free of the initial pool
constexpr float beyond_head = 10e-3f;          // [m], distance at which escaped liquid is removed

// Above this speed particles may pass through a wall as thick as a tissue particle in one substep; saliva
// hardly reaches it over the few centimetres that it can fall.
constexpr float max_speed = 0.25f;  // [m/s]
constexpr float substep = step_duration / Saliva::substeps;
constexpr int steps_per_wall = 2;  // half the rate costs half, without visible difference
// Distance around each particle within which the boundary is updated; farther away it is outdated.
constexpr float way = 0.1f * step_duration * steps_per_wall;

/// Bounding box of the head over all postures, as far as the shell reaches.
std::array<Vec3f, 2> head_box(const patient::Patient& patient, float margin) {
    std::array<Vec3f, 2> box = {patient.shell.mesh.vertices.front(), patient.shell.mesh.vertices.front()};
    for (const float elevation : {0.0f, max_head_elevation}) {
        for (const float opening : {0.0f, max_jaw_opening}) {
            const patient::BonePoses bones = patient::pose_bones(patient.skeleton, {elevation, opening});
            for (std::size_t i = 0; i < patient.shell.mesh.vertices.size(); ++i) {
                const Vec3f p =
                    patient::pose_point(patient.shell.mesh.vertices[i], patient.shell.vertex_bones[i], bones);
                box[0] = box[0].cwiseMin(p);
                box[1] = box[1].cwiseMax(p);
            }
        }
    }
    return {box[0] - Vec3f::Constant(margin), box[1] + Vec3f::Constant(margin)};
}

float size_of(const patient::Patient& patient) {
    return std::cbrt(patient.weight / 3.5f);
}

pbd::FluidSettings fluid_settings(const patient::Patient& patient, LiquidKind kind) {
    const float size = size_of(patient);
    pbd::FluidSettings s = saliva_settings(saliva_spacing(patient), substep, kind);
    const auto [lower, upper] = head_box(patient, size * beyond_head);
    s.lower = lower;
    s.upper = upper;
    return s;
}

pbd::MovingCapsule part_of(const pbd::MovingCapsule& whole, float begin, float end) {
    return {whole.a_before + begin * (whole.a - whole.a_before),
            whole.b_before + begin * (whole.b - whole.b_before),
            whole.a_before + end * (whole.a - whole.a_before),
            whole.b_before + end * (whole.b - whole.b_before), whole.radius};
}

}  // namespace

float saliva_spacing(const patient::Patient& patient) {
    return std::max(size_of(patient) * spacing, min_spacing);
}

pbd::FluidSettings saliva_settings(float spacing, float dt, LiquidKind kind) {
    const LiquidProperties& liquid = properties_of(kind);
    pbd::FluidSettings s;
    s.spacing = spacing;
    s.rest_density = liquid.density;
    s.viscosity = liquid.viscosity;
    s.wall_viscosity = liquid.wall_viscosity;
    s.surface_tension = liquid.surface_tension;
    s.max_speed = max_speed;
    // Limited to a sixteenth of the theoretical stability limit of the substep (see FluidSettings): above it,
    // liquid in clefts is compressed and does not come to rest.
    const float stable =
        s.rest_density * spacing * spacing * spacing / (2.0f * std::numbers::pi_v<float> * dt * dt);
    s.surface_tension = std::min(s.surface_tension, 0.0625f * stable);
    return s;
}

Saliva::Saliva(const patient::Patient& patient, const Laryngoscope& scope, float tube_radius,
               std::uint64_t seed, LiquidKind kind)
    : patient_(patient),
      scope_(scope),
      tube_radius_(tube_radius),
      size_(size_of(patient)),
      seed_(seed),
      fluid_(fluid_settings(patient, kind), seed),
      wall_(2.0f * fluid_.settings().spacing, way) {
    capsules_.reserve(64);
    now_.reserve(64);
    const pbd::FluidEmitter gland{.opening = 0.7f * fluid_.settings().spacing,
                                  .flow = gland_flow * size_ * size_ * size_};
    fluid_.set_emitters(std::array<pbd::FluidEmitter, 4>{gland, gland, gland, gland});
    suction_[0].radius = scope.capsules[2].radius + 2.0f * fluid_.settings().spacing;
    suction_[0].reach = suction_[0].radius + 6e-3f * size_;
}

void Saliva::reset(const SalivaSurroundings& at, bool dry) {
    fluid_.reset(seed_);
    step_ = 0;
    wall_.reset(at.shell);
    // All of mouth and throat, once.
    std::vector<Vec3f> everywhere;
    Eigen::AlignedBox3f room;
    for (const Vec3f& p : at.landmarks) {
        room.extend(p);
    }
    const float step = 2.0f * fluid_.settings().spacing;
    const Vec3f margin = Vec3f::Constant(12e-3f * size_);
    const Vec3f low = room.min() - margin;
    const Eigen::Vector3i steps = ((room.max() + margin - low) / step).cast<int>();
    for (int z = 0; z <= steps.z(); ++z) {
        for (int y = 0; y <= steps.y(); ++y) {
            for (int x = 0; x <= steps.x(); ++x) {
                everywhere.push_back(low + step * Eigen::Vector3i(x, y, z).cast<float>());
            }
        }
    }
    wall_.update(at.shell, at.shell_revision, at.tissue, everywhere);
    find_glands(at);
    place_emitters(at.bones);
    if (dry) {
        return;
    }
    const float volume = fluid_.particle_volume();
    const float part = size_ * size_ * size_ / volume;
    std::set<Place> seen;
    fill(eti::at(at.landmarks, Landmark::epiglottis_tip), static_cast<std::size_t>(pool * part),
         Order::lowest, seen, at.landmarks);
    fill(eti::at(at.landmarks, Landmark::tongue_dorsum), static_cast<std::size_t>(film * part),
         Order::nearest, seen, at.landmarks);
}

/// The ducts: two under the tongue, two in the cheeks opposite the upper molars. The model has no such
/// openings; each is placed in the free space nearest to its anatomical position.
void Saliva::find_glands(const SalivaSurroundings& at) {
    const Vec3f lower = eti::at(at.landmarks, Landmark::lower_gum);
    const Vec3f upper = eti::at(at.landmarks, Landmark::upper_gum);
    const Vec3f dorsum = eti::at(at.landmarks, Landmark::tongue_dorsum);
    const Vec3f under_tongue = lower + 0.25f * (dorsum - lower);
    const Vec3f molars = upper + 0.8f * (Vec3f(upper.x(), dorsum.y(), upper.z()) - upper);
    const std::array<Vec3f, 4> places = {
        under_tongue + Vec3f(3e-3f * size_, 0, 0), under_tongue - Vec3f(3e-3f * size_, 0, 0),
        molars + Vec3f(18e-3f * size_, 0, 0), molars - Vec3f(18e-3f * size_, 0, 0)};
    for (std::size_t k = 0; k < glands_.size(); ++k) {
        Gland& gland = glands_[k];
        gland.bone = k < 2 ? patient::Bone::mandible : patient::Bone::skull;
        const RigidTransform back = at.bones[static_cast<std::size_t>(gland.bone)].inverse();
        const Vec3f place = nearest_free(places[k], gland_search * size_);
        gland.place = back * place;
        gland.direction = back.rotation * wall_.distance().sample(place).normal;
    }
}

Vec3f Saliva::nearest_free(const Vec3f& point, float radius) const {
    const float step = fluid_.settings().spacing;
    const int reach = static_cast<int>(radius / step);
    Vec3f best = point;
    float closest = radius * radius;
    for (int z = -reach; z <= reach; ++z) {
        for (int y = -reach; y <= reach; ++y) {
            for (int x = -reach; x <= reach; ++x) {
                const Vec3f offset = step * Eigen::Vector3i(x, y, z).cast<float>();
                if (offset.squaredNorm() < closest &&
                    wall_.distance().distance(point + offset) > 0.75f * step) {
                    best = point + offset;
                    closest = offset.squaredNorm();
                }
            }
        }
    }
    return best;
}

bool Saliva::holds_liquid(const Vec3f& point, const Landmarks& landmarks) const {
    const Vec3f& inlet = eti::at(landmarks, Landmark::oesophagus_inlet);
    return wall_.distance().distance(point) > 0.5f * fluid_.settings().spacing &&
           point.y() > eti::at(landmarks, Landmark::upper_gum).y() &&
           point.z() > inlet.z() + 2.0f * sphincter_radius * size_ &&
           (point - eti::at(landmarks, Landmark::glottis)).norm() > glottis_kept_free * size_;
}

/// Fills free lattice points, starting from the one nearest to `from`.
void Saliva::fill(const Vec3f& from, std::size_t count, Order order, std::set<Place>& seen,
                  const Landmarks& landmarks) {
    const float step = fluid_.settings().spacing;
    const auto point = [&](const Place& p) {
        return Vec3f(step * Eigen::Vector3i(p[0], p[1], p[2]).cast<float>());
    };
    const Vec3f start = nearest_free(from, gland_search * size_) / step;
    const Place origin{static_cast<int>(start.x()), static_cast<int>(start.y()), static_cast<int>(start.z())};
    // Largest first; ties are broken by position, so that the order is platform-independent.
    std::priority_queue<std::pair<int, Place>> open;
    const auto visit = [&](const Place& p) {
        if (!seen.contains(p) && holds_liquid(point(p), landmarks)) {
            const int away = (p[0] - origin[0]) * (p[0] - origin[0]) +
                             (p[1] - origin[1]) * (p[1] - origin[1]) +
                             (p[2] - origin[2]) * (p[2] - origin[2]);
            open.push({order == Order::lowest ? p[1] : -away, p});
        }
        seen.insert(p);
    };
    constexpr int about = 2;  // rounding may have put the origin into the boundary
    for (int k = 0; k < (2 * about + 1) * (2 * about + 1) * (2 * about + 1); ++k) {
        visit({origin[0] + k % 5 - about, origin[1] + k / 5 % 5 - about, origin[2] + k / 25 - about});
    }
    for (std::size_t filled = 0; filled < count && !open.empty(); ++filled) {
        const Place p = open.top().second;
        open.pop();
        fluid_.add(point(p));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (const int side : {-1, 1}) {
                Place next = p;
                next[axis] += side;
                visit(next);
            }
        }
    }
}

void Saliva::place_emitters(const patient::BonePoses& bones) {
    for (std::size_t k = 0; k < glands_.size(); ++k) {
        const RigidTransform& bone = bones[static_cast<std::size_t>(glands_[k].bone)];
        fluid_.place_emitter(k, bone * glands_[k].place, bone.rotation * glands_[k].direction);
    }
}

void Saliva::place_capsules(const SalivaSurroundings& during) {
    capsules_.clear();
    for (const Capsule& c : scope_.capsules) {
        capsules_.push_back({during.blade_from * c.a, during.blade_from * c.b, during.blade_to * c.a,
                             during.blade_to * c.b, c.radius});
    }
    for (std::size_t k = 0; k + 1 < during.tube_to.size(); ++k) {
        capsules_.push_back({during.tube_from[k], during.tube_from[k + 1], during.tube_to[k],
                             during.tube_to[k + 1], tube_radius_});
    }
    // The oesophageal sphincter is closed, so that secretions pool above it.
    const Vec3f inlet = eti::at(during.landmarks, Landmark::oesophagus_inlet);
    const Vec3f aside(sphincter_half_width * size_, 0.0f, 0.0f);
    capsules_.push_back(
        {inlet - aside, inlet + aside, inlet - aside, inlet + aside, sphincter_radius * size_});
}

void Saliva::begin_step(const SalivaSurroundings& during) {
    place_capsules(during);
    place_emitters(during.bones);
    fluid_.set_flow(during.secretion * gland_flow * size_ * size_ * size_);
    gravity_ = during.gravity;
    suction_[0].strength = during.suction;
    suction_[0].tip = during.blade_to * scope_.tip();
    tissue_.position = during.tissue.position;
    tissue_.radius = during.tissue.radius;
    background_task_.run(
        [this, &shell = during.shell, revision = during.shell_revision] { run(shell, revision); });
}

void Saliva::run(const DistanceGrid& shell, std::uint64_t shell_revision) {
    const bool wall_follows = step_ % steps_per_wall == 0;
    ++step_;
    if (wall_follows) {
        wall_.update(shell, shell_revision, tissue_, fluid_.positions());
    }
    pbd::FluidSurroundings surroundings;
    surroundings.solid = &wall_.distance();
    surroundings.suctions = suction_;
    for (int s = 0; s < substeps; ++s) {
        constexpr float share = 1.0f / substeps;
        const float begin = share * static_cast<float>(s);
        now_.clear();
        for (const pbd::MovingCapsule& c : capsules_) {
            now_.push_back(part_of(c, begin, begin + share));
        }
        surroundings.capsules = now_;
        surroundings.solid_moved = s == 0 && wall_follows && wall_.nodes() > 0;
        fluid_.step(substep, gravity_, surroundings);
    }
}

void Saliva::end_step() {
    background_task_.wait();
}

}  // namespace eti::scene
