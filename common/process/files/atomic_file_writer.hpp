// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace eti {

/// Writes a file as "NAME.unfinished.PID" and renames it when it is complete: readers of NAME see either the
/// whole new file or the old one. Several programs may write one name at once; the last one wins. An
/// unfinished file is removed in the destructor.
class AtomicFileWriter {
  public:
    explicit AtomicFileWriter(std::filesystem::path name);
    ~AtomicFileWriter();
    AtomicFileWriter(const AtomicFileWriter&) = delete;
    AtomicFileWriter& operator=(const AtomicFileWriter&) = delete;

    /// Where to write until finish().
    [[nodiscard]] const std::filesystem::path& path() const { return temporary_path_; }
    /// Renames the file. Throws std::filesystem::filesystem_error.
    void finish();

  private:
    std::filesystem::path name_;
    std::filesystem::path temporary_path_;
};

/// Writes a whole file, replacing an existing one. Returns the reason of a failure ("is a pipe", "No space
/// left on device"), with the old file unchanged; empty on success.
[[nodiscard]] std::string write_file_atomically(const std::filesystem::path& name, std::string_view bytes);

/// The system's reason in a library's message if it says that there is no room ("No space left on device", a
/// quota, a limit of a file's size); otherwise empty.
[[nodiscard]] std::string full_disk_reason(std::string_view message);

/// The bytes of an array of plain values.
template <class Value>
[[nodiscard]] std::string_view bytes_of(std::span<const Value> values) {
    return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

}  // namespace eti
