// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The three files of eti-calibrate: a calibration, named points and poses of a sensor.
#include "common/scenario/data_file.hpp"
#include "devices/calibration/calibration_file.hpp"
#include "devices/calibration/point_file.hpp"
#include "memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eti;
    static const fuzz::MemoryFile file;
    const std::filesystem::path path = file.path();
    file.hold(data, size);
    const auto read = [&](const auto& load) { fuzz::read_or_refuse<InputError>(path.string(), load); };
    read([&] { (void)devices::load_calibration(path); });
    read([&] { (void)devices::load_points(path, true); });
    read([&] { (void)devices::load_points(path, false); });
    read([&] {
        for (const Eigen::Isometry3d& pose : devices::load_poses(path)) {
            fuzz::require(pose.matrix().allFinite(), "a pose that is not finite");
        }
    });
    return 0;
}
