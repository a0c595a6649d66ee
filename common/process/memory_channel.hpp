// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/process/descriptor.hpp"
#include "common/process/guard.hpp"

namespace eti {

/// A nameless file in memory that a child process inherits, for what it has to say.
class MemoryChannel {
  public:
    MemoryChannel();  ///< Throws std::runtime_error when there is no memory.

    void put(const void* data, std::size_t size) const;  ///< Throws std::runtime_error.
    void put(const std::string& text) const;

    void rewind() const;
    /// False: it holds less.
    [[nodiscard]] bool get(void* data, std::size_t size) const;
    [[nodiscard]] bool get(std::string& text) const;  ///< of at most 1 MiB

  private:
    Descriptor file_;
};

/// A file that a child process could not read; the text names it, what was found and the remedy.
class ParseError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Runs `parse` in a child process (see run_guarded) and returns what it returns. What it throws, and how it
/// died, comes back as ParseError with `name`, the file's.
[[nodiscard]] std::vector<std::uint8_t> parse_in_child(
    const std::function<std::vector<std::uint8_t>()>& parse, const std::string& name,
    const GuardLimits& limits = {});

/// The text for a file whose reading ended with `how`; `expected`: what it should have been.
[[nodiscard]] std::string damaged(const std::string& name, const std::string& how,
                                  const std::string& expected);

}  // namespace eti
