// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "client/render/image.hpp"

namespace eti::render {

/// An MPEG-4 video (mp4v) of equally sized pictures at a constant rate. The file is playable after finish()
/// or destruction.
class Video {
  public:
    /// Throws std::runtime_error naming the file and the remedy.
    Video(const std::filesystem::path& file, double frames_per_second, int width, int height);
    ~Video();
    Video(const Video&) = delete;
    Video& operator=(const Video&) = delete;

    /// Adds `image` `times` times; it must have the video's size.
    void add(const Image& image, int times = 1);
    void finish();

    [[nodiscard]] std::uint64_t frames() const { return frames_; }
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }

  private:
    struct Writer;
    std::unique_ptr<Writer> writer_;
    std::filesystem::path file_;
    std::uint64_t frames_ = 0;
};

}  // namespace eti::render
