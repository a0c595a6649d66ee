// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <BulletSoftBody/btSoftBody.h>

#include <fmt/format.h>

#include <memory>

#include "server/pbd/soft/links.hpp"
#include "server/pbd/soft/soft_body.hpp"
#include "tests/bench/server/speed/speed_meter.hpp"

// Bullet's soft bodies with the same lattice, substep and initial state as our own constraints, one pass per
// substep, no collisions. Bullet updates a bounding-volume tree of its nodes in every step, which is not
// needed here; it runs on one thread.

namespace eti::bench {

namespace {

std::unique_ptr<btSoftBody> bullet_body(btSoftBodyWorldInfo& info, const pbd::Particles& particles) {
    std::vector<btVector3> rest;
    for (const Vec3f& x : particles.rest) {
        rest.emplace_back(x.x(), x.y(), x.z());
    }
    const std::vector<btScalar> mass(particles.size(), btScalar(3.2e-5));
    auto body = std::make_unique<btSoftBody>(&info, static_cast<int>(rest.size()), rest.data(), mass.data());
    body->m_cfg.piterations = 1;
    body->m_cfg.collisions = 0;
    body->getCollisionShape()->setMargin(btScalar(1e-4));
    return body;
}

void shear(btSoftBody& body, const pbd::Particles& particles) {
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        const Vec3f& x = particles.position[static_cast<std::size_t>(i)];
        btSoftBody::Node& node = body.m_nodes[i];
        node.m_x = node.m_q = btVector3(x.x(), x.y(), x.z());
        node.m_v.setZero();
    }
}

void links(SpeedMeter& meter, const test::TetrahedralLattice& lattice) {
    const std::vector<std::array<std::uint32_t, 2>> edges = edges_of(lattice);
    const double count = static_cast<double>(edges.size());
    pbd::SoftBody ours;
    ours.particles = sheared_particles(lattice);
    ours.links.configure(edges, std::vector<float>(edges.size(), 10.0f), ours.particles);

    btSoftBodyWorldInfo info;
    info.m_gravity.setZero();
    const std::unique_ptr<btSoftBody> theirs = bullet_body(info, ours.particles);
    for (const auto& [a, b] : edges) {
        theirs->appendLink(static_cast<int>(a), static_cast<int>(b));
    }
    shear(*theirs, ours.particles);
    const double our_links = meter.fastest([&] { ours.links.project(ours.particles, speed_substep); });
    theirs->predictMotion(btScalar(speed_substep));
    // One pass over the links and the velocity update after it.
    const double their_links = meter.fastest([&] { theirs->solveConstraints(); });
    meter.add("links, per link", our_links / count, "ns", {}, their_links / count);
    const double our_step = meter.fastest([&] {
        ours.predict(speed_substep, 1.0f);
        ours.links.project(ours.particles, speed_substep);
        ours.finish(speed_substep);
    });
    const double their_step = meter.fastest([&] {
        theirs->predictMotion(btScalar(speed_substep));
        theirs->solveConstraints();
    });
    meter.add(fmt::format("body of {:.0f} links, per substep", count), 1e-6 * our_step, "ms", {},
              1e-6 * their_step);
}

}  // namespace

void measure_peers(SpeedMeter& meter) {
    const test::TetrahedralLattice lattice = meter.quick() ? test::tetrahedral_lattice(8, 8, 8, 2e-3)
                                                           : test::tetrahedral_lattice(24, 24, 15, 2e-3);
    links(meter, lattice);
}

}  // namespace eti::bench
