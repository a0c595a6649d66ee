// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/process/files/descriptor.hpp"
#include "common/process/guard.hpp"

namespace eti {

/// An anonymous memory file, inherited by a child process, that carries the child's output.
class MemfdPipe {
  public:
    MemfdPipe();  ///< Throws std::runtime_error when there is no memory.

    void put(const void* data, std::size_t size) const;  ///< Throws std::runtime_error.
    void put(const std::string& text) const;

    void rewind() const;
    /// False: fewer bytes are left.
    [[nodiscard]] bool get(void* data, std::size_t size) const;
    [[nodiscard]] bool get(std::string& text) const;  ///< of at most 1 MiB

  private:
    Descriptor file_;
};

/// A file that a child process could not read; the text names it, the problem and the remedy.
class ParseError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Runs `parse` in a child process (see run_guarded) and returns its result. Exceptions and crashes are
/// reported as ParseError with `name`, the file's name.
[[nodiscard]] std::vector<std::uint8_t> parse_in_child(
    const std::function<std::vector<std::uint8_t>()>& parse, const std::string& name,
    const GuardLimits& limits = {});

/// Error text for a file whose reading ended with `how`; `expected`: the expected kind of file.
[[nodiscard]] std::string damaged_file_message(const std::string& name, const std::string& how,
                                               const std::string& expected);

}  // namespace eti
