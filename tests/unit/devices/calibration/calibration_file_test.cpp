// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/calibration/calibration_file.hpp"
#include "common/scenario/data_file.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "devices/calibration/calibrated_sensor.hpp"
#include "devices/calibration/point_file.hpp"
#include "tests/support/error_of.hpp"

namespace eti::devices {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class CalibrationFile : public ::testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(file_); }
    void write(const std::string& text) const { std::ofstream(file_) << text; }
    template <class Load>
    [[nodiscard]] std::string refusal(Load load) const {
        return test::error_of<InputError>([&] { (void)load(file_); });
    }
    std::filesystem::path file_ =
        testing::TempDir() + "eti_calibration_" + std::to_string(::getpid()) + ".yaml";
};

TEST_F(CalibrationFile, RoundTrips) {
    Calibration c;
    c.registered = false;
    c.device = "openhaptics";
    c.date = utc_now();
    c.points = 10;
    c.error = 0.4e-3;
    c.left_out_error = 0.7e-3;
    c.to_patient = {quaternion_from({1.0f, -2.0f, 0.5f}), {0.3f, 0.2f, -0.1f}};
    c.tool = {quaternion_from({0.0f, 1.5f, 0.0f}), {0.01f, 0.0f, -0.06f}};
    save_calibration(c, file_);
    const Calibration back = load_calibration(file_);
    EXPECT_FALSE(back.registered);
    EXPECT_EQ(back.device, "openhaptics");
    EXPECT_EQ(back.date, c.date);
    EXPECT_EQ(back.date.size(), 20u);
    EXPECT_EQ(back.points, 10);
    EXPECT_NEAR(back.error, 0.4e-3, 1e-6);
    EXPECT_NEAR(back.left_out_error, 0.7e-3, 1e-6);
    // Written to a tenth of a micrometre and a hundred-thousandth of a degree.
    EXPECT_LT((back.to_patient.translation - c.to_patient.translation).norm(), 1e-6f);
    EXPECT_LT(rotation_vector(back.to_patient.rotation * c.to_patient.rotation.conjugate()).norm(), 1e-5f);
    EXPECT_LT((back.tool.translation - c.tool.translation).norm(), 1e-6f);
}

TEST_F(CalibrationFile, InvalidFileErrorNamesPlaceAndRemedy) {
    const auto load = [](const auto& file) { return load_calibration(file); };
    write("device: openhaptics\n");
    EXPECT_THAT(refusal(load), AllOf(HasSubstr("to_patient"), HasSubstr("eti-calibrate")));
    write("device: x\nto_patient: {translation_mm: [1, 2, .nan], rotation_vector_deg: [0, 0, 0]}\n");
    EXPECT_THAT(refusal(load), HasSubstr("translation_mm"));
    write(
        "device: x\nextra: 1\nto_patient: {translation_mm: [1, 2, 3]}\ntool: {translation_mm: [1, 2, 3]}\n");
    EXPECT_THAT(refusal(load), HasSubstr("extra"));
    std::filesystem::remove(file_);
    EXPECT_THAT(refusal(load), HasSubstr(file_.string()));
    EXPECT_THROW(save_calibration({}, "/nowhere/at/all.yaml"), InputError);
}

TEST_F(CalibrationFile, PointAndPoseErrorsNameTheLine) {
    write("points:\n  - {name: a, patient_mm: [1, 2, 3], device_mm: [4, 5, 6]}\n");
    EXPECT_LT((load_points(file_, true)[0].device - Eigen::Vector3d(4e-3, 5e-3, 6e-3)).norm(), 1e-9);
    write("points:\n  - {name: a, patient_mm: [1, 2, 3]}\n");
    EXPECT_EQ(load_points(file_, false).size(), 1u);
    EXPECT_THAT(refusal([](const auto& file) { return load_points(file, true); }), HasSubstr("device_mm"));
    write("points: []\n");
    EXPECT_THAT(refusal([](const auto& file) { return load_points(file, false); }), HasSubstr("no points"));
    write("# x y z w x y z\n1,2,3,1,0,0,0\n\n1 2 3 1 0 0\n");
    EXPECT_THAT(refusal([](const auto& file) { return load_poses(file); }),
                HasSubstr(":4: found '1 2 3 1 0 0'"));
    write("1 2 3 5 0 0 0\n");
    EXPECT_THAT(refusal([](const auto& file) { return load_poses(file); }), HasSubstr("unit quaternion"));
}

