// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/image.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <stdexcept>

#include <fmt/format.h>

#include "common/process/files/atomic_file_writer.hpp"

namespace eti::render {

void write_png(const Image& image, const std::filesystem::path& file) {
    // OpenCV's Mat requires a mutable pointer, but only reads here.
    const cv::Mat rgba(image.height, image.width, CV_8UC4, const_cast<std::uint8_t*>(image.rgba.data()));
    cv::Mat bgr;
    cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
    std::vector<std::uint8_t> encoded;
    // Level 1: a fifth larger than the default, several times faster.
    if (!cv::imencode(".png", bgr, encoded, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
        throw std::runtime_error(fmt::format("{}: cannot encode the picture as PNG", file.string()));
    }
    if (const std::string why = write_file_atomically(file, bytes_of(std::span<const std::uint8_t>(encoded)));
        !why.empty()) {
        throw std::runtime_error(
            fmt::format("{}: cannot write the picture: {}. Check that the folder exists, is writable and "
                        "that the disk is not full.",
                        file.string(), why));
    }
}

Image read_png(const std::filesystem::path& file) {
    const cv::Mat bgr = cv::imread(file.string(), cv::IMREAD_COLOR);
    if (bgr.empty()) {
        throw std::runtime_error(fmt::format("{}: cannot read a picture from this file", file.string()));
    }
    Image image{.width = bgr.cols, .height = bgr.rows, .rgba = {}};
    image.rgba.resize(4 * bgr.total());
    cv::Mat rgba(bgr.rows, bgr.cols, CV_8UC4, image.rgba.data());
    cv::cvtColor(bgr, rgba, cv::COLOR_BGR2RGBA);
    return image;
}

}  // namespace eti::render
