// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <filesystem>

namespace eti::headset_runtime {

/// Images that an application renders into in turn.
struct RuntimeSwapchain {
    static constexpr std::uint32_t length = 3;

    RuntimeSwapchain(int width, int height, int layers, GLenum format);
    ~RuntimeSwapchain();
    RuntimeSwapchain(const RuntimeSwapchain&) = delete;
    RuntimeSwapchain& operator=(const RuntimeSwapchain&) = delete;

    int width, height, layers;
    std::array<GLuint, length> textures{};
    std::uint32_t next = 0;
    bool acquired = false, waited = false, ever_released = false;

    /// Writes one layer of the image released last, with its opacity.
    void write(int layer, const std::filesystem::path& file) const;
};

}  // namespace eti::headset_runtime
