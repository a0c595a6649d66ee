// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "server/patient/imaging/formats.hpp"
#include "server/patient/imaging/read.hpp"
#include "tests/support/scratch_folder.hpp"

namespace eti::imaging::test {

/// A rotated, anisotropic volume in which every voxel has a distinct value.
inline Volume sample() {
    Volume volume;
    volume.geometry.size = {7, 6, 5};
    volume.geometry.origin = Vec3d(0.012, -0.034, 0.056);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.4, Vec3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
    volume.geometry.step = turn * Vec3d(0.5e-3, 0.7e-3, 1.5e-3).asDiagonal();
    for (std::size_t i = 0; i < volume.geometry.count(); ++i) {
        volume.value.push_back(static_cast<float>(static_cast<int>(i * 7 % 2000) - 1000));
    }
    return volume;
}

inline void expect_same(const Volume& a, const Volume& b) {
    EXPECT_EQ(a.geometry.size, b.geometry.size);
    EXPECT_LT((a.geometry.origin - b.geometry.origin).norm(), 1e-8);  // NIfTI stores positions as floats
    EXPECT_LT((a.geometry.step - b.geometry.step).norm(), 1e-9);
    EXPECT_EQ(a.value, b.value);
}

class Folder : public eti::test::ScratchFolderTest {
  protected:
    std::filesystem::path put(const std::string& name, const Bytes& data) const {
        std::ofstream out(folder / name, std::ios::binary);
        out.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
        return folder / name;
    }
};

/// Reads a file that must be rejected; the message names the file, `said`, and a remedy.
inline void expect_refused(const std::filesystem::path& file, const std::string& said,
                           const GuardLimits& limits = {}) {
    try {
        (void)read(file, limits);
        ADD_FAILURE() << file << " was accepted";
    } catch (const VolumeError& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find(file.string()), std::string::npos) << message;
        EXPECT_NE(message.find(said), std::string::npos) << message;
        EXPECT_NE(message.find("xpected"), std::string::npos) << message;
        EXPECT_NE(message.find("Remedy: "), std::string::npos) << message;
    }
}

}  // namespace eti::imaging::test
