// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/cluster_chain.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "server/pbd/rotation.hpp"

namespace eti::pbd {

namespace {

constexpr int warm_rotation_steps = 2;  // warm-started from the last substep
// [rad]; a joint bent farther than a plate ever is (a tool went through it) returns gradually.
constexpr float max_bend = 1.0f;
// [rad], rotation of a joint after which the system is inverted again. Below it a pass corrects approximately
// enough.
constexpr float stale = 0.1f;
constexpr float shear_share = 5.0f / 6.0f;  // of a rectangle's area: Timoshenko's k

Vec3f turn_of(const Quatf& rotation) {
    const float sign = rotation.w() < 0.0f ? -1.0f : 1.0f;
    const Vec3f half = sign * rotation.vec();
    const float sine = half.norm();
    // For small angles the ratio of angle to sine is 2.
    const float over = sine < 1e-4f ? 2.0f : 2.0f * std::atan2(sine, sign * rotation.w()) / sine;
    const Vec3f turn = over * half;
    const float angle = turn.norm();
    return angle > max_bend ? Vec3f(turn * (max_bend / angle)) : turn;
}

Eigen::Matrix3f cross_of(const Vec3f& a) {
    Eigen::Matrix3f m;
    m << 0.0f, -a.z(), a.y(), a.z(), 0.0f, -a.x(), -a.y(), a.x(), 0.0f;
    return m;
}

/// Columns: direction between the centres, the transverse axis, and the normal to both.
Eigen::Matrix3f axes_of(const Vec3f& apart, const Vec3f& across) {
    Eigen::Matrix3f axes;
    axes.col(0) = (apart - across * across.dot(apart)).normalized();
    axes.col(1) = across;
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
}

/// Section of a plate over its length: volume [m^2] and second moments [m^4] about the transverse and the
/// normal axis, relative to its own mid-plane, which may be inclined to the axes.
struct Section {
    float area = 0.0f, across = 0.0f, normal = 0.0f;
};

Section section_of(std::span<const std::uint32_t> members, const std::vector<Vec3f>& rest,
                   std::span<const float> volume, const Eigen::Matrix3f& axes, float length) {
    Vec3d mean = Vec3d::Zero();
    for (const std::uint32_t i : members) {
        mean += rest[i].cast<double>() / static_cast<double>(members.size());
    }
    std::vector<Vec3d> places;
    double ss = 1e-30;
    double sy = 0.0;
    for (const std::uint32_t i : members) {
        places.push_back(axes.cast<double>().transpose() * (rest[i].cast<double>() - mean));
        ss += places.back().x() * places.back().x();
        sy += places.back().x() * places.back().z();
    }
    double area = 0.0;
    double across = 0.0;
    double normal = 0.0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        const double v = static_cast<double>(volume[members[k]]);
        const double off = places[k].z() - sy / ss * places[k].x();
        const double cube = std::pow(v, 2.0 / 3.0) / 12.0;  // a particle's own second moment
        area += v;
        across += v * (off * off + cube);
        normal += v * (places[k].y() * places[k].y() + cube);
    }
    const auto over_length = [&](double sum) {
        return static_cast<float>(sum / static_cast<double>(length));
    };
    return {over_length(area), over_length(across), over_length(normal)};
}

}  // namespace

void ClusterChain::configure(const Description& description, const Particles& particles) {
    const auto& clusters = description.clusters;
    assert(clusters.size() > 1 && clusters.size() <= max_clusters);
    across_ = description.across;
    clusters_.assign(clusters.size(), {});
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        Cluster& cluster = clusters_[c];
        for (const std::uint32_t i : clusters[c]) {
            cluster.mass += description.fitting_mass[i];
        }
        for (const std::uint32_t i : clusters[c]) {
            cluster.members.push_back({.particle = i,
                                       .weight = description.fitting_mass[i] / cluster.mass,
                                       .free = particles.inverse_mass[i] > 0.0f});
        }
    }
    coupled_pairs_.clear();
    for (std::size_t c = 1; c < clusters.size(); ++c) {
        for (const std::uint32_t a : clusters[c - 1]) {
            for (const std::uint32_t b : clusters[c]) {
                coupled_pairs_.push_back({a, b});
            }
        }
    }
    joints_.assign(clusters.size() - 1, {});
    set_rest(particles);
    const float modulus = description.youngs_modulus;
    const float shear = modulus / (2.0f + 2.0f * description.poissons_ratio);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const Vec3f apart = clusters_[j + 1].rest_centre - clusters_[j].rest_centre;
        const Eigen::Matrix3f axes = axes_of(apart, across_);
        const float length = apart.norm();
        Section section;  // mean of both sides
        for (const std::size_t c : {j, j + 1}) {
            const Section side = section_of(clusters[c], particles.rest, description.volume, axes, length);
            section.area += 0.5f * side.area;
            section.across += 0.5f * side.across;
            section.normal += 0.5f * side.normal;
        }
        const float sliding = length / (shear_share * shear * section.area);
        joints_[j].local_stretch_compliance = {length / (modulus * section.area), sliding, sliding};
        // Twist is taken to be as stiff as bending; that of a flat sheet is 4 / (2 + 2 nu) = 1.4 times that.
        const float bending = length / (modulus * section.across);
        joints_[j].local_bend_compliance = {bending, bending, length / (modulus * section.normal)};
    }
    set_rest(particles);
    reset();
}

