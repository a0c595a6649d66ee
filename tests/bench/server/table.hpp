// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "common/process/files/folder.hpp"
#include "tests/bench/server/shard.hpp"

namespace eti::bench {

/// A table that a command writes row by row, so that finished rows survive an interruption.
class Table {
  public:
    /// Creates the folder and truncates the file to `header`. Throws when it cannot be written. Rows belong
    /// to the current run of `shard`, if any.
    Table(const std::filesystem::path& folder, const std::string& name, const std::string& header,
          const Shard* shard = nullptr)
        : path_(folder / name), shard_(shard != nullptr && shard->sharded() ? shard : nullptr) {
        make_folder(folder);
        stream_.open(path_);
        if (!stream_) {
            throw std::runtime_error("cannot write " + path_.string() + "; choose another folder with --out");
        }
        stream_ << (shard_ != nullptr ? "run," : "") << header << std::endl;
    }

    void row(const std::string& text) {
        if (shard_ != nullptr) {
            stream_ << shard_->run() << ',';
        }
        stream_ << text << std::endl;
    }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    const Shard* shard_;
    std::ofstream stream_;
};

}  // namespace eti::bench
