// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace eti::bench {

/// A table that a command writes row by row, so that what is done is kept when it is stopped.
class Table {
  public:
    /// Makes the folder and begins the file anew with `header`. Throws when it cannot be written.
    Table(const std::filesystem::path& folder, const std::string& name, const std::string& header)
        : path_(folder / name) {
        std::filesystem::create_directories(folder);
        stream_.open(path_);
        if (!stream_) {
            throw std::runtime_error("cannot write " + path_.string() + "; choose another folder with --out");
        }
        row(header);
    }

    void row(const std::string& text) { stream_ << text << std::endl; }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    std::ofstream stream_;
};

}  // namespace eti::bench
