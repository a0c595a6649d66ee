// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/shard.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include "common/process/files/atomic_file_writer.hpp"
#include "common/process/files/folder.hpp"

namespace eti::bench {

namespace {

namespace fs = std::filesystem;

constexpr const char* manifest_name = "shard.json";
// Identifies this build: only the same build gives the same bits.
constexpr const char* build = "eti-bench " ETI_VERSION ", compiler " __VERSION__;

/// Parses a whole number at the start of `text` and removes it; none if there is none.
std::optional<std::size_t> take_number(std::string_view& text) {
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) {
        return std::nullopt;
    }
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

struct Manifest {
    nlohmann::json common;  ///< values that must be equal in all shards of a sweep
    std::size_t index = 0, count = 0;
    std::vector<std::string> tables;
};

Manifest read_manifest(const fs::path& folder) {
    std::ifstream in(folder / manifest_name);
    if (!in) {
        throw std::runtime_error(fmt::format(
            "{}: has no {}: the shard is incomplete, or this is not the folder of a shard; run it again",
            folder.string(), manifest_name));
    }
    try {
        const auto json = nlohmann::json::parse(in);
        return {json.at("sweep"), json.at("shard"), json.at("of"), json.at("tables")};
    } catch (const nlohmann::json::exception& error) {
        throw std::runtime_error(
            fmt::format("{}: {}; run that shard again", (folder / manifest_name).string(), error.what()));
    }
}

/// One table's rows by run, and its header.
struct Rows {
    std::string header;
    std::map<std::size_t, std::string> of_run;
};

void read_rows(const fs::path& file, const Manifest& shard, Rows& rows) {
    std::ifstream in(file);
    const auto refuse = [&](std::size_t line, const std::string& found) {
        throw std::runtime_error(
            fmt::format("{}:{}: {}; run shard {} again", file.string(), line, found, shard.index));
    };
    std::string text;
    if (!std::getline(in, text) || !text.starts_with("run,")) {
        refuse(1, "no header that begins with 'run,'");
    }
    if (rows.header.empty()) {
        rows.header = text.substr(4);
    } else if (rows.header != text.substr(4)) {
        refuse(1, "its columns are not those of the other shards");
    }
    for (std::size_t line = 2; std::getline(in, text); ++line) {
        std::string_view left = text;
        const std::optional<std::size_t> run = take_number(left);
        if (!run || !left.starts_with(',') || *run % shard.count != shard.index) {
            refuse(line, "not a row of one of its runs");
        }
        rows.of_run[*run] += std::string(left.substr(1)) + "\n";
    }
}

}  // namespace

Shard::Shard(std::string_view text) : sharded_(true) {
    std::string_view left = text;
    const std::optional<std::size_t> index = take_number(left);
    const bool slash = left.starts_with('/');
    left.remove_prefix(slash ? 1 : 0);
    const std::optional<std::size_t> count = take_number(left);
    if (!index || !slash || !count || !left.empty() || *index >= *count) {
        throw std::invalid_argument(
            fmt::format("'{}' is not a shard I/N with I from 0 to N - 1, such as 0/4 to 3/4", text));
    }
    index_ = *index;
    count_ = *count;
}

fs::path Shard::begin(const fs::path& out) const {
    if (!sharded_) {
        return out;
    }
    const fs::path folder = out / fmt::format("shard-{}-of-{}", index_, count_);
    fs::remove_all(folder);
    make_folder(folder);
    return folder;
}

void Shard::finish(const fs::path& folder, const std::string& command, const Settings& settings) const {
    if (!sharded_) {
        return;
    }
    nlohmann::ordered_json json;
    json["sweep"] = {{"command", command}, {"build", build}, {"runs", next_}};
    for (const auto& [name, value] : settings) {
        json["sweep"][name] = value;
    }
    json["shard"] = index_;
    json["of"] = count_;
    std::set<std::string> tables;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() == ".csv") {
            tables.insert(entry.path().filename().string());
        }
    }
    json["tables"] = tables;
    // It appears complete or not at all.
    const fs::path manifest = folder / manifest_name;
    if (const std::string why = write_file_atomically(manifest, json.dump(2) + "\n"); !why.empty()) {
        throw std::runtime_error(fmt::format(
            "{}: cannot be written: {}; free some space and run this shard again", manifest.string(), why));
    }
    spdlog::info("shard {} of {} is complete; when all are: eti-bench merge OUT {}", index_, count_,
                 (folder.parent_path() / fmt::format("shard-*-of-{}", count_)).string());
}

int merge(const fs::path& out, const std::vector<fs::path>& shards) {
    const Manifest first = read_manifest(shards.front());
    std::map<std::size_t, fs::path> given;
    std::map<std::string, Rows> tables;
    for (const fs::path& folder : shards) {
        const Manifest shard = read_manifest(folder);
        if (shard.common != first.common || shard.count != first.count || shard.tables != first.tables) {
            throw std::runtime_error(fmt::format(
                "{} and {} are of different sweeps, settings or builds ({} and {}); merge what was "
                "started with the same options by the same program",
                shards.front().string(), folder.string(), first.common.dump(), shard.common.dump()));
        }
        if (const auto [other, added] = given.emplace(shard.index, folder); !added) {
            throw std::runtime_error(fmt::format("{} and {} are both shard {}; give each once",
                                                 other->second.string(), folder.string(), shard.index));
        }
        for (const std::string& name : shard.tables) {
            if (fs::path(name).filename() != name) {
                throw std::runtime_error(
                    fmt::format("{}: '{}' is not the name of a table; run that shard again",
                                (folder / manifest_name).string(), name));
            }
            read_rows(folder / name, shard, tables[name]);
        }
    }
    for (std::size_t index = 0; index < first.count; ++index) {
        if (!given.contains(index)) {
            throw std::runtime_error(
                fmt::format("shard {} of {} is not among those given; give all of them", index, first.count));
        }
    }
    make_folder(out);
    for (const auto& [name, rows] : tables) {
        std::ofstream file(out / name);
        file << rows.header << "\n";
        for (const auto& [run, text] : rows.of_run) {
            file << text;
        }
        if (!file.flush()) {
            throw std::runtime_error(
                fmt::format("cannot write {}; choose another folder", (out / name).string()));
        }
        spdlog::info("wrote {}: {} runs with rows", (out / name).string(), rows.of_run.size());
    }
    return 0;
}

}  // namespace eti::bench
