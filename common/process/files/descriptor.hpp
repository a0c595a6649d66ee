// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <unistd.h>

#include <utility>

namespace eti {

/// Owns and closes a file descriptor, as returned by open(2) or socket(2). Negative: none.
class Descriptor {
  public:
    Descriptor() = default;
    explicit Descriptor(int id) : id_(id) {}
    ~Descriptor() { close(); }
    Descriptor(Descriptor&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }

    [[nodiscard]] int get() const { return id_; }
    explicit operator bool() const { return id_ >= 0; }
    void close() {
        if (id_ >= 0) {
            ::close(std::exchange(id_, -1));
        }
    }

  private:
    int id_ = -1;
};

}  // namespace eti
