// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/transform.hpp"
#include "common/scenario/data_file.hpp"

namespace eti {

/// Range of a number in typed units, and the SI value of one typed unit.
struct Range {
    float low, high;
    float unit = 1.0f;  ///< SI value of one typed unit, e.g. 1e-3 for millimetres
};

/// A YAML mapping, read strictly: every access names the key it expects, and finish() rejects keys that were
/// never read. All errors are InputErrors that state file, line and key, what was found, what was expected
/// and, where there is one, the remedy. A read with `help` describes its key.
class YamlMap {
  public:
    /// Parses `text`. Rejects anchors and aliases, tags, duplicate keys, a second document, more than 10,000
    /// values and nesting deeper than 12: a small file cannot expand to a large one.
    [[nodiscard]] static YamlMap parse(const std::string& text, const std::string& file);

    [[nodiscard]] bool has(std::string_view key) const;
    [[nodiscard]] float number(const std::string& key, float fallback, const Range& range,
                               std::string_view help = {});  ///< SI
    [[nodiscard]] int whole(const std::string& key, int fallback, int low, int high,
                            std::string_view help = {});
    [[nodiscard]] std::uint64_t seed(const std::string& key, std::uint64_t fallback,
                                     std::string_view help = {});
    [[nodiscard]] bool flag(const std::string& key, bool fallback, std::string_view help = {});
    /// At most 500 letters.
    [[nodiscard]] std::string text(const std::string& key, const std::string& fallback,
                                   std::string_view help = {});
    /// A name for the bus and for tables: one line of 1 to 60 letters.
    [[nodiscard]] std::string name(const std::string& key, const std::string& fallback,
                                   std::string_view help = {});
    /// Index of the value among `names`; `fallback` where the key is absent.
    [[nodiscard]] std::size_t choice(const std::string& key, std::size_t fallback,
                                     std::span<const std::string_view> names, std::string_view help = {});
    [[nodiscard]] Vec3f vector(const std::string& key, const Range& range);  ///< SI; zero where absent
    [[nodiscard]] std::optional<YamlMap> map(const std::string& key);
    [[nodiscard]] std::vector<YamlMap> list(const std::string& key);
    /// Rejects keys that were never read.
    void finish() const;
    /// The keys described so far, also those of mappings within this one.
    [[nodiscard]] const std::vector<KeyDescription>& described() const { return *described_; }

    [[noreturn]] void refuse(const std::string& key, const std::string& found,
                             const std::string& expected) const;

  private:
    using Descriptions = std::shared_ptr<std::vector<KeyDescription>>;

    YamlMap(YAML::Node node, std::string file, std::string path, Descriptions described);
    [[nodiscard]] std::optional<std::string> scalar(const std::string& key, const std::string& expected,
                                                    const std::string& fallback, std::string_view help);
    template <class Integer>
    [[nodiscard]] Integer integer(const std::string& key, Integer fallback, Integer low, Integer high,
                                  std::string_view help);
    [[nodiscard]] float in_range(const std::string& key, const std::string& typed, const Range& range) const;

    YAML::Node node_;
    std::string file_, path_;
    std::vector<std::string> known_;
    Descriptions described_;
};

}  // namespace eti
