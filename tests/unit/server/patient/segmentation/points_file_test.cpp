// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/placement/points_file.hpp"

#include <gtest/gtest.h>

#include "common/math/random.hpp"
#include "server/patient/imaging/bytes.hpp"
#include "server/patient/imaging/volume.hpp"
#include "tests/support/scratch_folder.hpp"

namespace eti::segmentation {
namespace {

const Points points = {{"tongue", {Vec3d(0.001, 0.021, -0.0125)}},
                       {"spine", {Vec3d(0, 0.06, 0), Vec3d(0, 0.07, -0.04)}}};

class PointsFile : public eti::test::ScratchFolderTest {
  protected:
    void expect_refused(const std::string& text, const std::string& said) const {
        imaging::write_text(file, text);
        try {
            (void)read_points(file, remarks);
            ADD_FAILURE() << text << " was accepted";
        } catch (const imaging::VolumeError& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.rfind(file.string(), 0), 0u) << message;
            EXPECT_NE(message.find(said), std::string::npos) << message;
            EXPECT_NE(message.find("Remedy: "), std::string::npos) << message;
        }
    }
    static std::string with(std::string from, const std::string& to) {
        std::string text = encode_points(points);
        text.replace(text.find(from), from.size(), to);
        return text;
    }

    const std::filesystem::path file = folder / "points.mrk.json";
    mutable std::vector<std::string> remarks;
};

TEST_F(PointsFile, RoundTripPreservesPoints) {
    imaging::write_text(file, encode_points(points));
    const Points back = read_points(file, remarks);
    ASSERT_EQ(back.size(), 2u);
    ASSERT_EQ(back.at("spine").size(), 2u);
    EXPECT_LT((back.at("spine")[1] - points.at("spine")[1]).norm(), 1e-9);
    EXPECT_LT((back.at("tongue")[0] - points.at("tongue")[0]).norm(), 1e-9);
}

TEST_F(PointsFile, RasIsConvertedToLps) {
    imaging::write_text(file, with("\"LPS\"", "\"RAS\""));
    EXPECT_LT((read_points(file, remarks).at("tongue")[0] - Vec3d(-0.001, -0.021, -0.0125)).norm(), 1e-9);
}

TEST_F(PointsFile, UndefinedPointsAreLeftOut) {
    // As Slicer saves a point that was named, but not yet placed.
    const std::string undefined =
        R"({"markups": [{"coordinateSystem": "LPS", "coordinateUnits": ["mm", "UCUM", "millimeter"],
            "controlPoints": [
              {"label": "tongue", "position": [1, 2, 3], "positionStatus": "defined"},
              {"label": "tongue", "position": [0, 0, 0], "positionStatus": "undefined"},
              {"label": "spine", "position": [0, 0, 0], "positionStatus": "preview"}]}]})";
    imaging::write_text(file, undefined);
    const Points found = read_points(file, remarks);
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found.at("tongue").size(), 1u);
    EXPECT_LT((found.at("tongue")[0] - Vec3d(0.001, 0.002, 0.003)).norm(), 1e-12);
    ASSERT_EQ(remarks.size(), 2u);
    EXPECT_NE(remarks[0].find("'tongue' whose position is undefined"), std::string::npos) << remarks[0];
}

TEST_F(PointsFile, MalformedPointsAreRefused) {
    expect_refused(with("\"tongue\"", "\"tounge\""), "tounge");
    expect_refused(with("\"LPS\"", "\"IJK\""), "IJK");
    expect_refused(with("\"mm\"", "\"inch\""), "inch");
    expect_refused(with("-12.5", "1e300"), "tongue");
    expect_refused("{}", "markups");
    expect_refused("[[[", "parse");
    EXPECT_THROW((void)read_points(file.string() + ".absent", remarks), imaging::VolumeError);
}

TEST_F(PointsFile, DamagedFilesAreRefusedOrHarmless) {
    Random random(3);
    const std::string whole = encode_points(points);
    std::size_t refused = 0;
    for (int round = 0; round < 500; ++round) {
        std::string text = whole;
        for (int flips = 1 + static_cast<int>(random.bits() % 3); flips > 0; --flips) {
            text[random.bits() % text.size()] = static_cast<char>(random.bits() % 256);
        }
        imaging::write_text(file, text);
        try {
            (void)read_points(file, remarks);
        } catch (const imaging::VolumeError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace eti::segmentation
