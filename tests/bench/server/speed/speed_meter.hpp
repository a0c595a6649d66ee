// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/pbd/particles.hpp"
#include "tests/support/tetrahedral_lattice.hpp"

namespace eti::bench {

inline constexpr float speed_substep = 1.0f / 1440.0f;  ///< [s]

struct SpeedResult {
    std::string name;
    int threads = 1;
    double value = 0.0;
    std::string unit;
    std::optional<double> bound;  ///< in the same unit, from the bandwidth measured in the same run
    std::optional<double> peer;   ///< the same work by another library, in the same unit
};

/// Measures with one number of threads and collects results.
class SpeedMeter {
  public:
    SpeedMeter(int threads, bool quick, std::vector<SpeedResult>& results)
        : threads_(threads), quick_(quick), results_(results) {}

    [[nodiscard]] int threads() const { return threads_; }
    [[nodiscard]] bool quick() const { return quick_; }

    /// The fastest of several repetitions [ns]: the others were disturbed. At least three, then as many as
    /// fit into half a second, 400 at most.
    [[nodiscard]] double fastest(const std::function<void()>& work) const;

    /// [bytes/ns] of a = b + s c over a working set of that many bytes (McCalpin's triad).
    [[nodiscard]] double bandwidth(double bytes) const;

    void add(const std::string& name, double value, const std::string& unit, std::optional<double> bound = {},
             std::optional<double> peer = {}) {
        results_.push_back({name, threads_, value, unit, bound, peer});
    }

  private:
    int threads_;
    bool quick_;
    std::vector<SpeedResult>& results_;
};

/// Particles at the nodes of a lattice, sheared, so that constraints have errors to correct.
[[nodiscard]] pbd::Particles sheared_particles(const test::TetrahedralLattice& lattice);
/// Edges of its tetrahedra, each once.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> edges_of(const test::TetrahedralLattice& lattice);

/// The parts: constraints of the tissue, contacts, fluid and tube; the same tissue as Bullet's soft bodies;
/// bodies from ten to five hundred thousand particles; the scenario 'term' by stage.
void measure_parts(SpeedMeter& meter);
void measure_peers(SpeedMeter& meter);
void measure_scaling(SpeedMeter& meter);
void measure_scene(SpeedMeter& meter);
/// The scenario 'term' while head, jaw, table, tongue and stiffness sweep their ranges and back.
void measure_sweeps(SpeedMeter& meter);
/// Whole steps of a scenario with saliva, and of one at the finest useful resolution. Takes minutes.
void measure_whole_scenes(SpeedMeter& meter);

}  // namespace eti::bench
