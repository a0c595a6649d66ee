// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace eti {

/// A file that is written beside its name, as "NAME.unfinished.PID", and takes its name when it is whole: who
/// opens the name finds all of it, or what was there before. Several programs may write one name at once; the
/// last one stays. Unless finished it is removed with this object.
class UnfinishedFile {
  public:
    explicit UnfinishedFile(std::filesystem::path name);
    ~UnfinishedFile();
    UnfinishedFile(const UnfinishedFile&) = delete;
    UnfinishedFile& operator=(const UnfinishedFile&) = delete;

    /// Where to write until then.
    [[nodiscard]] const std::filesystem::path& path() const { return unfinished_; }
    /// Gives the file its name. Throws std::filesystem::filesystem_error.
    void finish();

  private:
    std::filesystem::path name_;
    std::filesystem::path unfinished_;
};

/// Writes a whole file, in the place of one that has its name. Returns in words why it could not ("is a
/// pipe", "No space left on device"), or nothing; then what was there is as it was.
[[nodiscard]] std::string write_whole(const std::filesystem::path& name, std::string_view bytes);

/// The bytes of a row of plain values.
template <class Value>
[[nodiscard]] std::string_view bytes_of(std::span<const Value> values) {
    return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

}  // namespace eti
