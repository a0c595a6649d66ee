// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/recorded.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "common/process/files/memfd_pipe.hpp"
#include "common/session/reader.hpp"

namespace eti::devices {

namespace {

/// The data of a step passed on by the child process that reads the file.
struct Step {
    double time = 0.0;                   // [s]
    std::array<float, 4> rotation{};     // x, y, z, w
    std::array<float, 3> translation{};  // [m]
};

// The library that reads session files may crash on a hostile one, so a child process runs it. The limit on
// address space is high because the bus has already mapped a lot.
constexpr GuardLimits limits{.processor_seconds = 60, .memory_bytes = std::uint64_t{16} << 30};

std::vector<std::uint8_t> steps_of(const std::string& file, Tool tool) {
    std::vector<std::uint8_t> bytes;
    for (const session::StepRecord& record : session::SessionReader(file).steps()) {
        const RigidTransform& pose = tool == Tool::tube ? record.tube_grip : record.laryngoscope;
        Step step{.time = 1e-9 * static_cast<double>(record.time_ns)};
        Eigen::Map<Eigen::Vector4f>(step.rotation.data()) = pose.rotation.coeffs();
        Eigen::Map<Vec3f>(step.translation.data()) = pose.translation;
        const std::size_t at = bytes.size();
        bytes.resize(at + sizeof(Step));
        std::memcpy(bytes.data() + at, &step, sizeof(Step));
    }
    return bytes;
}

class Recorded final : public Sensor {
  public:
    explicit Recorded(const SensorSetup& setup) {
        if (setup.source.empty()) {
            throw DeviceError("--device recorded: no session file given. Name one with --source");
        }
        try {
            const std::vector<std::uint8_t> bytes =
                parse_in_child([&] { return steps_of(setup.source, setup.tool); }, setup.source, limits);
            times_.resize(bytes.size() / sizeof(Step));
            poses_.resize(times_.size());
            for (std::size_t i = 0; i < times_.size(); ++i) {
                Step step;
                std::memcpy(&step, bytes.data() + i * sizeof(Step), sizeof(Step));
                times_[i] = step.time;
                poses_[i] = {Quatf(step.rotation.data()), Vec3f(step.translation.data())};
            }
        } catch (const ParseError& error) {
            throw DeviceError("--source " + setup.source + ": " + error.what());
        }
        if (times_.empty() || !std::ranges::is_sorted(times_)) {
            throw DeviceError("--source " + setup.source +
                              ": contains no steps in order of time. Try eti-review check --repair");
        }
        last_.motion.pose = poses_.front();
    }

    void observe(const Observation& seen) override { time_ = seen.time; }

    Reading exchange(const Wrench&, float elapsed) override {
        const auto next = static_cast<std::size_t>(std::ranges::upper_bound(times_, time_) - times_.begin());
        const RigidTransform before = last_.motion.pose;
        if (next == 0 || next == times_.size()) {
            last_.motion.pose = next == 0 ? poses_.front() : poses_.back();
        } else {
            const double gap = times_[next] - times_[next - 1];
            const auto share = gap > 0.0 ? static_cast<float>((time_ - times_[next - 1]) / gap) : 1.0f;
            const RigidTransform &a = poses_[next - 1], &b = poses_[next];
            last_.motion.pose = {
                (quaternion_from(share * rotation_vector(b.rotation * a.rotation.conjugate())) * a.rotation)
                    .normalized(),
                a.translation + share * (b.translation - a.translation)};
        }
        if (elapsed > 0.0f) {
            last_.motion.velocity = (last_.motion.pose.translation - before.translation) / elapsed;
            last_.motion.angular_velocity =
                rotation_vector(last_.motion.pose.rotation * before.rotation.conjugate()) / elapsed;
        }
        ++last_.sample;
        return last_;
    }

    [[nodiscard]] bool finished() const override { return time_ >= times_.back(); }

  private:
    std::vector<double> times_;  // [s]
    std::vector<RigidTransform> poses_;
    double time_ = 0.0;
    Reading last_;
};

}  // namespace

std::unique_ptr<Sensor> open_recorded(const SensorSetup& setup) {
    return std::make_unique<Recorded>(setup);
}

}  // namespace eti::devices