void ClusterChain::set_rest(const Particles& particles) {
    for (Cluster& cluster : clusters_) {
        Vec3d centre = Vec3d::Zero();
        for (const Member& member : cluster.members) {
            centre += static_cast<double>(member.weight) * particles.rest[member.particle].cast<double>();
        }
        cluster.rest_centre = centre.cast<float>();
        Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
        Eigen::Matrix<double, 6, 6> free = Eigen::Matrix<double, 6, 6>::Zero();
        for (Member& member : cluster.members) {
            const Vec3d arm = particles.rest[member.particle].cast<double>() - centre;
            member.arm = arm.cast<float>();
            const double mass = static_cast<double>(cluster.mass * member.weight);
            const Eigen::Matrix3d of_member =
                mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
            inertia += of_member;
            if (member.free) {
                const Eigen::Matrix3d lever = mass * cross_of(member.arm).cast<double>();
                free.topLeftCorner<3, 3>() += mass * Eigen::Matrix3d::Identity();
                free.topRightCorner<3, 3>() -= lever;
                free.bottomLeftCorner<3, 3>() += lever;
                free.bottomRightCorner<3, 3>() += of_member;
            }
        }
        Eigen::Matrix<double, 6, 6> light = Eigen::Matrix<double, 6, 6>::Zero();
        light.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / static_cast<double>(cluster.mass);
        light.bottomRightCorner<3, 3>() = inertia.inverse();
        cluster.inverse_inertia = inertia.inverse().cast<float>();
        cluster.response = (light * free * light).cast<float>();
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const Vec3f apart = clusters_[j + 1].rest_centre - clusters_[j].rest_centre;
        const Eigen::Matrix3f axes = axes_of(apart, across_);
        joints_[j].rest = clusters_[j].rest_centre + 0.5f * apart;
        joints_[j].stretch_compliance =
            axes * joints_[j].local_stretch_compliance.asDiagonal() * axes.transpose();
        joints_[j].bend_compliance = axes * joints_[j].local_bend_compliance.asDiagonal() * axes.transpose();
    }
    inverse_dt_ = 0.0f;
}

void ClusterChain::reset() {
    for (Cluster& cluster : clusters_) {
        cluster.rotation = Quatf::Identity();
        cluster.centre = cluster.rest_centre;
        cluster.shift = cluster.turn = Vec3f::Zero();
    }
    inverted_at_rotation_.assign(joints_.size(), Vec3f::Zero());
    inverse_dt_ = 0.0f;
    asleep_ = false;
}

void ClusterChain::select(const Particles& particles) {
    // Members that clusters of other tissue also move may be awake alone: they keep the forces from when the
    // others fell asleep.
    std::size_t count = 0;
    std::size_t asleep = 0;
    for (const Cluster& cluster : clusters_) {
        for (const Member& member : cluster.members) {
            ++count;
            asleep += particles.asleep[member.particle] != 0 ? 1 : 0;
        }
    }
    asleep_ = 2 * asleep > count;
}

void ClusterChain::fit(Cluster& cluster, const std::vector<Vec3f>& positions) const {
    const Vec3f origin = positions[cluster.members.front().particle];
    Vec3f mean = Vec3f::Zero();
    float a[3][3] = {};
    for (const Member& member : cluster.members) {
        const Vec3f apart = member.weight * (positions[member.particle] - origin);
        mean += apart;
        for (int c = 0; c < 3; ++c) {
            for (int r = 0; r < 3; ++r) {
                a[c][r] += member.arm[c] * apart[r];
            }
        }
    }
    cluster.centre = origin + mean;
    float q[4] = {cluster.rotation.x(), cluster.rotation.y(), cluster.rotation.z(), cluster.rotation.w()};
    extract_rotation(a, q, warm_rotation_steps);
    cluster.rotation = Quatf(q[3], q[0], q[1], q[2]).normalized();
}

