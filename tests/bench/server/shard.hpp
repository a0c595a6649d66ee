// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace eti::bench {

/// Which of a sweep's runs this process does. Runs are independent and numbered in the order in which one
/// process would do them all; shard I of N does those whose number leaves I when divided by N, so that long
/// and short ones are spread evenly. Its tables lie in a folder of its own, their rows begin with the run's
/// number, and merge() puts those of all shards together as one process would have written them.
class Shard {
  public:
    /// All runs, in tables without numbers.
    Shard() = default;
    /// From "I/N" with 0 <= I < N. Throws std::invalid_argument.
    explicit Shard(std::string_view text);

    /// Numbers the next run; true when this process does it. Ask once for each, whatever becomes of the
    /// others.
    [[nodiscard]] bool takes_next() { return next_++ % count_ == index_; }
    /// Number of the run that takes_next() was last asked of.
    [[nodiscard]] std::size_t run() const { return next_ - 1; }
    [[nodiscard]] bool sharded() const { return sharded_; }

    /// Where the tables go: `out` itself or, for a shard, a folder in it. An earlier attempt's end is
    /// forgotten.
    [[nodiscard]] std::filesystem::path begin(const std::filesystem::path& out) const;

    using Settings = std::vector<std::pair<std::string, std::string>>;
    /// The shard is whole: says so in its folder, with what has to be equal in all of them.
    void finish(const std::filesystem::path& folder, const std::string& command,
                const Settings& settings) const;

  private:
    bool sharded_ = false;
    std::size_t index_ = 0, count_ = 1;
    std::size_t next_ = 0;
};

/// Puts the tables of all shards of a sweep together in `out`. Throws std::runtime_error when one is missing,
/// not whole, or of another sweep or build. Returns the program's exit code.
[[nodiscard]] int merge(const std::filesystem::path& out, const std::vector<std::filesystem::path>& shards);

}  // namespace eti::bench