/// A device at rest that records the wrench it receives.
class Still final : public Sensor {
  public:
    explicit Still(Wrench& given, const bool& broken) : given_(given), broken_(broken) {}
    [[nodiscard]] DeviceCapabilities capabilities() const override { return {.force = 8.0f, .torque = 0.5f}; }
    Reading exchange(const Wrench& wrench, float) override {
        given_ = wrench;
        Reading reading;
        if (broken_) {
            reading.motion.pose.rotation = Quatf(std::numeric_limits<float>::quiet_NaN(), 0, 0, 0);
            return reading;
        }
        reading.motion.pose = {quaternion_from({0, 0, 0.5f}), {0.1f, 0, 0}};
        reading.motion.velocity = {0.01f, 0, 0};
        reading.motion.angular_velocity = {0, 0, 2.0f};
        return reading;
    }

  private:
    Wrench& given_;
    const bool& broken_;
};

// Power is the same in both frames and at both points: force times velocity plus torque times angular
// velocity.
TEST(CalibratedSensor, ReturnsToolPoseAndConservesPower) {
    Calibration c;
    c.to_patient = {quaternion_from({1.0f, 0.3f, 0}), {0.3f, 0.2f, -0.1f}};
    c.tool = {quaternion_from({0, 1.5f, 0}), {0.01f, 0.05f, -0.06f}};
    Wrench given;
    const bool broken = false;
    CalibratedSensor sensor(std::make_unique<Still>(given, broken), c);
    Reading reading = sensor.exchange({}, 1e-3f);
    const RigidTransform expected =
        c.to_patient * RigidTransform{quaternion_from({0, 0, 0.5f}), {0.1f, 0, 0}} * c.tool;
    EXPECT_LT((reading.motion.pose.translation - expected.translation).norm(), 1e-7f);
    EXPECT_LT(rotation_vector(reading.motion.pose.rotation * expected.rotation.conjugate()).norm(), 1e-6f);
    const Wrench wrench{{1.0f, -2.0f, 0.5f}, {0.1f, 0.02f, -0.3f}};
    reading = sensor.exchange(wrench, 1e-3f);
    const float outside =
        wrench.force.dot(reading.motion.velocity) + wrench.torque.dot(reading.motion.angular_velocity);
    const float inside = given.force.dot(Vec3f(0.01f, 0, 0)) + given.torque.dot(Vec3f(0, 0, 2.0f));
    EXPECT_NEAR(outside, inside, 1e-6f);
    EXPECT_GT(std::abs(outside), 0.1f);
}

TEST(CalibratedSensor, CommandedWrenchIsWithinMotorLimits) {
    Calibration c;
    c.tool = {Quatf::Identity(), {0, 0, -0.1f}};
    Wrench given;
    bool broken = false;
    CalibratedSensor sensor(std::make_unique<Still>(given, broken), c);
    (void)sensor.exchange({}, 1e-3f);
    const Wrench far{{8.0f, 0, 0}, Vec3f::Zero()};  // 0.8 N m about the moving part
    (void)sensor.exchange(far, 1e-3f);
    EXPECT_EQ(given.force.norm(), 8.0f);
    EXPECT_NEAR(given.torque.norm(), 0.5f, 1e-6f);
    // A non-finite pose has no lever arm; the last valid one is used.
    broken = true;
    (void)sensor.exchange(far, 1e-3f);
    (void)sensor.exchange(far, 1e-3f);
    EXPECT_TRUE(given.torque.allFinite());
    EXPECT_NEAR(given.torque.norm(), 0.5f, 1e-6f);
}

}  // namespace
}  // namespace eti::devices
