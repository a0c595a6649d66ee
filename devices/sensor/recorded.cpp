// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/recorded.hpp"

#include <algorithm>
#include <vector>

#include "common/session/reader.hpp"

namespace eti::devices {

namespace {

class Recorded final : public Sensor {
  public:
    explicit Recorded(const SensorSetup& setup) {
        if (setup.source.empty()) {
            throw DeviceError("--device recorded: which file? Name a session file with --source");
        }
        try {
            for (const session::StepRecord& step : session::SessionReader(setup.source).steps()) {
                times_.push_back(1e-9 * static_cast<double>(step.time_ns));
                poses_.push_back(setup.tool == Tool::tube ? step.tube_grip : step.laryngoscope);
            }
        } catch (const hdf5::Error& error) {
            throw DeviceError("--source " + setup.source + ": " + error.what());
        }
        if (times_.empty() || !std::ranges::is_sorted(times_)) {
            throw DeviceError("--source " + setup.source +
                              ": holds no steps in order of time. Try eti-review check --repair");
        }
        last_.motion.pose = poses_.front();
    }

    void look(const Observation& seen) override { time_ = seen.time; }

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
