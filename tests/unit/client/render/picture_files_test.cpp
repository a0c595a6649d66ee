// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "client/render/image.hpp"
#include "client/render/video.hpp"
#include "client/render/views/camera.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/scratch_folder.hpp"

namespace eti {
namespace {

class PictureFiles : public test::ScratchFolderTest {
  protected:
    static render::Image gradient(int width, int height, std::uint8_t blue) {
        render::Image image{width, height, {}};
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                image.rgba.insert(image.rgba.end(),
                                  {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), blue, 255});
            }
        }
        return image;
    }
};

TEST_F(PictureFiles, PngRoundTrips) {
    const render::Image image = gradient(64, 48, 200);
    render::write_png(image, folder / "a.png");
    const cv::Mat read = cv::imread((folder / "a.png").string(), cv::IMREAD_COLOR);
    ASSERT_EQ(read.cols, 64);
    ASSERT_EQ(read.rows, 48);
    const auto pixel = read.at<cv::Vec3b>(20, 10);  // row 20, column 10; blue, green, red
    EXPECT_EQ(pixel, cv::Vec3b(200, 20, 10));
}

TEST_F(PictureFiles, PngErrorNamesMissingFolder) {
    EXPECT_THAT(test::error_of<std::runtime_error>(
                    [&] { render::write_png(gradient(8, 8, 0), folder / "missing" / "a.png"); }),
                ::testing::HasSubstr("missing/a.png"));
}

TEST_F(PictureFiles, VideoKeepsFramesAndRate) {
    const auto file = folder / "run.mp4";
    {
        render::Video video(file, 15.0, 64, 48);
        for (int i = 0; i < 10; ++i) {
            video.add(gradient(64, 48, static_cast<std::uint8_t>(20 * i)), i == 9 ? 6 : 1);
        }
        EXPECT_EQ(video.frames(), 15u);
    }
    cv::VideoCapture read(file.string());
    ASSERT_TRUE(read.isOpened());
    EXPECT_NEAR(read.get(cv::CAP_PROP_FPS), 15.0, 1e-6);
    cv::Mat frame;
    int frames = 0;
    double last_blue = 0.0;
    while (read.read(frame)) {
        ++frames;
        last_blue = cv::mean(frame)[0];
    }
    EXPECT_EQ(frames, 15);
    EXPECT_NEAR(last_blue, 180.0, 15.0) << "lossy, but the last picture is the bluest";
}

TEST_F(PictureFiles, VideoInMissingFolderIsRejected) {
    EXPECT_THROW(render::Video(folder / "missing" / "a.mp4", 15.0, 64, 48), std::runtime_error);
}

TEST(Camera, PoseLooksAlongMinusZ) {
    render::Camera camera;
    camera.eye = Vec3f(0.1f, -0.2f, 0.3f);
    camera.target = Vec3f(0.0f, 0.04f, -0.03f);
    const RigidTransform pose = camera.pose();
    const Vec3f gaze = (camera.target - camera.eye).normalized();
    EXPECT_LT((pose.rotation * Vec3f(0, 0, -1) - gaze).norm(), 1e-5f);
    EXPECT_GT((pose.rotation * Vec3f(0, 1, 0)).dot(camera.up), 0.0f);
    // The view matrix is the pose's inverse.
    const Eigen::Vector4f at_eye = camera.view() * Eigen::Vector4f(0.1f, -0.2f, 0.3f, 1.0f);
    EXPECT_LT(at_eye.head<3>().norm(), 1e-6f);
}

}  // namespace
}  // namespace eti
