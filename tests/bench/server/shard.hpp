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

/// The runs of a sweep that this process executes. Runs are independent and numbered in the order of a single
/// process; shard I of N executes those whose number modulo N is I, which spreads long and short ones evenly.
/// Its tables lie in a folder of its own, and their rows begin with the run's number. merge() combines those
/// of all shards into the tables that one process would have written.
class Shard {
  public:
    /// All runs, in tables without numbers.
    Shard() = default;
    /// From "I/N" with 0 <= I < N. Throws std::invalid_argument.
    explicit Shard(std::string_view text);

    /// Numbers the next run; returns true when this process executes it. Call it once for each run,
    /// independent of the result.
    [[nodiscard]] bool claim_next() { return next_++ % count_ == index_; }
    /// Number of the run that claim_next() was last called for.
    [[nodiscard]] std::size_t run() const { return next_ - 1; }
    [[nodiscard]] bool sharded() const { return sharded_; }

    /// Output folder of the tables: `out` itself or, for a shard, a folder in it. Removes the completion mark
    /// of an earlier attempt.
    [[nodiscard]] std::filesystem::path begin(const std::filesystem::path& out) const;

    using Settings = std::vector<std::pair<std::string, std::string>>;
    /// Marks the shard as complete in its folder, with the values that must be equal in all of them.
    void finish(const std::filesystem::path& folder, const std::string& command,
                const Settings& settings) const;

  private:
    bool sharded_ = false;
    std::size_t index_ = 0, count_ = 1;
    std::size_t next_ = 0;
};

/// Merges the tables of all shards of a sweep in `out`. Throws std::runtime_error when one is missing,
/// incomplete, or of another sweep or build. Returns the program's exit code.
[[nodiscard]] int merge(const std::filesystem::path& out, const std::vector<std::filesystem::path>& shards);

}  // namespace eti::bench
