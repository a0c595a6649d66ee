// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/video.hpp"

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <stdexcept>

#include <fmt/format.h>

namespace eti::render {

struct Video::Writer {
    cv::VideoWriter file;
    cv::Size size;
    cv::Mat bgr;
};

Video::Video(const std::filesystem::path& file, double frames_per_second, int width, int height)
    : writer_(std::make_unique<Writer>()), file_(file) {
    // FFmpeg explicitly: OpenCV's fallback writer would put a frame number into the file names.
    writer_->size = cv::Size(width, height);
    const bool opened =
        writer_->file.open(file.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'),
                           frames_per_second, writer_->size);
    if (!opened) {
        throw std::runtime_error(
            fmt::format("{}: cannot write a video to this file. Give a name that ends in .mp4, in a folder "
                        "that exists and is writable; the size ({} x {}) must be even.",
                        file.string(), width, height));
    }
}

Video::~Video() {
    finish();
}

void Video::add(const Image& image, int times) {
    if (!writer_->file.isOpened() || image.width != writer_->size.width ||
        image.height != writer_->size.height) {
        return;
    }
    const cv::Mat rgba(image.height, image.width, CV_8UC4, const_cast<std::uint8_t*>(image.rgba.data()));
    cv::cvtColor(rgba, writer_->bgr, cv::COLOR_RGBA2BGR);
    for (int i = 0; i < times; ++i) {
        writer_->file.write(writer_->bgr);
        ++frames_;
    }
}

void Video::finish() {
    writer_->file.release();
}

}  // namespace eti::render