void ClusterChain::measure() {
    const Quatf back = middle().conjugate();
    residual_.resize(static_cast<Eigen::Index>(6 * joints_.size()));
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const Cluster& from = clusters_[j];
        const Cluster& to = clusters_[j + 1];
        const Vec3f gap = to.centre + to.rotation * (joints_[j].rest - to.rest_centre) - from.centre -
                          from.rotation * (joints_[j].rest - from.rest_centre);
        joints_[j].bend_rotation = back * turn_of(to.rotation * from.rotation.conjugate());
        const auto at = static_cast<Eigen::Index>(6 * j);
        residual_.segment<3>(at) = back * gap;
        residual_.segment<3>(at + 3) = joints_[j].bend_rotation;
    }
}

void ClusterChain::invert(float dt) {
    const Quatf back = middle().conjugate();
    const auto size = static_cast<Eigen::Index>(6 * joints_.size());
    Square whole = Square::Zero(size, size);
    // Change of a joint's gap and rotation with the motion of a cluster's frame.
    const auto side = [&](std::size_t joint, std::size_t cluster) {
        const Eigen::Matrix3f turn = (back * clusters_[cluster].rotation).toRotationMatrix();
        Matrix6 sides = Matrix6::Identity();
        sides.topRightCorner<3, 3>() =
            -cross_of(turn * (joints_[joint].rest - clusters_[cluster].rest_centre));
        return cluster == joint ? Matrix6(-sides) : sides;
    };
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
        Matrix6 turn = Matrix6::Zero();
        turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
            (back * clusters_[c].rotation).toRotationMatrix();
        const Matrix6 response = turn * clusters_[c].response * turn.transpose();
        for (std::size_t j = c > 0 ? c - 1 : 0; j <= c && j < joints_.size(); ++j) {
            for (std::size_t k = c > 0 ? c - 1 : 0; k <= c && k < joints_.size(); ++k) {
                whole.block<6, 6>(static_cast<Eigen::Index>(6 * j), static_cast<Eigen::Index>(6 * k)) +=
                    side(j, c) * response * side(k, c).transpose();
            }
        }
    }
    const float over = 1.0f / (dt * dt);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const auto at = static_cast<Eigen::Index>(6 * j);
        const Eigen::Matrix3f turn = (back * clusters_[j].rotation).toRotationMatrix();
        whole.block<3, 3>(at, at) += over * (turn * joints_[j].stretch_compliance * turn.transpose());
        whole.block<3, 3>(at + 3, at + 3) += over * (turn * joints_[j].bend_compliance * turn.transpose());
        inverted_at_rotation_[j] = joints_[j].bend_rotation;
    }
    inverse_ = whole.ldlt().solve(Square::Identity(size, size));
    inverse_dt_ = dt;
}

void ClusterChain::compute_response() {
    multiplier_.noalias() = inverse_ * residual_;
    for (Cluster& cluster : clusters_) {
        cluster.shift = cluster.turn =
            Vec3f::Zero();  // at first sums of forces and moments over the squared substep
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const auto at = static_cast<Eigen::Index>(6 * j);
        const Vec3f force = middle() * Vec3f(multiplier_.segment<3>(at));
        const Vec3f moment = middle() * Vec3f(multiplier_.segment<3>(at + 3));
        Cluster& from = clusters_[j];
        Cluster& to = clusters_[j + 1];
        from.shift += force;
        from.turn += moment + (from.rotation * (joints_[j].rest - from.rest_centre)).cross(force);
        to.shift -= force;
        to.turn -= moment + (to.rotation * (joints_[j].rest - to.rest_centre)).cross(force);
    }
    for (Cluster& cluster : clusters_) {
        cluster.shift /= cluster.mass;
        cluster.turn =
            cluster.rotation * (cluster.inverse_inertia * (cluster.rotation.conjugate() * cluster.turn));
    }
}

void ClusterChain::project(Particles& particles, float dt) {
    if (!asleep_) {
        for (Cluster& cluster : clusters_) {
            fit(cluster, particles.predicted);
        }
        measure();
        bool old = dt != inverse_dt_;
        for (std::size_t j = 0; j < joints_.size(); ++j) {
            old = old || (joints_[j].bend_rotation - inverted_at_rotation_[j]).squaredNorm() > stale * stale;
        }
        if (old) {
            invert(dt);
        }
        compute_response();
    }
    for (const Cluster& cluster : clusters_) {
        for (const Member& member : cluster.members) {
            if (member.free && particles.asleep[member.particle] == 0) {
                Vec3f& place = particles.predicted[member.particle];
                place += cluster.shift + cluster.turn.cross(place - cluster.centre);
            }
        }
    }
}

}  // namespace eti::pbd
