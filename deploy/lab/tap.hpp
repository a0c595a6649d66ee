// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace eti::lab {

/// The far end of a network interface in another network namespace. Destroying it removes the interface.
class Tap {
  public:
    /// `space`: the namespace's file, /proc/PID/ns/net or /run/netns/NAME. Throws std::system_error.
    Tap(const std::filesystem::path& space, const std::string& interface);
    ~Tap();
    Tap(Tap&& other) noexcept : file_(other.file_) { other.file_ = -1; }
    Tap& operator=(Tap&&) = delete;

    /// Size [bytes] of the next frame that the host has sent; 0: none is waiting.
    [[nodiscard]] std::size_t read(std::span<std::uint8_t> frame);
    /// False: the host cannot receive it.
    bool write(std::span<const std::uint8_t> frame);
    [[nodiscard]] int file() const { return file_; }

  private:
    void close();

    int file_ = -1;
};

}  // namespace eti::lab
