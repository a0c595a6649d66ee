// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <filesystem>

namespace eti::headset_runtime {

/// Pictures that a program draws into, one after the other.
struct Chain {
    static constexpr std::uint32_t length = 3;

    Chain(int width, int height, int layers, GLenum format);
    ~Chain();
    Chain(const Chain&) = delete;
    Chain& operator=(const Chain&) = delete;

    int width, height, layers;
    std::array<GLuint, length> textures{};
    std::uint32_t next = 0;
    bool acquired = false, waited = false, ever_released = false;

    /// Writes a layer of what was released last, with its opacity.
    void write(int layer, const std::filesystem::path& file) const;
};

}  // namespace eti::headset_runtime
